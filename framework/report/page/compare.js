// Two results side by side: `compare` has `{a, b, paired, cells: [{variant_a, variant_b, sweep, scalars: {NAME: {...}}}], only_a, only_b}`.

/** Whether a difference is larger than its 95 % interval: then it is hardly chance. */
const isClear = (d) => isNumber(d.difference) && isNumber(d.ci95) && Math.abs(d.difference) > d.ci95;

const cellName = (cell) => [cell.variant_a === cell.variant_b ? cell.variant_a : `${cell.variant_a} → ${cell.variant_b}`, pointText(cell.sweep)].filter(Boolean).join(", ");

function forest(cells, scalar) {
  const shown = cells.filter((cell) => cell.scalars[scalar] && isNumber(cell.scalars[scalar].difference));
  const colours = shown.map((cell) => { const d = cell.scalars[scalar]; return isClear(d) ? hue(d.difference < 0 ? 2 : 1) : colour("quiet"); });
  const data = [{ type: "scatter", mode: "markers", y: shown.map((cell) => plain(cellName(cell))), x: shown.map((cell) => cell.scalars[scalar].difference),
    marker: { size: 9, color: colours, symbol: shown.map((cell) => (isClear(cell.scalars[scalar]) ? "circle" : "circle-open")) },
    error_x: { type: "data", array: shown.map((cell) => cell.scalars[scalar].ci95 ?? 0), thickness: 1.2, color: colour("quiet") }, hovertemplate: "%{y}: %{x:.4g}<extra></extra>" }];
  const unit = shown.length ? shown[0].scalars[scalar].unit : "";
  const clear = shown.filter((cell) => isClear(cell.scalars[scalar]));
  const less = clear.filter((cell) => cell.scalars[scalar].difference < 0).length;
  const says = `${withUnit(scalar, unit)}, B - A: clearly less in ${less} and clearly more in ${clear.length - less} of ${plural(shown.length, "cell")}. Filled points differ by more than their 95 % confidence interval.`;
  return { data, says, caption: says, height: 120 + 26 * Math.max(shown.length, 2), layout: { showlegend: false, margin: { l: 60, r: 16, t: 12, b: 60 },
    xaxis: { title: { text: plain(withUnit("B - A: " + scalar, unit)) }, zeroline: true, zerolinewidth: 2, zerolinecolor: colour("quiet") }, yaxis: { type: "category", autorange: "reversed", showgrid: false } } };
}

function differenceTable(cells, scalar) {
  const rows = cells.filter((cell) => cell.scalars[scalar]).map((cell) => {
    const d = cell.scalars[scalar];
    return [cellName(cell), number(d.a), number(d.b), el("td", {}, isClear(d) ? el("strong", {}, number(d.difference)) : number(d.difference), isNumber(d.ci95) ? " ± " + number(d.ci95, 2) : ""),
      isNumber(d.difference) && isNumber(d.a) && d.a !== 0 ? percent(d.difference / Math.abs(d.a)) : ""];
  });
  const unit = (cells.find((cell) => cell.scalars[scalar]) || { scalars: {} }).scalars[scalar]?.unit;
  return table(`${withUnit(scalar, unit)}; bold: the difference is larger than its 95 % confidence interval`,
    [{ head: "Cell", text: true }, { head: "A" }, { head: "B" }, { head: "B - A" }, { head: "Relative" }], rows);
}

function showDifferences(compare) {
  const part = section("differences", "Differences", (compare.paired
    ? "Both results have the same seed and the same runs, so differences are taken run by run: they are known better than the values."
    : "The runs of the two results are not paired: intervals are those of independent runs.") + " A is the first result, B the second.");
  const scalars = unique(compare.cells.flatMap((cell) => Object.keys(cell.scalars)));
  if (!scalars.length) return part.append(el("p", { class: "note" }, "The results have no scalar in common."));
  let scalar = scalars[0];
  const place = el("div", {});
  const plot = figure("differences", 420, "", () => forest(compare.cells, scalar));
  const show = (name) => { scalar = name; place.replaceChildren(differenceTable(compare.cells, scalar)); };
  part.append(controls(choice("Figure", scalars.map((s) => ({ value: s, text: s })), scalar, (name) => { show(name); plot.draw(); })), plot.element, place);
  show(scalar);
}

function showLeft(compare) {
  if (!compare.only_a.length && !compare.only_b.length) return;
  const part = section("left", "Not in common", null);
  const list = (title, names) => (names.length ? el("div", {}, el("h3", {}, title), el("ul", {}, names.map((name) => el("li", {}, name)))) : null);
  part.append(...[list("Only in A", compare.only_a), list("Only in B", compare.only_b)].filter(Boolean));
}
