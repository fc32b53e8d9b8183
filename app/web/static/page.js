// Connects to the robot, hands messages to the panels, and orders back. The server checks every order again.
import { addEntry, showApproval, showHints, showSaying, showTranscript } from "./chat.js";
import { wireControls } from "./controls.js";
import { $, throttled } from "./dom.js";
import { wireHover } from "./hover.js";
import { showGrasps, showLamps, showMemory, showPictures, showScene, showWhy, wireTabs } from "./panels.js";
import { wirePortage } from "./portage.js";
import { showAttempts } from "./timeline.js";

const page = { status: {}, board: {}, offers: { scenes: [], models: [], sessions: [], limits: {} }, replays: [], controls: { yours: false }, camera: "front" };
let socket = null;
let waiting = 500;

function identity() {
  let id = sessionStorage.getItem("page");
  if (!id) sessionStorage.setItem("page", (id = crypto.randomUUID?.() ?? Array.from(crypto.getRandomValues(new Uint8Array(16)), (b) => b.toString(16).padStart(2, "0")).join("")));
  return id;
}

export function send(order) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(order));
}

const sendBytes = (bytes) => { if (socket?.readyState === WebSocket.OPEN) socket.send(bytes); };
const chooseTab = wireTabs();
const controls = wireControls(page, send);
const point = throttled((name) => send({ type: "point", name }), 80);
// Grippers are drawn from the plan until the motion is over.
wireHover(() => (page.status.busy || page.board.pending ? page.board.plan?.candidates ?? [] : []), point);
const portage = wirePortage(send, sendBytes, (text) => controls.notice(text));

const PARTS = {
  look: () => showScene(page.board.look, page.board.graph),
  graph: () => showScene(page.board.look, page.board.graph),
  constraints: (value) => showLamps(value),
  plan: (value) => { showGrasps(value, point); showWhy(value, page.board.experiences); },
  experiences: () => showWhy(page.board.plan, page.board.experiences),
  attempts: (value) => showAttempts(value, send),
  memory: (value) => showMemory(value, send),
  pictures: (value) => showPictures(value, page.camera, (name) => { page.camera = name; PARTS.pictures(page.board.pictures); }),
  pending: (value) => { controls.show(); showApproval(value, page.offers.limits, page.controls.yours, send); hints(); },
};

function hints() {
  const scene = page.offers.scenes.find((s) => s.name === page.status.scene);
  const say = (text) => [text, { type: "say", text }];
  const done = page.board.attempts?.filter((row) => row.tool === "execute_grasp").length;
  const words = page.status.unfinished ? [[`Go on: ${page.status.unfinished.slice(0, 40)}`, { type: "resume" }]] : [];
  if (!page.status.busy && !page.board.pending && page.controls.yours) {
    if (done) words.push(["Why?", { type: "why" }], ["What if 4 N?", { type: "whatif", force: 4 }], ...(done > 1 ? [["Compare", { type: "compare" }]] : []), ["Undo", { type: "undo" }]);
    else words.push(say(scene?.say || "pick it up"));
    if (!(done > 1)) words.push(say("what do you see"));
  }
  showHints(words, send);
}

function status(next) {
  const before = page.status;
  page.status = next;
  controls.show();
  if (next.busy !== before.busy || next.unfinished !== before.unfinished || next.scene !== before.scene) hints();
}

const HANDLERS = {
  hello(message) {
    Object.assign(page, { board: message.board, replays: message.replays, offers: message.offers ?? page.offers });
    status(message.status);
    showTranscript(message.transcript);
    for (const part of ["constraints", "plan", "look", "attempts", "memory", "pictures", "pending"]) PARTS[part](page.board[part]);
    controls.showReplays();
    controls.showOffers();
    hints();
  },
  status: (message) => status(message.status),
  board(message) {
    page.board[message.part] = message.value;
    PARTS[message.part]?.(message.value);
    if (message.part === "attempts" && message.value.at(-1)?.state === "moving" && message.value.at(-1).curve.length === 0) chooseTab("tab-attempts");
    if (message.part === "pending" && message.value && "force" in message.value.numbers) chooseTab("tab-grasps");
  },
  entry(message) {
    document.querySelector("#log > .empty")?.remove();
    addEntry(message.entry);
  },
  saying: (message) => showSaying(message.text),
  replays(message) { page.replays = message.value; controls.showReplays(); },
  offers(message) { page.offers = message.value; controls.showOffers(); },
  controls(message) { page.controls = message; controls.show(); PARTS.pending(page.board.pending); },
  notice: (message) => controls.notice(message.text),
  upload: (message) => portage.upload(message),
  download: (message) => portage.download(message),
};

function connect() {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/talk`);
  socket.onopen = () => {
    waiting = 500;
    $("lost").hidden = true;
    send({ type: "enter", page: identity() });
  };
  socket.onmessage = (event) => {
    const message = JSON.parse(event.data);
    HANDLERS[message.type]?.(message);
  };
  socket.onclose = async () => {
    $("lost").hidden = false;
    // Another process does not know this page's cookie: trying again would be in vain.
    const answer = await fetch("/", { cache: "no-store" }).catch(() => null);
    if (answer?.status === 403) return ($("lost").textContent = "The robot's program was started anew. Open the address that it printed.");
    setTimeout(connect, waiting);
    waiting = Math.min(waiting * 2, 8000);
  };
}

$("compose").onsubmit = (event) => {
  event.preventDefault();
  const text = $("words").value.trim();
  if (!text) return;
  send({ type: "say", text });
  $("words").value = "";
};
$("words").focus();
connect();
