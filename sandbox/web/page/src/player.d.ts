// What the scripts of sandbox/player/assets offer, which stand before this one on the page.

interface PlayerView {
  name: string;
  title: string[];
  valued: boolean;
  made: boolean;
  chains: boolean;
  onlyChains: boolean;
  top: number | null;
  least: number;
  ramp: string;
  unit: string;
}

interface PlayerBody {
  role: string;
  there: number[];
  shape: Float64Array;
  columns: number;
  discs: number;
  segments: number;
  polygons: number[];
}

interface PlayerCamera {
  k: number;
  x: number;
  y: number;
}

interface PlayerEvent {
  kind: string;
  stroke: number;
  force: number;
  increment: number;
  text: () => string; // in the present language
}

// What there is of a run besides its grains.
interface PlayerTrack {
  stroke: number[];
  force: number[];
  events: PlayerEvent[];
}

// A packing at one moment, as `Scenery` and `Plot` know it.
interface PlayerPane {
  packing: string;
  title: string[];
  moments: number;
  count: number;
  labels: ArrayLike<number>;
  there: ArrayLike<number>;
  pointed: ArrayLike<number>;
  squeezed: ArrayLike<number>;
  x: Float64Array;
  y: Float64Array;
  p: Float64Array;
  q1: Float64Array;
  q2: Float64Array;
  rest: Float64Array;
  nu: Float64Array;
  spin: Float64Array;
  rubs: boolean;
  box: { wide: boolean; high: boolean; size: Float64Array } | null;
  i: ArrayLike<number>;
  j: ArrayLike<number>;
  pairs: number;
  withBodies: number;
  bearing: Float64Array;
  pressure: ArrayLike<number>;
  stress: ArrayLike<number>;
  motion: ArrayLike<number>;
  dx: Float64Array;
  dy: Float64Array;
  active: Uint32Array[];
  bodies: PlayerBody[];
  handles: { at: Float64Array; axis: [number, number] | null; force: Float64Array }[];
  bounds: [number, number, number, number];
  stroke: number[];
  force: number[];
  at: number[];
  counts: boolean;
  events: PlayerEvent[];
  look: { colour: number; dash: number[] };
}

interface PlayerLook {
  theme: string;
  view: PlayerView;
  chains: boolean;
  scale: number;
}

interface PlayerRun {
  panes: PlayerPane[];
  languages: string[];
  labels: { force: string[]; stroke: string[] };
  limit: number | null;
  views: PlayerView[];
  tops: { chains: number; hand: number };
  words: Record<string, string>[];
  keys: [key: string, does: string][][];
  [name: string]: unknown;
}

declare const inAddress: URLSearchParams;
declare let run: PlayerRun;
declare let language: number;

declare function say(said: string[]): string;
declare function word(key: string, values?: Record<string, string | number>): string;
declare function number(value: number, decimals: number): string;
declare function short(value: number): string;
declare function roundUp(value: number, steps?: number[]): number;
declare function css(colour: number): string;
declare function cameraFor(bounds: number[], width: number, height: number, margin: number, scale?: number): PlayerCamera;
declare function settle(code: string, theme: string): void;
declare function themeAsked(auto: boolean, otherwise: string): string;
declare function languageAsked(auto: boolean, languages: string[], otherwise: string): number;
declare function topOf(view: PlayerView, panes: PlayerPane[]): number;
declare function labelParts(label: string): [name: string, unit: string];
declare function decimalsFor(spread: number): number;
declare function signOf(event: KeyboardEvent): string;
declare function legendOf(panes: PlayerPane[], view: PlayerView, theme: string, chains: boolean): HTMLElement[];
declare function shapeOfEvent(kind: string): SVGElement;
declare const PLURALS: ((count: number) => number)[];
declare const FINER: number[];

declare class Scenery {
  constructor(context: CanvasRenderingContext2D, pane: PlayerPane, moment: number, camera: PlayerCamera, look: PlayerLook);
  draw(width: number, height: number): void;
}

declare class Plot {
  constructor(canvas: HTMLCanvasElement, seek: (moment: number) => void);
  known: { low: number; high: number; bottom: number; top: number };
  key?: string;
  draw(moment: number, look: PlayerLook): void;
}

// What Python puts on the page.
declare const PAGE: Record<string, unknown>;
declare const LIVE: import("./live").Live;
declare const WORKER: string;
