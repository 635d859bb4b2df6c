// Looks at every page of a folder in Chromium: npm install --no-save playwright-core axe-core && node .ci/check_pages.mjs FOLDER [PICTURES]
//
// No message on the console, no request beyond the folder, no violation found by axe-core, nothing wider than the screen; at the
// size of a desk, a tablet and a phone, in both themes and in two languages. Says how soon a player is ready and how many pictures a second it
// draws, which depends on the machine and fails nothing. Pictures of all pages are left in PICTURES. CHROMIUM names the browser.

import { existsSync, mkdirSync, readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const require = createRequire(join(process.cwd(), "package.json"));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const SIZES = { desk: [1280, 800], tablet: [820, 1180], phone: [390, 844] };
const LOOKS = [["en", "dark"], ["de", "light"]];
const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const [folder, pictures] = process.argv.slice(2).map((path) => resolve(path));
if (pictures) mkdirSync(pictures, { recursive: true });
const executablePath = process.env.CHROMIUM ?? BROWSERS.find(existsSync);
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const faults = [];

async function look(name, size, language, theme) {
  const [width, height] = SIZES[size];
  const page = await browser.newPage({ viewport: { width, height }, reducedMotion: "reduce" });
  const where = `${name} ${size} ${language} ${theme}`;
  const fault = (text) => faults.push(`${where}: ${text}`);
  page.on("console", (message) => fault(message.text()));
  page.on("pageerror", (error) => fault(String(error)));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) fault(`asks for ${request.url()}`);
  });
  await page.goto(`${pathToFileURL(join(folder, name))}?language=${language}&theme=${theme}`);
  await page.waitForSelector("html[data-ready]", { timeout: 30000 });
  const player = await page.evaluate(() => {
    const shown = window.sandboxPlayer;
    if (!shown) return false;
    shown.go(Math.round(shown.run.increments.length * 0.6));
    document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "i", bubbles: true }));
    return true;
  });
  if (await page.evaluate(() => "sandboxLive" in window)) await run(page);
  if ((await page.evaluate(() => document.documentElement.lang)) !== language) fault("is in another language");
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  if (wide > 0) fault(`is ${wide} px wider than the screen`);
  await page.waitForTimeout(300);
  if (pictures) await page.screenshot({ path: join(pictures, `${name}-${size}-${theme}.png`), fullPage: size !== "desk" });
  await page.evaluate(`${axe};0`);
  const { violations } = await page.evaluate(() => window.axe.run());
  for (const { id, help, nodes } of violations) fault(`${id}: ${help}: ${nodes[0].html.slice(0, 120)}`);
  if (player && size === "desk" && theme === "dark") console.log(`${name}: ${await speed(page)}`);
  await page.close();
}

// A page on which a scene runs: its script for a moment, with the colours of the pressure.
async function run(page) {
  await page.click("#script");
  for (const key of ["v", "v"]) await page.keyboard.press(key);
  await page.waitForFunction(() => window.sandboxLive.panes.every((pane) => pane.count("rows") > 8), undefined, { timeout: 60000 });
}

async function speed(page) {
  const [ready, rate] = await page.evaluate(async () => {
    const { go, run } = window.sandboxPlayer;
    const begun = performance.now();
    for (let picture = 0; picture < 60; picture++) {
      await new Promise(requestAnimationFrame);
      go((picture * 7) % run.increments.length);
    }
    return [document.documentElement.dataset.ready, 60000 / (performance.now() - begun)];
  });
  return `ready after ${ready} ms, ${rate.toFixed(0)} pictures a second`;
}

const names = readdirSync(folder).filter((name) => name.endsWith(".html"));
for (const name of names) {
  for (const size of Object.keys(SIZES)) for (const [language, theme] of LOOKS) await look(name, size, language, theme);
}
await browser.close();
for (const text of faults) console.error(text);
console.log(`${names.length} pages, ${faults.length} faults`);
process.exit(faults.length || !names.length ? 1 : 0);
