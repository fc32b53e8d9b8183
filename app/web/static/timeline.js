// The attempts with the forces that the robot felt, drawn as curves.
import { $, fill, h, svg } from "./dom.js";

const W = 640, H = 104, LEFT = 34, RIGHT = 8, TOP = 8, BOTTOM = 20;
const GRIP = "#0072b2", WRIST = "#a35f00";

function line(points, x, y, index) {
  return points.map((point, number) => `${number ? "L" : "M"}${x(point[0]).toFixed(1)} ${y(point[index]).toFixed(1)}`).join("");
}

function plot(row) {
  const end = Math.max(row.curve.at(-1)[0], 0.5);
  const peak = Math.max(5, ...row.curve.map((p) => Math.max(p[1], p[2])));
  const x = (t) => LEFT + (t / end) * (W - LEFT - RIGHT);
  const y = (n) => TOP + (1 - n / peak) * (H - TOP - BOTTOM);
  const parts = [];
  for (const share of [0, 0.5, 1]) {
    parts.push(svg("line", { x1: LEFT, x2: W - RIGHT, y1: y(peak * share), y2: y(peak * share), stroke: "#e3e8ee" }), svg("text", { x: LEFT - 4, y: y(peak * share) + 4, "text-anchor": "end" }, (peak * share).toFixed(0)));
  }
  let free = -1;
  for (const [name, start] of row.phases) {
    const at = x(start);
    parts.push(svg("line", { x1: at, x2: at, y1: TOP, y2: H - BOTTOM, stroke: "#b9c4cf", "stroke-dasharray": "2 3" }));
    if (at < free) continue;
    parts.push(svg("text", { x: at + 3, y: H - 6 }, name.replace("_", " ")));
    free = at + name.length * 6.6 + 10;
  }
  parts.push(svg("path", { d: line(row.curve, x, y, 2), fill: "none", stroke: WRIST, "stroke-width": 1.6, "stroke-dasharray": "5 2" }), svg("path", { d: line(row.curve, x, y, 1), fill: "none", stroke: GRIP, "stroke-width": 2.2 }));
  return svg("svg", { viewBox: `0 0 ${W} ${H}`, preserveAspectRatio: "none", role: "img", "aria-label": `Forces over ${end.toFixed(1)} seconds, peak ${peak.toFixed(1)} newtons` }, ...parts);
}

const WORDS = { moving: ["wait", "● moving"], claimed: ["good", "✓ claims success"], failed: ["bad", "✕ claims failure"], stopped: ["bad", "⬣ stopped"], done: ["wait", "✓ done"] };
const plain = (text) => text.toLowerCase().replaceAll("_", " ");

function card(row, number) {
  const [kind, word] = WORDS[row.state] ?? WORDS.moving;
  const name = row.tool === "execute_grasp" ? `Grasp, level ${row.level}` : plain(row.tool);
  const head = [h("b", {}, `${number}. ${name}`), h("span", { class: `tag ${kind}` }, row.failure ? `${word}: ${plain(row.failure)}` : word)];
  if (row.observed !== null) head.push(h("span", { class: `tag ${row.observed ? "good" : "bad"}` }, row.observed ? "✓ observed success" : `✕ observed ${plain(row.observed_failure ?? "failure")}`));
  if (row.correction) head.push(h("span", { class: "soft" }, `then: ${row.correction}`));
  const v = row.verdict;
  const facts = v ? `lifted ${v.lifted} cm · held ${v.held} s · slip ${v.slip} mm · peak ${v.peak} N${v.damage.length ? ` · damaged ${v.damage.join(", ")}` : ""}${v.disturbed.length ? ` · moved ${v.disturbed.join(", ")}` : ""}` : "";
  return h("div", { class: "attempt" }, h("div", { class: "head" }, ...head), row.curve.length > 1 ? plot(row) : null, facts ? h("div", { class: "soft" }, facts) : null);
}

const CHANGES = [["force", "force [N]", 4, 1], ["aperture", "opening [mm]", 60, 1000], ["yaw", "yaw [°]", 30, 180 / Math.PI], ["top", "approach from the top"], ["tilted", "a tilted approach"], ["side", "approach from the side"], ["other", "the next candidate"]];

// Simulates the last attempt otherwise; kept between redraws so that what was typed stays.
const value = h("input", { type: "number", step: "any", value: "4", "aria-label": "Value" });
const pick = h("select", { "aria-label": "What would be different" }, ...CHANGES.map(([name, label]) => h("option", { value: name }, label)));
pick.onchange = () => {
  const change = CHANGES.find(([name]) => name === pick.value);
  value.hidden = change.length === 2;
  if (!value.hidden) value.value = change[2];
};
let order = () => {};
const form = h("form", { class: "whatif", onsubmit: (event) => {
  event.preventDefault();
  const [name, , , scale] = CHANGES.find(([other]) => other === pick.value);
  if (scale) order({ type: "whatif", [name]: Number(value.value) / scale });
  else order({ type: "whatif", ...(name === "other" ? { candidate: "other" } : { approach: name }) });
} }, h("b", {}, "What if"), pick, value, h("button", { type: "submit", class: "small" }, "Simulate"));

export function showAttempts(rows, send) {
  order = send;
  const panel = $("panel-attempts");
  if (!rows.length) return fill(panel, h("p", { class: "empty" }, "Every motion appears here with the forces that the fingers and the wrist felt, what the robot claims, and what the observer saw."));
  const legend = h("span", { title: "Forces that were felt, over simulated time; the latest motion first" }, h("span", { style: `color:${GRIP};font-weight:650` }, "▬ fingers"), " ", h("span", { style: `color:${WRIST};font-weight:650` }, "╌ wrist"), h("span", { class: "soft" }, " N"));
  fill(panel, h("div", { class: "topline" }, rows.some((row) => row.tool === "execute_grasp" && row.state !== "moving") ? form : null, legend), ...rows.map((row, index) => card(row, index + 1)).reverse());
}
