// The page is put together.

function head(title, lead, facts) {
  document.getElementById("header").append(
    el("div", { class: "head" }, el("h1", {}, title), themeSwitch(drawAll)), el("p", { class: "lead" }, lead),
    el("dl", { class: "cards" }, facts.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value)))));
}

function showReport(page) {
  const summary = data("summary"), provenance = data("provenance"), beside = data("beside"), scene = data("scene", []), cells = summary.cells;
  const grid = gridOf(cells);
  const runs = cells.reduce((sum, cell) => sum + cell.runs, 0), failed = cells.reduce((sum, cell) => sum + (cell.failed || 0), 0);
  const facts = [["Variants", String(grid.variants.length)], ["Grid points", String(grid.points.length)], ["Runs", runs.toLocaleString("en")]];
  if (provenance) facts.push(["Seed", String(provenance.seed)]);
  if (failed) facts.push(["Failed runs", String(failed)]);
  if (beside && beside.judged) facts.push(["Figures as expected", `${beside.judged - beside.outside} of ${beside.judged}`]);
  head(page.title, page.lead, facts);
  if (provenance && provenance.completed === false) document.getElementById("main").append(el("p", { class: "note trouble" }, "The run was stopped before its end: the figures are of what was done until then."));
  if (failed) document.getElementById("main").append(el("p", { class: "note trouble" }, `${failed} runs failed and are left out. The first one said: ${cells.find((cell) => cell.failed).failure}`));
  if (beside) showExpected(beside);
  if (cells.length) showGrid(cells);
  showTime(cells);
  showScene(scene, cells.length > 1 || runs > 1 ? "Run 0 of the first cell." : "The run.");
  showLineage(scene);
  showHistograms(cells, data("samples"));
  showProvenance(provenance, data("timing"), page.notes);
}

function showComparison(page) {
  const compare = data("compare");
  const all = compare.cells.flatMap((cell) => Object.values(cell.scalars));
  head(page.title, page.lead, [["Cells in common", String(compare.cells.length)], ["Differences", String(all.length)], ["Clear ones", String(all.filter(isClear).length)], ["Runs paired", compare.paired ? "yes" : "no"]]);
  showDifferences(compare);
  showLeft(compare);
}

/** The figures as images, in place of the page: whoever asked for them takes them out of the document. */
async function exportFigures(format) {
  const images = [];
  for (const each of figures) {
    const size = { width: 1200, height: Math.max(each.height, 500) };
    images.push(el("img", { "data-figure": each.name, src: await Plotly.toImage(each.plot, { format, scale: format === "png" ? 2 : 1, ...size }) }));
  }
  document.head.replaceChildren();
  document.body.replaceChildren(...images, el("p", { id: "exported" }, String(images.length)));
}

const page = data("page");
document.getElementById("footer").textContent = `Made by pelorus ${page.version}. Everything that this page shows is in this one file.`;
if (page.kind === "comparison") showComparison(page);
else showReport(page);
drawAll().then(() => {
  document.documentElement.dataset.ready = "yes";
  if (options.has("export")) return exportFigures(options.get("export"));
});
