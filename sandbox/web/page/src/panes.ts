// Packings side by side: canvases, and what is said above each.

import type { Live, Packing } from "./live";
import { told, type Told } from "./sentences";
import { lamp } from "./trust";
import { MARKS, type Command, type Seen } from "./shared";
import { the } from "./stage";

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

// What has gone round a periodic cell is drawn where its image is.
const folded = (x: number, width: number | null) => (width ? x - width * Math.floor(x / width) : x);

const LETTER = 8; // [px] of one, about
const FRESH = 40; // increments for which an event is spoken of

export class Pane {
  readonly canvas = element("canvas");
  readonly shown: PlayerPane;
  seen: Seen | null = null;
  camera: PlayerCamera = { k: 1, x: 0, y: 0 };
  fresh = true; // is there something new to be drawn?
  target: [number, number] | null = null; // where the hand wants the body [R]
  private readonly width: number | null; // of a periodic cell [R]
  private readonly name = element("strong");
  private readonly value = element("span", "value");
  private readonly lamp = element("span", "lamp");
  private readonly said = element("span", "said");
  private readonly told = element("p");
  private readonly swatch = element("span", "swatch");
  private sentences: Told[] = [];
  private unheard: PlayerEvent[] = [];
  private lags = false;
  private marks: PlayerTrack[] = []; // what the curve was at the states that the worker keeps
  private undone: PlayerTrack[] = [];
  went = true; // has it gone back?
  private room = 0; // for what is said of the lamp [px]

  constructor(private readonly live: Live, readonly index: number) {
    const { name, title, dash, bounds, width } = live.packings[index];
    this.width = width;
    const packings = PAGE.packings as Record<string, { colour: number }>;
    const none = new Float64Array();
    this.shown = {
      ...{ packing: name, title, moments: 1, count: 0, labels: [], there: [], pointed: [], squeezed: [] },
      ...{ x: none, y: none, p: none, q1: none, q2: none, rest: none, nu: none, spin: none, rubs: false },
      ...{ pressure: none, stress: none, motion: none, i: [], j: [], pairs: 0, withBodies: 0, bearing: none, dx: none, dy: none, active: [new Uint32Array()] },
      ...{ bodies: [], handles: [], bounds, stroke: [], force: [], at: [0], counts: live.counts, events: [] },
      box: width ? { wide: true, high: false, size: Float64Array.of(width, Infinity, 0) } : null,
      look: { colour: packings[name].colour, dash },
    };
    this.canvas.setAttribute("role", "img");
    const first = element("div", "row", this.swatch, this.name, this.value);
    const strip = element("figcaption", "", first, element("div", "row", this.lamp, this.said));
    const body = element("div", "canvas", this.canvas);
    $("stage").append(element("figure", "", strip, body));
    $("told").append(this.told);
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

  // Before the first increment of a packing.
  begin() {
    Object.assign(this, { seen: null, sentences: [], unheard: [], marks: [], undone: [] });
    this.clear();
  }

  private clear() {
    Object.assign(this.shown, { stroke: [], force: [], events: [] });
    this.went = true;
  }

  // The curve goes the way of the worker's state, which has obeyed these commands.
  obey(commands: Command[]) {
    const { shown, marks, undone } = this;
    const track = () => ({ stroke: [...shown.stroke], force: [...shown.force], events: [...shown.events] });
    for (const [name] of commands) {
      if (name === "keep") {
        marks.push(track());
        if (marks.length > MARKS) marks.shift();
        undone.length = 0;
      }
      if (name === "reset") this.clear();
      if (name !== "undo" && name !== "redo") continue;
      const [from, to] = name === "undo" ? [marks, undone] : [undone, marks];
      to.push(track());
      Object.assign(shown, from.pop());
      this.went = true;
    }
  }

  // What an increment has come to: into the form that the player's drawing knows.
  take(seen: Seen) {
    this.seen = seen;
    const { shown, live } = this;
    const n = seen.label.length;
    const contacts = seen.first.length;
    const withBodies = seen.endX.length;
    const grain = (k: number) => seen.first[contacts - withBodies + k];
    Object.assign(shown, seen.grains, {
      x: seen.grains.x.map((x) => folded(x, this.width)),
      ...{ count: n, labels: seen.label, there: new Uint8Array(n).fill(1) },
      ...{ pressure: seen.pressure, stress: seen.stress, motion: seen.motion },
      ...{ pointed: seen.pointed, squeezed: seen.squeezed, rubs: seen.grains.spin.some((angle) => angle !== 0) },
      ...{ i: seen.first, j: seen.second, pairs: contacts, withBodies, bearing: seen.force },
      dx: seen.endX.map((x, k) => x - seen.grains.x[grain(k)]),
      dy: seen.endY.map((y, k) => y - seen.grains.y[grain(k)]),
      active: [Uint32Array.from(seen.first.keys())],
      bodies: live.packings[this.index].bodies.map((body, k) => placed(body, seen.places.subarray(k * live.layout.columns), this.width)),
    });
    this.sentences = told(live, seen.said);
    if (!seen.back) this.goOn();
    shown.at = [shown.stroke.length - 1];
    this.hold();
  }

  private goOn() {
    const { shown } = this;
    const place = { stroke: this.row("stroke"), force: this.row("resisting"), increment: this.count("rows") - 1 };
    shown.stroke.push(place.stroke);
    shown.force.push(place.force);
    const begun = this.sentences.filter(({ event }) => event).map(({ event, text }) => ({ ...place, kind: event, text }));
    shown.events.push(...begun);
    this.unheard.push(...begun);
  }

  // What has begun since somebody has asked, for who does not see it.
  news(): (() => string)[] {
    const said = this.unheard.map((event) => () => `${this.title}: ${event.text()}`);
    this.unheard = [];
    return said;
  }

  measure() {
    this.room = this.said.clientWidth;
  }

  // Does an increment keep a person waiting?
  lag(lags: boolean) {
    if (lags === this.lags) return;
    this.lags = lags;
    this.tell();
  }

  get title(): string {
    return say(this.shown.title);
  }

  private place({ places }: Seen): Float64Array {
    return places.subarray(this.live.handle.body * this.live.layout.columns);
  }

  // The hand wants the body at this place, or at that image of it which is nearest: the kernels see it so too.
  want(x: number, y: number) {
    const turns = this.seen && this.width ? Math.round((this.place(this.seen)[0] - x) / this.width) : 0;
    this.target = [x + turns * (this.width ?? 0), y];
    this.hold();
  }

  // The handle, where it is and where it is wanted.
  hold() {
    this.fresh = true;
    if (!this.seen) return;
    const { axis } = this.live.handle;
    const [there, y] = this.place(this.seen);
    const x = folded(there, this.width);
    const [alongX, alongY] = (axis ?? [1, 1]).map(Math.abs); // what has no axis goes anywhere
    const [toX, toY] = this.target ? [x + (this.target[0] - there) * alongX, y + (this.target[1] - y) * alongY] : [x, y];
    const force = Float64Array.of(this.row("hand_x"), this.row("hand_y"));
    this.shown.handles = [{ at: Float64Array.of(x, y, toX, toY), axis, force }];
  }

  draw(look: PlayerLook) {
    const { canvas } = this;
    this.fresh = false;
    new Scenery(canvas.getContext("2d")!, this.shown, 0, this.camera, look).draw(canvas.width, canvas.height);
    this.tell();
  }

  tell() {
    setText(this.name, this.title);
    setText(this.value, this.valuesSaid().join(" · "));
    const settling = word("settling");
    const { level, words, short } = this.seen && !this.lags ? lamp(this) : { level: 1, words: settling, short: settling };
    const paused = the.conductor?.paused ? word("paused") : "";
    const [long, brief] = [words, short].map((said) => [paused, said].filter(Boolean).join(" · "));
    setText(this.said, long.length * LETTER < this.room ? long : brief);
    this.said.title = long;
    this.lamp.className = `lamp ${["good", "working", "bad"][level]}`;
    const notices = this.notices();
    if (this.told.dataset.notices !== notices + this.title) {
      this.told.dataset.notices = notices + this.title;
      const name = element("strong");
      name.textContent = LIVE.packings.length > 1 && notices ? `${this.title} ` : "";
      this.told.replaceChildren(name, notices);
      this.told.tabIndex = this.told.scrollHeight > this.told.clientHeight ? 0 : -1; // to scroll it by the keyboard
    }
    this.canvas.setAttribute("aria-label", this.standing());
  }

  // What the curve says last, unless it counts what is counted anyway.
  private valuesSaid(): string[] {
    return [this.live.counts ? "" : this.forceSaid(), this.outSaid()].filter(Boolean);
  }

  private forceSaid(): string {
    const [, unit] = labelParts(say(run.labels.force));
    const { top, bottom } = the.plot.known;
    return `${number(this.row("resisting"), decimalsFor(top - bottom) + 2)} ${unit}`.trim(); // hundredths of the plot
  }

  private outSaid(): string {
    const count = this.count("out");
    return count ? word("grains_out", { count }) : "";
  }

  private squeezedSaid(): string {
    const count = Array.from(this.shown.squeezed).filter((squeezed) => squeezed).length;
    return count ? word("squeezed", { count }) : "";
  }

  // What is said of the latest increment, or else of an event that has just been.
  private notices(): string {
    const shown = this.sentences.filter((sentence) => sentence.shown).map((sentence) => sentence.text());
    const latest = this.shown.events.at(-1);
    if (!shown.length && latest && this.count("rows") - 1 - latest.increment < FRESH) shown.push(latest.text());
    return [...shown, this.squeezedSaid()].filter(Boolean).join(" · ");
  }

  // For who does not see the picture.
  standing(): string {
    const parts = [...this.valuesSaid(), this.said.title, this.notices()].filter(Boolean);
    return `${this.title}: ${parts.join(", ")}`;
  }
}

function placed(body: Packing["bodies"][number], [x, y]: Float64Array, width: number | null): PlayerBody {
  const shape: number[] = [];
  for (let k = 0; k < body.discs.length; k += 3) {
    const [across, radius] = [folded(x + body.discs[k], width), body.discs[k + 2]];
    for (const turns of width ? [-1, 0, 1] : [0]) {
      const image = across + turns * (width ?? 0);
      if (!width || (image + radius > 0 && image - radius < width)) shape.push(image, y + body.discs[k + 1], radius);
    }
  }
  const discs = shape.length / 3;
  for (let k = 0; k < body.segments.length; k += 5) {
    const [x0, y0, x1, y1, radius] = body.segments.slice(k, k + 5);
    shape.push(x + x0, y + y0, x + x1, y + y1, radius);
  }
  for (const corners of body.polygons) corners.forEach((value, k) => shape.push(value + (k % 2 ? y : x)));
  return {
    ...{ role: body.role, there: [1], shape: Float64Array.from(shape), columns: shape.length },
    ...{ discs, segments: body.segments.length / 5 },
    polygons: body.polygons.map((corners) => corners.length / 2),
  };
}
