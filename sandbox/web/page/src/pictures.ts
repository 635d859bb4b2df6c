// Pictures: how canvases are laid out, scales that all packings share, and what is drawn when.

import { $, setText } from "./panes";
import { look, panes, state, the, view } from "./stage";

export const pictures = { count: 0, since: performance.now() };
const SHRINKS = 0.2; // of a scale that is much too large
const LAG = 500; // [ms] after which an increment keeps a person waiting

let scale = 1; // [pixels of the screen per px]
export function arrange() {
  const stage = $("stage");
  const scrolls = getComputedStyle(stage).flexGrow === "0";
  const [wide, high] = [stage.clientWidth, scrolls ? Math.max(innerHeight * 0.62, 240) : stage.clientHeight];
  const sizes = panes.map(({ shown: { bounds: [x0, y0, x1, y1] } }) => [x1 - x0, y1 - y0]);
  const tallest = Math.max(...sizes.map(([, height]) => height));
  let [best, columns] = [0, 1];
  for (let count = 1; count <= panes.length; count++) {
    const rows = Math.ceil(panes.length / count);
    const k = Math.min(...sizes.map(([w, h]) => Math.min((wide / count - 20) / w, (high / rows - 80) / h)));
    if (k > best * 1.02) [best, columns] = [k, count];
  }
  stage.style.setProperty("--columns", String(columns));
  stage.dataset.columns = String(columns);
  stage.style.setProperty("--cell", scrolls ? `${Math.round(Math.max(best * tallest + 20, 100))}px` : "auto");
  scale = devicePixelRatio;
  const ratio = scale || 1;
  for (const canvas of [...panes.map((pane) => pane.canvas), $<HTMLCanvasElement>("plot")]) {
    const { clientWidth, clientHeight } = canvas.parentElement!;
    canvas.width = Math.max(Math.round(clientWidth * ratio), 1);
    canvas.height = Math.max(Math.round(clientHeight * ratio), 1);
  }
  for (const pane of panes) pane.measure();
  const fitted = panes.map(({ canvas, shown }) => cameraFor(shown.bounds, canvas.width, canvas.height, 10 * ratio));
  const k = Math.min(...fitted.map((camera) => camera.k)); // one scale for all
  for (const { canvas, shown, camera } of panes) Object.assign(camera, cameraFor(shown.bounds, canvas.width, canvas.height, 0, k));
  the.dirty = true;
}

// One scale for all packings; it only grows.
export function scales() {
  const most = (some: ArrayLike<number>, least: number) => Array.from(some).reduce((a, b) => Math.max(a, b), least);
  const { plot } = the;
  const axes = plot.known;
  for (const pane of panes) {
    const [stroke, force] = [pane.row("stroke"), pane.row("resisting")];
    const wider = [Math.min(axes.low, -roundUp(-stroke)), Math.max(axes.high, roundUp(stroke, FINER))];
    const higher = [Math.min(axes.bottom, -roundUp(-force)), Math.max(axes.top, roundUp(force, FINER))];
    const [low, high] = [stroke < axes.low ? wider[0] : axes.low, stroke > axes.high ? wider[1] : axes.high];
    const [bottom, top] = [force < axes.bottom ? higher[0] : axes.bottom, force > axes.top ? higher[1] : axes.top];
    const chains = Math.max(run.tops.chains, roundUp(most(pane.shown.bearing, 0), FINER));
    if (chains !== run.tops.chains) the.dirty = true;
    run.tops.chains = chains;
    if (low !== axes.low || high !== axes.high || bottom !== axes.bottom || top !== axes.top) plot.key = "";
    Object.assign(axes, { low, high, bottom, top });
  }
  for (const pane of panes) run.tops.hand = Math.max(run.tops.hand, roundUp(most([pane.row("hand_x"), pane.row("hand_y")].map(Math.abs), 0), FINER));
}

// The scale of the colours.
function scaleView() {
  const shown = view();
  if (!shown.valued) return;
  const wanted = topOf(shown, panes.map((pane) => pane.shown));
  if (shown.top && wanted <= shown.top && wanted >= SHRINKS * shown.top) return;
  shown.top = wanted;
  the.dirty = true;
}

let legend = "";
function showLegend() {
  const kinds = panes.map(({ shown: { nu } }) => `${nu.some((ratio) => ratio < 0)} ${nu.some((ratio) => ratio > 0)}`);
  const key = [state.theme, language, state.view, state.chains, run.tops.chains, view().top, ...kinds].join();
  if (key === legend) return;
  legend = key;
  $("legend").replaceChildren(...legendOf(run.panes, view(), state.theme, state.chains));
}

// Why nothing moves.
export function showTrouble(name: string) {
  const part = $("trouble");
  part.hidden = !name;
  setText(part, name && word(name, { reset: word("reset"), asked: state.asked, seed: LIVE.seeds[state.seed] }));
}

export function picture() {
  requestAnimationFrame(picture);
  pictures.count++;
  the.conductor.turn();
  showTrouble(the.conductor.silent ? "silent" : state.asked && "unknown_seed");
  if (scale !== devicePixelRatio) arrange(); // on another screen
  const lags = the.conductor.waited > LAG;
  for (const pane of panes) pane.lag(lags);
  if (!the.dirty && panes.every((pane) => !pane.fresh)) return;
  scaleView();
  for (const pane of panes) if (the.dirty || pane.fresh) pane.draw(look()); // one that is locked stands still
  the.plot.draw(0, look());
  showLegend();
  the.dirty = false;
}
