// What page and worker say to each other, and where things stand in the blocks of memory that kernels work on.

export interface Layout {
  part: Record<string, number>; // which whole number says where a part begins
  sizes: Record<string, number>;
  counts: Record<string, number>; // places in the part of that name
  row: Record<string, number>;
  firstInt: number; // parts from here on are of whole numbers
  columns: number; // of a body's place
  said: Record<string, number>; // places in a sentence
  sentence: number; // numbers of one
}

// An entry of the kernels with its values; or "keep" the state as it is, "undo" what came since then, "redo" that, "reset" to the start.
export type Command = [name: string, ...values: number[]];

export const MARKS = 20; // states that are kept

// What a packing looks like after an increment.
export interface Seen {
  back: boolean; // is it a state that was kept?
  grains: Record<"x" | "y" | "p" | "q1" | "q2" | "rest" | "nu" | "spin", Float64Array>;
  label: Int32Array;
  first: Int32Array;
  second: Int32Array;
  force: Float64Array;
  endX: Float64Array; // of the contacts with bodies, which come last
  endY: Float64Array;
  pressure: Float64Array;
  stress: Float64Array; // difference of the principal ones
  motion: Float64Array;
  squeezed: Int32Array; // further than a real grain could be?
  pointed: Int32Array; // is it meant by what is said?
  said: Float64Array; // sentences, one behind the other
  places: Float64Array;
  reactions: Float64Array;
  row: Float64Array;
  counts: Int32Array;
}

export type ToWorker =
  | { kind: "load"; module: WebAssembly.Module; layout: Layout; ints: ArrayBuffer; floats: ArrayBuffer }
  | { kind: "turn"; commands: Command[] }
  | { kind: "dump" };

export type FromWorker =
  | { kind: "ready" }
  | { kind: "seen"; made: boolean; time: number; seen: Seen | null } // time spent on it [ms]
  | { kind: "dump"; ints: ArrayBuffer; floats: ArrayBuffer; memory: number }
  | { kind: "failed"; text: string };
