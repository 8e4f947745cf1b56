// The data that are embedded in the page, and how values are written.

/** The JSON of a data block; `otherwise` where the page has none. */
function data(id, otherwise = null) {
  const block = document.getElementById(id);
  return block ? JSON.parse(block.textContent) : otherwise;
}

const isNumber = (x) => typeof x === "number" && Number.isFinite(x);

/** `digits` significant digits, without an exponent where that is short; a dash for what is no number. */
function number(x, digits = 4) {
  if (!isNumber(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e7 || size < 1e-4) return x.toExponential(Math.max(digits - 2, 0));
  if (size >= 10 ** digits) return Math.round(x).toString();
  return String(Number(x.toPrecision(digits)));
}

/** `2.35 ± 0.04` */
const withInterval = (value, ci95) => number(value) + (isNumber(ci95) ? " ± " + number(ci95, 2) : "");
const percent = (x) => (isNumber(x) ? (x > 0 ? "+" : "") + (100 * x).toFixed(1) + " %" : "");
const withUnit = (name, unit) => (unit ? name + " [" + unit + "]" : name);
const plural = (n, noun) => n + " " + noun + (n === 1 ? "" : "s");
const unique = (list) => [...new Set(list)];

/** The shortest end of an address that no other address of the list has: `noise`, or `radar.noise` beside `camera.noise`. */
function shortAddress(address, all) {
  const parts = address.split(".");
  for (let n = 1; n < parts.length; n++) {
    const end = "." + parts.slice(-n).join(".");
    if (all.filter((other) => ("." + other).endsWith(end)).length === 1) return end.slice(1);
  }
  return address;
}

const valueText = (value) => (isNumber(value) ? number(value, 6) : typeof value === "string" ? value : JSON.stringify(value));

/** `noise 1, points_per_scan 16` */
function pointText(sweep) {
  const addresses = Object.keys(sweep);
  return addresses.map((a) => shortAddress(a, addresses) + " " + valueText(sweep[a])).join(", ");
}

const pointKey = (sweep) => JSON.stringify(sweep);
