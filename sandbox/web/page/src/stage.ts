// What the parts of the page share.

import type { Conductor } from "./conductor";
import type { Pane } from "./panes";

export const state = { theme: "dark", view: 0, chains: true, seed: 0, share: LIVE.share?.at ?? 0, script: false, asked: "" }; // asked: a seed that is not there
export const held = { by: null as number | "keys" | null }; // a pointer, or arrow keys
export const values = new Map(LIVE.sliders.map((slider) => [slider.name, slider.value]));
export const panes: Pane[] = [];
export const the = { dirty: true, aloud: () => "" } as { plot: Plot; conductor: Conductor; dirty: boolean; aloud: () => string }; // what is heard

export const view = () => LIVE.views[state.view];
export const look = (): PlayerLook => ({ theme: state.theme, view: view(), chains: state.chains, scale: devicePixelRatio || 1 });
