// The conversation: entries as they come, the approval box, and suggestions.
import { $, fill, h } from "./dom.js";

const STEPS = ["understood", "look", "grounding", "retrieved", "graphed", "constrained", "planned", "thought", "approval", "action", "observation", "reflection", "remembered", "sub_goal", "heeded", "noted", "reply_refused"];
const MOST = 400;

export function enlarge(source) {
  $("picture-large").src = source;
  $("picture-dialog").showModal();
}

export function entryElement(entry) {
  const kind = /^[a-z_]+$/.test(entry.kind) ? entry.kind : "noted";
  const box = h("div", { class: `entry k-${kind}${STEPS.includes(kind) ? " step" : ""}` }, h("span", { class: "who" }, entry.label), h("span", {}, entry.text));
  if (entry.details.length) {
    box.append(h("details", {}, h("summary", {}, entry.details.length === 1 ? "numbers" : `${entry.details.length} lines`), ...entry.details.map((line) => h("div", {}, line))));
  }
  // Only pictures of this session's own folder are shown, whatever an entry says.
  if (/^\/session\/[A-Za-z0-9_-]+\.png$/.test(entry.picture ?? "")) box.append(h("button", { type: "button", class: "aside", "aria-label": "Enlarge the picture", onclick: () => enlarge(entry.picture) }, h("img", { src: entry.picture, alt: "Both endings side by side" })));
  return box;
}

// The end stays in view while the person has not scrolled back, also when the box below grows or shrinks.
let pinned = true, top = 0, size = "";
$("log").addEventListener("scroll", () => {
  const log = $("log"), now = `${log.clientWidth}x${log.clientHeight}`;
  // A window that changes its size moves the text too; that is nobody scrolling back.
  if (now !== size) {
    size = now;
    if (pinned) log.scrollTop = log.scrollHeight;
  } else if (log.scrollHeight - log.scrollTop - log.clientHeight < 60) pinned = true;
  else if (log.scrollTop < top) pinned = false;
  top = log.scrollTop;
});
new ResizeObserver(() => { if (pinned) $("log").scrollTop = $("log").scrollHeight; }).observe($("log"));

// What a model is saying: not judged yet, gone when the next entry comes, and not read aloud word by word.
let saying = null;

export function showSaying(text) {
  const log = $("log");
  if (!saying?.isConnected) log.append(saying = h("div", { class: "entry step k-saying", "aria-hidden": "true" }, h("span", { class: "who" }, "Says"), h("span", {})));
  saying.lastElementChild.textContent = text;
  if (pinned) log.scrollTop = log.scrollHeight;
}

export function addEntry(entry) {
  const log = $("log");
  saying?.remove();
  log.append(entryElement(entry));
  while (log.childElementCount > MOST) log.firstElementChild.remove();
  pinned ||= entry.kind === "said";
  if (pinned) log.scrollTop = log.scrollHeight;
}

export function showTranscript(entries) {
  const log = $("log");
  fill(log, ...entries.map(entryElement));
  if (!entries.length) log.append(h("p", { class: "empty" }, "Say what the robot is to do, in your words. You see what it sees, why it chooses a grasp, and what it felt. Esc stops it at once."));
  log.scrollTop = log.scrollHeight;
}

// Field, label, digits, scale to what is shown.
const FIELDS = [["force", "force N", 1, 1], ["aperture", "open mm", 0, 1000], ["yaw", "yaw °", 0, 180 / Math.PI], ["standoff", "start mm", 0, 1000], ["speed", "speed", 2, 1], ["x", "mm from its base", 0, 1000], ["y", "mm to your right", 0, 1000]];

export function showApproval(pending, limits, mayAct, send) {
  const box = $("approval");
  box.hidden = !pending;
  if (!pending) return;
  const inputs = FIELDS.filter(([field]) => field in pending.numbers).map(([field, label, digits, scale]) => {
    const [low, high] = (limits[field] ?? [-1e3, 1e3]).map((value) => value * scale);
    const shown = Number((pending.numbers[field] * scale).toFixed(digits));
    const hint = `${Number(low.toFixed(digits))} … ${Number(high.toFixed(digits))}`;
    const input = h("input", { type: "number", name: field, step: "any", min: Math.floor(low * 100) / 100, max: Math.ceil(high * 100) / 100, value: shown, required: true, disabled: !mayAct });
    return [field, scale, shown, input, label, hint];
  });
  const yes = h("button", { type: "submit", class: "yes", disabled: !mayAct }, "Approve");
  const changed = () => inputs.filter(([, , was, input]) => Number(input.value) !== was);
  fill(box, h("h2", {}, pending.question), h("p", { class: "why" }, pending.thought),
    h("div", { class: inputs.length > 2 ? "numbers" : "numbers few" }, ...inputs.map(([, , , input, label, hint]) => h("label", {}, label, input, h("small", { title: "Limits" }, hint)))),
    h("div", { class: "row" }, yes, h("button", { type: "button", class: "no", disabled: !mayAct, onclick: (event) => { send({ type: "reject" }); typeOn(event); } }, "Reject")));
  box.oninput = () => { yes.textContent = changed().length ? "Approve with my numbers" : "Approve"; };
  box.onsubmit = (event) => {
    event.preventDefault();
    const edits = changed();
    if (box.contains(document.activeElement) && !matchMedia("(pointer: coarse)").matches) $("words").focus();
    if (!edits.length) send({ type: "approve" });
    else send({ type: "edit", ...Object.fromEntries(edits.map(([field, scale, , input]) => [field, Number(input.value) / scale])) });
  };
  if (mayAct && document.activeElement === document.body) yes.focus();
}

// A button that goes when it is pressed leaves the keyboard's focus nowhere; a finger's tap must not raise a keyboard.
const typeOn = (event) => { if (event.detail === 0) $("words").focus(); };

export function showHints(words, send) {
  fill($("hints"), ...words.map(([text, order]) => h("button", { type: "button", onclick: (event) => { send(order); typeOn(event); } }, text)));
}
