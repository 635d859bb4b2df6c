// One packing: hands commands to the kernels, asks for increments, and copies what there is to be seen. It computes nothing itself.

import { MARKS, type Command, type FromWorker, type Layout, type Seen, type ToWorker } from "./shared";

interface Kernels {
  memory: WebAssembly.Memory;
  reserve(bytes: bigint): number;
  forget(): void;
  [name: string]: unknown;
}

let kernels: Kernels;
let layout: Layout;
let [intsAt, floatsAt, whole, others] = [0, 0, 0, 0];

interface Kept {
  ints: Uint8Array;
  floats: Uint8Array;
}
let start: Kept;
const marks: Kept[] = [];
const undone: Kept[] = [];
let back = false;

const answer = (message: FromWorker, moved: Transferable[] = []) => postMessage(message, { transfer: moved });

// Memory may have grown since the last look: views are made anew each time.
const ints = () => new BigInt64Array(kernels.memory.buffer, intsAt, whole);
const floats = () => new Float64Array(kernels.memory.buffer, floatsAt, others);

function call([name, ...values]: Command): unknown {
  kernels.forget();
  const run = kernels[name] as (...all: (number | bigint)[]) => unknown;
  const kinds = WHOLE[name] ?? [];
  const given = values.map((value, k) => (kinds.includes(k) ? BigInt(value) : value));
  return run(intsAt, BigInt(whole), floatsAt, BigInt(others), ...given);
}

// Which values of an entry are whole numbers.
const WHOLE: Record<string, number[]> = { command: [0, 1], set_ratio: [0] };

function load(message: Extract<ToWorker, { kind: "load" }>) {
  ({ layout } = message);
  kernels = new WebAssembly.Instance(message.module, {}).exports as unknown as Kernels;
  start = { ints: new Uint8Array(message.ints), floats: new Uint8Array(message.floats) };
  intsAt = kernels.reserve(BigInt(start.ints.length));
  floatsAt = kernels.reserve(BigInt(start.floats.length));
  [whole, others] = [start.ints.length / 8, start.floats.length / 8];
  put(start);
}

const bytes = (at: number) => new Uint8Array(kernels.memory.buffer, at, 8 * (at === intsAt ? whole : others));

const kept = (): Kept => ({ ints: bytes(intsAt).slice(), floats: bytes(floatsAt).slice() });

function put(kept: Kept) {
  bytes(intsAt).set(kept.ints);
  bytes(floatsAt).set(kept.floats);
}

function obey(command: Command) {
  const [name] = command;
  if (name === "keep") {
    marks.push(kept());
    if (marks.length > MARKS) marks.shift();
    undone.length = 0;
  } else if (name === "undo" || name === "redo") {
    const [from, to] = name === "undo" ? [marks, undone] : [undone, marks];
    to.push(kept());
    put(from.pop()!);
  } else if (name === "reset") {
    put(start);
  } else {
    call(command);
  }
  if (["undo", "redo", "reset"].includes(name)) back = name !== "reset";
}

function seen(): Seen {
  const [whole, numbers] = [ints(), floats()];
  const at = (name: string) => Number(whole[layout.part[name]]);
  const some = (name: string, count: number, skip = 0) => numbers.slice(at(name) + skip, at(name) + skip + count);
  const few = (name: string, count: number) => Int32Array.from(whole.subarray(at(name), at(name) + count), Number);
  const size = (name: string) => Number(whole[layout.sizes[name]]);
  const n = size("grains");
  const counts = few("counts", Object.keys(layout.counts).length);
  const [pairs, shown] = [counts[layout.counts.pairs], counts[layout.counts.shown]];
  const state = (row: number) => some("state", n, row * n);
  return {
    back,
    grains: {
      ...{ x: state(0), y: state(1), p: state(2), q1: state(3), q2: state(4) },
      ...{ rest: some("rest_radius", n), nu: some("poisson_ratio", n), spin: some("spin", n) },
    },
    label: few("label", n),
    first: few("first", shown),
    second: few("second", shown),
    force: some("force", shown),
    endX: some("ends", shown - pairs, pairs),
    endY: some("ends", shown - pairs, size("contacts") + pairs),
    ...{ pressure: some("pressure", n), stress: some("difference", n), motion: some("motion", n) },
    ...{ squeezed: few("squeezed", n), pointed: few("pointed", n) },
    said: some("said", layout.sentence * counts[layout.counts.said]),
    places: some("places", layout.columns * size("bodies")),
    reactions: some("reactions", 3 * size("bodies")),
    row: some("row", Object.keys(layout.row).length),
    counts,
  };
}

function turn(commands: Command[]) {
  const begun = performance.now();
  back = false;
  for (const command of commands) obey(command);
  const made = back || call(["advance"]) === 1n;
  answer({ kind: "seen", made, time: performance.now() - begun, seen: made ? seen() : null });
}

onmessage = ({ data }: MessageEvent<ToWorker>) => {
  try {
    if (data.kind === "load") {
      load(data);
      answer({ kind: "ready" });
    } else if (data.kind === "turn") {
      turn(data.commands);
    } else {
      const copies = [ints().slice().buffer, floats().slice().buffer];
      const [whole, numbers] = copies;
      answer({ kind: "dump", ints: whole, floats: numbers, memory: kernels.memory.buffer.byteLength }, copies);
    }
  } catch (error) {
    answer({ kind: "failed", text: String(error) });
  }
};
