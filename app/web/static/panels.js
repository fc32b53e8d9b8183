// The panels under the 3D view: camera, lamps, grasps, provenance, scene graph, memory.
import { $, fill, h, table } from "./dom.js";

const empty = (text) => h("p", { class: "empty" }, text);
const SIGNS = { watched: ["◉", "watched"], kept: ["✓", "kept"], broken: ["✕", "broken"] };

export function showLamps(rows) {
  const lamps = rows.map((row) => {
    const [sign, word] = SIGNS[row.state] ?? SIGNS.watched;
    const numbers = [row.gap === null || row.gap === undefined ? null : `gap ${row.gap} mm`, ...row.measured].filter(Boolean);
    return h("span", { class: `lamp ${row.state}`, title: [row.reason, ...row.measured].join("\n"), tabindex: "0" },
      h("span", { class: "sign", "aria-hidden": "true" }, sign), h("b", {}, `${row.kind}: ${row.target}`), h("span", {}, word), numbers.length ? h("span", { class: "soft" }, numbers.slice(0, 2).join(", ")) : null);
  });
  fill($("lamps"), ...(lamps.length ? lamps : [h("span", { class: "lamp" }, h("span", { class: "sign soft", "aria-hidden": "true" }, "○"), h("span", { class: "soft" }, "Constraints: none active"))]));
}

export function showPictures(pictures, choice, choose) {
  const names = Object.keys(pictures).filter((name) => !name.endsWith("/near"));
  const chosen = names.includes(choice) ? choice : names[0];
  fill($("cameras"), ...names.map((name) => h("button", { type: "button", "aria-pressed": String(name === chosen), onclick: () => choose(name) }, name)));
  if (chosen) {
    $("picture").src = pictures[`${chosen}/near`] ?? pictures[chosen];
    $("picture").dataset.whole = pictures[chosen];
  }
  $("picture-open").disabled = !chosen;
}

export function showGrasps(plan, point) {
  const panel = $("panel-grasps");
  if (!plan) return fill(panel, empty("No grasp is planned yet. Once the robot plans one, its candidates stand here and as grippers in the 3D view, each with its score."));
  const rows = plan.candidates.map((row, index) => {
    const on = () => point(row.name);
    const off = () => point(null);
    return h("tr", { class: `pick${row.chosen ? " chosen" : ""}`, "data-name": row.name, tabindex: "0", title: "Sets it off in the 3D view", onmouseenter: on, onmouseleave: off, onfocus: on, onblur: off },
      h("td", {}, `${row.chosen ? "▶ " : ""}#${index + 1}`), h("td", { class: "n" }, row.score.toFixed(2)), h("td", {}, row.type), h("td", { class: "n" }, `${row.force} N`), h("td", { class: "n" }, `${row.opening} mm`), h("td", { class: "n" }, `${row.tilt}°`), h("td", { class: "n" }, `${row.yaw}°`));
  });
  const rejected = Object.entries(plan.rejected).map(([reason, count]) => `${count} ${reason}`);
  const clear = plan.clearance === null ? "nothing near" : `clearance ${plan.clearance} mm`;
  fill(panel, h("p", {}, h("b", {}, `${plan.target}, by its ${plan.region}`), ` · quality ${plan.quality.toFixed(2)} · ${clear}`),
    table([["rank"], ["score", "n"], ["type"], ["force", "n"], ["opening", "n"], ["tilt", "n"], ["yaw", "n"]], rows),
    rejected.length ? h("p", { class: "soft" }, `Rejected: ${rejected.join(", ")}.`) : null);
}

export function showWhy(plan, experiences) {
  const panel = $("panel-why");
  if (!plan) return fill(panel, empty("Where each number of a grasp comes from: experience, memory, constraint, geometry or a correction."));
  const rows = plan.provenance.map((row) => h("tr", {}, h("td", {}, row.field), h("td", {}, h("b", {}, row.value)),
    h("td", {}, ...row.sources.map((s) => h("span", { class: `src ${s.source}` }, s.id && s.id !== s.source ? `${s.source} · ${s.id}` : s.source)))));
  const parts = [table([["number"], ["value"], ["from"]], rows)];
  if (experiences?.top.length) {
    parts.push(h("p", { class: "soft" }, `Experiences, from ${experiences.funnel.join(" → ")}:`), table([["experience"], ["score", "n"], ["category", "n"], ["affordance", "n"], ["looks", "n"], ["worked", "n"]],
      experiences.top.map((e) => h("tr", {}, h("td", {}, e.id), h("td", { class: "n" }, e.score.toFixed(3)), h("td", { class: "n" }, e.category.toFixed(2)), h("td", { class: "n" }, e.affordance.toFixed(2)), h("td", { class: "n" }, e.looks.toFixed(2)), h("td", { class: "n" }, `${e.worked} of ${e.of}`)))));
  }
  fill(panel, ...parts);
}

export function showScene(look, graph) {
  const panel = $("panel-scene");
  if (!look) return fill(panel, empty("Nothing has been looked at yet. Ask “what do you see?”"));
  const things = look.objects.map((o) => h("tr", { class: o.id === look.target ? "chosen" : "" }, h("td", {}, `${o.id === look.target ? "▶ " : ""}${o.id}`), h("td", {}, `${o.name}${o.state === "empty" ? "" : `, ${o.state}`}`), h("td", { class: "n" }, o.confidence.toFixed(2)), h("td", {}, `${o.size.join(" × ")} mm`), h("td", {}, o.parts.join(", "))));
  const edges = graph.map((e) => h("tr", { class: e.telling ? "" : "soft" }, h("td", {}, e.source), h("td", {}, e.relation.toLowerCase().replaceAll("_", " ")), h("td", {}, e.target), h("td", { class: "n" }, e.gap === null ? "" : `${e.gap} mm`)));
  const label = look.by === "oracle" ? "Oracle perception: read from the simulator, not seen." : `Look ${look.number}, from pixels.`;
  fill(panel, h("p", { class: "soft" }, label), table([["object"], ["seen as"], ["sure", "n"], ["size"], ["parts"]], things),
    edges.length ? table([["relation of"], [""], ["to"], ["gap", "n"]], edges) : null);
}

export function showMemory(items, send) {
  const panel = $("panel-memory");
  if (!items.length) return fill(panel, empty("Nothing yet: what has worked in this session is remembered here, and used again for things alike."));
  const ask = (text, type) => h("button", { type: "button", class: "small", onclick: () => send({ type }) }, text);
  fill(panel, h("p", { class: "row" }, ask("Remember the last one for good", "remember"), ask("What do you remember?", "recall")), table([["thing"], ["grasp"], ["force", "n"], ["opening", "n"], ["weight", "n"], ["from"]],
    items.map((i) => h("tr", {}, h("td", {}, h("b", {}, i.category)), h("td", {}, `${i.type} at the ${i.region}`), h("td", { class: "n" }, `${i.force} N`), h("td", { class: "n" }, `${i.aperture} mm`), h("td", { class: "n" }, i.mass === null ? "" : `${i.mass} g`), h("td", {}, i.source || `attempt ${i.attempts}`)))));
}

export function wireTabs() {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  const choose = (tab) => {
    for (const other of tabs) {
      other.setAttribute("aria-selected", String(other === tab));
      other.tabIndex = other === tab ? 0 : -1;
      $(other.getAttribute("aria-controls")).hidden = other !== tab;
    }
  };
  tabs.forEach((tab, index) => {
    tab.onclick = () => choose(tab);
    tab.onkeydown = (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const next = tabs[(index + step + tabs.length) % tabs.length];
      choose(next);
      next.focus();
    };
  });
  return (id) => choose($(id));
}
