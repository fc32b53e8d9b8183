// Which of the drawn grippers the pointer is over. viser's client tells its server of clicks only, so the page casts the
// ray itself: the view notes its camera (see gate.py), the server has said where the hands are.
import { $, throttled } from "./dom.js";

// Direction of the ray through a point of the view, world frame; the camera looks along +z, its y axis points down.
export function rayThrough(camera, x, y, width, height) {
  const slope = Math.tan(camera.fov / 2), [w, i, j, k] = camera.wxyz;
  const [a, b, c] = [((2 * x) / width - 1) * slope * (width / height), ((2 * y) / height - 1) * slope, 1];
  const [p, q, r] = [2 * (j * c - k * b), 2 * (k * a - i * c), 2 * (i * b - j * a)];
  return [a + w * p + j * r - k * q, b + w * q + k * p - i * r, c + w * r + i * q - j * p];
}

// Share of the ray until it enters one of the hand's boxes; Infinity if it passes by.
export function distance(from, ray, hand) {
  const own = (v) => [0, 1, 2].map((axis) => hand.axes[3 * axis] * v[0] + hand.axes[3 * axis + 1] * v[1] + hand.axes[3 * axis + 2] * v[2]);
  const start = own(from.map((value, axis) => value - hand.origin[axis])), way = own(ray);
  let best = Infinity;
  for (const box of hand.boxes) {
    let enter = 0, leave = Infinity;
    for (const axis of [0, 1, 2]) {
      const ends = [-1, 1].map((side) => (box[axis] + side * box[axis + 3] - start[axis]) / (way[axis] || 1e-9));
      enter = Math.max(enter, Math.min(...ends));
      leave = Math.min(leave, Math.max(...ends));
    }
    if (enter < leave) best = Math.min(best, enter);
  }
  return best;
}

export function gripperAt(camera, x, y, width, height, rows) {
  const ray = rayThrough(camera, x, y, width, height);
  const hits = rows.map((row) => [distance(camera.position, ray, row.hand), row.name]).filter(([far]) => far < Infinity);
  return hits.sort((a, b) => a[0] - b[0])[0]?.[1] ?? null;
}

// Sets off the gripper under the pointer, and its row. `shown` says which grippers are drawn now.
export function wireHover(shown, point) {
  const view = $("view");
  let over = null, at = null;
  const set = (name) => {
    if (name === over) return;
    over = name;
    point(name);
    for (const row of document.querySelectorAll("#panel-grasps tr.pick")) row.classList.toggle("over", row.dataset.name === name);
  };
  const look = throttled(() => {
    const camera = view.contentWindow.camera;
    set(at && camera ? gripperAt(camera, ...at, view.clientWidth, view.clientHeight, shown()) : null);
  }, 80);
  const listen = () => {
    const inside = view.contentDocument;
    // While a button is pressed the view is being turned.
    inside.addEventListener("pointermove", (event) => { if (!event.buttons) { at = [event.clientX, event.clientY]; look(); } }, true);
    inside.documentElement.addEventListener("pointerleave", () => { at = null; look(); });
  };
  view.addEventListener("load", listen);
  if (view.contentDocument?.readyState === "complete") listen();
}
