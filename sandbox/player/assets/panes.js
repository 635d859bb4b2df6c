// Packings side by side: their canvases, and what is said above and below each.

function makePanes() {
  run.panes.forEach((pane, index) => {
    pane.look = { ...(run.packings[pane.packing] ?? run.packings.mixed), dash: pane.dash };
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
  let [best, columns, cell] = [0, 1, 100];
  for (let count = 1; count <= run.panes.length; count++) {
    const rows = Math.ceil(run.panes.length / count);
    const strips = 68 + 21 * linesOf(wide / count); // above and below the grains
    const [w, h] = [wide / count - 20, high / rows - strips - 20];
    const k = Math.min(...run.panes.map(({ bounds: [x0, y0, x1, y1] }) => Math.min(w / (x1 - x0), h / (y1 - y0))));
    if (k > best * 1.02) [best, columns] = [k, count];
  }
  for (const { bounds } of run.panes) cell = Math.max(cell, best * (bounds[3] - bounds[1]) + 20);
  stage.style.setProperty("--columns", columns);
  stage.dataset.columns = columns;
  stage.style.setProperty("--lines", linesOf(wide / columns));
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

// Lines that the longest notice takes below a packing so wide: the room is kept, so that nothing jumps.
function linesOf(width) {
  const texts = run.panes.flatMap((pane) => pane.events.map((event) => say(event.text)));
  for (const pane of run.panes) for (const some of pane.notices) texts.push(some.map((text) => say(run.texts[text])).join(" · "));
  const longest = Math.max(0, ...texts.map((text) => text.length));
  return Math.min(Math.ceil((longest * 8) / (width - 20)), 5);
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

// As many as tell hundredths of the curve's spread, but no show of rounding noise.
function digitsOf(pane) {
  if (pane.counts) return 0;
  const spread = pane.force.reduce((a, b) => Math.max(a, b)) - pane.force.reduce((a, b) => Math.min(a, b));
  return decimalsFor(Math.max(spread, 0.01)) + 2;
}

function tellPanes() {
  const levels = ["good", "working", "bad"];
  for (const pane of run.panes) {
    pane.digits ??= digitsOf(pane);
    const out = pane.out[state.moment] ? word("grains_out", { count: pane.out[state.moment] }) : "";
    setText(pane.nodes.name, say(pane.title));
    setText(pane.nodes.value, (pane.counts ? [out] : [forceOf(pane), out]).filter(Boolean).join(" · "));
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
