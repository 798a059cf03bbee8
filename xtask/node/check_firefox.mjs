// Opens galleries, live ones and playgrounds from file:// in Firefox and uses them: FIREFOX=… node check_firefox.mjs SHOTS_FOLDER PAGE.html …
import { mkdirSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import puppeteer from 'puppeteer-core';

const [shots, ...files] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });
// The processor draws WebGL.
const extraPrefsFirefox = { 'webgl.force-enabled': true };
const browser = await puppeteer.launch({ browser: 'firefox', executablePath: process.env.FIREFOX, headless: false, extraPrefsFirefox });
console.log(await browser.version());
const PATIENCE = 240000, wrong = [];
const demand = (truth, what) => { if (!truth) throw new Error(what); };
for (const file of files) {
  const name = basename(file, '.html'), page = await browser.newPage(), noise = [];
  page.on('console', (message) => { if (message.type() === 'error') noise.push(message.text()); });
  page.on('pageerror', (error) => noise.push(error.message));
  try {
    await page.setViewport({ width: 1400, height: 1000 });
    await page.goto(`file://${resolve(file)}`);
    await page.waitForSelector('html[data-ready]', { timeout: PATIENCE });
    const begun = Date.now();
    if (name === 'playground') await playground(page);
    else if (await page.evaluate(() => Boolean(document.getElementById('live-worker')))) await live(page);
    else await still(page);
    demand(!noise.length, `it complains: ${noise.slice(0, 3).join('; ')}`);
    await page.screenshot({ path: join(shots, `firefox-${name}.png`) });
    console.log(`ok ${name}: ready after ${await page.evaluate(() => document.documentElement.dataset.ready)} ms, used for ${Date.now() - begun} ms`);
  } catch (error) {
    wrong.push(`${file}: ${error.message}`);
    await page.screenshot({ path: join(shots, `firefox-${name}.png`) }).catch(() => {});
  }
  await page.close();
}
await browser.close();
for (const line of wrong) console.log(`WRONG ${line}`);
console.log(`${files.length} pages opened in Firefox, ${wrong.length} wrong`);
process.exit(wrong.length || !files.length ? 1 : 0);

function until(page, truth, ...values) { return page.waitForFunction(truth, { timeout: PATIENCE }, ...values); }

// It plays, tiles have pictures, and a click chooses one.
async function still(page) {
  await until(page, () => gallery.player.playing && gallery.player.time > 0.05);
  await until(page, () => document.querySelector('.tile canvas').toDataURL().length > 1000);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  demand(wide <= 0, `the page is ${wide} pixels too wide`);
  const tiles = await page.$$('.tile .pick'), last = tiles[tiles.length - 1];
  await last.evaluate((button) => button.scrollIntoView({ block: 'center' }));
  await last.click();
  await until(page, (last) => gallery.a === gallery.listed[last], tiles.length - 1);
  await page.evaluate(() => scrollTo(0, 0));
}

// It finds more; a value is typed, and then solutions of the new scenario come.
async function live(page) {
  await still(page);
  await until(page, () => gallery.live.found.length > 0);
  await until(page, () => gallery.live.ready && !document.getElementById('steer').hidden);
  await page.click('#steer > summary');
  const field = await page.waitForSelector('#wishes input[name$="/x_mm"]'), typed = String(+(await field.evaluate(({ value }) => value)) + 20);
  await field.evaluate((input, typed) => { input.value = typed; input.dispatchEvent(new Event('change', { bubbles: true })); }, typed);
  await until(page, () => gallery.live.how && !gallery.live.fresh && gallery.live.found.length > 0);
  console.log(await page.evaluate(() => gallery.live.told));
  demand(await page.evaluate((typed) => JSON.stringify(gallery.live.about.scenario).includes(`"x_mm":${typed}`), typed), 'the typed value is not sampled');
}

// What is wrong is told; what is right is sampled.
async function playground(page) {
  const right = await page.$eval('#text', ({ value }) => value), write = (text) => page.$eval('#text', (area, text) => { area.value = text; area.dispatchEvent(new Event('input', { bubbles: true })); }, text);
  await write(`${right}\nwarmap = 1`);
  await page.click('#run');
  await page.waitForSelector('#problems li', { timeout: PATIENCE });
  await write(right);
  await page.click('#run');
  await until(page, () => gallery.solutions.length > 0 && gallery.stage);
  console.log(await page.evaluate(() => gallery.live.told));
}
