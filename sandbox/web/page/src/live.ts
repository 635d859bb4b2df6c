// What Python says about a scene: `sandbox/web/story.py` writes it.

import type { Layout } from "./shared";

export interface Slider {
  name: string;
  title: string[];
  unit: string;
  least: number;
  most: number;
  step: number;
  value: number;
  top: string[] | null; // what the highest value is called
  command: (string | number)[]; // an entry of the kernels with its values: numbers, or what sliders of these names are set to
}

// A share of auxetic grains that is chosen from some; another one packs anew.
export interface Share {
  name: string;
  title: string[];
  values: number[];
  at: number; // the place of that which it begins with
  packing: number; // that it is about
  places: number[]; // of the packings with these shares, among all of a seed
}

export interface Packing {
  name: string;
  title: string[];
  dash: number[];
  bounds: [number, number, number, number];
  width: number | null; // of a periodic cell [R]
  radius: number; // how near the handle is grabbed [R]
  bodies: { role: string; discs: number[]; segments: number[]; polygons: number[][] }[]; // as seen from the body
}

// How packings are to be unfolded: see `packings.ts`.
export interface Packed {
  steps: number; // of the grid in a radius
  lengths: [ints: number, floats: number][]; // bytes of the blocks, by packing
  differing: [block: number, begin: number, count: number][][]; // numbers that differ from seed to seed, by packing
}

export interface Live {
  scene: string;
  languages: string[];
  layout: Layout;
  labels: { force: string[]; stroke: string[] };
  title: string[];
  question: string[];
  about: string[];
  views: PlayerView[];
  packings: Packing[];
  seeds: number[];
  counts: boolean; // are grains plotted that have left?
  plotsHand: boolean; // is it the force of the hand that is plotted?
  axes: [number, number]; // highest stroke [R] and force [k R] that the plot begins with
  handle: { body: number; label: string[]; axis: [number, number] | null };
  sliders: Slider[];
  share: Share | null;
  commands: Record<string, number>; // kinds of the entry `command`
  tolerance: number; // of the residual
  rough: number; // an error of the force that is much
  reasons: { text: string[]; level: number }[]; // why a relaxation ended
  sentences: ({ text: string[]; values: string[] } | null)[]; // what is said, and what its numbers are called
  events: string[]; // kinds
  machine: number; // a hand without bound [k R]
  lockedAfter: number;
  packed: Packed;
  start: { theme: string; auto: boolean };
}
