// The run: packings to begin with, what is set, where one can go back to, the script.

import { $, setText } from "./panes";
import { packing, spread } from "./packings";
import { MARKS, type Command } from "./shared";
import { held, panes, state, the, values } from "./stage";

let program: WebAssembly.Module;
interface Mark {
  values: [string, number][];
  script: boolean;
  held: boolean;
}
const marks: Mark[] = [];
const undone: Mark[] = [];

export async function load() {
  const [kernels, all] = await Promise.all([unpacked("kernels"), unpacked("packings")]);
  spread(all);
  program = await WebAssembly.compile(kernels);
}

async function unpacked(id: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(document.getElementById(id)!.textContent!.trim()), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

// The blocks of the packings that are chosen, to be handed out.
export function blocks(seed = state.seed): ArrayBuffer[][] {
  return LIVE.packings.map((_, k) => packing(seed, k === LIVE.share?.packing ? LIVE.share.places[state.share] : k));
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

const mark = (): Mark => ({ values: [...values], script: state.script, held: held.by !== null });

// A place to come back to, for hand, script and settings alike.
export function keep() {
  marks.push(mark());
  if (marks.length > MARKS) marks.shift();
  undone.length = 0;
  the.conductor.ask(["keep"]);
}

export const canUndo = () => marks.length > 0;
export const canRedo = () => undone.length > 0;
export const undo = () => goTo("undo", marks, undone);
export const redo = () => goTo("redo", undone, marks);

function goTo(command: string, from: Mark[], to: Mark[]) {
  letGo();
  const there = from.pop();
  if (!there) return;
  to.push(mark());
  for (const [name, value] of there.values) values.set(name, value);
  state.script = there.script;
  the.conductor.ask([command]);
  if (there.held) hand("release"); // nobody holds the handle now
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
  marks.length = undone.length = 0;
  state.script = false;
  for (const pane of panes) pane.begin();
  the.aloud = () => "";
  setText($("live"), "");
  the.conductor.begin(program, blocks(), changed());
}

export function switchScript() {
  letGo();
  keep();
  state.script = !state.script;
  hand(state.script ? "scriptOn" : "scriptOff");
}
