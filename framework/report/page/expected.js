// Results beside the figures that were expected of them.

const kinds = { published: "Published", reproduced: "Reproduced", limit: "Limit" };

/** The judgement in words and colours: nobody has to tell green from red. */
function judgement(expected) {
  if (!expected) return el("td", {});
  const cell = el("td", {}, number(expected.value), " ");
  const told = expected.kind === "limit" ? (expected.within ? "kept" : "above") : percent(expected.deviation);
  if (expected.within === null) cell.append(el("small", {}, told));
  else cell.append(el("span", { class: expected.within ? "good" : "bad" }, (expected.within ? "✓ " : "✗ ") + told));
  return cell;
}

function bandText(figures) {
  const bands = {};
  for (const figure of figures) for (const e of figure.expected) if (isNumber(e.band)) bands[e.kind] = e.band;
  return Object.entries(bands).map(([kind, band]) => `${kind} figures within ${number(100 * band)} %`).join(", ");
}

function showExpected(beside) {
  const all = beside.figures;
  const bands = bandText(all);
  const part = section("expected", "Beside what is expected",
    `Each figure beside what is known of it. Percentages are deviations of this result; ✓ and ✗ stand where a band or a limit is stated` +
    (bands ? ` (${bands}).` : "."));
  if (!all.length) {
    part.append(el("p", { class: "note" }, "No cell of this result has an expected figure."));
    return;
  }
  const addresses = unique(all.flatMap((f) => Object.keys(f.sweep)));
  const shown = Object.keys(kinds).filter((kind) => all.some((f) => f.expected.some((e) => e.kind === kind)));
  const place = el("div", {});
  const draw = (scalar) => {
    const chosen = all.filter((f) => scalar === "" || f.scalar === scalar);
    const columns = [{ head: "Variant", text: true }, ...addresses.map((a) => ({ head: shortAddress(a, addresses) })),
      { head: "Figure", text: true }, { head: "This result" }, ...shown.map((kind) => ({ head: kinds[kind] }))];
    const rows = chosen.map((f) => [f.variant, ...addresses.map((a) => (a in f.sweep ? valueText(f.sweep[a]) : "")),
      withUnit(f.scalar, f.unit), withInterval(f.value, f.ci95),
      ...shown.map((kind) => judgement(f.expected.find((e) => e.kind === kind)))]);
    place.replaceChildren(table(`${plural(chosen.length, "figure")}; ± is the 95 % confidence interval`, columns, rows));
  };
  const scalars = unique(all.map((f) => f.scalar));
  part.append(controls(choice("Figure", [{ value: "", text: "all figures" }, ...scalars.map((s) => ({ value: s, text: s }))], "", draw)), place);
  draw("");
}
