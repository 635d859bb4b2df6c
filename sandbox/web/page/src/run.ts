// The run: packings to begin with, what is set, where one can go back to, the script.

import { $, setText } from "./panes";
import { MARKS, type Command } from "./shared";
import { held, panes, state, the, values } from "./stage";

let program: WebAssembly.Module;
let packings: BigUint64Array[][][]; // by seed and packing: whole numbers, and others
const marks: { values: [string, number][]; script: boolean; held: boolean }[] = [];

export async function load() {
  const [kernels, all] = await Promise.all([unpacked("kernels"), unpacked("packings")]);
  program = await WebAssembly.compile(kernels);
  let at = 0;
  let first: BigUint64Array[] = [];
  packings = LIVE.lengths.map((some) =>
    some.map((lengths) => {
      const both = lengths.map((length) => {
        at += length;
        return new BigUint64Array(all, at - length, length / 8);
      });
      first = first.length ? first : both;
      both.forEach((block, k) => {
        // What is as in the first packing is 0.
        if (block !== first[k] && block.length === first[k].length) first[k].forEach((value, place) => (block[place] ^= value));
      });
      return both;
    }),
  );
}

async function unpacked(id: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(document.getElementById(id)!.textContent!.trim()), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

// The blocks of the packings that are chosen, to be handed out.
export function blocks(): ArrayBuffer[][] {
  const all = packings[state.seed];
  const chosen = LIVE.packings.map((_, k) => all[k === LIVE.share?.packing ? LIVE.share.places[state.share] : k]);
  return chosen.map((both) => both.map((block) => block.slice().buffer));
}

// A slider's entry of the kernels with its values: numbers as they are, and what sliders are set to.
export function commandOf(name: string): Command {
  const [entry, ...given] = LIVE.sliders.find((each) => each.name === name)!.command;
  return [String(entry), ...given.map((value) => (typeof value === "number" ? value : valueOf(value)))];
}

function valueOf(name: string): number {
  const slider = LIVE.sliders.find((each) => each.name === name)!;
  const value = values.get(name)!;
  return slider.top && value >= slider.most ? Infinity : value;
}

const changed = () => LIVE.sliders.filter((slider) => values.get(slider.name) !== slider.value).map((slider) => commandOf(slider.name));

export function hand(kind: string, x = 0, y = 0) {
  the.conductor.ask(["command", LIVE.commands[kind], LIVE.handle.body, x, y]);
}

export function letGo() {
  if (held.by === null) return;
  held.by = null;
  for (const pane of panes) {
    pane.target = null;
    pane.hold();
  }
  hand("release");
}

// A place to come back to, for hand, script and settings alike.
export function keep() {
  marks.push({ values: [...values], script: state.script, held: held.by !== null });
  if (marks.length > MARKS) marks.shift();
  the.conductor.ask(["keep"]);
}

export const canUndo = () => marks.length > 0;

export function undo() {
  letGo();
  const mark = marks.pop();
  if (!mark) return;
  for (const [name, value] of mark.values) values.set(name, value);
  state.script = mark.script;
  the.conductor.ask(["undo"]);
  if (mark.held) hand("release"); // nobody holds the handle now
}

export function reset() {
  if (the.conductor.silent) return begin();
  letGo();
  keep();
  state.script = false;
  for (const command of [["reset"] as Command, ...changed()]) the.conductor.ask(command);
}

// With the packings that are chosen, from their start.
export function begin() {
  letGo();
  marks.length = 0;
  state.script = false;
  for (const pane of panes) pane.begin();
  setText($("live"), "");
  the.conductor.begin(program, blocks(), changed());
}

export function switchScript() {
  letGo();
  keep();
  state.script = !state.script;
  hand(state.script ? "scriptOn" : "scriptOff");
}
