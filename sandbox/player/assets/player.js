// The page: what is shown, and what a person asks for by mouse, finger and keyboard.

const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';
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

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && key !== "role" && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function icon(path, name = "") {
  const template = document.createElement("template"); // its parser knows the namespace
  template.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true" class="${name}"><path d="${path}"></path></svg>`;
  return template.content.firstChild;
}

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

// -- packings side by side --

function makePanes() {
  run.panes.forEach((pane, index) => {
    pane.look = run.packings[pane.packing] ?? run.packings.mixed;
    pane.pressureTop = run.views.find((each) => each.name === "pressure").top;
    pane.canvas = element("canvas", { role: "img" });
    pane.nodes = {};
    pane.nodes.swatch = element("span", { className: "swatch" });
    pane.nodes.name = element("strong");
    pane.nodes.lamp = element("span", { className: "lamp" });
    pane.nodes.said = element("span", { className: "said" });
    pane.nodes.value = element("span", { className: "value" });
    pane.nodes.foot = element("p", { className: "foot" });
    const { swatch, name, value, lamp, said } = pane.nodes;
    const first = element("div", { className: "row" }, swatch, name, value);
    const strip = element("figcaption", {}, first, element("div", { className: "row" }, lamp, said));
    const body = element("div", { className: "canvas" }, pane.canvas);
    $("stage").append(element("figure", {}, strip, body, pane.nodes.foot));
    pane.canvas.addEventListener("click", (event) => lookAt(index, under(pane, event)));
    pane.canvas.addEventListener("pointermove", (event) => {
      pane.canvas.style.cursor = under(pane, event) < 0 ? "" : "pointer";
    });
  });
}

function under(pane, event) {
  const place = pane.canvas.getBoundingClientRect();
  const ratio = pane.canvas.width / place.width;
  const [x, y] = [(event.clientX - place.left) * ratio, (event.clientY - place.top) * ratio];
  return grainAt(pane, state.moment, (x - pane.camera.x) / pane.camera.k, (pane.camera.y - y) / pane.camera.k);
}

// So many columns that the grains are largest; where the page scrolls, the stage is as high as that needs.
function arrange() {
  const stage = $("stage");
  const free = getComputedStyle(stage).flexGrow === "0";
  const [wide, high] = [stage.clientWidth, free ? Math.max(innerHeight * 0.62, 240) : stage.clientHeight];
  const extra = 94; // strip and foot
  let [best, columns, cell] = [0, 1, 100];
  for (let count = 1; count <= run.panes.length; count++) {
    const rows = Math.ceil(run.panes.length / count);
    const [w, h] = [wide / count - 20, high / rows - extra - 20];
    const k = Math.min(...run.panes.map(({ bounds: [x0, y0, x1, y1] }) => Math.min(w / (x1 - x0), h / (y1 - y0))));
    if (k > best * 1.02) [best, columns] = [k, count];
  }
  for (const { bounds } of run.panes) cell = Math.max(cell, best * (bounds[3] - bounds[1]) + 20);
  stage.style.setProperty("--columns", columns);
  stage.style.setProperty("--cell", free ? `${Math.round(cell)}px` : "auto");
  const ratio = devicePixelRatio || 1;
  for (const canvas of [...run.panes.map((pane) => pane.canvas), $("plot")]) {
    const { clientWidth, clientHeight } = canvas.parentElement;
    canvas.width = Math.max(Math.round(clientWidth * ratio), 1);
    canvas.height = Math.max(Math.round(clientHeight * ratio), 1);
  }
  const fitted = run.panes.map(({ canvas, bounds }) => cameraFor(bounds, canvas.width, canvas.height, 10 * ratio));
  const scale = Math.min(...fitted.map((camera) => camera.k)); // one scale for all
  for (const pane of run.panes) pane.camera = cameraFor(pane.bounds, pane.canvas.width, pane.canvas.height, 0, scale);
  draw();
}

function draw() {
  run.panes.forEach((pane, index) => {
    const scenery = new Scenery(pane.canvas.getContext("2d"), pane, state.moment, pane.camera, look());
    scenery.draw(pane.canvas.width, pane.canvas.height);
    if (index === state.pane && state.grain >= 0) scenery.ring(state.grain);
  });
  plot.draw(state.moment, look());
  tellPanes();
  const { moment } = state;
  const time = $("time");
  time.value = moment;
  time.setAttribute("aria-valuetext", word("time_value", { increment: run.increments[moment], last: run.increments[last()] }));
  setText($("now"), `${run.increments[moment]} / ${run.increments[last()]}`);
  tellGrain();
}

function forceOf(pane) {
  const [, unit] = labelParts(say(run.labels.force));
  const value = pane.force[Math.min(pane.at[state.moment], pane.force.length - 1)];
  return `${number(value, pane.digits)} ${unit}`.trim();
}

function tellPanes() {
  const levels = ["good", "working", "bad"];
  for (const pane of run.panes) {
    pane.digits ??= decimalsFor(Math.max(...pane.force) - Math.min(...pane.force)) + 2;
    const out = pane.out[state.moment];
    setText(pane.nodes.name, say(pane.title));
    setText(pane.nodes.value, forceOf(pane) + (out ? ` · ${word("grains_out", { count: out })}` : ""));
    setText(pane.nodes.said, say(run.texts[pane.state[state.moment]]));
    pane.nodes.said.title = pane.nodes.said.textContent;
    pane.nodes.lamp.className = `lamp ${levels[pane.level[state.moment]]}`;
    setText(pane.nodes.foot, noticeOf(pane));
  }
}

// What the scene says now, or else an event that has just happened.
function noticeOf(pane) {
  const notices = pane.notices[state.moment].map((text) => say(run.texts[text]));
  if (notices.length) return notices.join(" · ");
  const increment = pane.at[state.moment];
  const event = pane.events.filter((each) => each.increment <= increment).pop();
  return event && increment - event.increment < 40 ? say(event.text) : "";
}

// For who does not see the picture: where all packings stand.
function standing() {
  const panes = run.panes.map((pane) => {
    const parts = [forceOf(pane), say(run.texts[pane.state[state.moment]]), noticeOf(pane)];
    const out = pane.out[state.moment];
    if (out) parts.splice(1, 0, word("grains_out", { count: out }));
    return `${say(pane.title)}: ${parts.filter(Boolean).join(", ")}`;
  });
  return [word("increment", { increment: run.increments[state.moment] }), ...panes].join(". ");
}

let announcing = 0;
function announce(text) {
  clearTimeout(announcing);
  announcing = setTimeout(() => {
    setText($("live"), text ?? standing());
    run.panes.forEach((pane) => pane.canvas.setAttribute("aria-label", picture(pane)));
  }, 250);
}

function picture(pane) {
  const count = pane.there.subarray(state.moment * pane.count, (state.moment + 1) * pane.count).reduce((sum, one) => sum + (one ? 1 : 0), 0);
  return word("picture", { packing: say(pane.title), count, view: say(view().title), force: forceOf(pane), notice: noticeOf(pane) });
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

// -- looking at a grain --

function lookAt(pane, grain) {
  state.pane = pane;
  state.grain = grain;
  state.seen = grain < 0 ? [] : [...state.seen.filter((seen) => seen !== grain), grain];
  draw();
  if (grain >= 0) announce(grainText());
}

function followContact() {
  const pane = run.panes[state.pane];
  if (state.grain < 0) {
    const [x0, y0, x1, y1] = pane.bounds;
    const handle = pane.handles[0]?.at.subarray(4 * state.moment, 4 * state.moment + 2) ?? [(x0 + x1) / 2, (y0 + y1) / 2];
    lookAt(state.pane, nearestGrain(pane, state.moment, ...handle));
  } else lookAt(state.pane, nextGrain(pane, state.moment, state.grain, state.seen));
}

function grainName(pane, grain) {
  const kind = pane.nu[state.moment * pane.count + grain] < 0 ? "auxetic" : "regular";
  return `${word("grain_label", { label: pane.labels[grain] })}, ${word("kind_" + kind)}`;
}

function grainText() {
  const pane = run.panes[state.pane];
  const { facts } = factsOf(pane, state.moment, state.grain);
  return [grainName(pane, state.grain), ...facts.map(([name, value]) => `${name} ${value}`)].join(". ");
}

function tellGrain() {
  const card = $("grain");
  const pane = run.panes[state.pane];
  const gone = state.grain < 0 || !pane.there[state.moment * pane.count + state.grain];
  if (gone) {
    if (!card.hidden) card.hidden = true;
    return;
  }
  card.hidden = false;
  const { facts, contacts, forces } = factsOf(pane, state.moment, state.grain);
  const focused = card.contains(document.activeElement) ? document.activeElement.dataset.key : null;
  const close = element("button", { type: "button", className: "small", textContent: word("let_go"), onclick: () => lookAt(state.pane, -1) });
  const along = element("button", { type: "button", className: "small", textContent: word("next_contact"), onclick: followContact });
  close.dataset.key = "close";
  along.dataset.key = "along";
  const list = element("dl", { className: "facts" });
  for (const [name, value] of facts) list.append(element("dt", { textContent: name }), element("dd", { textContent: value }));
  const touching = element("ul", { className: "touching" });
  for (const [other, force] of contacts) {
    const size = `${number(force, forces)} k R`;
    if (other < 0) touching.append(element("li", { textContent: `${word("grain_wall")}: ${size}` }));
    else {
      const text = word("grain_other", { label: pane.labels[other], force: size });
      const button = element("button", { type: "button", className: "small", textContent: text, onclick: () => lookAt(state.pane, other) });
      button.dataset.key = `grain ${other}`;
      touching.append(element("li", {}, button));
    }
  }
  const heading = [element("h2", { textContent: grainName(pane, state.grain) })];
  if (run.panes.length > 1) heading.push(element("p", { className: "soft", textContent: `${word("panel_packing")}: ${say(pane.title)}` }));
  card.replaceChildren(...heading, list, touching, element("p", { className: "row" }, along, close));
  if (focused) (card.querySelector(`[data-key="${focused}"]`) ?? close).focus();
}

// -- words, choices, keys --

function speakAll() {
  document.documentElement.lang = run.languages[language];
  document.title = say(run.title);
  for (const story of document.querySelectorAll("[data-story]")) story.hidden = story.lang !== run.languages[language];
  const texts = { title: say(run.title), question: say(run.question), "view-label": word("view"), "speed-label": word("speed") };
  Object.assign(texts, { "story-title": word("story"), "events-title": word("events"), "keys-title": word("keys") });
  Object.assign(texts, { "letters-label": word("letters"), chains: word("chains") });
  for (const [id, text] of Object.entries(texts)) setText($(id), text);
  const other = (language + 1) % run.languages.length;
  setText($("language"), run.words[other].name);
  $("language").lang = run.languages[other];
  $("choices").setAttribute("aria-label", word("choices"));
  $("stage").setAttribute("aria-label", word("stage"));
  $("plot-part").setAttribute("aria-label", word("plot"));
  $("time-part").setAttribute("aria-label", word("time"));
  $("time").setAttribute("aria-label", word("time"));
  $("plot").setAttribute("aria-label", word("plot_picture", { force: say(run.labels.force), stroke: say(run.labels.stroke) }));
  for (const [id, key] of [["back", "back"], ["on", "on"]]) {
    $(id).replaceChildren(icon(ICONS[id]));
    $(id).setAttribute("aria-label", word(key));
    $(id).title = word(key);
  }
  $("view").replaceChildren(...run.views.map((each, k) => element("option", { value: k, textContent: say(each.title), selected: k === state.view })));
  $("speed").setAttribute("aria-label", word("speed"));
  const names = ["1/8", "1/4", "1/2", "1", "2", "4"];
  $("speed").replaceChildren(...names.map((name, k) => element("option", { value: k, textContent: `${name} ×`, selected: k === state.speed })));
  makeEvents();
  $("keys").replaceChildren(...run.keys[language].flatMap(([key, does]) => [element("dt", { textContent: key }), element("dd", { textContent: does })]));
  showPlay();
  showTheme();
  makeLegend();
  draw();
  announce();
}

function makeEvents() {
  const all = eventsInOrder();
  $("events-part").hidden = !all.length;
  $("marks").replaceChildren();
  $("events").replaceChildren();
  for (const event of all) {
    const whose = run.panes.length > 1 ? `${say(run.panes[event.pane].title)} · ` : "";
    const text = `${whose}${word("increment", { increment: event.increment })}: ${say(event.text)}`;
    const choose = () => seek(event.moment);
    const mark = element("button", { type: "button", className: "mark", tabIndex: -1, title: text, onclick: choose }, shapeOfEvent(event.kind));
    mark.setAttribute("aria-hidden", "true"); // the list says the same, and is on the way of Tab
    mark.style.left = `${(100 * event.moment) / Math.max(last(), 1)}%`;
    $("marks").append(mark);
    $("events").append(element("li", {}, element("button", { type: "button", onclick: choose }, shapeOfEvent(event.kind), element("span", { textContent: text }))));
  }
}

function shapeOfEvent(kind) {
  const points = (run.shapes[kind] ?? run.shapes.clog).map(([u, v]) => `${12 + 8 * u} ${12 - 8 * v}`);
  return icon(`M${points.join("L")}z`, "event");
}

function makeLegend() {
  const parts = [];
  const theme = run.themes[state.theme];
  const count = [0, 0];
  for (const pane of run.panes) for (let k = 0; k < pane.count; k++) count[pane.nu[k] < 0 ? 1 : 0]++;
  ["regular", "auxetic"].forEach((kind, k) => {
    if (count[k]) parts.push(element("span", { className: "part" }, kindPicture(kind), word("kinds_" + kind)));
  });
  const bar = (name, top, unit, ramp, wedge) => {
    const picture = element("span", { className: wedge ? "ramp wedge" : "ramp" });
    picture.style.backgroundImage = `linear-gradient(to right, ${ramp.map(css).join(",")})`;
    const high = `${number(top, decimalsFor(top / 10))} ${unit}`.trim();
    parts.push(element("span", { className: "part" }, `${name}  0`, picture, high));
  };
  if (state.chains || view().onlyChains) {
    bar(word("chains"), run.tops.chains, "k R", view().valued ? [theme.text, theme.text] : theme.ramps.chains, true);
  }
  if (view().valued) bar(say(view().title), view().top, view().unit, theme.ramps[view().ramp], false);
  $("legend").replaceChildren(...parts);
}

// A grain as on the canvas.
function kindPicture(kind) {
  const ratio = devicePixelRatio || 1;
  const canvas = element("canvas", { width: 24 * ratio, height: 24 * ratio, className: "kind" });
  canvas.setAttribute("aria-hidden", "true");
  const one = (value) => Float32Array.of(value);
  const pane = { count: 1, labels: [0], x: one(0), y: one(0), p: one(1), q1: one(0), q2: one(0), rest: one(1), spin: one(0), there: one(1), pointed: one(0), squeezed: one(0) };
  Object.assign(pane, { nu: one(kind === "auxetic" ? -1 : 1), bodies: [], handles: [], box: null, rubs: false, active: [[]] });
  const shown = view().made ? run.views.find((each) => each.made) : run.views.find((each) => each.name === "kind");
  const camera = { k: 11 * ratio, x: 12 * ratio, y: 12 * ratio };
  const scenery = new Scenery(canvas.getContext("2d"), pane, 0, camera, { theme: state.theme, view: shown, chains: false, scale: ratio });
  scenery.line = 1.5 * ratio;
  scenery.grains();
  return canvas;
}

function showTheme() {
  document.documentElement.dataset.theme = state.theme;
  setText($("theme"), word(state.theme === "dark" ? "to_light" : "to_dark"));
  $("chains").setAttribute("aria-pressed", String(state.chains));
  for (const pane of run.panes) {
    const { colour, dash } = pane.look;
    pane.nodes.swatch.style.background = dash.length
      ? `repeating-linear-gradient(to right, ${css(colour)} 0 ${dash[0]}px, transparent ${dash[0]}px ${dash[0] + dash[1]}px)`
      : css(colour);
  }
}

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
  const act = OTHERS[event.key] ?? ($("letters").checked ? LETTERS[event.key] ?? LETTERS[event.key.toLowerCase()] : undefined);
  if (!act) return;
  event.preventDefault();
  act();
}

async function begin() {
  run = Object.assign(await unpack($("recording").textContent.trim()), PAGE);
  language = Math.max(run.languages.indexOf(document.documentElement.lang), 0);
  state.theme = document.documentElement.dataset.theme;
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
  arrange();
  document.documentElement.dataset.ready = Math.round(performance.now());
  if (!still.matches && run.start.play) play(true);
}

// For tests and for who is curious: what is shown.
window.sandboxPlayer = { state, go: seek, get run() { return run; } };
begin();
