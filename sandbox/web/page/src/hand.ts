// The hand: mouse, finger and arrow keys pull the handle, in all packings at once.

import type { Pane } from "./panes";
import { hand, keep, letGo } from "./run";
import { held, panes, state } from "./stage";

const [FAR, SMALL] = [2, 0.01]; // [R]

function grab(by: number | "keys") {
  keep();
  held.by = by;
  state.script = false;
  hand("grab");
}

function pull(x: number, y: number) {
  if (!Number.isFinite(x + y)) return; // in a window without any room
  for (const pane of panes) pane.want(x, y);
  hand("move", x, y);
}

function placeOf(pane: Pane, event: PointerEvent): [number, number] {
  const box = pane.canvas.getBoundingClientRect();
  const ratio = pane.canvas.width / box.width;
  const { k, x, y } = pane.camera;
  return [((event.clientX - box.left) * ratio - x) / k, (y - (event.clientY - box.top) * ratio) / k];
}

export function follow(pane: Pane, shown: () => void) {
  const { canvas } = pane;
  let offset: [number, number] = [0, 0];
  canvas.addEventListener("pointerdown", (event) => {
    const [x, y] = placeOf(pane, event);
    const at = pane.shown.handles[0]?.at;
    if (!at || held.by !== null || event.button) return;
    const near = 24 / ((pane.camera.k * canvas.clientWidth) / canvas.width); // so many pixels
    const { radius } = LIVE.packings[pane.index];
    const [beside, above] = [Math.max(radius, near), Math.max(LIVE.handle.axis ? 2 : radius, near)];
    if (Math.abs(x - at[0]) > beside || Math.abs(y - at[1]) > above) return;
    canvas.setPointerCapture(event.pointerId);
    offset = [at[0] - x, at[1] - y];
    grab(event.pointerId);
    shown();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerId !== held.by) return;
    if (!event.buttons) return letGo(); // it was released where no page is told of it
    const [x, y] = placeOf(pane, event);
    pull(x + offset[0], y + offset[1]);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
    canvas.addEventListener(end, (event) => {
      if (event.pointerId === held.by) letGo();
    });
  }
  // A finger scrolls the page, unless it has the handle.
  canvas.addEventListener("touchstart", (event) => {
    if (held.by !== null) event.preventDefault();
  }, { passive: false });
}

export const ARROWS: Record<string, [number, number]> = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };

// On and on, as long as the key is down; or by a small step.
export function pullBy([wx, wy]: [number, number], small: boolean) {
  const at = panes[0].shown.handles[0]?.at;
  if (!at || typeof held.by === "number") return;
  const far = small ? SMALL : FAR;
  if (held.by === null) grab("keys");
  pull(at[0] + far * wx, at[1] + far * wy);
}
