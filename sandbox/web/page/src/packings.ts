// Packings of all seeds, as sandbox/web/packed.py writes them: one is unfolded when it is chosen.

const sum = (some: number[]) => some.reduce((a, b) => a + b, 0);

let bare: BigUint64Array[][]; // by packing: whole numbers and others of a run, without a state
let rest: BigUint64Array; // parts that differ from seed to seed
let steps: Uint8Array; // of states on the grid: all lowest bytes, all next ones, and so on
let words: number[]; // in `rest`, by packing
let numbers: number[]; // of a state, by packing

export function spread(all: ArrayBuffer) {
  const { lengths, differing } = LIVE.packed;
  let at = 0;
  const taken = (bytes: number) => new BigUint64Array(all, (at += bytes) - bytes, bytes / 8);
  bare = lengths.map((both) => both.map(taken));
  for (const both of bare.slice(1)) {
    both.forEach((block, k) => {
      // What is as in the first packing is 0.
      if (block.length === bare[0][k].length) bare[0][k].forEach((value, place) => (block[place] ^= value));
    });
  }
  words = differing.map((parts) => sum(parts.map(([, , count]) => count)));
  numbers = bare.map(([ints]) => 5 * Number(ints[LIVE.layout.sizes.grains]));
  rest = taken(8 * LIVE.seeds.length * sum(words));
  steps = new Uint8Array(all, at);
}

// Both blocks of a packing, by places of seed and kind.
export function packing(seed: number, kind: number): ArrayBuffer[] {
  const both = bare[kind].map((block) => block.slice());
  const before = (lengths: number[]) => seed * sum(lengths) + sum(lengths.slice(0, kind));
  let at = before(words);
  for (const [block, begin, count] of LIVE.packed.differing[kind]) {
    both[block].set(rest.subarray(at, at + count), begin);
    at += count;
  }
  const [ints, floats] = both;
  const state = new Float64Array(floats.buffer, 8 * Number(ints[LIVE.layout.part.state]), numbers[kind]);
  const [first, count] = [before(numbers), steps.length / 4];
  state.forEach((_, k) => {
    const byte = (which: number) => steps[which * count + first + k] << (8 * which);
    const folded = byte(0) | byte(1) | byte(2) | byte(3);
    state[k] = ((folded >>> 1) ^ -(folded & 1)) / LIVE.packed.steps;
  });
  return both.map((block) => block.buffer);
}
