// Figures: drawn by Plotly, redrawn when colours or the width change, exported under their names.

const figures = [];

/** Axes, fonts and colours that all figures share. */
function look(layout = {}) {
  const axis = { gridcolor: colour("rule"), zerolinecolor: colour("rule"), linecolor: colour("quiet"), automargin: true };
  const made = {
    paper_bgcolor: colour("paper"), plot_bgcolor: colour("paper"),
    font: { family: "system-ui, 'DejaVu Sans', sans-serif", size: 13, color: colour("ink") },
    margin: { l: 60, r: 16, t: 48, b: 48 }, hovermode: "closest", dragmode: "pan",
    legend: { orientation: "h", y: -0.2, yanchor: "top", x: 0 },
    hoverlabel: { bgcolor: colour("raised"), font: { color: colour("ink") } },
    ...layout,
  };
  for (const name of Object.keys(made)) if (/^[xy]axis\d*$/.test(name)) made[name] = { ...axis, ...made[name] };
  return made;
}

/** On a narrow screen the buttons would lie over the titles; fingers do what they do. */
const settings = () => ({ responsive: true, displaylogo: false, scrollZoom: false, displayModeBar: window.innerWidth < 640 ? false : "hover",
  modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d", "toggleSpikelines"] });

/**
 * A figure. `build(width)` answers `{data, layout, says}`: Plotly's traces and layout, and what somebody is told who does not see them.
 * The answer has `element` and `draw()`.
 */
function figure(name, height, caption, build) {
  const plot = el("div", { class: "plot", id: "plot-" + name, role: "img", style: "height:" + height + "px" });
  const told = el("figcaption", {}, caption);
  const made = { name, plot, height, element: el("figure", {}, plot, told) };
  made.draw = () => {
    const built = build(plot.clientWidth || 800);
    plot.setAttribute("aria-label", built.says);
    if (built.height) plot.style.height = built.height + "px";
    made.height = built.height || height;
    if (built.caption) told.textContent = built.caption;
    return Plotly.react(plot, built.data, look(built.layout), settings());
  };
  figures.push(made);
  return made;
}

const drawAll = () => Promise.all(figures.map((each) => each.draw()));

let drawnWidth = window.innerWidth;
window.addEventListener("resize", () => {
  const isOther = (window.innerWidth < 640) !== (drawnWidth < 640);  // Plotly itself follows small changes
  drawnWidth = window.innerWidth;
  if (isOther) drawAll();
});
