// The page: what is shown, and what a person asks for by mouse, finger and keyboard.

const RATE = 15; // moments a second at speed 1
const SPEEDS = [0.125, 0.25, 0.5, 1, 2, 4];
const LEAP = 10; // moments that a page key goes
const ICONS = {
  play: "M7 4l13 8-13 8z",
  pause: "M6 4h4v16H6zM14 4h4v16h-4z",
  on: "M5 4l10 8-10 8zM16 4h3v16h-3z",
  back: "M19 4L9 12l10 8zM5 4h3v16H5z",
};
const $ = (id) => document.getElementById(id);
const still = matchMedia("(prefers-reduced-motion: reduce)");
const state = { moment: 0, playing: false, speed: 3, view: 0, chains: true, theme: "dark", pane: 0, grain: -1, seen: [], carry: 0 };
let plot;

const view = () => run.views[state.view];
const last = () => run.increments.length - 1;
const look = () => ({ theme: state.theme, view: view(), chains: state.chains, scale: devicePixelRatio || 1 });

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

// -- time --

function go(moment, quietly = false) {
  state.moment = Math.min(Math.max(Math.round(moment), 0), last());
  draw();
  if (!quietly) announce();
}

function play(on) {
  if (on && still.matches) {
    go(state.moment >= last() ? 0 : state.moment + Math.max(Math.round(last() / 12), 1)); // steps, not motion
    return;
  }
  if (on && state.moment >= last()) go(0, true);
  state.playing = on;
  state.carry = 0;
  state.clock = performance.now();
  showPlay();
  if (on) requestAnimationFrame(tick);
  else announce();
}

function showPlay() {
  $("play").replaceChildren(icon(state.playing ? ICONS.pause : ICONS.play));
  $("play").setAttribute("aria-label", word(state.playing ? "pause" : still.matches ? "play_steps" : "play"));
  $("play").title = $("play").getAttribute("aria-label");
}

function tick(now) {
  if (!state.playing) return;
  state.carry += Math.min((now - state.clock) / 1000, 0.25) * RATE * SPEEDS[state.speed];
  state.clock = now;
  const steps = Math.floor(state.carry);
  if (steps) {
    state.carry -= steps;
    go(state.moment + steps, true);
    if (state.moment >= last()) return play(false);
  }
  requestAnimationFrame(tick);
}

function seek(moment) {
  if (state.playing) play(false);
  go(moment);
}

function eventsInOrder() {
  const all = run.panes.flatMap((pane, index) => pane.events.map((event) => ({ ...event, pane: index })));
  return all.sort((a, b) => a.increment - b.increment || a.pane - b.pane);
}

function nextEvent(way) {
  const moments = eventsInOrder().map((event) => event.moment);
  const found = way > 0 ? moments.find((moment) => moment > state.moment) : moments.reverse().find((moment) => moment < state.moment);
  if (found !== undefined) seek(found);
}

// -- choices and keys --

function chooseView(index) {
  state.view = (index + run.views.length) % run.views.length;
  state.chains = view().chains;
  $("view").value = state.view;
  showTheme();
  makeLegend();
  draw();
  announce();
}

function switchChains() {
  state.chains = !state.chains;
  showTheme();
  makeLegend();
  draw();
}

function switchTheme() {
  state.theme = state.theme === "dark" ? "light" : "dark";
  showTheme();
  makeLegend();
  draw();
}

function switchLanguage() {
  language = (language + 1) % run.languages.length;
  speakAll();
}

function chooseSpeed(index) {
  state.speed = Math.min(Math.max(index, 0), SPEEDS.length - 1);
  $("speed").value = state.speed;
}

const LETTERS = {
  "[": () => seek(state.moment - 1),
  "]": () => seek(state.moment + 1),
  ",": () => chooseSpeed(state.speed - 1),
  ".": () => chooseSpeed(state.speed + 1),
  n: () => nextEvent(1),
  N: () => nextEvent(-1),
  v: () => chooseView(state.view + 1),
  V: () => chooseView(state.view - 1),
  f: switchChains,
  t: switchTheme,
  l: switchLanguage,
  i: followContact,
};
const OTHERS = {
  " ": () => play(!state.playing),
  ArrowLeft: () => seek(state.moment - 1),
  ArrowRight: () => seek(state.moment + 1),
  PageUp: () => seek(state.moment + LEAP),
  PageDown: () => seek(state.moment - LEAP),
  Home: () => seek(0),
  End: () => seek(last()),
  Escape: () => lookAt(state.pane, -1),
};

function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const at = event.target;
  const own = at.matches("select, textarea, input:not([type=range])") || (at.matches("input") && event.key.startsWith("Arrow"));
  const pressing = event.key === " " && at.matches("button, summary, a, input[type=checkbox]");
  if (own || pressing) return;
  const sign = signOf(event);
  const act = OTHERS[event.key] ?? ($("letters").checked ? LETTERS[sign] ?? LETTERS[sign.toLowerCase()] : undefined);
  if (!act) return;
  event.preventDefault();
  act();
}

async function begin() {
  run = Object.assign(await unpack($("recording").textContent.trim()), PAGE);
  language = languageAsked(run.start.auto, run.languages, document.documentElement.lang);
  state.theme = themeAsked(run.start.auto, document.documentElement.dataset.theme);
  state.view = Math.max(run.views.findIndex((each) => each.name === run.start.view), 0);
  state.chains = view().chains;
  makePanes();
  plot = new Plot($("plot"), seek);
  $("time").max = last();
  $("time").addEventListener("input", (event) => seek(Number(event.target.value)));
  $("play").addEventListener("click", () => play(!state.playing));
  $("back").addEventListener("click", () => seek(state.moment - 1));
  $("on").addEventListener("click", () => seek(state.moment + 1));
  $("view").addEventListener("change", (event) => chooseView(Number(event.target.value)));
  $("speed").addEventListener("change", (event) => chooseSpeed(Number(event.target.value)));
  $("chains").addEventListener("click", switchChains);
  $("theme").addEventListener("click", switchTheme);
  $("language").addEventListener("click", switchLanguage);
  document.addEventListener("keydown", pressed);
  still.addEventListener("change", () => play(false));
  for (const pane of run.panes) pane.camera = cameraFor(pane.bounds, 1, 1, 0);
  speakAll();
  new ResizeObserver(arrange).observe($("stage"));
  document.documentElement.dataset.ready = Math.round(performance.now());
  if (!still.matches && run.start.play) play(true);
}

// For tests and for who is curious: what is shown.
window.sandboxPlayer = { state, go: seek, get run() { return run; } };
begin();
