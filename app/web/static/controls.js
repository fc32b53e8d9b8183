// Stop and release, scenes, sessions, speed, replays: everything in the bar and under the 3D view.
import { enlarge } from "./chat.js";
import { $, fill, h, throttled } from "./dom.js";

export function wireControls(page, send) {
  const stop = () => { window.stopPressedAt = Date.now(); send({ type: "stop" }); };
  $("stop").onclick = stop;
  $("release").onclick = () => send({ type: "release" });
  const onKey = (event) => { if (event.key === "Escape" && (page.status.busy || !document.querySelector("dialog[open]"))) stop(); };
  addEventListener("keydown", onKey);
  // A frame shows no ring of its own when the keyboard reaches it.
  addEventListener("keydown", (event) => { if (event.key === "Tab") document.body.classList.add("keys"); });
  addEventListener("pointerdown", () => document.body.classList.remove("keys"), true);
  // The 3D view is a document of its own: Esc must stop the robot there too.
  const listen = () => {
    $("view").contentWindow.addEventListener("keydown", onKey);
    $("view").contentWindow.addEventListener("pointerdown", () => document.body.classList.remove("keys"), true);
    for (const [name, has] of [["focus", true], ["blur", false]]) $("view").contentWindow.addEventListener(name, () => $("view").parentElement.classList.toggle("entered", has));
  };
  $("view").addEventListener("load", listen);
  if ($("view").contentDocument?.readyState === "complete") listen();
  $("asks").onchange = (event) => send({ type: "asks", on: event.target.checked });
  $("speed").onchange = (event) => send({ type: "speed", value: Number(event.target.value) });
  $("holder").onclick = () => { if (page.controls.free) send({ type: "take" }); };
  wireDialogs(page, send);
  const replay = wireReplay(page, send);
  let timer = null;
  return {
    show: () => { showStatus(page); replay.show(); },
    showReplays: replay.list,
    showOffers: () => showOffers(page, send),
    notice(text) {
      $("notice").textContent = text;
      $("notice").hidden = false;
      clearTimeout(timer);
      timer = setTimeout(() => { $("notice").hidden = true; }, 7000);
    },
  };
}

const plain = (scene) => scene.split("/").at(-1).replace(/\.ya?ml$/, "");

function showStatus(page) {
  const { status, controls } = page;
  const yours = controls.yours;
  $("scene-name").textContent = `${plain(status.scene ?? "")} · ${status.seed}`;
  $("scene-open").title = `Scene ${plain(status.scene ?? "")}, seed ${status.seed}`;
  $("session-name").textContent = status.thread ?? "not kept";
  $("speed").value = String(status.speed);
  $("asks").checked = Boolean(status.asks);
  $("release").hidden = !status.stopped;
  $("stop").classList.toggle("on", Boolean(status.stopped));
  $("stop").setAttribute("aria-pressed", String(Boolean(status.stopped)));
  const halted = status.halted_ms === null || status.halted_ms === undefined ? "" : ` · physics halted after ${status.halted_ms.toFixed(0)} ms`;
  const [kind, text] = status.stopped ? ["halt", `⬣ Stopped${halted}`] : status.replay !== null ? ["past", "↺ Replay, not live"] : status.busy ? ["busy", "Working"] : page.board.pending ? ["past", "Waits for your word"] : ["", "Live · ready"];
  $("state").className = `chip ${kind}`;
  $("state").textContent = text;
  const holder = $("holder");
  holder.className = `badge${controls.free && !yours ? " offer" : ""}`;
  holder.textContent = yours ? "You control" : controls.free ? "Take the controls" : `View only: page ${controls.holder} controls`;
  for (const id of ["scene-open", "session-open", "speed", "asks", "release", "words"]) $(id).disabled = !yours;
  document.querySelector(".send").disabled = !yours;
  $("words").placeholder = !yours ? "Another page has the controls" : page.board.pending ? "yes, no, or how else it should be" : status.busy ? "Steer it: “gentler”, “no, by the handle”" : "Tell the robot what to do";
}

function wireDialogs(page, send) {
  const close = (id) => $(id).close();
  $("scene-open").onclick = () => { $("scene-seed").value = page.status.seed ?? 0; $("scene-dialog").showModal(); };
  $("session-open").onclick = () => { send({ type: "offers" }); $("session-dialog").showModal(); };
  $("picture-open").onclick = () => enlarge($("picture").dataset.whole);
  $("scene-go").onclick = () => { send({ type: "scene", name: $("scene-pick").value, seed: Number($("scene-seed").value) || 0 }); close("scene-dialog"); };
  // Enter in a field does what the button of that part does.
  const enters = (fields, button) => fields.forEach((id) => $(id).addEventListener("keydown", (event) => { if (event.key === "Enter") { event.preventDefault(); $(button).click(); } }));
  enters(["scene-seed"], "scene-go");
  enters(["add-x", "add-y"], "add-go");
  $("add-place").onchange = (event) => { $("add-x").disabled = $("add-y").disabled = !event.target.checked; };
  $("add-go").onclick = () => {
    const places = [$("add-x"), $("add-y")];
    if ($("add-place").checked && !places.every((field) => field.reportValidity())) return;
    const position = $("add-place").checked ? places.map((field) => Number(field.value) / 1000) : null;
    send({ type: "add", model: $("add-pick").value, position });
    close("scene-dialog");
  };
  $("session-new").onclick = () => { send({ type: "fresh" }); close("session-dialog"); };
}

function showOffers(page, send) {
  const { scenes, models, sessions } = page.offers;
  fill($("scene-pick"), ...scenes.map((s) => h("option", { value: s.name, selected: s.name === page.status.scene }, s.say ? `${s.name}: ${s.say}` : s.name)));
  fill($("add-pick"), ...models.map((m) => h("option", { value: m }, m.replaceAll("_", " "))));
  const rows = sessions.map((s) => {
    const here = s.thread === page.status.thread;
    // What is deleted is gone: the button asks once more.
    const remove = (event) => {
      if (event.target.textContent !== "Delete") act("delete")();
      else event.target.textContent = "Really?";
    };
    const act = (action) => () => { send({ type: "session", action, thread: s.thread }); if (action === "open") $("session-dialog").close(); };
    return h("div", { class: "session" }, h("div", {}, h("b", {}, s.thread), here ? " (open)" : "", h("div", { class: "soft" }, `${plain(s.scene || "?")} · seed ${s.seed} · ${s.turns} ${s.turns === 1 ? "turn" : "turns"}${s.last ? ` · “${s.last.slice(0, 60)}”` : ""}`)),
      h("button", { type: "button", class: "small", disabled: here, onclick: act("open") }, "Open"), h("button", { type: "button", class: "small", title: "The whole session as one file", onclick: act("export") }, "Export"), h("button", { type: "button", class: "small no", disabled: here, onclick: remove }, "Delete"));
  });
  const points = (page.offers.points ?? []).map((p) => h("div", { class: "session" }, h("div", {}, `after turn ${p.turn}: “${p.said}”`),
    h("button", { type: "button", class: "small", onclick: () => { send({ type: "fork", point: p.id }); $("session-dialog").close(); } }, "Go back")));
  fill($("points"), ...(points.length ? points : [h("p", { class: "session soft" }, "Nothing was said yet.")]));
  fill($("sessions"), ...(rows.length ? rows : [h("p", { class: "session soft" }, "No session is kept yet.")]));
}

function wireReplay(page, send) {
  const at = $("replay-at"), run = $("replay-run");
  let player = null;
  const length = () => page.replays.find((r) => String(r.run) === run.value)?.seconds ?? 0;
  const pause = () => { clearInterval(player); player = null; $("replay-play").textContent = "Play"; };
  const ask = throttled((order) => send(order), 80);
  const move = () => {
    ask({ type: "replay", run: Number(run.value), share: at.value / 1000 });
    $("replay-time").textContent = `${((at.value / 1000) * length()).toFixed(1)} s`;
  };
  at.oninput = () => { pause(); move(); };
  run.onchange = () => { pause(); at.value = 0; move(); };
  $("replay-play").onclick = () => {
    if (player) return pause();
    if (Number(at.value) >= 1000) at.value = 0;
    $("replay-play").textContent = "Pause";
    const begun = Date.now(), from = at.value / 1000;
    player = setInterval(() => {
      const share = from + (Date.now() - begun) / 1000 / Math.max(length(), 0.1);
      at.value = Math.min(1000, share * 1000);
      move();
      if (share >= 1) pause();
    }, 100);
  };
  $("replay-live").onclick = () => { pause(); ask({ type: "live" }); at.value = 1000; };
  const show = () => {
    const usable = page.replays.length > 0 && !page.status.busy && page.controls.yours;
    at.disabled = run.disabled = $("replay-play").disabled = !usable;
    $("replay-live").disabled = page.status.replay === null || page.status.replay === undefined;
    if (page.status.busy) pause();
    if (page.status.replay === null) $("replay-time").textContent = "live";
  };
  const list = () => {
    const kept = run.value;
    fill(run, ...(page.replays.length ? page.replays.map((r) => h("option", { value: r.run }, `${r.seconds} s: ${r.words.length > 20 ? `${r.words.slice(0, 19)}…` : r.words}`)) : [h("option", { value: "" }, "no motion yet")]));
    if (page.replays.some((r) => String(r.run) === kept)) run.value = kept;
    show();
  };
  return { show, list };
}
