// The page of a scene: what is shown, and what a person asks for by mouse, finger and keyboard. It draws; kernels compute.

import { Conductor } from "./conductor";
import { $, Pane, element, setText } from "./panes";
import type { Command } from "./shared";

const state = { theme: "dark", view: 0, chains: true, seed: 0, script: false, held: false };
const values = new Map(LIVE.sliders.map((slider) => [slider.name, slider.value]));
const panes: Pane[] = [];
const pictures = { count: 0, since: performance.now() };
let plot: Plot;
let conductor: Conductor;
let program: WebAssembly.Module;
let packings: ArrayBuffer;
let dirty = true;

const PACE = 1000 / 60; // [ms] from one increment to the next, at least

const view = () => LIVE.views[state.view];
const look = (): PlayerLook => ({ theme: state.theme, view: view(), chains: state.chains, scale: devicePixelRatio || 1 });

async function unpacked(id: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob($(id).textContent!.trim()), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

// -- the run --

// The blocks of all packings of a seed.
function blocks(): [ArrayBuffer, ArrayBuffer][] {
  let at = 0;
  const found: [ArrayBuffer, ArrayBuffer][] = [];
  LIVE.lengths.forEach((some, seed) => {
    for (const [ints, floats] of some) {
      if (seed === state.seed) found.push([packings.slice(at, at + ints), packings.slice(at + ints, at + ints + floats)]);
      at += ints + floats;
    }
  });
  return found;
}

function commandOf(name: string): Command {
  const slider = LIVE.sliders.find((each) => each.name === name)!;
  const value = values.get(name)!;
  const [entry, ...before] = slider.command;
  return [String(entry), ...before.map(Number), slider.top && value >= slider.most ? Infinity : value];
}

const changed = () => LIVE.sliders.filter((slider) => values.get(slider.name) !== slider.value).map((slider) => commandOf(slider.name));

function hand(kind: string, x = 0, y = 0) {
  conductor.ask(["command", LIVE.commands[kind], LIVE.handle.body, x, y]);
}

function reset() {
  letGo();
  state.script = false;
  conductor.reset(changed());
  showButtons();
}

function chooseSeed(seed: number) {
  letGo();
  state.seed = seed;
  state.script = false;
  conductor.begin(program, blocks(), changed());
  showButtons();
}

function switchScript() {
  letGo();
  state.script = !state.script;
  hand(state.script ? "scriptOn" : "scriptOff");
  showButtons();
}

// -- the hand --

function grab() {
  if (state.held) return;
  state.held = true;
  state.script = false;
  hand("grab");
  showButtons();
}

function pull(x: number, y: number) {
  for (const pane of panes) {
    pane.target = [x, y];
    pane.hold();
  }
  hand("move", x, y);
}

function letGo() {
  if (!state.held) return;
  state.held = false;
  for (const pane of panes) {
    pane.target = null;
    pane.hold();
  }
  hand("release");
}

function placeOf(pane: Pane, event: PointerEvent): [number, number] {
  const box = pane.canvas.getBoundingClientRect();
  const ratio = pane.canvas.width / box.width;
  const { k, x, y } = pane.camera;
  return [((event.clientX - box.left) * ratio - x) / k, (y - (event.clientY - box.top) * ratio) / k];
}

function follow(pane: Pane) {
  const { canvas } = pane;
  let offset: [number, number] = [0, 0];
  canvas.addEventListener("pointerdown", (event) => {
    const [x, y] = placeOf(pane, event);
    const at = pane.shown.handles[0]?.at;
    if (!at) return;
    const near = 24 / ((pane.camera.k * canvas.clientWidth) / canvas.width); // so many pixels
    const { radius } = LIVE.packings[pane.index];
    const [beside, above] = [Math.max(radius, near), Math.max(LIVE.handle.axis ? 2 : radius, near)];
    if (Math.abs(x - at[0]) > beside || Math.abs(y - at[1]) > above) return;
    canvas.setPointerCapture(event.pointerId);
    offset = [at[0] - x, at[1] - y];
    grab();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!state.held || !canvas.hasPointerCapture(event.pointerId)) return;
    const [x, y] = placeOf(pane, event);
    pull(x + offset[0], y + offset[1]);
  });
  for (const end of ["pointerup", "pointercancel"] as const) canvas.addEventListener(end, letGo);
}

const ARROWS: Record<string, [number, number]> = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };

function pullBy([wx, wy]: [number, number]) {
  const at = panes[0].shown.handles[0]?.at;
  if (!at) return;
  grab();
  pull(at[0] + 2 * wx, at[1] + 2 * wy); // on and on, as long as the key is down
}

// -- pictures --

function arrange() {
  const stage = $("stage");
  const scrolls = getComputedStyle(stage).flexGrow === "0";
  const [wide, high] = [stage.clientWidth, scrolls ? Math.max(innerHeight * 0.62, 240) : stage.clientHeight];
  const sizes = panes.map(({ shown: { bounds: [x0, y0, x1, y1] } }) => [x1 - x0, y1 - y0]);
  const tallest = Math.max(...sizes.map(([, height]) => height));
  let [best, columns] = [0, 1];
  for (let count = 1; count <= panes.length; count++) {
    const rows = Math.ceil(panes.length / count);
    const k = Math.min(...sizes.map(([w, h]) => Math.min((wide / count - 20) / w, (high / rows - 110) / h)));
    if (k > best * 1.02) [best, columns] = [k, count];
  }
  stage.style.setProperty("--columns", String(columns));
  stage.dataset.columns = String(columns);
  stage.style.setProperty("--lines", "1");
  stage.style.setProperty("--cell", scrolls ? `${Math.round(Math.max(best * tallest + 20, 100))}px` : "auto");
  const ratio = devicePixelRatio || 1;
  for (const canvas of [...panes.map((pane) => pane.canvas), $<HTMLCanvasElement>("plot")]) {
    const { clientWidth, clientHeight } = canvas.parentElement!;
    canvas.width = Math.max(Math.round(clientWidth * ratio), 1);
    canvas.height = Math.max(Math.round(clientHeight * ratio), 1);
  }
  const fitted = panes.map(({ canvas, shown }) => cameraFor(shown.bounds, canvas.width, canvas.height, 10 * ratio));
  const scale = Math.min(...fitted.map((camera) => camera.k)); // one scale for all
  for (const { canvas, shown, camera } of panes) Object.assign(camera, cameraFor(shown.bounds, canvas.width, canvas.height, 0, scale));
  dirty = true;
}

// One scale for all packings; it only grows.
function scales() {
  const most = (some: ArrayLike<number>, least: number) => Array.from(some).reduce((a, b) => Math.max(a, b), least);
  const axes = (plot.known ??= { low: 0, high: LIVE.axes[0], bottom: 0, top: LIVE.axes[1] });
  for (const pane of panes) {
    const [stroke, force] = [pane.row("stroke"), pane.row("resisting")];
    const wider = [Math.min(axes.low, -roundUp(-stroke)), Math.max(axes.high, roundUp(stroke, FINER))];
    const higher = [Math.min(axes.bottom, -roundUp(-force)), Math.max(axes.top, roundUp(force, FINER))];
    const [low, high] = [stroke < axes.low ? wider[0] : axes.low, stroke > axes.high ? wider[1] : axes.high];
    const [bottom, top] = [force < axes.bottom ? higher[0] : axes.bottom, force > axes.top ? higher[1] : axes.top];
    const chains = Math.max(run.tops.chains, roundUp(most(pane.shown.bearing, 0), FINER));
    if (chains !== run.tops.chains) dirty = true;
    run.tops.chains = chains;
    if (low !== axes.low || high !== axes.high || bottom !== axes.bottom || top !== axes.top) plot.key = "";
    Object.assign(axes, { low, high, bottom, top });
  }
  for (const pane of panes) run.tops.hand = Math.max(run.tops.hand, roundUp(most([pane.row("hand_x"), pane.row("hand_y")].map(Math.abs), 0), FINER));
}

function picture() {
  requestAnimationFrame(picture);
  pictures.count++;
  conductor.turn();
  if (!dirty && panes.every((pane) => !pane.fresh)) return;
  for (const each of LIVE.views) if (each.valued) each.top = topOf(each, panes.map((pane) => pane.shown));
  for (const pane of panes) if (dirty || pane.fresh) pane.draw(look()); // one that is locked stands still
  plot.draw(0, look());
  dirty = false;
}

let said = 0;
let begun = 0;
// Increments do not wait for pictures: where a computer draws slowly, some are not seen.
function finished() {
  const wait = begun + PACE - performance.now();
  setTimeout(() => {
    begun = performance.now();
    conductor.turn();
  }, Math.max(wait, 0));
  scales();
  if (state.script && panes.every((pane) => pane.count("script") < 0) && conductor.turns > 1) {
    state.script = false;
    showButtons();
  }
  const now = performance.now();
  if (conductor.idle && now - said > 1000) {
    said = now;
    setText($("live"), panes.map((pane) => pane.standing()).join(". "));
  }
}

// -- words and choices --

function showButtons() {
  $("script").setAttribute("aria-pressed", String(state.script));
  $("chains").setAttribute("aria-pressed", String(state.chains));
}

function speak() {
  settle(LIVE.languages[language], state.theme);
  document.title = say(LIVE.title);
  setText($("title"), say(LIVE.title));
  setText($("question"), say(LIVE.question));
  setText($("about"), say(LIVE.about));
  setText($("reset"), word("reset"));
  setText($("script"), word("drive"));
  setText($("chains"), word("chains"));
  setText($("theme"), word(state.theme === "dark" ? "to_light" : "to_dark"));
  setText($("language"), run.words[(language + 1) % LIVE.languages.length].name);
  setText($("seed-label"), word("new"));
  $("seed").setAttribute("aria-label", word("new"));
  setText($("view-label"), word("view"));
  $<HTMLSelectElement>("view").replaceChildren(...LIVE.views.map((each, k) => option(say(each.title), k, state.view)));
  $<HTMLSelectElement>("seed").replaceChildren(...LIVE.seeds.map((seed, k) => option(word("seed", { seed }), k, state.seed)));
  $("stage").setAttribute("aria-label", word("stage"));
  $("plot").setAttribute("aria-label", `${say(run.labels.force)}, ${say(run.labels.stroke)}`);
  makeSliders();
  showButtons();
  if (plot) plot.key = "";
  dirty = true;
}

function option(text: string, value: number, chosen: number) {
  const made = element("option");
  made.textContent = text;
  made.value = String(value);
  made.selected = value === chosen;
  return made;
}

function makeSliders() {
  const lines = LIVE.sliders.map((slider) => {
    const input = element("input");
    Object.assign(input, { type: "range", id: `slider-${slider.name}`, min: slider.least, max: slider.most, step: slider.step });
    input.value = String(values.get(slider.name));
    const name = element("span");
    name.textContent = say(slider.title);
    const output = element("output");
    const show = () => {
      const value = values.get(slider.name)!;
      const text = slider.top && value >= slider.most ? say(slider.top) : `${short(value)} ${slider.unit}`.trim();
      output.textContent = text;
      input.setAttribute("aria-valuetext", text);
    };
    input.addEventListener("input", () => {
      values.set(slider.name, Number(input.value));
      conductor.ask(commandOf(slider.name));
      if (slider.name === "hand_strength") limits();
      show();
    });
    show();
    return element("label", "slider", name, output, input);
  });
  $("sliders").replaceChildren(...lines);
}

function limits() {
  const slider = LIVE.sliders.find((each) => each.name === "hand_strength");
  const value = values.get("hand_strength") ?? Infinity;
  run.limit = LIVE.plotsHand && slider && value < slider.most ? value : null;
  if (plot) plot.key = "";
  dirty = true;
}

const KEYS: Record<string, () => void> = {
  r: reset,
  a: switchScript,
  n: () => chooseSeed((state.seed + 1) % LIVE.seeds.length),
  f: () => ((state.chains = !state.chains), showButtons(), (dirty = true)),
  t: () => ((state.theme = state.theme === "dark" ? "light" : "dark"), speak()),
  l: () => ((language = (language + 1) % LIVE.languages.length), speak()),
  v: () => chooseView((state.view + 1) % LIVE.views.length),
  escape: () => letGo(),
};

function chooseView(index: number) {
  state.view = index;
  state.chains = view().chains;
  $<HTMLSelectElement>("view").value = String(index);
  showButtons();
  dirty = true;
}

function listen() {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.target as HTMLElement).matches("select, input")) return;
    const arrow = ARROWS[event.key];
    const act = arrow ? () => pullBy(arrow) : KEYS[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  });
  document.addEventListener("keyup", (event) => {
    if (ARROWS[event.key]) letGo();
  });
  $("reset").addEventListener("click", reset);
  $("script").addEventListener("click", switchScript);
  $("chains").addEventListener("click", KEYS.f);
  $("theme").addEventListener("click", KEYS.t);
  $("language").addEventListener("click", KEYS.l);
  $("view").addEventListener("change", (event) => chooseView(Number((event.target as HTMLSelectElement).value)));
  $("seed").addEventListener("change", (event) => chooseSeed(Number((event.target as HTMLSelectElement).value)));
}

async function begin() {
  run = Object.assign(PAGE, {
    ...{ panes: [], languages: LIVE.languages, labels: LIVE.labels, limit: null, views: LIVE.views },
    tops: { chains: 0.5, hand: LIVE.axes[1] },
  }) as unknown as PlayerRun;
  language = languageAsked(LIVE.start.auto, LIVE.languages, document.documentElement.lang);
  state.theme = themeAsked(LIVE.start.auto, LIVE.start.theme);
  LIVE.packings.forEach((_, index) => panes.push(new Pane(LIVE, index)));
  run.panes = panes.map((pane) => pane.shown);
  plot = new Plot($<HTMLCanvasElement>("plot"), () => undefined);
  limits();
  speak();
  const [kernels, all] = await Promise.all([unpacked("kernels"), unpacked("packings")]);
  [program, packings] = [await WebAssembly.compile(kernels), all];
  const failed = (text: string) => setText($("question"), text);
  conductor = new Conductor(LIVE, (pane, seen) => panes[pane].take(seen), finished, failed);
  conductor.begin(program, blocks(), []);
  panes.forEach(follow);
  listen();
  new ResizeObserver(arrange).observe($("stage"));
  arrange();
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
  picture();
}

// For tests and for who is curious.
Object.assign(window, { sandboxLive: { state, panes, pictures, get conductor() { return conductor; }, hand, reset, chooseSeed, blocks } });
begin();
