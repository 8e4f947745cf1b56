// Variants and grid points: small multiples of one scalar, and the same as a table.

/** What the cells have in common. */
function gridOf(cells) {
  const addresses = unique(cells.flatMap((cell) => Object.keys(cell.sweep)));
  const points = [...new Map(cells.map((cell) => [pointKey(cell.sweep), cell.sweep])).entries()].map(([key, sweep]) => ({ key, sweep }));
  const scalars = new Map();
  for (const cell of cells) for (const [name, scalar] of Object.entries(cell.scalars)) scalars.set(name, scalar.unit);
  return { cells, addresses, points, variants: unique(cells.map((cell) => cell.variant)), scalars };
}

const cellOf = (grid, variant, key) => grid.cells.find((cell) => cell.variant === variant && pointKey(cell.sweep) === key);

/** Panels of small multiples: the last axis runs along a panel, all others make the panels. */
function panelsOf(grid) {
  const along = grid.addresses[grid.addresses.length - 1];
  const panels = new Map();
  for (const point of grid.points) {
    const rest = Object.fromEntries(Object.entries(point.sweep).filter(([address]) => address !== along));
    const key = pointKey(rest);
    if (!panels.has(key)) panels.set(key, { rest, points: [] });
    panels.get(key).points.push(point);
  }
  return { along, panels: [...panels.values()] };
}

function multiples(grid, scalar, width) {
  const { along, panels } = panelsOf(grid);
  const columns = Math.min(panels.length, width < 640 ? 1 : 3), rows = Math.ceil(panels.length / columns);
  const data = [], layout = { grid: { rows, columns, pattern: "independent", ygap: 0.3, xgap: 0.12 }, annotations: [] };
  panels.forEach((panel, p) => {
    const n = p ? String(p + 1) : "";
    grid.variants.forEach((variant, v) => {
      const scalars = panel.points.map((point) => cellOf(grid, variant, point.key)?.scalars[scalar]);
      if (!scalars.some((s) => s && isNumber(s.value))) return;
      data.push({ type: "scatter", mode: "lines+markers", name: variant, legendgroup: variant, showlegend: !data.some((d) => d.name === variant),
        x: panel.points.map((point) => valueText(point.sweep[along])), y: scalars.map((s) => (s ? s.value : null)),
        error_y: { type: "data", array: scalars.map((s) => (s && isNumber(s.ci95) ? s.ci95 : 0)), thickness: 1, width: 3 },
        line: { color: hue(v), dash: dash(v) }, marker: { symbol: symbols[v % symbols.length], size: 7 }, xaxis: "x" + n, yaxis: "y" + n,
        hovertemplate: `${variant.replace(/[<>&]/g, "")}: %{y:.4g}<extra></extra>` });
    });
    layout["xaxis" + n] = { type: "category", title: { text: shortAddress(along, grid.addresses) } };
    layout["yaxis" + n] = { matches: p ? "y" : undefined, title: p % columns ? undefined : { text: plain(withUnit(scalar, grid.scalars.get(scalar))) } };
    const title = pointText(panel.rest);
    if (title) layout.annotations.push({ text: plain(title), xref: `x${n} domain`, yref: `y${n} domain`, x: 0.5, y: 1.02, yanchor: "bottom", showarrow: false });
  });
  const height = 120 + rows * 290;
  return { data, layout: { ...layout, legend: { orientation: "h", y: -75 / (height - 120), yanchor: "top", x: 0 }, margin: { l: 60, r: 16, t: 36, b: 110 } }, height: height + 40 };
}

/** Without a grid: a point for each variant. */
function dots(grid, scalar) {
  const shown = grid.variants.map((variant) => cellOf(grid, variant, grid.points[0].key)?.scalars[scalar]);
  return { height: 120 + 34 * grid.variants.length,
    data: [{ type: "scatter", mode: "markers", y: grid.variants.map(plain), x: shown.map((s) => (s ? s.value : null)), marker: { size: 10, color: hue(0) },
      error_x: { type: "data", array: shown.map((s) => (s && isNumber(s.ci95) ? s.ci95 : 0)), thickness: 1.5, color: hue(0) }, hovertemplate: "%{y}: %{x:.4g}<extra></extra>" }],
    layout: { showlegend: false, xaxis: { title: { text: plain(withUnit(scalar, grid.scalars.get(scalar))) } }, yaxis: { type: "category", autorange: "reversed" } } };
}

/** Plotly takes some markup; names have none. */
const plain = (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

function lowest(grid, scalar) {
  const found = grid.cells.map((cell) => ({ cell, scalar: cell.scalars[scalar] })).filter((each) => each.scalar && isNumber(each.scalar.value));
  if (!found.length) return "no finite value";
  const least = found.reduce((a, b) => (a.scalar.value <= b.scalar.value ? a : b));
  const greatest = found.reduce((a, b) => (a.scalar.value >= b.scalar.value ? a : b));
  const told = (each) => `${number(each.scalar.value)} (${each.cell.variant}${grid.points.length > 1 ? ", " + pointText(each.cell.sweep) : ""})`;
  return `from ${told(least)} to ${told(greatest)}`;
}

function gridTable(grid, scalar) {
  const values = grid.points.map((point) => grid.cells.filter((cell) => pointKey(cell.sweep) === point.key).map((cell) => cell.scalars[scalar]?.value).filter(isNumber));
  const rows = grid.variants.map((variant) => [variant, ...grid.points.map((point, p) => {
    const cell = cellOf(grid, variant, point.key), told = cell?.scalars[scalar];
    if (!told) return el("td", {}, "");
    const least = Math.min(...values[p]), most = Math.max(...values[p]);
    const shade = isNumber(told.value) && most > least ? 0.28 * (most - told.value) / (most - least) : 0;
    const left = told.non_finite ? el("small", {}, ` (${told.non_finite} not finite)`) : null;
    return el("td", { style: `background: rgba(var(--heat), ${shade.toFixed(3)})` }, withInterval(told.value, told.ci95), left);
  })]);
  const heads = grid.points.map((point) => ({ head: pointText(point.sweep) || "value" }));
  return table(`${withUnit(scalar, grid.scalars.get(scalar))}: the darker, the smaller within its column; ± is the 95 % confidence interval`, [{ head: "Variant", text: true }, ...heads], rows);
}

function showGrid(cells) {
  const grid = gridOf(cells);
  const part = section("figures", "Figures", grid.addresses.length
    ? "One scalar for all variants at all grid points. Bars are 95 % confidence intervals; a click on the legend hides a variant, a double click all others."
    : null);
  if (cells.length === 1) return showScalars(part, cells[0]);
  if (!grid.scalars.size) return part.append(el("p", { class: "note" }, "There are no scalars: no analyzer published one."));
  let scalar = grid.scalars.keys().next().value;
  const place = el("div", {});
  const plot = figure("figures", 420, "", (width) => {
    const built = grid.addresses.length ? multiples(grid, scalar, width) : dots(grid, scalar);
    const says = `${withUnit(scalar, grid.scalars.get(scalar))}, ${lowest(grid, scalar)}.`;
    return { ...built, says, caption: says };
  });
  const draw = (name) => {
    scalar = name;
    place.replaceChildren(gridTable(grid, scalar));
    plot.draw();
  };
  part.append(controls(choice("Figure", [...grid.scalars].map(([name, unit]) => ({ value: name, text: withUnit(name, unit) })), scalar, draw)), plot.element, place);
  place.replaceChildren(gridTable(grid, scalar));
}

function showScalars(part, cell) {
  const rows = Object.entries(cell.scalars).map(([name, s]) => [name, number(s.value, 5), s.unit, isNumber(s.ci95) ? "± " + number(s.ci95, 2) : "", s.non_finite ? String(s.non_finite) : ""]);
  if (!rows.length) return part.append(el("p", { class: "note" }, "There are no scalars: no analyzer published one."));
  part.append(table(plural(rows.length, "scalar"), [{ head: "Figure", text: true }, { head: "Value" }, { head: "Unit", text: true }, { head: "95 % interval" }, { head: "Not finite, left out" }], rows));
}
