// Opens the site from file:// in headless Chromium, offline, and uses it: node check_site.mjs SHOTS_FOLDER SITE_FOLDER
import { mkdirSync, readdirSync, existsSync } from 'node:fs';
import { join, relative, resolve } from 'node:path';
import chromium from '@sparticuz/chromium';
import axe from 'axe-core';
import { chromium as playwright } from 'playwright-core';

const [shots, folder] = process.argv.slice(2), site = resolve(folder);
mkdirSync(shots, { recursive: true });
const args = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
const executablePath = process.env.PLAUS_CHROMIUM ?? (await chromium.executablePath());
const browser = await playwright.launch({ executablePath, headless: true, args });
const wrong = [];
const demand = (truth, what) => { if (!truth) throw new Error(what); };
// One of each kind of page: front, tried, a guide, a list of documents, long tables, code, and interfaces where they are.
const pages = ['index.html', 'try/index.html', 'docs/getting-started.html', 'docs/index.html', 'docs/reference/keys.html', 'scenarios/dice-one.toml.html', 'playground.html', 'api/index.html'];
const looks = [{ width: 390, height: 844, colorScheme: 'dark' }, { width: 1400, height: 900, colorScheme: 'light' }];
if (process.env.PLAUS_ALL_LOOKS) looks.push({ width: 390, height: 844, colorScheme: 'light' }, { width: 1400, height: 900, colorScheme: 'dark' }, { width: 2560, height: 1300, colorScheme: 'light' }, { width: 2560, height: 1300, colorScheme: 'dark' });

async function opened({ colorScheme, ...viewport }, at, more = {}) {
  const context = await browser.newContext({ viewport, colorScheme, offline: true, ...more });
  const page = await context.newPage(), noise = [];
  page.on('console', (message) => { if (message.type() === 'error') noise.push(message.text()); });
  page.on('pageerror', (error) => noise.push(error.message));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) noise.push(`asks for ${request.url()}`); });
  await page.goto(`file://${join(site, at)}`);
  return { context, page, noise };
}

for (const look of looks) {
  for (const at of pages.filter((at) => existsSync(join(site, at)))) {
    const { context, page, noise } = await opened(look, at);
    try {
      await page.screenshot({ path: join(shots, `site-${at.replace(/\W/g, '-')}-${look.width}-${look.colorScheme}.png`) });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      demand(wide <= 0, `the page is ${wide} pixels too wide`);
      demand(await page.evaluate(() => document.documentElement.dataset.theme) === look.colorScheme, 'it is not as dark or light as asked for');
      demand(await page.evaluate(() => [...document.images].every((image) => image.loading === 'lazy' || image.complete && image.naturalWidth)), 'a picture is missing');
      await page.evaluate(axe.source);
      const barriers = await page.evaluate(async () => (await axe.run({ preload: false })).violations.filter(({ impact }) => ['serious', 'critical'].includes(impact)));
      demand(!barriers.length, barriers.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, failureSummary }) => `${target} (${failureSummary})`).slice(0, 3)}`).join('; '));
      demand(!noise.length, `it complains: ${noise.join('; ')}`);
    } catch (error) {
      wrong.push(`${at} at ${look.width}, ${look.colorScheme}: ${error.message}`);
    }
    await context.close();
  }
}

for (const visit of [first, searched, still, sampling]) {
  try {
    await visit();
  } catch (error) {
    wrong.push(`${visit.name}: ${error.message}`);
  }
}
await browser.close();
for (const line of wrong) console.log(`WRONG ${line}`);
console.log(`${pages.length} pages of the site opened, ${wrong.length} wrong`);
process.exit(wrong.length ? 1 : 0);

// The loop comes before any word, and moves.
async function first() {
  const { context, page } = await opened(looks[1], 'index.html');
  await page.waitForFunction(() => document.querySelector('#loop img').complete);
  const [painted, shown] = await page.evaluate(() => [performance.getEntriesByName('first-contentful-paint')[0]?.startTime, performance.getEntriesByType('navigation')[0].loadEventEnd]);
  const words = await page.evaluate(() => { const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT); const seen = []; while (walker.nextNode()) { const { parentElement: at, textContent } = walker.currentNode; if (textContent.trim() && !at.closest('.skip, #loop')) seen.push(at.getBoundingClientRect().top); } return Math.min(...seen) >= document.querySelector('#loop img').getBoundingClientRect().bottom - 1; });
  demand(words, 'words stand before the loop');
  const one = await page.locator('#loop').screenshot();
  await page.waitForTimeout(1200);
  demand(!one.equals(await page.locator('#loop').screenshot()), 'the loop stands still');
  await page.locator('#pause').click();
  await page.waitForTimeout(300);
  const paused = await page.locator('#loop img').screenshot();
  await page.waitForTimeout(1200);
  demand(paused.equals(await page.locator('#loop img').screenshot()), 'the loop cannot be paused');
  console.log(`first paint after ${Math.round(painted)} ms, all of it, with the loop, after ${Math.round(shown)} ms`);
  await context.close();
}

// By keyboard alone: a word leads to a section.
async function searched() {
  const { context, page, noise } = await opened(looks[1], 'docs/getting-started.html');
  await page.keyboard.press('/');
  await page.keyboard.type('faces_up');
  await page.waitForSelector('#found a');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await page.waitForURL((url) => !url.pathname.endsWith('getting-started.html'));
  demand((await page.locator('article').textContent()).includes('faces_up'), 'the search leads elsewhere');
  demand(!noise.length, `it complains: ${noise.join('; ')}`);
  await context.close();
}

// Who asks for less motion gets a picture that stands still.
async function still() {
  const { context, page } = await opened(looks[1], 'index.html', { reducedMotion: 'reduce' });
  demand((await page.evaluate(() => document.querySelector('#loop img').currentSrc)).endsWith('strikes.png'), 'it moves nevertheless');
  await context.close();
}

// Every page to try finds something new.
async function sampling() {
  for (const name of readdirSync(join(site, 'try')).filter((name) => name.endsWith('.html') && name !== 'index.html')) {
    const begun = Date.now(), { context, page, noise } = await opened(looks[1], `try/${name}`);
    await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 240000 });
    const ready = Date.now() - begun;
    await page.waitForFunction(() => gallery.live.found.length, null, { timeout: 240000, polling: 50 }).catch(() => demand(false, `${name} finds nothing`));
    console.log(`${relative(site, join(site, 'try', name))}: ready after ${ready} ms, first new solution after ${Date.now() - begun} ms`);
    demand(!noise.length, `${name} complains: ${noise.join('; ')}`);
    await context.close();
  }
}
