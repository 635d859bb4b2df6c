// Whether to believe what is shown: a lamp, and a few words. As sandbox/draw/lamp.py.

import type { Pane } from "./panes";

const STEPS = [1, 2, 5, 10];
const ONE_DIGIT = [1, 2, 3, 5, 7, 10];
const LEAST = 1e-6; // that is told

export interface Lamp {
  level: number; // 0: green, 1: on the way, 2: do not believe it
  words: string;
  short: string;
}

export function lamp(pane: Pane): Lamp {
  const { text, level } = LIVE.reasons[pane.count("reason")];
  if (level > 1) return { level, words: say(text), short: say(text) };
  const [residual, usual, most] = [pane.row("residual"), pane.row("usual_error"), pane.row("force_error")];
  const estimated = most >= 0 && most <= 1; // false where nobody knows
  let [error, within] = ["", ""];
  if (!Number.isFinite(residual)) error = word("no_forces");
  else if (residual > 1) error = word("unknown_forces");
  else {
    const bound = estimated ? percent(most, ONE_DIGIT) : percent(residual, STEPS);
    const often = percent(usual, ONE_DIGIT);
    within = word("within", { error: bound });
    if (!estimated) error = word("force_error", { error: bound });
    else error = word(often === bound ? "handle_force_within" : "handle_force_error", { usual: often, error: bound });
  }
  const doubt = level ? residual > 10 * LIVE.tolerance : estimated && most > LIVE.rough;
  const said = (more: string) => [say(text), more].filter(Boolean).join(" · ");
  return { level: level + (doubt ? 1 : 0), words: said(error), short: said(within) };
}

// An upper bound in words.
function percent(share: number, steps: number[]): string {
  const bound = 100 * roundUp(Math.max(share, LEAST), steps);
  return `${number(bound, decimalsFor(bound))} %`;
}
