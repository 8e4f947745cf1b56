// Dark and light: as the system says, until the switch is used.

const systemIsDark = window.matchMedia("(prefers-color-scheme: dark)");
const options = new URLSearchParams(location.hash.slice(1));

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : systemIsDark.matches;
}

/** The button; `onChange` redraws what does not follow the style sheet. */
function themeSwitch(onChange) {
  const label = () => (isDark() ? "Light" : "Dark");
  const button = el("button", { id: "theme", type: "button", onclick: () => choose(isDark() ? "light" : "dark") }, label());
  const changed = () => {
    button.textContent = label();
    button.setAttribute("aria-label", "Show the page in " + (isDark() ? "light" : "dark") + " colours");
    onChange();
  };
  const choose = (theme) => {
    document.documentElement.dataset.theme = theme;
    changed();
  };
  systemIsDark.addEventListener("change", changed);
  button.setAttribute("aria-label", "Show the page in " + (isDark() ? "light" : "dark") + " colours");
  return button;
}

if (["dark", "light"].includes(options.get("theme"))) document.documentElement.dataset.theme = options.get("theme");
if (options.has("export")) document.documentElement.dataset.theme = "light";

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

// Ten hues that people with colour deficiencies can tell apart as well as ten can be; lines differ in dashes, too.
const hues = {
  light: ["#0b5cad", "#c8501e", "#12805c", "#8e44ad", "#b8860b", "#d0267c", "#3a7ca5", "#6b4f3a", "#5a6572", "#7a9a01"],
  dark: ["#6db1ff", "#ff9a6b", "#4fd6a5", "#cf9cf0", "#f0c14b", "#ff84bd", "#86c9ee", "#d0ac8f", "#b4bfcb", "#bfdc4e"],
};
const dashes = ["solid", "dash", "dot", "dashdot", "longdash"];
const symbols = ["circle", "square", "diamond", "cross", "triangle-up", "x", "star", "hexagon", "pentagon", "triangle-down"];

function hue(index) {
  const list = isDark() ? hues.dark : hues.light;
  return list[index % list.length];
}
const dash = (index) => dashes[Math.floor(index / 2) % dashes.length];

/** A colour with an opacity, from `#rrggbb`. */
function faint(hex, opacity) {
  const part = (at) => parseInt(hex.slice(at, at + 2), 16);
  return `rgba(${part(1)}, ${part(3)}, ${part(5)}, ${opacity})`;
}
