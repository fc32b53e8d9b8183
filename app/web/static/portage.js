// Sessions as files: fetched when they are packed, sent in pieces when they are brought.
import { $, h } from "./dom.js";

const PIECE = 240_000, PAUSE_MS = 60, MOST = 100_000_000;

export function wirePortage(send, sendBytes, notice) {
  let file = null;
  const pick = $("session-file");
  $("session-import").onclick = () => pick.click();
  pick.onchange = () => {
    file = pick.files[0] ?? null;
    pick.value = "";
    if (!file) return;
    if (file.size < 1 || file.size > MOST) return notice(`${file.name} is ${file.size ? "larger than 100 MB" : "empty"}; it is no session for this page`);
    send({ type: "upload", size: file.size });
  };
  return {
    // The server says how much has arrived; the next piece follows, never faster than it takes them.
    async upload({ got }) {
      if (!file || got >= file.size) return;
      const piece = await file.slice(got, got + PIECE).arrayBuffer();
      setTimeout(() => sendBytes(piece), PAUSE_MS);
    },
    download({ path, name }) {
      const link = h("a", { href: path, download: name, hidden: true });
      document.body.append(link);
      link.click();
      link.remove();
    },
  };
}
