// Every state of a gallery, a live page and a playground, at several sizes: pictures to look at, and what keeps people out:
// [PLAUS_ALL_LOOKS=1] node check_looks.mjs SHOTS_FOLDER GALLERY.html LIVE.html PLAYGROUND.html
import { mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import chromium from '@sparticuz/chromium';
import axe from 'axe-core';
import { chromium as playwright } from 'playwright-core';

const [shots, gallery, live, playground] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });
const args = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
const browser = await playwright.launch({ executablePath: process.env.PLAUS_CHROMIUM ?? (await chromium.executablePath()), headless: true, args });
const looks = [[390, 844, 'dark'], [1400, 900, 'light']];
if (process.env.PLAUS_ALL_LOOKS) looks.push([390, 844, 'light'], [1400, 900, 'dark'], [2560, 1300, 'light'], [2560, 1300, 'dark']);
const PATIENCE = 240000, wrong = [];
let seen = 0;

// A state's name, its page, what the address adds, how a browser differs, and how it is reached.
const states = [
  ['grid', gallery, '', {}, async () => {}],
  ['chosen', gallery, '', {}, async (page) => { await page.locator('.tile .pick').nth(2).click(); }],
  ['compare', gallery, '', {}, async (page) => { await page.locator('.tile .pick').nth(1).click({ modifiers: ['Shift'] }); }],
  ['keys', gallery, '', {}, async (page) => { if (await page.locator('#help-open').isVisible()) await page.locator('#help-open').click(); else await page.keyboard.press('?'); }],
  ['none-passes', gallery, '', {}, async (page) => { await page.locator('#only-starred').click(); }],
  ['alone', gallery, '?solution=', {}, async () => {}],
  ['calm', gallery, '', { reducedMotion: 'reduce' }, async (page) => { if (await page.evaluate(() => window.gallery.player.playing)) throw new Error('it plays although less motion was asked for'); }],
  ['steering', live, '', {}, async (page) => { await page.waitForFunction(() => !document.getElementById('steer').hidden, null, { timeout: PATIENCE }); await page.locator('#steer > summary').click(); }],
  ['found-more', live, '', {}, async (page) => { await page.waitForFunction(() => window.gallery.live.found.length > 2, null, { timeout: PATIENCE }); await page.locator('.tile .pick').last().click(); await page.evaluate(() => scrollTo(0, 0)); }],
  ['no-wasm', live, '', { without: true }, async () => {}],
  ['playground', playground, '', {}, async () => {}],
  ['playground-error', playground, '', {}, async (page) => { await page.locator('#text').fill('[world.dice]\ncount = -1\ncolour = 3'); await page.locator('#run').click(); await page.locator('#problems li').first().waitFor({ timeout: PATIENCE }); }],
  ['playground-solutions', playground, '', {}, async (page) => { await page.locator('#run').click(); await page.waitForFunction(() => window.gallery.solutions.length > 3 && window.gallery.stage, null, { timeout: PATIENCE }); }],
];
for (const [width, height, colorScheme] of looks) {
  for (const [name, file, more, { without, ...differs }, reach] of states) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme, offline: true, ...differs }), page = await context.newPage();
    try {
      if (without) await page.addInitScript(() => { delete window.WebAssembly; });
      const address = `file://${resolve(file)}`;
      await page.goto(address);
      await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: PATIENCE });
      if (more) {
        await page.goto(`${address}${more}${await page.evaluate(() => encodeURIComponent(window.gallery.solutions[0].id))}`);
        await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: PATIENCE });
      }
      await reach(page);
      await page.waitForTimeout(1200);
      await page.screenshot({ path: join(shots, `look-${name}-${width}-${colorScheme}.png`), fullPage: name !== 'keys' });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      if (wide > 0) throw new Error(`it is ${wide} pixels too wide`);
      await page.evaluate(axe.source);
      const barriers = await page.evaluate(async () => (await window.axe.run()).violations.filter(({ impact }) => ['serious', 'critical'].includes(impact)));
      if (barriers.length) throw new Error(barriers.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, failureSummary }) => `${target} (${failureSummary})`).slice(0, 3)}`).join('; '));
      seen += 1;
    } catch (error) {
      wrong.push(`${name} at ${width}, ${colorScheme}: ${error.message}`);
    }
    await context.close();
  }
}
await browser.close();
for (const line of wrong) console.log(`WRONG ${line}`);
console.log(`${seen} states seen, ${wrong.length} wrong`);
process.exit(wrong.length ? 1 : 0);
