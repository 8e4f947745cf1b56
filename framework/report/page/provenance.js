// What the result was made from, and where the time went.

function showProvenance(provenance, timing, notes) {
  const part = section("provenance", "Provenance", "The same config, seed, plugins and processor features give the same figures, byte for byte.");
  if (!provenance) part.append(el("p", { class: "note" }, "There is no provenance.json in this folder: what the result was made from is not known."));
  if (provenance) {
    const host = provenance.host || {};
    const facts = [["Config", provenance.config_file], ["Title", provenance.title], ["Seed", provenance.seed], ["Runs of each cell", provenance.runs], ["Run", provenance.run],
      ["Completed", provenance.completed === false ? "no: the run was stopped" : "yes"], ["Pelorus", host.pelorus], ["Compiler", host.compiler],
      ["Instruction set", host.isa && host.isa.compiled], ["Processor features", host.isa && (host.isa.processor || []).join(", ")], ["C library", host.libc]];
    part.append(table("Run and host", [{ head: "What", text: true }, { head: "Value", text: true }],
      facts.filter(([, value]) => value !== undefined && value !== null && value !== "").map(([name, value]) => [name, el("td", { class: "text wrap" }, String(value))])));
    if ((provenance.plugins || []).length)
      part.append(table("Plugins", [{ head: "Plugin", text: true }, { head: "Version", text: true }, { head: "SHA-256", text: true }],
        provenance.plugins.map((p) => [p.id, p.version, el("td", { class: "text wrap" }, el("code", {}, p.sha256))])));
    if (provenance.campaign) part.append(el("details", {}, el("summary", {}, "The campaign"), el("pre", { tabindex: "0" }, JSON.stringify(provenance.campaign, null, 2))));
    if (provenance.config) part.append(el("details", {}, el("summary", {}, provenance.campaign ? "The config of the first cell, as resolved" : "The config, as resolved"), el("pre", { tabindex: "0" }, JSON.stringify(provenance.config, null, 2))));
  }
  if (timing && timing.nodes) {
    const rows = Object.entries(timing.nodes).map(([name, node]) => [name, String(node.calls ?? ""), number(node.seconds)]);
    part.append(el("details", {}, el("summary", {}, `Where the time went (${number(timing.total_seconds, 3)} s)`),
      table("Processor time of the nodes, of all runs", [{ head: "Node", text: true }, { head: "Calls" }, { head: "Seconds" }], rows)));
  }
  for (const note of notes) part.append(el("p", { class: "note" }, note));
}
