// Pictures of galleries' first solutions with their trails: node world_pictures.mjs FOLDER PAGE.html …
// Each shows the moment at which something passes a place, if that is required, or the end: FOLDER/world-PAGE.png.
import { basename, join, resolve } from 'node:path';
import chromium from '@sparticuz/chromium';
import { chromium as playwright } from 'playwright-core';

const [folder, ...pages] = process.argv.slice(2);
const args = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
const executablePath = process.env.PLAUS_CHROMIUM ?? (await chromium.executablePath());
const browser = await playwright.launch({ executablePath, headless: true, args });
for (const file of pages) {
  const context = await browser.newContext({ viewport: { width: 660, height: 1000 }, offline: true });
  const page = await context.newPage();
  await page.goto(`file://${resolve(file)}`);
  await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 60000 });
  await page.locator('body').press(' ');
  await page.evaluate(() => {
    const passed = gallery.a.asked.filter(({ what }) => what.includes(' passes ')).map(({ found }) => found);
    gallery.player.seek(passed[0] ?? gallery.player.duration);
  });
  await page.addStyleTag({ content: '#stage ~ * { visibility: hidden }' });
  await page.getByText('Reset view').evaluateAll((all) => all.forEach((one) => { one.style.visibility = 'hidden'; }));
  await page.waitForTimeout(1200); // paused pictures are drawn in full detail
  await page.locator('#stage').screenshot({ path: join(folder, `world-${basename(file, '.html')}.png`) });
  await context.close();
}
await browser.close();
