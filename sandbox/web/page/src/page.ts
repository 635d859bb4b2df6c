// The page of a scene: what is shown, and what a person asks for by mouse, finger and keyboard. It draws; kernels compute.

import { limits, listen, makeSliders, showButtons, showEvents, speak } from "./choices";
import { Conductor } from "./conductor";
import { follow } from "./hand";
import { $, Pane, setText } from "./panes";
import { arrange, picture, pictures, scales, showTrouble } from "./pictures";
import * as runs from "./run";
import type { Command, Seen } from "./shared";
import { held, panes, state, the } from "./stage";

const PACE = 1000 / 60; // [ms] from one increment to the next, at least
const QUIET = 1000; // [ms] between two sentences for who hears the page

let said = 0;
let begun = 0;
let later = 0;

function sayAloud(...sentences: (() => string)[]) {
  said = performance.now();
  the.aloud = () => sentences.map((sentence) => sentence()).join(". ");
  setText($("live"), the.aloud());
}

// How things stand, as soon as what was said last has been heard.
function standing() {
  if (the.conductor.busy) return; // with something newer
  for (const pane of panes) pane.tell();
  sayAloud(...panes.map((pane) => () => pane.standing()));
}

// Increments do not wait for pictures: where a computer draws slowly, some are not seen.
function finished() {
  const wait = begun + PACE - performance.now();
  setTimeout(() => {
    begun = performance.now();
    the.conductor.turn();
  }, Math.max(wait, 0));
  scales();
  if (state.script && panes.every((pane) => pane.count("script") < 0) && the.conductor.turns > 1 && !the.conductor.asked) {
    state.script = false;
    showButtons();
  }
  const news = panes.flatMap((pane) => pane.news());
  if (news.length || panes.some((pane) => pane.went)) showEvents();
  for (const pane of panes) pane.went = false;
  clearTimeout(later);
  if (news.length) sayAloud(...news);
  else if (the.conductor.idle) later = setTimeout(standing, Math.max(said + QUIET - performance.now(), 0));
}

function taken(pane: number, commands: Command[], seen: Seen | null) {
  panes[pane].obey(commands);
  if (seen) panes[pane].take(seen);
}

async function begin() {
  run = Object.assign(PAGE, {
    ...{ panes: [], languages: LIVE.languages, labels: LIVE.labels, limit: null, views: LIVE.views },
    tops: { chains: 0.5, hand: LIVE.axes[1] },
  }) as unknown as PlayerRun;
  language = languageAsked(LIVE.start.auto, LIVE.languages, document.documentElement.lang);
  state.theme = themeAsked(LIVE.start.auto, LIVE.start.theme);
  const asked = inAddress.get("seed") ?? "";
  const place = LIVE.seeds.indexOf(Number(asked));
  state.seed = Math.max(place, 0);
  if (place < 0) state.asked = asked.slice(0, 20);
  LIVE.packings.forEach((_, index) => panes.push(new Pane(LIVE, index)));
  run.panes = panes.map((pane) => pane.shown);
  the.plot = new Plot($<HTMLCanvasElement>("plot"), () => undefined);
  the.plot.known = { low: 0, high: LIVE.axes[0], bottom: 0, top: LIVE.axes[1] };
  limits();
  makeSliders();
  speak();
  await runs.load();
  the.conductor = new Conductor(LIVE, taken, finished);
  runs.begin();
  for (const pane of panes) follow(pane, showButtons);
  listen();
  new ResizeObserver(arrange).observe($("stage"));
  arrange();
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
  picture();
}

// For tests and for who is curious.
const { hand, reset, undo, redo, blocks } = runs;
Object.assign(window, { sandboxLive: { state, held, panes, pictures, get conductor() { return the.conductor; }, hand, reset, undo, redo, blocks } });
begin().catch((error) => {
  console.error(error);
  document.documentElement.dataset.trouble = "";
  showTrouble("cannot_run");
});
