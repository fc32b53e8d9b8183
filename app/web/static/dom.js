// Elements are made from text, never from markup: whatever a scene, a model or a person wrote stays inert.
export const $ = (id) => document.getElementById(id);

export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function fill(element, ...children) {
  element.replaceChildren(...children.filter((child) => child !== null && child !== undefined));
}

export function table(head, rows) {
  const cells = head.map(([text, kind]) => h("th", { class: kind ?? "", scope: "col" }, text));
  return h("table", {}, h("thead", {}, h("tr", {}, ...cells)), h("tbody", {}, ...rows));
}

// At most once in so many milliseconds, and always with the latest call: the server cuts off a page that talks too much.
export function throttled(work, ms) {
  let timer = null, latest = null;
  const run = () => {
    if (latest === null) return (timer = null);
    const values = latest;
    latest = null;
    timer = setTimeout(run, ms);
    return work(...values);
  };
  return (...values) => {
    latest = values;
    if (timer === null) run();
  };
}
