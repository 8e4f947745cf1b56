// Elements of the page. Text gets in as text, never as markup.

/** An element with attributes (`onX` are listeners, null ones are left out) and children: elements, or what becomes text. */
function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

/** A section of the page, with its entry in the list of contents. */
function section(id, title, about) {
  const heading = el("h2", { id: id + "-title" }, title);
  const made = el("section", { id, "aria-labelledby": id + "-title" }, heading);
  if (about) made.append(el("p", { class: "about" }, about));
  document.getElementById("main").append(made);
  document.getElementById("contents").append(el("a", { href: "#" + id }, title));
  return made;
}

/** A table; `columns` are `{head, text}`, cells texts or elements. The first cell of a row heads it. */
function table(caption, columns, rows) {
  const kind = (column) => (columns[column].text ? "text" : null);
  const head = columns.map((column, c) => el("th", { scope: "col", class: kind(c) }, column.head));
  const body = rows.map((row) =>
    el("tr", {}, row.map((cell, c) => (c === 0 ? el("th", { scope: "row" }, cell) : cell instanceof HTMLTableCellElement ? cell : el("td", { class: kind(c) }, cell)))));
  // What scrolls must be reached by the keyboard.
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
    el("table", {}, el("caption", {}, caption), el("thead", {}, el("tr", {}, head)), el("tbody", {}, body)));
}

/** A labelled choice; `options` are `{value, text}`. */
function choice(label, options, chosen, onChoice) {
  const select = el("select", { onchange: () => onChoice(select.value) }, options.map((o) => el("option", { value: o.value }, o.text)));
  select.value = chosen;
  return el("label", {}, label, select);
}

const controls = (...children) => el("div", { class: "controls" }, ...children);
