// Opens live galleries from file:// in headless Chromium, offline, and waits for what they find: PLAUS=… node check_live.mjs SHOTS_FOLDER PAGE.html …
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import { deflateRawSync } from 'node:zlib';
import chromium from '@sparticuz/chromium';
import axe from 'axe-core';
import { chromium as playwright } from 'playwright-core';

const [shots, ...pages] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });
const args = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
const executablePath = process.env.PLAUS_CHROMIUM ?? (await chromium.executablePath());
const browser = await playwright.launch({ executablePath, headless: true, args });
// How long it may take until solutions come: the machine may be slow, and the picture is drawn by its processor.
const PATIENCE = 240000;
const wrong = [];
for (const page of pages) {
  for (const visit of page.endsWith('playground.html') ? [playground, bounds, playgroundByPhone] : [live, steer, safety, phone, without]) {
    try {
      await visit(resolve(page), basename(page, '.html'));
    } catch (error) {
      wrong.push(`${page}, ${visit.name}: ${error.message}`);
    }
  }
}
await browser.close();
for (const line of wrong) console.log(`WRONG ${line}`);
console.log(`${pages.length} live galleries opened, ${wrong.length} wrong`);
process.exit(wrong.length || !pages.length ? 1 : 0);

function demand(truth, what) { if (!truth) throw new Error(what); }

async function opened(file, look, prepare = null, colorScheme = 'light') {
  const context = await browser.newContext({ viewport: look, colorScheme, offline: true, acceptDownloads: true });
  const page = await context.newPage(), noise = [];
  page.on('console', (message) => { if (message.type() === 'error') noise.push(message.text()); });
  page.on('pageerror', (error) => noise.push(error.message));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) noise.push(`asks for ${request.url()}`); });
  if (prepare) await page.addInitScript(prepare);
  await page.goto(`file://${file}`);
  await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: PATIENCE });
  return { context, page, noise };
}

async function live(file, name) {
  const { context, page, noise } = await opened(file, { width: 1400, height: 1000 });
  const begun = await page.evaluate(() => gallery.meta.samples.length - gallery.live.found.length);
  await page.waitForFunction(() => gallery.live.found.length >= 2, null, { timeout: PATIENCE });
  await page.locator('#live-toggle').click();
  demand((await page.locator('#live-state').textContent()).startsWith('Paused'), 'it does not pause');
  await page.waitForTimeout(1500);
  const [found, tiles, dots, iterations] = await page.evaluate(() => [gallery.live.found.length, document.querySelectorAll('.tile').length, gallery.map.layout().flat(), gallery.live.iterations]);
  demand(tiles === begun + found, `${begun} solutions and ${found} new ones have ${tiles} tiles`);
  demand(dots.length === 2 * tiles && dots.every(Number.isFinite), 'the map has no dot for each solution');
  demand(iterations > 0, 'it counts no iterations');
  await page.waitForTimeout(2000);
  demand(await page.evaluate(() => gallery.live.iterations) === iterations, 'workers go on while it is paused');

  // Its GLB is the file of `plaus export`, to the byte.
  const [command, { length }] = [await page.locator('#command').textContent(), await exported(page)];
  demand(length > 1000, 'the GLB is empty');
  if (process.env.PLAUS) {
    const written = join(shots, `${name}-live.glb`), words = command.split(' ').slice(3, -1);
    execFileSync(process.env.PLAUS, ['export', file.replace(/\.html$/, '.run'), ...words, written, '--force'], { stdio: ['ignore', 'ignore', 'inherit'] });
    demand(readFileSync(written).equals(await exported(page)), 'the GLB of the page is not that of the command that it shows');
  }

  // A new one plays, and its tile has a picture.
  const tile = page.locator('.tile').nth(tiles - 1), id = await tile.getAttribute('data-id');
  await tile.scrollIntoViewIfNeeded();
  await page.waitForFunction((k) => document.querySelectorAll('.tile canvas')[k].toDataURL().length > 1000, tiles - 1, { timeout: 60000 });
  await tile.locator('.pick').click();
  demand(await page.evaluate(() => gallery.a.live && gallery.a.open().count > 0), 'the new solution is not chosen');
  demand((await page.locator('#command').textContent()).includes(`--sample ${id}`), 'no command rebuilds it');
  const called = await page.evaluate(() => gallery.a.name);
  await page.locator('#live').scrollIntoViewIfNeeded();
  await page.evaluate(() => scrollTo(0, 0));
  await page.waitForTimeout(1000);
  await page.screenshot({ path: join(shots, `live-${name}.png`), fullPage: true });

  // What was found is saved, and the command rebuilds it bit for bit.
  const downloading = page.waitForEvent('download');
  await page.locator('#live-save').click();
  const saved = join(shots, `${name}-live.json`);
  await (await downloading).saveAs(saved);
  if (process.env.PLAUS) {
    execFileSync(process.env.PLAUS, ['replay', saved, '--sample', id], { stdio: ['ignore', 'ignore', 'inherit'], maxBuffer: 1 << 28 });
    demand(fails(saved, '999999:1'), 'a sample that is not in the file is rebuilt');
  }

  // Workers go on from a chosen solution, with chains of their own; one that stops is replaced, and that is told.
  const before = await page.evaluate(() => gallery.live.next);
  await page.locator('#like').click();
  await page.waitForFunction((before) => gallery.live.near && gallery.live.next > before && gallery.live.going, before, { timeout: PATIENCE });
  demand((await page.locator('#live-state').textContent()).includes(`from ${called} on`), 'it does not say where workers go on from');
  const went = await page.evaluate(() => gallery.live.iterations);
  await page.waitForFunction((went) => gallery.live.iterations > went, went, { timeout: PATIENCE });
  await page.evaluate(() => { const [worker] = gallery.live.samplers.keys(); worker.postMessage({ near: '"no draw"', chain: 1000 }); });
  await page.waitForFunction(() => /stopped .* was replaced/.test(document.getElementById('live-state').textContent), null, { timeout: PATIENCE });
  const last = await page.evaluate(() => gallery.live.next);
  await page.locator('#unlike').click();
  await page.waitForFunction((last) => gallery.live.next > last, last, { timeout: PATIENCE });
  demand((await page.locator('#live-state').textContent()).includes(`least like ${called} on`), 'it does not say that workers look elsewhere');
  await page.locator('#live-back').click();
  demand(await page.evaluate(() => !gallery.live.near), 'it does not go back to the chains of the run');
  demand(await page.evaluate(() => window.hacked === undefined && !document.querySelector('img')), 'a name ran as code');
  demand(!noise.length, `it complains: ${noise.join('; ')}`);
  await context.close();
}

// The GLB of the chosen solution, as bytes.
async function exported(page) {
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: PATIENCE }), page.locator('#download').click()]);
  return readFileSync(await download.path());
}

// What must happen is typed and dragged: old sampling goes on until the new is right, and what is then found meets it.
async function steer(file, name) {
  const { context, page, noise } = await opened(file, { width: 1400, height: 1000 });
  await page.waitForFunction(() => gallery.live.ready && !document.getElementById('steer').hidden, null, { timeout: PATIENCE });
  await page.locator('#steer > summary').click();
  const field = page.locator('#wishes input[name$="/x_mm"]').first(), before = await field.inputValue();
  await field.fill('1e9');
  await field.press('Enter');
  const problem = page.locator('#wishes .problem', { hasText: 'out of range' });
  await problem.waitFor({ timeout: PATIENCE });
  demand((await field.getAttribute('aria-invalid')) === 'true' && (await field.getAttribute('aria-describedby')) === await problem.getAttribute('id'), 'the problem is not beside its field');
  const went = await page.evaluate(() => gallery.live.iterations);
  await page.waitForFunction((went) => gallery.live.iterations > went, went, { timeout: PATIENCE });

  const typed = String(+before + 20);
  await field.fill(typed);
  await field.press('Enter');
  const found = () => page.waitForFunction(() => gallery.live.how && !gallery.live.fresh && gallery.live.found.length > 0, null, { timeout: PATIENCE });
  await found();
  demand((await page.locator('#live-state').textContent()).includes('what must happen now'), 'it does not say what is sampled');
  demand(await page.evaluate(() => document.querySelectorAll('.tile').length === gallery.live.found.length && gallery.a.open().count > 0), 'solutions of before are left');
  console.log(`${name}: ${await page.evaluate(() => gallery.live.told)} (typed)`);

  // What is saved now is of the changed scenario.
  const id = await page.evaluate(() => gallery.solutions[0].id), downloading = page.waitForEvent('download');
  await page.locator('#live-save').click();
  const saved = join(shots, `${name}-changed.json`);
  await (await downloading).saveAs(saved);
  demand(readFileSync(saved, 'utf8').includes(`"x_mm":${typed}`), 'the changed scenario is not saved');
  if (process.env.PLAUS) execFileSync(process.env.PLAUS, ['replay', saved, '--sample', id], { stdio: ['ignore', 'ignore', 'inherit'], maxBuffer: 1 << 28 });

  await page.evaluate(() => scrollTo(0, 0));
  const handle = await page.locator('.handle').first().boundingBox(), at = [handle.x + handle.width / 2, handle.y + handle.height / 2];
  await page.mouse.move(...at);
  await page.mouse.down();
  await page.mouse.move(at[0] + 25, at[1], { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction((typed) => gallery.live.about && document.querySelector('#wishes input[name$="/x_mm"]').value !== typed, typed, { timeout: PATIENCE });
  await page.waitForFunction((typed) => !JSON.stringify(gallery.live.about?.scenario ?? typed).includes(`"x_mm":${typed}`), typed, { timeout: PATIENCE });
  await found();
  console.log(`${name}: ${await page.evaluate(() => gallery.live.told)} (dragged)`);
  await page.screenshot({ path: join(shots, `steer-${name}.png`), fullPage: true });
  demand(!noise.length, `it complains: ${noise.join('; ')}`);
  await context.close();
}

// A scenario is written: what is wrong has line and column, a link carries it, and its solutions come.
async function playground(file) {
  const { context, page, noise } = await opened(file, { width: 1400, height: 900 });
  const text = page.locator('#text'), right = await text.inputValue();
  demand(await page.evaluate(() => gallery.live.samplers.size === 0), 'it samples before it is told to');
  await text.fill(right.replace(/^warmup = .*$/m, 'warmup = 7\nwarmap = -1'));
  await page.locator('#run').click();
  await page.locator('#problems li').first().waitFor({ timeout: PATIENCE });
  const told = await page.locator('#problems').textContent(), line = right.split('\n').findIndex((one) => one.startsWith('warmup = ')) + 2;
  demand(told.includes(`${line}:1`) && told.includes('did you mean'), `what is wrong is not told: ${told}`);

  await text.fill(`${right}\n[sampler.te`);
  await page.locator('#completion li').first().waitFor();
  await text.press('ArrowDown');
  await text.press('Enter');
  demand((await text.inputValue()).endsWith('[sampler.tempering'), 'it does not complete keys');

  await text.fill(right);
  await page.locator('#link').click();
  await page.waitForFunction(() => location.hash.length > 2);
  const address = page.url();
  await text.fill('');
  await page.goto('about:blank');
  await page.goto(address);
  await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: PATIENCE });
  demand((await text.inputValue()) === right, 'the link does not carry the scenario');
  demand(await page.evaluate(() => gallery.live.samplers.size === 0), 'a link samples by itself');
  await page.locator('#run').click();
  await page.waitForFunction(() => gallery.solutions.length > 0 && gallery.stage, null, { timeout: PATIENCE });
  console.log(`playground: ${await page.evaluate(() => gallery.live.told)}`);
  await page.waitForTimeout(2000);
  await page.screenshot({ path: join(shots, 'playground.png') });
  await text.fill('[world.');
  await text.press('Escape');
  const hostile = Buffer.from('not compressed').toString('base64url');
  await page.goto(`${address.split('#')[0]}#${hostile}`);
  await page.waitForFunction(() => document.getElementById('problems').textContent.includes('no scenario'), null, { timeout: PATIENCE });
  demand(!noise.length, `it complains: ${noise.join('; ')}`);
  await context.close();
}

// What a scenario may cost is bounded, and said.
async function bounds(file) {
  const { context, page } = await opened(file, { width: 1400, height: 900 });
  const said = await page.locator('#text-hint').textContent();
  for (const bound of ['4 workers', '10 minutes', '300 solutions', '1 GiB', '65,536 characters']) demand(said.includes(bound), `it does not say ${bound}`);
  demand((await page.locator('#text').getAttribute('maxlength')) === '65536', 'a text may be longer than is said');
  // A short link with a long text.
  const address = page.url(), long = deflateRawSync(Buffer.from('#'.repeat(70000))).toString('base64url');
  await page.goto(`${address}#${long}`);
  await page.waitForFunction(() => document.getElementById('problems').textContent.includes('too long'), null, { timeout: PATIENCE });
  // Ten minutes later it pauses, and goes on when someone asks.
  await page.evaluate(() => { window.written = gallery; });
  await page.locator('#run').click();
  await page.waitForFunction(() => gallery.stage, null, { timeout: PATIENCE });
  await page.evaluate(() => { written.begun -= 600000; });
  await page.waitForFunction(() => !gallery.live.going && gallery.live.told.includes('10 minutes'), null, { timeout: PATIENCE });
  const before = await page.evaluate(() => gallery.live.iterations);
  await page.locator('#live-toggle').click();
  await page.waitForFunction((before) => gallery.live.iterations > before, before, { timeout: PATIENCE });
  await context.close();

  // One that reads and reads is ended after 20 seconds.
  const slow = await opened(file, { width: 1400, height: 900 });
  await slow.page.clock.install();
  await slow.page.evaluate(() => { window.Worker = class { postMessage() {} terminate() { window.ended = true; } }; });
  await slow.page.locator('#run').click();
  await slow.page.clock.fastForward(19000);
  demand(!await slow.page.evaluate(() => window.ended), 'a reader is ended too early');
  await slow.page.clock.fastForward(2000);
  demand(await slow.page.evaluate(() => window.ended && document.getElementById('problems').textContent.includes('too long')), 'a reader that is silent goes on');
  await slow.context.close();
}

async function playgroundByPhone(file) {
  for (const [width, height, scheme] of [[390, 844, 'light'], [390, 844, 'dark'], [2560, 1300, 'light']]) {
    const { context, page } = await opened(file, { width, height }, null, scheme);
    await page.locator('#run').click();
    await page.waitForFunction(() => gallery.stage, null, { timeout: PATIENCE });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    demand(wide <= 0, `the page is ${wide} pixels too wide`);
    await barred(page);
    await page.waitForTimeout(1500);
    await page.screenshot({ path: join(shots, `playground-${width}-${scheme}.png`), fullPage: true });
    await context.close();
  }
}

// Nothing keeps out those who use a keyboard or a screen reader.
async function barred(page) {
  await page.evaluate(axe.source);
  const barriers = await page.evaluate(async () => (await axe.run()).violations.filter(({ impact }) => ['serious', 'critical'].includes(impact)));
  demand(!barriers.length, barriers.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, failureSummary }) => `${target} (${failureSummary})`).slice(0, 3)}`).join('; '));
}

// A page sends nothing and runs no foreign script; it survives workers that run out of memory, fall silent, or are stopped.
async function safety(file) {
  const { context, page } = await opened(file, { width: 1400, height: 1000 });
  const refused = await page.evaluate(async () => {
    const kinds = new Set();
    document.addEventListener('securitypolicyviolation', ({ effectiveDirective }) => kinds.add(effectiveDirective));
    await fetch('https://example.org/').catch(() => {});
    new Image().src = 'https://example.org/a.png';
    document.body.append(Object.assign(document.createElement('script'), { textContent: 'window.hacked = 1' }));
    document.body.insertAdjacentHTML('beforeend', '<i onclick="window.hacked = 1"></i>');
    document.body.lastElementChild.click();
    // Code that a driver runs itself may do more, so this is done later.
    setTimeout(() => { try { window.eval('window.hacked = 1'); } catch {} }, 0);
    await new Promise((done) => { setTimeout(done, 500); });
    return [[...kinds].sort().join(), window.hacked];
  });
  demand(refused[0] === 'connect-src,img-src,script-src,script-src-attr,script-src-elem' && refused[1] === undefined, `the policy refuses only ${refused}`);

  await page.waitForFunction(() => gallery.live.ready && gallery.live.iterations > 0, null, { timeout: PATIENCE });
  const replaced = async (what, why) => {
    await page.waitForFunction((why) => gallery.live.told.includes(`stopped (${why}`) && gallery.live.told.includes('was replaced'), why, { timeout: PATIENCE });
    const went = await page.evaluate(() => gallery.live.iterations);
    await page.waitForFunction((went) => gallery.live.iterations > went && gallery.live.samplers.size > 0, went, { timeout: PATIENCE });
    demand(await page.evaluate(() => gallery.live.going), `it samples no more after ${what}`);
  };
  // More than the 1 GiB that a worker may have.
  await page.evaluate(() => { const [worker] = gallery.live.samplers.keys(); worker.postMessage({ near: '\u20ac'.repeat(360e6), chain: 1000 }); });
  await replaced('one without memory', 'unreachable');
  await page.evaluate(() => { const [worker] = gallery.live.samplers.keys(); worker.terminate(); gallery.live.samplers.set(worker, performance.now() - 60001); gallery.live.look(); });
  await replaced('one that fell silent', 'it was silent for a minute');
  await page.evaluate(() => { const [worker] = gallery.live.samplers.keys(); worker.dispatchEvent(new ErrorEvent('error', { message: 'stopped by the browser' })); });
  await replaced('one that was stopped', 'stopped by the browser');
  // What compares solutions is stopped: what was found stays.
  const tiles = await page.locator('.tile').count();
  await page.evaluate(() => gallery.live.keeper.dispatchEvent(new ErrorEvent('error', { message: 'no memory' })));
  demand((await page.locator('#live-state').textContent()).includes('Sampling ended: what compares solutions stopped (no memory)'), 'it does not say that sampling ended');
  demand(tiles <= await page.locator('.tile').count(), 'tiles are gone');
  await page.locator('.tile .pick').last().click();
  demand(await page.evaluate(() => gallery.a.open().count > 0), 'it shows no solution any more');
  await context.close();
}

async function phone(file, name) {
  const { context, page } = await opened(file, { width: 390, height: 844 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  demand(wide <= 0, `the page is ${wide} pixels too wide`);
  await page.waitForFunction(() => gallery.live.iterations > 0, null, { timeout: PATIENCE });
  await page.waitForFunction(() => !document.getElementById('steer').hidden, null, { timeout: PATIENCE });
  await page.locator('#steer > summary').click();
  demand(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'what can be changed is too wide');
  await barred(page);
  await page.screenshot({ path: join(shots, `live-${name}-phone.png`), fullPage: true });
  await context.close();
}

// Without WebAssembly it is the gallery that it was, and says so.
async function without(file) {
  const { context, page, noise } = await opened(file, { width: 1000, height: 800 }, () => { delete window.WebAssembly; });
  demand((await page.locator('#live-state').textContent()).includes('no WebAssembly'), 'it does not say what is missing');
  demand(await page.locator('.tile').count() > 0 && !noise.length, `it is no gallery: ${noise.join('; ')}`);
  await context.close();
}

function fails(saved, id) {
  try {
    execFileSync(process.env.PLAUS, ['replay', saved, '--sample', id], { stdio: 'ignore' });
    return false;
  } catch { return true; }
}
