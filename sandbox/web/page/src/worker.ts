// One packing: hands commands to the kernels, asks for increments, and copies what there is to be seen. It computes nothing itself.

import type { Command, FromWorker, Layout, Seen, ToWorker } from "./shared";

interface Kernels {
  memory: WebAssembly.Memory;
  reserve(bytes: bigint): number;
  forget(): void;
  [name: string]: unknown;
}

let kernels: Kernels;
let layout: Layout;
let [intsAt, floatsAt, whole, others] = [0, 0, 0, 0];
let start: { ints: Uint8Array; floats: Uint8Array };

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
  toStart();
}

function toStart() {
  new Uint8Array(kernels.memory.buffer, intsAt, start.ints.length).set(start.ints);
  new Uint8Array(kernels.memory.buffer, floatsAt, start.floats.length).set(start.floats);
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
    places: some("places", layout.columns * size("bodies")),
    reactions: some("reactions", 3 * size("bodies")),
    row: some("row", Object.keys(layout.row).length),
    counts,
  };
}

function turn(commands: Command[]) {
  const begun = performance.now();
  for (const command of commands) call(command);
  const made = call(["advance"]) === 1n;
  answer({ kind: "seen", made, time: performance.now() - begun, seen: made ? seen() : null });
}

onmessage = ({ data }: MessageEvent<ToWorker>) => {
  try {
    if (data.kind === "load") {
      load(data);
      answer({ kind: "ready" });
    } else if (data.kind === "turn") {
      turn(data.commands);
    } else if (data.kind === "reset") {
      toStart();
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
