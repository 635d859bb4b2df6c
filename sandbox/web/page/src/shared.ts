// What page and worker say to each other, and where things stand in the blocks of memory that kernels work on.

export interface Layout {
  part: Record<string, number>; // which whole number says where a part begins
  sizes: Record<string, number>;
  counts: Record<string, number>; // places in the part of that name
  row: Record<string, number>;
  firstInt: number; // parts from here on are of whole numbers
  columns: number; // of a body's place
}

export type Command = [name: string, ...values: number[]];

// What a packing looks like after an increment.
export interface Seen {
  grains: Record<"x" | "y" | "p" | "q1" | "q2" | "rest" | "nu" | "spin", Float64Array>;
  label: Int32Array;
  first: Int32Array;
  second: Int32Array;
  force: Float64Array;
  endX: Float64Array; // of the contacts with bodies, which come last
  endY: Float64Array;
  places: Float64Array;
  reactions: Float64Array;
  row: Float64Array;
  counts: Int32Array;
}

export type ToWorker =
  | { kind: "load"; module: WebAssembly.Module; layout: Layout; ints: ArrayBuffer; floats: ArrayBuffer }
  | { kind: "turn"; commands: Command[] }
  | { kind: "reset"; commands: Command[] } // to the start, with these settings
  | { kind: "dump" };

export type FromWorker =
  | { kind: "ready" }
  | { kind: "seen"; made: boolean; time: number; seen: Seen | null } // time spent on it [ms]
  | { kind: "dump"; ints: ArrayBuffer; floats: ArrayBuffer; memory: number }
  | { kind: "failed"; text: string };
