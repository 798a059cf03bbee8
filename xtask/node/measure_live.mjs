// How long live galleries take, as their users wait: node measure_live.mjs PAGE.html [FIELD VALUE …]
// Seconds from opening the page until its pictures are drawn and until its first new solution, and from giving each value to
// the field of that name (`/world/spelling/text`) until a solution that meets it is shown. Run it on an idle machine.
import { resolve } from 'node:path';
import chromium from '@sparticuz/chromium';
import { chromium as playwright } from 'playwright-core';

const [file, field, ...values] = process.argv.slice(2);
const args = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
const browser = await playwright.launch({ executablePath: process.env.PLAUS_CHROMIUM ?? (await chromium.executablePath()), headless: true, args });
const page = await (await browser.newContext({ viewport: { width: 1400, height: 1000 }, offline: true })).newPage();
const began = performance.now(), seconds = (since) => ((performance.now() - since) / 1000).toFixed(2);
await page.goto(`file://${resolve(file)}`, { waitUntil: 'commit' });
await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 240000 });
console.log(`ready, with pictures drawn: ${seconds(began)} s`);
await page.waitForFunction(() => gallery.live.found.length > 0, null, { timeout: 240000, polling: 10 });
console.log(`first new solution: ${seconds(began)} s`);
if (!field) console.log(`fields: ${(await page.locator('#wishes :is(input, select)').evaluateAll((all) => all.map((one) => `${one.name} (${one.value})`))).join(', ')}`);
if (field) await page.locator('#steer > summary').click();
for (const value of values) {
  const since = performance.now();
  const asked = await page.evaluate(({ field, value }) => {
    const input = document.querySelector(`#wishes [name="${field}"]`);
    input.value = value;
    input.dispatchEvent(new Event('change'));
    return performance.now();
  }, { field, value });
  await page.waitForFunction((asked) => gallery.live.since > asked && !gallery.live.fresh && gallery.live.found.length > 0, asked, { timeout: 240000, polling: 10 });
  console.log(`${field} = ${value}: ${seconds(since)} s (${await page.evaluate(() => gallery.live.told)})`);
}
await browser.close();
