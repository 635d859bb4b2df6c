// The page of the hopper in Chromium: node tests/web/try_page.mjs PAGE.html FOLDER [PICTURE.png]
//
// FOLDER has node_modules with playwright-core. Prints what it found as JSON: the blocks of memory as they are, and what was seen on the way.

import { createHash } from "node:crypto";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [file, folder, picture] = process.argv.slice(2);
const { chromium } = createRequire(join(resolve(folder), "package.json"))("playwright-core");
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const faults = [];
const STEPS = 60;
page.on("console", (message) => faults.push(message.text()));
page.on("pageerror", (error) => faults.push(String(error)));
page.on("request", (request) => {
  if (!/^(file|data|blob):/.test(request.url())) faults.push(`asks for ${request.url()}`);
});
await page.goto(pathToFileURL(file).href);
await page.waitForSelector("html[data-ready]");
const ready = await page.evaluate(() => Number(document.documentElement.dataset.ready));

// Everything has come to rest.
const settled = () => page.waitForFunction(() => {
  const { conductor, panes } = window.sandboxLive;
  return !conductor.busy && conductor.idle && panes.every((pane) => pane.seen);
}, undefined, { timeout: 120000 });
const written = (ints, floats) => ({ ints: Array.from(new BigInt64Array(ints), String), floats: Array.from(new BigUint64Array(floats), String) });
const laid = await page.evaluate(`window.sandboxLive.blocks().map(([ints, floats]) => (${written})(ints, floats))`);
const hashes = async () => {
  const found = [];
  for (let pane = 0; pane < 3; pane++) {
    const dump = await page.evaluate(async (at) => {
      const { ints, floats, memory } = await window.sandboxLive.conductor.dump(at);
      return { memory, ints: Array.from(new BigInt64Array(ints), String), floats: Array.from(new BigUint64Array(floats), String) };
    }, pane);
    found.push({ memory: dump.memory, ints: dump.ints, floats: dump.floats });
  }
  return found;
};
const stand = () => page.evaluate(() => window.sandboxLive.panes.map((pane) => ({
  ...{ stroke: pane.row("stroke"), force: pane.row("resisting"), out: pane.count("out"), rows: pane.count("rows") },
  ...{ locked: pane.locked, residual: pane.row("residual") },
})));

await settled();
const first = await hashes();
// Drag the first handle down, and keep it down.
const [x, y, k, height] = await page.evaluate(() => {
  const pane = window.sandboxLive.panes[0];
  const box = pane.canvas.getBoundingClientRect();
  const ratio = pane.canvas.width / box.width;
  const [hx, hy] = pane.shown.handles[0].at;
  return [box.left + (pane.camera.x + pane.camera.k * hx) / ratio, box.top + (pane.camera.y - pane.camera.k * hy) / ratio, pane.camera.k / ratio, box.height];
});
await page.mouse.move(x, y);
await page.mouse.down();
await page.mouse.move(x, Math.min(y + 10 * k, y + height / 2), { steps: 8 });
const rate = await page.evaluate(async () => {
  const { conductor, pictures, panes } = window.sandboxLive;
  const [count, turns, spent, since] = [pictures.count, conductor.turns, conductor.spent, performance.now()];
  const rows = panes[1].count("rows");
  await new Promise((done) => setTimeout(done, 3000));
  const seconds = (performance.now() - since) / 1000;
  return {
    pictures: (pictures.count - count) / seconds,
    increments: (conductor.turns - turns) / seconds,
    kernels: (conductor.spent - spent) / Math.max(panes[1].count("rows") - rows, 1) / 3,
  };
});
await settled();
if (picture) await page.screenshot({ path: picture });
await page.mouse.up();
await settled();
const dragged = await stand();
await page.keyboard.press("r");
await page.waitForFunction(() => window.sandboxLive.panes.every((pane) => pane.count("rows") === 1));
await settled();
const again = await hashes();
// The script, so many increments far.
await page.evaluate((steps) => {
  const { conductor, hand } = window.sandboxLive;
  conductor.most = conductor.turns + steps;
  hand("scriptOn");
}, STEPS);
await page.waitForFunction((rows) => window.sandboxLive.panes.every((pane) => pane.count("rows") === rows), STEPS + 1, { timeout: 120000 });
await page.waitForFunction(() => !window.sandboxLive.conductor.busy);
const driven = await hashes();
await browser.close();
const hash = ({ ints, floats }) => createHash("sha256").update(ints.join() + floats.join()).digest("hex");
console.log(JSON.stringify({
  ...{ ready, faults, rate, dragged, memory: again.map(({ memory }) => memory) },
  first: first.map(hash),
  again: again.map(hash),
  laid,
  blocks: [again, driven].map((some) => some.map(({ ints, floats }) => ({ ints, floats }))),
}));
