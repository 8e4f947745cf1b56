// Columns of tables over their time column, for all variants, with bounds where the table has them.

/** Tables by name and columns that can be drawn over time: `NAME_lower` and `NAME_upper` are bounds of NAME, `true_NAME` is what it should be; none is a column of its own. */
function timeColumns(cells) {
  const found = new Map();
  for (const cell of cells)
    for (const [name, table] of Object.entries(cell.tables)) {
      const names = table.columns.map((column) => column.name);
      if (!names.includes("time") || table.rows.length < 2) continue;
      for (const column of table.columns) {
        if (column.name === "time" || /_(lower|upper)$/.test(column.name)) continue;
        if (column.name.startsWith("true_") && names.includes(column.name.slice(5))) continue;
        const key = JSON.stringify([column.name, column.unit]);
        if (!found.has(key)) found.set(key, { name: column.name, unit: column.unit, tables: new Set() });
        found.get(key).tables.add(name);
      }
    }
  return [...found.values()];
}

function columnOf(table, name) {
  const at = table ? table.columns.findIndex((column) => column.name === name) : -1;
  return at < 0 ? null : table.rows.map((row) => row[at]);
}

function timeTraces(cells, column) {
  const traces = [];
  let line = 0, bounded = false, held = false;
  for (const cell of cells)
    for (const name of column.tables) {
      const table = cell.tables[name], y = columnOf(table, column.name), x = columnOf(table, "time");
      if (!y || !y.some(isNumber)) continue;
      const label = column.tables.size > 1 ? `${cell.variant}, ${name.split(".")[0]}` : cell.variant;
      const lower = columnOf(table, column.name + "_lower"), upper = columnOf(table, column.name + "_upper");
      if (lower && upper && !bounded) {  // bounds depend on the number of runs, so they are the same for all variants
        bounded = true;
        traces.push({ type: "scatter", mode: "lines", x, y: lower, line: { color: faint(hue(8), 0.6), width: 1 }, hoverinfo: "skip", showlegend: false },
          { type: "scatter", mode: "lines", x, y: upper, fill: "tonexty", fillcolor: faint(hue(8), 0.18), line: { color: faint(hue(8), 0.6), width: 1 }, hoverinfo: "skip", name: "bounds" });
      }
      traces.push({ type: "scatter", mode: "lines", name: plain(label), x, y, line: { color: hue(line), dash: dash(line), width: 1.8 }, hovertemplate: "%{x:.5g} s: %{y:.4g}" });
      line += 1;
      const truth = columnOf(table, "true_" + column.name);
      if (truth && !held) {  // variants have the same truth
        held = true;
        traces.push({ type: "scatter", mode: "lines", name: "truth", x, y: truth, line: { color: colour("quiet"), dash: "dot", width: 2.4 }, hovertemplate: "%{x:.5g} s: %{y:.4g}" });
      }
    }
  return { traces, bounded };
}

function showTime(cells) {
  const columns = timeColumns(cells);
  if (!columns.length) return;
  const part = section("time", "Over time", "Reduced over the runs at each time, as the analyzer says (errors: root mean square). Tables of several nodes with the same column, as those of a bound, lie over each other.");
  const grid = gridOf(cells);
  let column = 0, key = grid.points[0].key;
  const plot = figure("time", 460, "", () => {
    const chosen = columns[column];
    const shown = cells.filter((cell) => pointKey(cell.sweep) === key);
    const { traces, bounded } = timeTraces(shown, chosen);
    const says = `${withUnit(chosen.name, chosen.unit)} over time${grid.points.length > 1 ? " at " + pointText(shown[0].sweep) : ""}` +
      (bounded ? "; the grey band holds it with the probability that the analyzer states, where all is right" : "") + thinnedText(shown, chosen) + ".";
    return { data: traces, says, caption: says, layout: { hovermode: "x unified", showlegend: traces.length > 1, xaxis: { title: { text: "time [s]" } },
      yaxis: { title: { text: plain(withUnit(chosen.name, chosen.unit)) }, rangemode: "tozero" } } };
  });
  const redraw = () => plot.draw();
  part.append(controls(
    choice("Column", columns.map((c, i) => ({ value: String(i), text: withUnit(c.name, c.unit) + (c.tables.size === 1 ? " · " + [...c.tables][0] : "") })), "0", (value) => { column = Number(value); redraw(); }),
    grid.points.length > 1 ? choice("Grid point", grid.points.map((p) => ({ value: p.key, text: pointText(p.sweep) })), key, (value) => { key = value; redraw(); }) : null,
  ), plot.element);
}

function thinnedText(cells, column) {
  for (const cell of cells)
    for (const name of column.tables)
      if (cell.tables[name]?.shown_every) return `; of ${cell.tables[name].all_rows} rows every ${cell.tables[name].shown_every}th is drawn`;
  return "";
}
