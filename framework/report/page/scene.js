// Where things were: truth, tracks, measurements and extents, at a time that is chosen.

/** The entries of the scene's files: `{time, id, centre, extent}`, by kind. */
function entriesOf(files, kind) {
  return files.filter((file) => file.kind === kind).flatMap((file) => file.time.map((time, i) => ({
    time, id: file.id[i], centre: file.position.map((axis) => axis[i]), extent: file.extent ? file.extent.map((part) => part[i]) : null })));
}

function byTime(entries) {
  const found = new Map();
  for (const entry of entries) found.has(entry.time) ? found.get(entry.time).push(entry) : found.set(entry.time, [entry]);
  return found;
}

/** One line for all paths, with gaps between them. */
function paths(entries, axes) {
  const byId = new Map();
  for (const entry of entries) byId.has(entry.id) ? byId.get(entry.id).push(entry) : byId.set(entry.id, [entry]);
  const line = Object.fromEntries(axes.map((axis) => [axis, []]));
  for (const path of byId.values()) {
    path.sort((a, b) => a.time - b.time).forEach((entry) => axes.forEach((axis, a) => line[axis].push(entry.centre[a])));
    axes.forEach((axis) => line[axis].push(null));
  }
  return line;
}

const points = (entries, axes) => Object.fromEntries(axes.map((axis, a) => [axis, entries.map((entry) => entry.centre[a])]));

class Scene {
  constructor(files) {
    this.flat = files.every((file) => file.position.length < 3);
    this.axes = this.flat ? ["x", "y"] : ["x", "y", "z"];
    this.kinds = {};
    for (const kind of ["truth", "tracks", "groups", "scans"]) {
      const all = entriesOf(files, kind);
      if (!this.flat) for (const entry of all) if (entry.centre.length === 2) entry.centre.push(0);
      this.kinds[kind] = { all, byTime: byTime(all) };
    }
    const leading = ["tracks", "truth", "groups", "scans"].find((kind) => this.kinds[kind].all.length);
    this.times = [...new Set([...this.kinds[leading].byTime.keys(), ...this.kinds.truth.byTime.keys()])].sort((a, b) => a - b);
    this.at = Math.min(this.times.length - 1, Math.floor(this.times.length / 2));
    this.hasExtents = ["truth", "tracks", "groups"].some((kind) => this.kinds[kind].all.some((entry) => root(entry.extent)));
    this.followed = this.hasExtents ? "nearest" : "all";
    const nouns = { groups: "group ", truth: "object ", tracks: "track " };
    const ids = Object.keys(nouns).map((kind) => unique(this.kinds[kind].all.map((entry) => entry.id)).slice(0, 50).map((id) => ({ value: kind + " " + id, text: nouns[kind] + id })));
    this.choices = [{ value: "all", text: "the whole scene" }, ...ids.flat()];
    if (this.hasExtents) this.followed = this.choices[1].value;
  }

  now(kind) { return this.kinds[kind].byTime.get(this.times[this.at]) || []; }

  /** What is followed, and how far around it is shown; null for the whole scene. */
  window() {
    const [kind, id] = this.followed.split(" ");
    if (kind === "all") return null;
    const path = this.kinds[kind].all.filter((entry) => entry.id === id);
    const time = this.times[this.at];
    const nearest = path.reduce((best, entry) => (Math.abs(entry.time - time) < Math.abs(best.time - time) ? entry : best), path[0]);
    const sizes = this.kinds[kind].all.filter((entry) => root(entry.extent)).map((entry) => reach(entry.extent)).sort((a, b) => a - b);
    const own = nearest && root(nearest.extent) ? 2 * reach(nearest.extent) : 0;  // groups are of many sizes
    const half = kind === "groups" && own ? own : sizes.length ? 1.7 * sizes[Math.floor(sizes.length / 2)] : this.span() / 20;
    return nearest && { centre: nearest.centre, half };
  }

  span() {
    const all = Object.values(this.kinds).flatMap((kind) => kind.all);
    return Math.max(1e-9, ...this.axes.map((_, a) => all.reduce((m, e) => Math.max(m, e.centre[a]), -Infinity) - all.reduce((m, e) => Math.min(m, e.centre[a]), Infinity)));
  }

  traces() {
    const type = this.flat ? "scatter" : "scatter3d", { axes } = this, made = [];
    const line = (name, kind, colour, width, dashing) => made.push({ type, mode: "lines", name, ...paths(this.kinds[kind].all, axes), line: { color: colour, width, dash: dashing }, hoverinfo: "skip", showlegend: this.kinds[kind].all.length > 0 });
    const dots = (name, entries, colour, size, symbol) => made.push({ type, mode: "markers", name, ...points(entries, axes), text: entries.map((e) => e.id), marker: { color: colour, size, symbol, line: { width: 0 } }, showlegend: name !== null && entries.length > 0,
      hovertemplate: `%{text}<br>${axes.map((a) => `${a} %{${a}:.6g} m`).join("<br>")}<extra></extra>` });
    line("truth", "truth", hue(2), this.flat ? 2 : 5, "solid");
    line("tracks", "tracks", hue(0), this.flat ? 2 : 4, this.flat ? "dot" : "dash");
    dots("measurements", this.now("scans"), hue(1), this.flat ? 6 : 4, "circle");
    dots("truth now", this.now("truth"), hue(2), this.flat ? 9 : 6, "diamond");
    dots("tracks now", this.now("tracks"), hue(0), this.flat ? 9 : 6, "square");
    dots("groups now", this.now("groups"), hue(3), this.flat ? 9 : 6, "cross");
    for (const [name, kind, colour] of [["true extent", "truth", hue(2)], ["estimated extent", "tracks", hue(0)], ["extent of groups", "groups", hue(3)]]) {
      const shown = this.now(kind).filter((entry) => entry.extent).slice(0, 200);
      if (this.flat) made.push({ type, mode: "lines", name, ...outlines(shown), fill: "toself", fillcolor: faint(colour, 0.2), line: { color: colour, width: 1.5 }, hoverinfo: "skip", showlegend: shown.length > 0 });
      else made.push({ type: "mesh3d", name, ...surfaces(shown), color: colour, opacity: kind === "tracks" ? 0.4 : 0.28, hoverinfo: "skip", showlegend: shown.length > 0, flatshading: false, lighting: { ambient: 0.7, diffuse: 0.6, specular: 0.2 } });
    }
    return made;
  }

  layout() {
    const around = this.window();
    const axis = (a) => ({ title: { text: this.axes[a] + " [m]" }, ...(around ? { range: [around.centre[a] - around.half, around.centre[a] + around.half], autorange: false } : { autorange: true }) });
    const common = { showlegend: true, uirevision: this.followed, legend: { orientation: "h", y: this.flat ? -0.14 : 0, yanchor: "top", x: 0 }, dragmode: this.flat ? "pan" : "turntable" };
    if (this.flat) return { ...common, xaxis: axis(0), yaxis: { ...axis(1), scaleanchor: "x" } };
    const in3d = (a) => ({ ...axis(a), color: colour("quiet"), gridcolor: colour("rule"), backgroundcolor: colour("paper"), zerolinecolor: colour("rule"), showspikes: false, nticks: 6 });
    return { ...common, margin: { l: 0, r: 0, t: 0, b: 60 }, scene: { xaxis: in3d(0), yaxis: in3d(1), zaxis: in3d(2), ...this.aspect(around), camera: { eye: { x: 1.05, y: -1.25, z: 0.65 }, center: { x: 0, y: 0, z: -0.06 } }, uirevision: this.followed } };
  }

  /** To scale, unless a path is so flat that nothing could be seen. */
  aspect(around) {
    if (around) return { aspectmode: "cube" };
    const all = [...this.kinds.truth.all, ...this.kinds.tracks.all, ...this.kinds.groups.all];
    const spans = this.axes.map((_, a) => all.reduce((m, e) => Math.max(m, e.centre[a]), -Infinity) - all.reduce((m, e) => Math.min(m, e.centre[a]), Infinity));
    const most = Math.max(...spans, 1e-9), ratio = spans.map((s) => Math.max(0.3, s / most));
    this.stretched = spans.some((s) => s / most < 0.3);
    return { aspectmode: "manual", aspectratio: { x: ratio[0], y: ratio[1], z: ratio[2] } };
  }
}

function sceneNotes(files) {
  return files.filter((file) => file.every > 1).map((file) => `Of the ${file.times} times in ${file.name} every ${file.every}th is kept.`).join(" ");
}

function showScene(files, about) {
  const drawable = files.filter((file) => file.time.length);
  if (!drawable.length) return;
  const part = section("scene", "Scene", `${about} Drag to turn, pinch or use the buttons to zoom. ${sceneNotes(files)}`);
  const scene = new Scene(drawable);
  const says = () => `At ${number(scene.times[scene.at], 6)} s: ${plural(scene.now("truth").length, "object")}, ${plural(scene.now("tracks").length, "track")}, ` +
    (scene.kinds.groups.all.length ? plural(scene.now("groups").length, "group") + ", " : "") + `${plural(scene.now("scans").length, "measurement")}.` +
    (scene.window() || !scene.stretched ? "" : " The axes are not to one scale.");
  const plot = figure("scene", 560, "", () => {
    const layout = scene.layout();
    return { data: scene.traces(), layout, says: "Scene. " + says(), caption: says() };
  });
  const slider = el("input", { type: "range", min: "0", max: String(scene.times.length - 1), step: "1", "aria-label": "Time" });
  slider.value = String(scene.at);
  const move = (at) => {
    scene.at = at;
    slider.value = String(at);
    slider.setAttribute("aria-valuetext", number(scene.times[at], 6) + " s");
    return plot.draw();
  };
  slider.addEventListener("input", () => move(Number(slider.value)));
  let playing = null;
  const button = el("button", { type: "button", onclick: () => (playing ? stop() : play()) }, "▶ Play");
  const stop = () => { clearTimeout(playing); playing = null; button.textContent = "▶ Play"; };
  const step = () => {
    if (scene.at + 1 >= scene.times.length) return stop();
    move(scene.at + 1).then(() => { if (playing) playing = setTimeout(step, 100); });
  };
  const play = () => {
    if (scene.at + 1 >= scene.times.length) scene.at = -1;
    button.textContent = "❚❚ Pause";
    playing = setTimeout(step, 0);
  };
  part.append(controls(button, el("label", { class: "wide" }, "Time", slider),
    choice("Around", scene.choices, scene.followed, (value) => { scene.followed = value; plot.draw(); })), plot.element);
}
