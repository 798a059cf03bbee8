// Opens galleries from file:// in headless Chromium, offline, and uses them: node check_gallery.mjs SHOTS_FOLDER PAGE.html …
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import chromium from '@sparticuz/chromium';
import axe from 'axe-core';
import { chromium as playwright } from 'playwright-core';
import validator from 'gltf-validator';

const [shots, ...pages] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });
// Chromium comes in a package of the registry, so no other download is needed. The processor draws WebGL.
const args = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
const executablePath = process.env.PLAUS_CHROMIUM ?? (await chromium.executablePath());
const browser = await playwright.launch({ executablePath, headless: true, args });
const wrong = [];
const desktop = { name: 'desktop', width: 1360, height: 900, colorScheme: 'light' };
const phone = { name: 'phone', width: 390, height: 844, colorScheme: 'dark' };
for (const [nth, page] of pages.entries()) {
  // What depends on the screen or takes long is tried on every second page: all are made by the same scripts.
  for (const look of nth % 2 ? [desktop, phone] : [{ ...desktop, films: true }]) {
    const name = `${basename(page, '.html')}-${look.name}`;
    try {
      await visit(page, look, name);
    } catch (error) {
      wrong.push(`${name}: ${error.message}`);
    }
  }
}
await browser.close();
for (const line of wrong) console.log(`WRONG ${line}`);
console.log(`${pages.length} galleries opened, ${wrong.length} wrong`);
process.exit(wrong.length || !pages.length ? 1 : 0);

async function visit(file, { name: kind, width, height, colorScheme, films }, name) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, offline: true, acceptDownloads: true });
  const page = await context.newPage(), noise = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/GPU stall|software WebGL|GL Driver/i.test(message.text())) noise.push(message.text()); });
  page.on('pageerror', (error) => noise.push(error.message));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) noise.push(`asks for ${request.url()}`); });
  await page.goto(`file://${resolve(file)}`);
  await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 60000 });
  const ready = await page.evaluate(() => document.documentElement.dataset.ready);
  const demand = (truth, what) => { if (!truth) throw new Error(what); };
  const picture = async (selector) => (await page.locator(selector).first().evaluate((canvas) => canvas.toDataURL()));

  // It plays without a click: pictures differ, and are not empty.
  const first = await picture('#stage');
  // At an animation's end the player pauses for most of a second.
  let second = first;
  for (let tries = 0; tries < 8 && second === first; tries++) {
    await page.waitForTimeout(350);
    second = await picture('#stage');
  }
  demand(first !== second, 'the player stands still');
  demand(second.length > 3000, 'the player is empty');
  const begin = await page.evaluate(() => [gallery.frames, performance.now()]);
  await page.waitForTimeout(1500);
  const playing = await rate(page, begin);
  await page.locator('body').press(' ');
  demand(await page.evaluate(() => !gallery.player.playing), 'the space bar does not pause');
  await page.waitForTimeout(300); // paused pictures are drawn in full detail
  await page.screenshot({ path: join(shots, `${name}.png`) });
  // Wherever it was paused: from the beginning to the first impact, on to the next later one, and back.
  await page.evaluate(() => gallery.player.seek(0));
  const hits = await page.evaluate(() => gallery.a.impacts.map((hit) => hit.time)), ends = await page.evaluate(() => gallery.player.duration);
  let expected = 0;
  for (const [key, next] of [['ArrowRight', (t) => hits.find((hit) => hit > t + 1e-4) ?? ends], ['ArrowRight', (t) => hits.find((hit) => hit > t + 1e-4) ?? ends],
    ['ArrowLeft', (t) => hits.findLast((hit) => hit < t - 1e-4) ?? 0]]) {
    await page.locator('body').press(`Shift+${key}`);
    expected = next(expected);
    const time = await page.evaluate(() => gallery.player.time);
    demand(time === expected, `shift and ${key} lead to ${time} s, not to the impact at ${expected} s`);
  }
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  demand(wide <= 0, `the page is ${wide} pixels too wide`);

  // Sound is off until it is asked for; then it is the sound of the exported file.
  demand(await page.evaluate(() => !gallery.player.sound.on && !gallery.player.sound.context), 'there is sound unasked');
  if (process.env.PLAUS && kind === 'desktop') {
    const [id, until] = await page.evaluate(() => [gallery.a.id, gallery.meta.until ?? 'rest']), wav = join(shots, `${name}.wav`);
    execFileSync(process.env.PLAUS, ['export', file.replace(/\.html$/, '.run'), '--format', 'wav', '--sample', id, '--until', until, '--out', wav, '--force'], { stdio: 'ignore' });
    const bytes = readFileSync(wav), data = bytes.indexOf('data') + 8;
    const exported = Array.from({ length: (bytes.length - data) / 2 }, (_, k) => bytes.readInt16LE(data + 2 * k));
    const alike = await page.evaluate((exported) => {
      const heard = gallery.player.sound.heard(gallery.a);
      let [ab, aa, bb] = [0, 0, 0];
      for (let k = 0; k < Math.min(heard.length, exported.length); k++) { ab += heard[k] * exported[k]; aa += heard[k] ** 2; bb += exported[k] ** 2; }
      return [ab / Math.sqrt(aa * bb), heard.length - exported.length];
    }, exported);
    // Allows for single precision, and for rolling noise from another hash.
    demand(alike[0] > 0.98 && Math.abs(alike[1]) <= 1, `the page's sound is not the file's: ${alike}`);
  }
  await page.locator('body').press('o');
  await page.locator('body').press(' ');
  await page.waitForFunction(() => gallery.player.sound.playing, null, { timeout: 20000 });
  await page.locator('body').press(' ');
  demand(await page.evaluate(() => !gallery.player.sound.playing), 'it sounds while it is paused');
  await page.locator('#sound').click();
  demand(await page.evaluate(() => !gallery.player.sound.on), 'the switch does not turn sound off');

  // Tiles: all have pictures; the one pointed at moves.
  const tiles = page.locator('.tile'), all = await tiles.count();
  demand(all === await page.evaluate(() => gallery.solutions.length), 'without a filter, not all solutions are shown');
  await tiles.nth(0).scrollIntoViewIfNeeded();
  await page.waitForTimeout(1500);
  const still = await picture('.tile canvas');
  demand(still.length > 1000, 'a tile is empty');
  await tiles.nth(0).hover();
  const over = await page.evaluate(() => [gallery.frames, performance.now()]);
  // If the machine is slow at the moment, the first picture may take seconds.
  let moved = false;
  for (let tries = 0; tries < 12 && !moved; tries++) {
    await page.waitForTimeout(800);
    moved = (await picture('.tile canvas')) !== still;
  }
  demand(moved, 'the tile pointed at stands still');
  const hovered = await rate(page, over);

  // Choosing, comparing, starring, filtering, sorting.
  if (all > 2) {
    const id = await tiles.nth(2).getAttribute('data-id');
    await tiles.nth(2).locator('.pick').click();
    const command = await page.locator('#command').textContent();
    demand(command.includes(` --sample ${id} `), 'the command is not of the chosen tile');
    const until = await page.evaluate(() => gallery.meta.until);
    demand(!until || command.includes(` --until ${until} `), 'the command does not end where the page does');
    await tiles.nth(1).locator('.pick').click({ modifiers: ['Shift'] });
    demand((await page.locator('.tile.b').count()) === 1, 'nothing to compare with');
    // By key: what is shown becomes A, what is chosen next becomes B.
    await page.locator('body').press('b');
    await page.locator('body').press('b');
    const legend = page.locator('#legend');
    demand((await legend.textContent()) === 'A Clip 3: now choose B', 'comparing does not begin with A');
    await tiles.nth(1).locator('.pick').click();
    demand((await legend.textContent()) === 'A Clip 3B Clip 2', 'the next one chosen is not B');
    await tiles.nth(1).locator('.star').click();
    await page.locator('#only-starred').click();
    demand((await tiles.count()) === 1, 'the filter for stars shows others too');
    await page.locator('#clear').click();
    await page.locator('.span[data-name="log p"] input').first().evaluate((input) => {
      input.value = (+input.min + +input.max) / 2;
      input.dispatchEvent(new Event('input', { bubbles: true }));
    });
    const fewer = await tiles.count();
    demand(fewer > 0 && fewer < all, `${fewer} of ${all} solutions have log p in the upper half`);
    await page.locator('#clear').click();
    await page.locator('#sort').selectOption('+0');
    const logs = await page.evaluate(() => gallery.listed.map((solution) => solution.log_p));
    demand(logs.every((value, k) => !k || logs[k - 1] <= value), 'not sorted by log p');
  }
  await cameras(page, demand);
  await slowly(page, demand);
  await page.locator('#map').scrollIntoViewIfNeeded();
  const dot = await page.evaluate(() => gallery.map.layout()[0]);
  await page.locator('#map').hover({ position: { x: dot[0], y: dot[1] } });
  await page.waitForTimeout(300);
  demand(await page.locator('#preview').isVisible(), 'the map shows no preview');
  await page.screenshot({ path: join(shots, `${name}-map.png`) });

  // Nothing keeps out those who use a keyboard or a screen reader.
  await page.evaluate(axe.source);
  const barriers = await page.evaluate(async () => (await axe.run()).violations.filter(({ impact }) => ['serious', 'critical'].includes(impact)));
  demand(!barriers.length, barriers.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, failureSummary }) => `${target} (${failureSummary})`).slice(0, 3)}`).join('; '));

  // The validator accepts the downloaded file.
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#download').click()]);
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(await download.path())));
  demand(issues.numErrors === 0, `the download has ${issues.numErrors} errors: ${JSON.stringify(issues.messages.slice(0, 3))}`);
  if (films) await video(page, demand, join(shots, `${name}.webm`));
  if (films) await loop(page, demand, join(shots, `${name}.gif`));
  await alone(context, page, demand, join(shots, `${name}-alone.png`));
  demand(noise.length === 0, `the console says: ${noise.slice(0, 3).join(' | ')}`);
  console.log(`ok ${name}: ready after ${ready} ms, ${all} tiles, plays at ${playing}/s, tile pointed at ${hovered}/s, ${kind}; download ${issues.numWarnings} warnings`);
  await context.close();
}

// Each camera looks from elsewhere; one that follows a body keeps its middle in the middle of the picture.
async function cameras(page, demand) {
  const select = page.locator('#camera'), all = await select.locator('option').evaluateAll((options) => options.map(({ value }) => value));
  demand(['first', 'front', 'side', 'above'].every((view) => all.includes(view)), `cameras are ${all}`);
  const seen = new Set();
  for (const view of all.slice(0, 4)) {
    await select.selectOption(view);
    seen.add(await page.evaluate(() => gallery.player.camera.position.toArray().map((x) => x.toFixed(3)).join()));
  }
  demand(seen.size === 4, 'two cameras look from the same place');
  const body = all.find((view) => view.startsWith('follow '));
  demand(body, 'no body can be followed');
  await select.selectOption(body);
  const places = [];
  for (const share of [0, 0.3, 0.6]) {
    await page.evaluate((share) => gallery.player.seek(share * gallery.player.duration), share);
    await page.waitForFunction(() => !gallery.player.stale);
    const [off, at] = await page.evaluate(() => {
      const { player } = gallery, at = player.view.place(player.view.followed(gallery.a)), seen = at.clone().project(player.camera);
      return [Math.hypot(seen.x, seen.y), at.toArray().join()];
    });
    // In halves of the picture; single precision.
    demand(off < 1e-4, `the followed body is ${off} from the middle`);
    places.push(at);
  }
  demand(new Set(places).size > 1, 'the followed body stands still');
  await page.locator('body').press('v');
  demand(await page.evaluate((body) => gallery.player.view.view !== body, body), 'the key v changes no camera');
  await select.selectOption('first');
}

// Around strong impacts time goes slower, and only there.
async function slowly(page, demand) {
  const rates = () => page.evaluate(() => {
    const { player, a } = gallery, [hit] = strongest(a), at = (time) => { player.seek(time); return player.rate / +player.speed.value; };
    const calm = Array.from({ length: 400 }, (_, k) => (k / 400) * a.duration).find((time) => a.impacts.every((one) => Math.abs(one.time - time) > 0.11));
    return [at(hit), calm === undefined ? 1 : at(calm)];
    function strongest({ impacts }) { return [...impacts].sort((a, b) => b.speed - a.speed).map(({ time }) => time); }
  });
  if (!await page.evaluate(() => gallery.a.impacts.length)) return;
  const before = await rates();
  await page.locator('#slow').click();
  const now = await rates();
  demand(before[0] === 1 && before[1] === 1, `it is slow unasked: ${before}`);
  demand(now[0] < 0.5 && now[1] === 1, `around impacts and elsewhere time goes ${now} times as fast`);
  demand((await page.locator('#slow').getAttribute('aria-pressed')) === 'true', 'the switch does not say that it is on');
  await page.locator('body').press('i');
  demand((await rates())[0] === 1, 'the key i does not turn slow motion off');
}

// A video of the whole clip, which a browser plays: its pictures differ.
async function video(page, demand, path) {
  await page.evaluate(() => { gallery.player.speed.value = '2'; });
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: 120000 }), page.locator('#video').click()]);
  await download.saveAs(path);
  const [width, height, differ] = await page.evaluate(async (bytes) => {
    const film = document.createElement('video'), once = (what) => new Promise((done, failed) => { film.addEventListener(what, done, { once: true }); film.onerror = () => failed(new Error(film.error.message)); });
    film.muted = true;
    film.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], { type: 'video/webm' }));
    await once('loadeddata');
    const canvas = Object.assign(document.createElement('canvas'), { width: 64, height: 36 }), pen = canvas.getContext('2d', { willReadFrequently: true });
    const picture = () => { pen.drawImage(film, 0, 0, 64, 36); return [...pen.getImageData(0, 0, 64, 36).data]; };
    const first = picture();
    await Promise.all([once('ended'), film.play()]);
    const last = picture();
    return [film.videoWidth, film.videoHeight, first.filter((value, k) => Math.abs(value - last[k]) > 24).length];
  }, readFileSync(path).toString('base64'));
  demand(Math.max(width, height) === 1280 && width % 2 + height % 2 === 0, `the video has ${width} by ${height} pixels`);
  demand(differ > 0, 'nothing moves in the video');
}

// A GIF of the whole clip, of the size that was told; making it can be stopped.
async function loop(page, demand, path) {
  await page.locator('#speed').selectOption('1');
  const button = page.locator('#gif'), told = await page.locator('#gif-about').textContent();
  let downloads = 0;
  page.on('download', () => { downloads += 1; });
  await button.click();
  await page.waitForFunction(() => /^Stop: GIF \d+ of \d+$/.test(document.getElementById('gif').textContent), null, { timeout: 60000 });
  await button.click();
  await page.waitForTimeout(1500);
  demand(!downloads && (await button.textContent()) === 'Download GIF', 'making a GIF does not stop');
  const { times, ...size } = await page.evaluate(() => gallery.gif.plan());
  demand(told.includes(`${times.length} pictures of ${size.width} × ${size.height} pixels`), `what is told is not what is planned: ${told}`);
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: 240000 }), button.click()]);
  await download.saveAs(path);
  const bytes = readFileSync(path);
  const [count, width, height, shares] = await page.evaluate(async (bytes) => {
    const decoder = new ImageDecoder({ data: Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0)), type: 'image/gif' });
    await Promise.all([decoder.completed, decoder.tracks.ready]);
    const { frameCount } = decoder.tracks.selectedTrack, shares = [];
    let first = null, size = [];
    for (const frameIndex of [0, frameCount >> 1, frameCount - 1]) {
      const { image } = await decoder.decode({ frameIndex }), { displayWidth: width, displayHeight: height } = image;
      const pen = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d');
      pen.drawImage(image, 0, 0);
      const { data } = pen.getImageData(0, 0, width, height);
      first ??= data;
      size = [width, height];
      shares.push([data.filter((value, k) => value !== first[k]).length / data.length, new Set(new Uint32Array(data.buffer)).size]);
      image.close();
    }
    return [frameCount, ...size, shares];
  }, bytes.toString('base64'));
  demand(count === times.length && width === size.width && height === size.height, `the GIF has ${count} pictures of ${width} by ${height} pixels`);
  demand(shares[0][1] > 20, 'its first picture is empty');
  demand(shares[1][0] > 0 && shares[1][0] < 0.5 && shares[2][0] < 0.5, `of its pictures, ${shares} differ from the first`);
  demand(bytes.length <= 16e6, `it has ${bytes.length} bytes`);
}

// The address of one solution shows that alone, from the camera that it names.
async function alone(context, page, demand, shot) {
  const html = await page.evaluate(() => { gallery.player.view.choose('side'); return gallery.details.embedding(gallery.a); }), [, address] = html.match(/src="([^"]*)"/);
  const id = await page.evaluate(() => gallery.a.id), other = await context.newPage();
  const open = async (address) => {
    await other.goto(new URL(address.replaceAll('&amp;', '&'), page.url()).href);
    await other.waitForSelector('html[data-ready]', { state: 'attached', timeout: 60000 });
  };
  await open(address);
  demand(await other.evaluate((id) => gallery.a.id === id && gallery.player.view.view === 'side', id), 'it is not the solution or the camera of the address');
  const shown = await other.locator('header, aside, #list').evaluateAll((parts) => parts.filter((part) => part.checkVisibility()).length);
  demand(!shown && await other.locator('#stage').isVisible() && await other.locator('#play').isVisible(), 'it is not the player alone');
  demand(await other.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.documentElement.scrollHeight <= innerHeight), 'the player alone does not fit');
  demand(!await other.evaluate(() => gallery.live), 'the player alone samples');
  await other.evaluate(axe.source);
  const barriers = await other.evaluate(async () => (await axe.run()).violations.filter(({ impact }) => ['serious', 'critical'].includes(impact)).map(({ id }) => id));
  demand(!barriers.length, `the player alone: ${barriers}`);
  await other.waitForTimeout(1000);
  await other.screenshot({ path: shot });
  await open(address.replace(/solution=[^&]*/, 'solution=99:99'));
  demand((await other.locator('#message').textContent()).includes('no solution 99:99'), 'it does not say that there is no such solution');
  await other.close();
}

async function rate(page, [frames, since]) {
  const [now, at] = await page.evaluate(() => [gallery.frames, performance.now()]);
  return ((1000 * (now - frames)) / (at - since)).toFixed(0);
}
