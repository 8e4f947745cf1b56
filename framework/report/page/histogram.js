// Distributions: scalars of the single runs, or the elements of a column.

/** Bins by the rule of Freedman and Diaconis, between 5 and 60 of them, common to all series. */
function binsOf(series) {
  const all = series.flatMap((s) => s.values).sort((a, b) => a - b);
  const least = all[0], most = all[all.length - 1];
  if (!(most > least)) return { from: least - 0.5, width: 1, count: 1 };
  const spread = all[Math.floor(0.75 * (all.length - 1))] - all[Math.floor(0.25 * (all.length - 1))];
  const wanted = spread > 0 ? (most - least) / (2 * spread / Math.cbrt(all.length / series.length)) : 10;
  const count = Math.max(5, Math.min(60, Math.ceil(wanted)));
  return { from: least, width: (most - least) / count, count };
}

function steps(values, bins) {
  const counts = new Array(bins.count).fill(0);
  for (const x of values) counts[Math.min(bins.count - 1, Math.floor((x - bins.from) / bins.width))] += 1;
  const x = [bins.from], y = [0];
  counts.forEach((count, b) => {
    x.push(bins.from + b * bins.width, bins.from + (b + 1) * bins.width);
    y.push(count, count);
  });
  x.push(bins.from + bins.count * bins.width);
  y.push(0);
  return { x, y };
}

/** What can be shown: of a campaign the scalars that every run has, otherwise columns of tables. */
function distributions(cells, samples) {
  const found = new Map();
  const add = (name, unit, of, cell, values) => {
    const finite = values.filter(isNumber);
    if (finite.length < 2) return;
    if (!found.has(name)) found.set(name, { name, unit, of, series: [] });
    found.get(name).series.push({ cell, values: finite, left: values.length - finite.length });
  };
  cells.forEach((cell, c) => {
    for (const [name, values] of Object.entries(samples?.[c] ?? {})) add(name, cell.scalars[name]?.unit ?? "", "runs", cell, values);
  });
  if (!found.size)
    for (const cell of cells)
      for (const [name, table] of Object.entries(cell.tables))
        table.columns.forEach((column, c) => {
          if (column.name !== "time") add(`${name}: ${column.name}`, column.unit, "rows", cell, table.rows.map((row) => row[c]));
        });
  return [...found.values()];
}

function showHistograms(cells, samples) {
  const all = distributions(cells, samples);
  if (!all.length) return;
  const isOfRuns = all[0].of === "runs";
  const part = section("distributions", "Distributions", isOfRuns
    ? "How a scalar is spread over the runs. Scalars that exist only over all runs, as an RMSE does, have no distribution."
    : "How the elements of a column are spread over the rows of its table.");
  const grid = gridOf(cells);
  const varies = all.findIndex((d) => d.series.some((s) => s.values.some((x) => x !== s.values[0])));
  let chosen = Math.max(varies, 0), key = grid.points[0].key;
  const plot = figure("distributions", 480, "", () => {
    const { name, unit, of, series } = all[chosen];
    const shown = series.filter((s) => pointKey(s.cell.sweep) === key);
    const bins = shown.length ? binsOf(shown) : null;
    const data = shown.map((s) => {
      const v = grid.variants.indexOf(s.cell.variant);
      return { type: "scatter", mode: "lines", name: plain(s.cell.variant), ...steps(s.values, bins), fill: "tozeroy", fillcolor: faint(hue(v), shown.length > 3 ? 0.07 : 0.25), line: { color: hue(v), dash: dash(v), width: 1.6 }, hovertemplate: "%{y} at %{x:.4g}" };
    });
    const left = shown.reduce((sum, s) => sum + s.left, 0);
    const says = `${withUnit(name, unit)} of the ${of}${grid.points.length > 1 ? " at " + pointText(JSON.parse(key)) : ""}` + (left ? `; ${left} that are not finite are left out` : "") + ".";
    return { data, says, caption: says, layout: { showlegend: data.length > 1, xaxis: { title: { text: plain(withUnit(name, unit)) } }, yaxis: { title: { text: of }, rangemode: "tozero", tickformat: "d" } } };
  });
  const redraw = () => plot.draw();
  part.append(controls(
    choice("Figure", all.map((d, i) => ({ value: String(i), text: withUnit(d.name, d.unit) })), String(chosen), (value) => { chosen = Number(value); redraw(); }),
    grid.points.length > 1 ? choice("Grid point", grid.points.map((p) => ({ value: p.key, text: pointText(p.sweep) })), key, (value) => { key = value; redraw(); }) : null,
  ), plot.element);
}
