// The pages in Chromium: node tests/web/try_page.mjs PAGES FOLDER [PICTURES]
//
// PAGES has the menu and the page of every scene, FOLDER node_modules with playwright-core and axe-core. Goes from the menu to the
// hopper, drags, sets and resets there, and does in short the same on every other page. Prints what it found as JSON: blocks of memory as
// they are or their hashes, and what was seen on the way. `faults` are messages, requests, and what axe-core has to say.

import { createHash } from "node:crypto";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [pages, folder, pictures] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), "package.json"));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const STEPS = 60;
const faults = [];
let where = "menu";
const fault = (text) => faults.push(`${where}: ${text}`);
page.on("console", (message) => fault(message.text()));
page.on("pageerror", (error) => fault(String(error)));
page.on("request", (request) => {
  if (!/^(file|data|blob):/.test(request.url())) fault(`asks for ${request.url()}`);
});
page.setDefaultTimeout(600000);

const address = (name) => pathToFileURL(join(resolve(pages), name)).href;
const hash = ({ ints, floats }) => createHash("sha256").update(ints.join() + floats.join()).digest("hex");
const written = (ints, floats) => ({ ints: Array.from(new BigInt64Array(ints), String), floats: Array.from(new BigUint64Array(floats), String) });
const look = (read) => page.evaluate(`window.sandboxLive.panes.map((pane) => (${read})(pane))`);

// Everything has come to rest, or waits for the test.
const settled = () => page.waitForFunction(() => {
  const { conductor, panes } = window.sandboxLive;
  return !conductor.busy && (conductor.idle || conductor.turns >= conductor.most) && panes.every((pane) => pane.seen);
});
// So many turns and no more.
async function turns(count) {
  await page.evaluate((more) => {
    const { conductor } = window.sandboxLive;
    conductor.most = conductor.turns + (conductor.busy ? 1 : 0) + more;
  }, count);
  await settled();
}
async function dumps() {
  const found = [];
  for (let pane = 0; pane < (await look("() => 0")).length; pane++) {
    found.push(await page.evaluate(`(async (at) => {
      const { ints, floats, memory } = await window.sandboxLive.conductor.dump(at);
      return { memory, ...(${written})(ints, floats) };
    })(${pane})`));
  }
  return found;
}
const hashes = async () => (await dumps()).map(hash);
const stand = () => look(`(pane) => ({
  ...{ stroke: pane.row("stroke"), force: pane.row("resisting"), out: pane.count("out"), rows: pane.count("rows"), locked: pane.locked },
  ...{ ratios: [...new Set(pane.seen.grains.nu)], events: pane.shown.events.map(({ kind, text }) => [kind, text()]) },
})`);

// Where the first handle is, how many pixels a radius is long, and where the canvas ends.
const handle = (on = page) =>
  on.evaluate(() => {
    const pane = window.sandboxLive.panes[0];
    const { left, top, width, height } = pane.canvas.getBoundingClientRect();
    const ratio = pane.canvas.width / width;
    const [hx, hy] = pane.shown.handles[0].at;
    const at = [left + (pane.camera.x + pane.camera.k * hx) / ratio, top + (pane.camera.y - pane.camera.k * hy) / ratio];
    return [...at, pane.camera.k / ratio, { right: left + width, bottom: top + height }];
  });

// Take it by the mouse, so far to the right and up [R], and hold it there.
async function drag(right, up) {
  const [x, y, k, box] = await handle();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(Math.min(x + right * k, box.right - 1), Math.min(y - up * k, box.bottom - 1), { steps: 8 });
}

// A slider by the keyboard, so many steps.
async function set(name, steps) {
  await page.focus(`#slider-${name}`);
  for (let k = 0; k < Math.abs(steps); k++) await page.keyboard.press(steps < 0 ? "ArrowLeft" : "ArrowRight");
  await page.evaluate(() => document.activeElement.blur());
}

async function check() {
  await page.evaluate(`${axe};0`);
  const { violations } = await page.evaluate(() => window.axe.run());
  for (const { id, help, nodes } of violations) fault(`${id}: ${help}: ${nodes[0].html.slice(0, 120)}`);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  if (wide > 0) fault(`is ${wide} px wider than the screen`);
  if (pictures) await page.screenshot({ path: join(pictures, `${where}.png`) });
}

// -- from the menu to the hopper --

await page.goto(address("index.html"));
await page.waitForSelector("html[data-ready]");
await check();
await page.click('a[href*="/hopper.html"]');
where = "hopper";
await page.waitForSelector("html[data-ready]");
const ready = await page.evaluate(() => Number(document.documentElement.dataset.ready));
const laid = await page.evaluate(`LIVE.seeds.map((_, seed) => window.sandboxLive.blocks(seed).map(([ints, floats]) => (${written})(ints, floats)))`);
await settled();
const first = await hashes();
await drag(0, -10); // down, and keep it there
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
await page.mouse.up();
await settled();
const dragged = await stand();
const told = await page.$$eval("#told p", (lines) => lines.map((line) => line.textContent));
const trust = await page.$$eval("figcaption .said", (lines) => lines.map((line) => line.title));
const errors = await look('(pane) => [pane.row("usual_error"), pane.row("force_error")]');
const events = await page.$$eval("#events li", (lines) => lines.map((line) => line.textContent));
await check();
// As if an increment took long.
const slow = await page.evaluate(async () => {
  const { conductor } = window.sandboxLive;
  Object.assign(conductor, { busy: true, since: performance.now() - 1000 });
  await new Promise(requestAnimationFrame);
  await new Promise(requestAnimationFrame);
  const said = Array.from(document.querySelectorAll("figcaption"), (strip) => [strip.querySelector(".said").textContent, strip.querySelector(".lamp").className]);
  conductor.busy = false;
  return said;
});
await set("regular_poisson_ratio", -4);
await settled();
const softer = await stand();
await set("regular_poisson_ratio", 4);
await page.keyboard.press("r");
await page.waitForFunction(() => window.sandboxLive.panes.every((pane) => pane.count("rows") === 1));
await settled();
const again = await dumps();
// The script, so many increments far.
await page.evaluate((steps) => {
  const { conductor, hand } = window.sandboxLive;
  conductor.most = conductor.turns + steps;
  hand("scriptOn");
}, STEPS);
await page.waitForFunction((rows) => window.sandboxLive.panes.every((pane) => pane.count("rows") === rows), STEPS + 1);
await settled();
const driven = await dumps();
await page.evaluate(() => (window.sandboxLive.conductor.most = Infinity));

// -- every other page, in short --

const rows = () => look('(pane) => pane.count("rows")');

// While the page is paused and its script is to run, and after it has gone on.
async function holding() {
  await page.keyboard.press("Space");
  await page.evaluate(() => (window.sandboxLive.conductor.most = Infinity));
  await page.click("#script");
  await page.waitForTimeout(300);
  const still = await rows();
  await page.evaluate(() => (window.sandboxLive.conductor.most = window.sandboxLive.conductor.turns));
  await page.click("#pause");
  await turns(2);
  return [still, await rows()];
}

async function tried(name) {
  where = name;
  await page.goto(address(`${name}.html`));
  await page.waitForSelector("html[data-ready]");
  await page.waitForFunction(() => window.sandboxLive.panes.every((pane) => pane.seen));
  await turns(0);
  await page.keyboard.press("r");
  await turns(1);
  const start = await hashes();
  await page.click("#script");
  await turns(6);
  const played = await stand();
  const before = await hashes();
  await drag(2, -2);
  await turns(6);
  await page.mouse.up();
  await turns(1);
  const [pulled, far] = [await stand(), await hashes()];
  await page.keyboard.press("z");
  await turns(1);
  const back = await hashes();
  await page.keyboard.press("Shift+Z");
  await turns(1);
  const redone = await hashes();
  const paused = await holding();
  const ratio = (await page.$("#slider-poisson_ratio")) ? "poisson_ratio" : "regular_poisson_ratio";
  await set(ratio, -4);
  await turns(3);
  const softer = await stand();
  await set(ratio, 4);
  for (const key of ["h", "v", "v", "t", "l"]) await page.keyboard.press(key);
  await turns(1);
  await check();
  await page.keyboard.press("r");
  await turns(1);
  const end = await hashes();
  let shares = null;
  if (await page.$("#slider-auxetic_fraction")) {
    await set("auxetic_fraction", 1);
    await turns(2); // it is loaded, and relaxed
    shares = await look("(pane) => pane.seen.grains.nu.filter((ratio) => ratio < 0).length / pane.seen.label.length");
  }
  return { start, played, pulled, before, far, back, redone, paused, softer, end, shares };
}

const others = {};
for (const name of readdirSync(pages).filter((name) => name.endsWith(".html")).map((name) => name.slice(0, -5))) {
  if (name !== "index") others[name] = await tried(name);
}

// -- clumsy hands, and browsers that cannot --

const held = () => page.evaluate(() => window.sandboxLive.held.by !== null);

async function clumsy() {
  where = "hopper, clumsy";
  await page.goto(address("hopper.html"));
  await page.waitForSelector("html[data-ready]");
  await settled();
  const [x, y] = await handle();
  await page.mouse.move(x, y);
  await page.mouse.down({ button: "right" });
  const byOther = await held();
  await page.mouse.up({ button: "right" });
  await drag(0, -1);
  await page.evaluate(() => window.sandboxLive.panes[0].canvas.dispatchEvent(new PointerEvent("pointerup", { pointerId: 77 })));
  const keptHold = await held();
  await settled();
  // A finger at a slider while another one pulls; nobody pulls any more when that is undone.
  const [, , , box] = await handle();
  await page.mouse.move(x, box.bottom - 1);
  await page.evaluate(() => {
    const slider = document.querySelector("#slider-friction");
    slider.value = "0.4";
    for (const kind of ["input", "change"]) slider.dispatchEvent(new Event(kind));
  });
  await page.mouse.up();
  await settled();
  const turned = await page.evaluate(() => window.sandboxLive.conductor.turns);
  await page.keyboard.press("z");
  await settled();
  const after = await page.evaluate((before) => window.sandboxLive.conductor.turns - before, turned);
  // Told how things stand, though an event has just been told.
  await page.evaluate(() => {
    window.sandboxLive.panes[0].unheard.push({ text: () => "an event" });
    window.sandboxLive.reset();
  });
  await page.waitForFunction(() => document.querySelector("#live").textContent.includes("an event"));
  await settled();
  await page.waitForTimeout(1500);
  const aloud = await page.textContent("#live");
  await page.keyboard.press("l");
  const inGerman = await page.textContent("#live");
  for (let other = await page.evaluate(() => document.documentElement.lang); other !== "en"; other = await page.evaluate(() => document.documentElement.lang)) await page.keyboard.press("l");
  // Faster than increments: the curve stays that of the state.
  await page.evaluate(() => {
    for (const key of "zrz") document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  });
  await settled();
  const curves = await look('(pane) => [pane.count("rows"), pane.shown.stroke.length]');
  await page.focus("#slider-friction");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("z");
  const friction = await page.inputValue("#slider-friction");
  await page.focus("#undo");
  for (let k = 0; k < 20; k++) await page.keyboard.press("Enter");
  const focus = await page.evaluate(() => document.activeElement.id);
  const colour = () => page.$eval(".lamp", (lamp) => getComputedStyle(lamp).backgroundColor);
  const lamps = [await colour()];
  await page.emulateMedia({ forcedColors: "active" });
  lamps.push(await colour());
  await page.emulateMedia({ forcedColors: "none", media: "print" });
  const printed = await look("(pane) => pane.canvas.clientHeight");
  await page.emulateMedia({ media: "screen" });
  return { byOther, keptHold, after, aloud, inGerman, curves, friction, focus, lamps, printed };
}

async function seeds() {
  where = "hopper, seeds";
  const begun = [];
  const seed = () => page.evaluate(() => window.sandboxLive.state.seed);
  const told = [];
  const trouble = () => page.$eval("#trouble", (part) => (part.hidden ? "" : part.textContent));
  for (const search of ["", "?seed=2", "?seed=77"]) {
    await page.goto(address("hopper.html") + search);
    await page.waitForSelector("html[data-ready]");
    begun.push([await page.$eval("#seed", (list) => list.selectedOptions[0].textContent), await seed()]);
    await settled();
    told.push(await trouble());
  }
  const offered = await page.$$eval("#seed option", (options) => options.map((option) => option.textContent));
  const named = await page.evaluate(() => document.querySelector("#seed").labels[0].innerText.split("\n")[0]);
  await page.keyboard.press("Space");
  await page.selectOption("#seed", { label: "2" });
  const chosen = [await seed()];
  await page.waitForFunction(() => window.sandboxLive.panes.every((pane) => pane.seen));
  await page.click("#script");
  await page.waitForTimeout(300);
  const start = await rows();
  await page.keyboard.press("n");
  chosen.push(await seed());
  told.push(await trouble());
  return { begun, offered, named, chosen, start, told };
}

async function without() {
  const other = await browser.newPage();
  await other.addInitScript(() => delete globalThis.WebAssembly);
  await other.goto(address("hopper.html"));
  const never = await other.textContent("#trouble:not([hidden])");
  await other.close();
  const failing = await browser.newPage();
  await failing.goto(address("hopper.html"));
  await failing.waitForSelector("html[data-ready]");
  const begun = () => failing.waitForFunction(() => window.sandboxLive.panes.every((pane) => pane.count("rows")));
  await begun();
  await failing.evaluate(() => window.sandboxLive.conductor.ask(["nothing of this name"]));
  const silent = await failing.textContent("#trouble:not([hidden])");
  await failing.keyboard.press("r");
  await begun();
  await failing.waitForSelector("#trouble", { state: "hidden" });
  await failing.close();
  return { never, silent };
}

// How far the page scrolls, and the handle goes, under a finger on the handle and beside it.
async function fingers() {
  const phone = await browser.newPage({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await phone.goto(address("hopper.html"));
  await phone.waitForFunction(() => window.sandboxLive?.panes.every((pane) => pane.count("rows")));
  const session = await phone.context().newCDPSession(phone);
  const swipe = async (x, y, up) => {
    const touch = (type, ...touchPoints) => session.send("Input.dispatchTouchEvent", { type, touchPoints });
    await touch("touchStart", { x, y });
    for (let k = 1; k <= 10; k++) await touch("touchMove", { x, y: y - (up * k) / 10 });
    const found = await phone.evaluate(() => window.sandboxLive.held.by !== null);
    await touch("touchEnd");
    return found;
  };
  const [x, y, , box] = await handle(phone);
  const pulled = [await swipe(x, y, -60), await phone.evaluate(() => scrollY)];
  const scrolled = [await swipe(box.right - 9, box.bottom - 9, 200)];
  await phone.waitForFunction(() => scrollY > 0);
  await phone.close();
  return { pulled, scrolled };
}

const chances = await seeds();
const hands = { ...(await clumsy()), ...(await without()), ...(await fingers()) };
await browser.close();
console.log(JSON.stringify({
  ...{ ready, faults, rate, dragged, told, trust, errors, events, slow, softer, memory: again.map(({ memory }) => memory), others, hands },
  ...{ first, again: again.map(hash), laid, seeds: chances },
  blocks: [again, driven].map((some) => some.map(({ ints, floats }) => ({ ints, floats }))),
}));
