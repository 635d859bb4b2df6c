// Packings side by side: canvases, and what is said above each.

import type { Live, Packing } from "./live";
import type { Seen } from "./shared";

export const $ = <Kind extends HTMLElement>(id: string) => document.getElementById(id) as Kind;

export function element<Name extends keyof HTMLElementTagNameMap>(name: Name, kind = "", ...children: Node[]) {
  const made = document.createElement(name);
  if (kind) made.className = kind;
  made.append(...children);
  return made;
}

export function setText(node: HTMLElement, text: string) {
  if (node.textContent !== text) node.textContent = text;
}

export class Pane {
  readonly canvas = element("canvas");
  readonly shown: PlayerPane;
  seen: Seen | null = null;
  camera: PlayerCamera = { k: 1, x: 0, y: 0 };
  fresh = true; // is there something new to be drawn?
  target: [number, number] | null = null; // where the hand wants the body [R]
  private readonly name = element("strong");
  private readonly value = element("span", "value");
  private readonly lamp = element("span", "lamp");
  private readonly said = element("span", "said");
  private readonly foot = element("p", "foot");
  private readonly swatch = element("span", "swatch");

  constructor(private readonly live: Live, readonly index: number) {
    const { name, title, dash, bounds } = live.packings[index];
    const packings = PAGE.packings as Record<string, { colour: number }>;
    const none = new Float64Array();
    this.shown = {
      ...{ packing: name, title, moments: 1, count: 0, labels: [], there: [], pointed: [], squeezed: [] },
      ...{ x: none, y: none, p: none, q1: none, q2: none, rest: none, nu: none, spin: none, rubs: false, box: null },
      ...{ i: [], j: [], pairs: 0, withBodies: 0, bearing: none, dx: none, dy: none, active: [new Uint32Array()] },
      ...{ bodies: [], handles: [], bounds, stroke: [], force: [], at: [0], counts: live.counts, events: [] },
      look: { colour: packings[name].colour, dash },
    };
    this.canvas.setAttribute("role", "img");
    const first = element("div", "row", this.swatch, this.name, this.value);
    const strip = element("figcaption", "", first, element("div", "row", this.lamp, this.said));
    const body = element("div", "canvas", this.canvas);
    $("stage").append(element("figure", "", strip, body, this.foot));
    this.swatch.style.background = css(this.shown.look.colour);
  }

  count(name: string): number {
    return this.seen ? this.seen.counts[this.live.layout.counts[name]] : 0;
  }

  row(name: string): number {
    return this.seen ? this.seen.row[this.live.layout.row[name]] : 0;
  }

  get locked(): boolean {
    return this.count("stuck") >= this.live.lockedAfter;
  }

  // What an increment has come to: into the form that the player's drawing knows.
  take(seen: Seen) {
    const wasLocked = this.locked;
    this.seen = seen;
    const { shown, live } = this;
    const n = seen.label.length;
    const contacts = seen.first.length;
    const withBodies = seen.endX.length;
    const grain = (k: number) => seen.first[contacts - withBodies + k];
    Object.assign(shown, seen.grains, {
      ...{ count: n, labels: seen.label, there: new Uint8Array(n).fill(1) },
      ...{ pointed: new Uint8Array(n), squeezed: new Uint8Array(n), rubs: seen.grains.spin.some((angle) => angle !== 0) },
      ...{ i: seen.first, j: seen.second, pairs: contacts, withBodies, bearing: seen.force },
      dx: seen.endX.map((x, k) => x - seen.grains.x[grain(k)]),
      dy: seen.endY.map((y, k) => y - seen.grains.y[grain(k)]),
      active: [Uint32Array.from(seen.first.keys())],
      bodies: live.packings[this.index].bodies.map((body, k) => placed(body, seen.places.subarray(k * live.layout.columns))),
    });
    if (this.count("rows") === 1) {
      shown.stroke = [];
      shown.force = [];
      shown.events = [];
    }
    shown.stroke.push(this.row("stroke"));
    shown.force.push(this.row("resisting"));
    shown.at = [shown.stroke.length - 1];
    if (this.locked && !wasLocked) shown.events.push({ kind: "locked", stroke: this.row("stroke"), force: this.row("resisting") });
    this.hold();
  }

  // The handle, where it is and where it is wanted.
  hold() {
    this.fresh = true;
    if (!this.seen) return;
    const { body, axis } = this.live.handle;
    const [x, y] = this.seen.places.subarray(body * this.live.layout.columns);
    const [alongX, alongY] = (axis ?? [1, 1]).map(Math.abs); // what has no axis goes anywhere
    const [toX, toY] = this.target ? [x + (this.target[0] - x) * alongX, y + (this.target[1] - y) * alongY] : [x, y];
    const force = Float64Array.of(this.row("hand_x"), this.row("hand_y"));
    this.shown.handles = [{ at: Float64Array.of(x, y, toX, toY), axis, force }];
  }

  draw(look: PlayerLook) {
    const { canvas } = this;
    this.fresh = false;
    new Scenery(canvas.getContext("2d")!, this.shown, 0, this.camera, look).draw(canvas.width, canvas.height);
    this.tell();
  }

  private tell() {
    const reason = this.live.reasons[this.count("reason")];
    setText(this.name, say(this.shown.title));
    setText(this.value, this.valuesSaid().join(" · "));
    const balance = word("force_error", { error: `${short(Number((100 * this.row("residual")).toPrecision(2)))} %` });
    // That it has settled is said by how well; there is no room for both beside other packings.
    setText(this.said, !this.seen ? word("settling") : reason.level ? say(reason.text) : balance);
    this.lamp.className = `lamp ${["good", "working", "bad"][this.seen ? reason.level : 1]}`;
    setText(this.foot, this.locked ? word("event_locked") : "");
    this.canvas.setAttribute("aria-label", this.standing());
  }

  // What the curve says last, unless it counts what is counted anyway.
  private valuesSaid(): string[] {
    return [this.live.counts ? "" : this.forceSaid(), this.outSaid()].filter(Boolean);
  }

  private forceSaid(): string {
    const [, unit] = labelParts(say(run.labels.force));
    return `${number(this.row("resisting"), 2)} ${unit}`.trim();
  }

  private outSaid(): string {
    const count = this.count("out");
    return count ? word("grains_out", { count }) : "";
  }

  // For who does not see the picture.
  standing(): string {
    const parts = [...this.valuesSaid(), ...(this.locked ? [word("event_locked")] : [])];
    return `${say(this.shown.title)}: ${parts.join(", ") || word("settling")}`;
  }
}

function placed(body: Packing["bodies"][number], [x, y]: Float64Array): PlayerBody {
  const shape: number[] = [];
  for (let k = 0; k < body.discs.length; k += 3) shape.push(x + body.discs[k], y + body.discs[k + 1], body.discs[k + 2]);
  for (let k = 0; k < body.segments.length; k += 5) {
    const [x0, y0, x1, y1, radius] = body.segments.slice(k, k + 5);
    shape.push(x + x0, y + y0, x + x1, y + y1, radius);
  }
  for (const corners of body.polygons) corners.forEach((value, k) => shape.push(value + (k % 2 ? y : x)));
  return {
    ...{ role: body.role, there: [1], shape: Float64Array.from(shape), columns: shape.length },
    ...{ discs: body.discs.length / 3, segments: body.segments.length / 5 },
    polygons: body.polygons.map((corners) => corners.length / 2),
  };
}
