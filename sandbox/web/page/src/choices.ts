// Words, buttons, sliders and keys.

import { $, element, setText } from "./panes";
import { ARROWS, pullBy } from "./hand";
import { begin, canRedo, canUndo, commandOf, keep, letGo, redo, reset, switchScript, undo } from "./run";
import { held, panes, state, the, values, view } from "./stage";
import type { Slider } from "./live";

export function showButtons() {
  $("script").setAttribute("aria-pressed", String(state.script));
  $("chains").setAttribute("aria-pressed", String(state.chains));
  for (const [id, can] of Object.entries({ undo: canUndo(), redo: canRedo() })) $(id).setAttribute("aria-disabled", String(!can)); // they keep the focus
  setText($("pause"), word(the.conductor?.paused ? "play" : "pause"));
}

export function speak() {
  settle(LIVE.languages[language], state.theme);
  document.title = say(LIVE.title);
  const texts = { title: say(LIVE.title), question: say(LIVE.question), about: say(LIVE.about), reset: word("reset"), undo: word("undo"), redo: word("redo") };
  Object.assign(texts, { script: word("drive"), chains: word("chains"), "seed-label": word("panel_seed"), "view-label": word("view") });
  Object.assign(texts, { theme: word(state.theme === "dark" ? "to_light" : "to_dark"), "events-title": word("events"), "keys-title": word("keys"), "letters-label": word("letters") });
  for (const [id, text] of Object.entries(texts)) setText($(id), text);
  const other = (language + 1) % LIVE.languages.length;
  setText($("language"), run.words[other].name);
  $("language").lang = LIVE.languages[other];
  $<HTMLSelectElement>("view").replaceChildren(...LIVE.views.map((each, k) => option(say(each.title), k, state.view)));
  $<HTMLSelectElement>("seed").replaceChildren(...LIVE.seeds.map((seed, k) => option(String(seed), k, state.seed)));
  $("choices").setAttribute("aria-label", word("choices"));
  $("stage").setAttribute("aria-label", word("stage"));
  $("plot").setAttribute("aria-label", `${say(run.labels.force)}, ${say(run.labels.stroke)}`);
  const keys = run.keys[language].flatMap(([key, does]) => [text("dt", key), text("dd", does)]);
  $("keys").replaceChildren(...keys);
  for (const show of lines) show();
  showButtons();
  showEvents();
  for (const pane of panes) pane.tell();
  setText($("live"), the.aloud());
  if (the.plot) the.plot.key = "";
  the.dirty = true;
}

function text(name: "dt" | "dd" | "span", said: string) {
  const made = element(name);
  made.textContent = said;
  return made;
}

function option(said: string, value: number, chosen: number) {
  const made = element("option");
  made.textContent = said;
  made.value = String(value);
  made.selected = value === chosen;
  return made;
}

// -- sliders --

const lines: (() => void)[] = []; // show what each is called and set to

export function makeSliders() {
  const { share } = LIVE;
  for (const slider of LIVE.sliders) line(slider, () => values.get(slider.name)!, (value) => set(slider, value), []);
  if (share) {
    const slider = { ...share, value: share.at, least: 0, most: share.values.length - 1, step: 1, unit: "", top: null };
    const packed = (value: number) => {
      state.share = value;
      begin();
      showButtons();
    };
    line(slider, () => state.share, packed, share.values);
  }
}

let setting = ""; // the slider that is being moved: it is kept once what was before
function set(slider: Slider, value: number) {
  if (setting !== slider.name) keep();
  setting = slider.name;
  values.set(slider.name, value);
  the.conductor.ask(commandOf(slider.name));
  if (slider.name === "hand_strength") limits();
  showButtons();
}

// One slider, back at first by a double click or Delete. `named`: values that are chosen from, by their places.
function line(slider: Omit<Slider, "command">, now: () => number, changed: (value: number) => void, named: number[]) {
  const input = element("input");
  Object.assign(input, { type: "range", id: `slider-${slider.name}`, min: slider.least, max: slider.most, step: slider.step });
  const output = element("output");
  const name = element("span");
  const show = () => {
    const value = Number(input.value);
    const top = slider.top && value >= slider.most;
    const said = top ? say(slider.top!) : `${short(named.length ? named[value] : value)} ${slider.unit}`.trim();
    output.textContent = said;
    input.setAttribute("aria-valuetext", said);
    setText(name, say(slider.title));
  };
  input.addEventListener("input", () => {
    if (!named.length) changed(Number(input.value));
    show();
  });
  input.addEventListener("change", () => {
    setting = "";
    if (named.length) changed(Number(input.value)); // packs anew, on letting go
  });
  const showNow = () => {
    input.value = String(now());
    show();
  };
  const restore = () => {
    if (now() === slider.value) return;
    changed(slider.value);
    setting = "";
    showNow();
  };
  input.addEventListener("dblclick", restore);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Delete") restore();
  });
  lines.push(showNow);
  $("sliders").append(element("label", "slider", name, output, input));
}

export function limits() {
  const slider = LIVE.sliders.find((each) => each.name === "hand_strength");
  const value = values.get("hand_strength") ?? Infinity;
  run.limit = LIVE.plotsHand && slider && value < slider.most ? value : null;
  if (the.plot) the.plot.key = "";
  the.dirty = true;
}

// -- events --

const MOST = 40; // that are listed

export function showEvents() {
  const all = panes.flatMap((pane) => pane.shown.events.map((event) => ({ ...event, whose: pane })));
  all.sort((a, b) => b.increment - a.increment || a.whose.index - b.whose.index);
  const lines = all.slice(0, MOST).map(({ kind, increment, text: said, whose }) => {
    const name = panes.length > 1 ? `${whose.title} · ` : "";
    return element("li", "", shapeOfEvent(kind), text("span", `${name}${word("increment", { increment })}: ${said()}`));
  });
  $("events-part").hidden = !lines.length;
  $("events").replaceChildren(...lines);
  if (the.plot) the.plot.key = ""; // it names the kinds there have been
}

// -- keys --

function chooseSeed(seed: number) {
  state.seed = seed;
  state.asked = "";
  $<HTMLSelectElement>("seed").value = String(seed);
  begin();
}

function chooseView(index: number) {
  state.view = index;
  state.chains = view().chains;
  $<HTMLSelectElement>("view").value = String(index);
  the.dirty = true;
}

function showKeys() {
  const part = $<HTMLDetailsElement>("keys-part");
  part.open = !part.open;
  if (part.open) $("keys-title").focus();
}

// Go to another state by `go`; what is set is shown anew, with the sliders.
function restored(go: () => void) {
  go();
  setting = "";
  limits();
  for (const show of lines) show();
}

function pause() {
  const { conductor } = the;
  conductor.paused = !conductor.paused;
  for (const pane of panes) pane.tell();
  the.aloud = () => (conductor.paused ? word("paused") : "");
  setText($("live"), the.aloud());
}

const LETTERS: Record<string, () => void> = {
  r: reset,
  a: switchScript,
  z: () => restored(undo),
  Z: () => restored(redo),
  " ": pause,
  n: () => chooseSeed((state.seed + 1) % LIVE.seeds.length),
  f: () => ((state.chains = !state.chains), (the.dirty = true)),
  t: () => ((state.theme = state.theme === "dark" ? "light" : "dark"), speak()),
  l: () => ((language = (language + 1) % LIVE.languages.length), speak()),
  v: () => chooseView((state.view + 1) % LIVE.views.length),
  h: showKeys,
  "?": showKeys,
};
const KEYS: Record<string, () => void> = { F1: showKeys, Escape: letGo };
const WITH_CTRL: Record<string, () => void> = { z: LETTERS.z, Z: LETTERS.Z, y: LETTERS.Z };

export function listen() {
  document.addEventListener("keydown", (event) => {
    const on = (kinds: string) => (event.target as HTMLElement).matches(kinds);
    const sign = signOf(event);
    if (event.altKey || on("select") || (sign === " " && on("a, button, summary, input[type=checkbox], .told p"))) return;
    const ctrl = event.ctrlKey || event.metaKey;
    const arrow = ctrl || on("input[type=range], .told p") ? undefined : ARROWS[event.key];
    const letters = ctrl ? WITH_CTRL : $<HTMLInputElement>("letters").checked && !event.repeat ? LETTERS : {};
    const letter = letters[sign] ?? letters[sign.toLowerCase()];
    const act = arrow ? () => pullBy(arrow, event.shiftKey) : ((ctrl ? undefined : KEYS[event.key]) ?? letter);
    if (!act) return;
    event.preventDefault();
    act();
    showButtons();
  });
  document.addEventListener("keyup", (event) => {
    if (ARROWS[event.key] && held.by === "keys") letGo();
  });
  window.addEventListener("blur", letGo);
  const buttons = { reset, pause, script: switchScript, undo: LETTERS.z, redo: LETTERS.Z, chains: LETTERS.f, theme: LETTERS.t, language: LETTERS.l };
  for (const [id, act] of Object.entries(buttons)) {
    $(id).addEventListener("click", () => {
      act();
      showButtons();
    });
  }
  $("view").addEventListener("change", (event) => {
    chooseView(Number((event.target as HTMLSelectElement).value));
    showButtons();
  });
  $("seed").addEventListener("change", (event) => {
    chooseSeed(Number((event.target as HTMLSelectElement).value));
    showButtons();
  });
}
