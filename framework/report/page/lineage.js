// Who came from whom: a line for each group (or track) while it was there, and where it split from another one or absorbed it.

/** What happened when: `{time, parent, child, isSplit}`; a child that was not there before has split from its parent. */
function lineageEvents(relatives) {
  const known = new Set(relatives.map((relative) => relative.id));
  return relatives.flatMap((relative) => relative.parents.filter(([parent]) => known.has(parent)).map(([parent, time]) => ({ time, parent, child: relative.id, isSplit: time <= relative.spans[0][0] })));
}

/** Where there are many, those that are nobody's parent nor child are left out. */
function related(relatives) {
  if (relatives.length <= 40) return relatives;
  const parents = new Set(relatives.flatMap((relative) => relative.parents.map(([parent]) => parent)));
  return relatives.filter((relative) => relative.parents.length || parents.has(relative.id));
}

function lineageTraces(relatives, events) {
  const row = new Map(relatives.map((relative, i) => [relative.id, i]));
  const there = { x: [], y: [], text: [] };
  for (const { id, spans } of relatives)
    for (const [from, to] of spans) {
      there.x.push(from, to, null);
      there.y.push(row.get(id), row.get(id), null);
      there.text.push(id, id, null);
    }
  const made = [{ type: "scatter", mode: "lines+markers", name: "there", ...there, line: { color: hue(0), width: 5 }, marker: { size: 5, color: hue(0) }, hovertemplate: "%{text}, %{x:.6g} s<extra></extra>" }];
  for (const [name, isSplit, colour, symbol] of [["split off", true, hue(2), "circle"], ["absorbed", false, hue(1), "x"]]) {
    const line = { x: [], y: [], text: [] };
    for (const event of events.filter((each) => each.isSplit === isSplit)) {
      const words = isSplit ? `${event.child} from ${event.parent}` : `${event.parent} into ${event.child}`;
      line.x.push(event.time, event.time, null);
      line.y.push(row.get(event.parent), row.get(event.child), null);
      line.text.push(words, words, null);
    }
    made.push({ type: "scatter", mode: "lines+markers", name, ...line, line: { color: colour, width: 1.5, dash: isSplit ? "solid" : "dot" }, marker: { size: 8, symbol, color: colour }, hovertemplate: "%{text}, %{x:.6g} s<extra></extra>", showlegend: line.x.length > 0 });
  }
  return made;
}

function showLineage(files) {
  const told = files.filter((file) => file.lineage);
  if (!told.length) return;
  const part = section("lineage", "Lineage", "Who came from whom: a line while a group or track was there, a link where one split off another or was absorbed by it. The larger part of a split keeps its name.");
  let chosen = told.find((file) => file.kind === "groups") || told[0];
  const plot = figure("lineage", 460, "", () => {
    const relatives = related(chosen.lineage), left = chosen.lineage.length - relatives.length, events = lineageEvents(relatives), splits = events.filter((each) => each.isSplit).length;
    const says = `${plural(chosen.lineage.length, chosen.kind === "groups" ? "group" : "track")} of ${chosen.name}: ${plural(splits, "split")}, ${plural(events.length - splits, "merger")}${left ? `; ${left} without relatives are not drawn` : ""}.`;
    return { data: lineageTraces(relatives, events), says: "Lineage. " + says, caption: says, height: Math.min(1600, 160 + 20 * relatives.length),
      layout: { hovermode: "closest", showlegend: true, xaxis: { title: { text: "time [s]" } },
        yaxis: { tickmode: "array", tickvals: relatives.map((_, i) => i), ticktext: relatives.map((relative) => relative.id), autorange: "reversed", zeroline: false } } };
  });
  part.append(told.length > 1 ? controls(choice("Table", told.map((file) => ({ value: file.name, text: file.name })), chosen.name, (name) => { chosen = told.find((file) => file.name === name); plot.draw(); })) : "", plot.element);
}
