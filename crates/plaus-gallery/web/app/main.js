// The page: which solution is chosen, and what is drawn when.

// Whether nothing moves before someone asks for it.
const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;

// The page's middle before anything was done to it.
const PRISTINE = document.querySelector('main').cloneNode(true);
// Parts of it that stay when all solutions are replaced.
const STAYS = ['live', 'steer'];

class App {
  // `before`: what this replaces, with all its solutions.
  constructor(meta, bytes, before = null) {
    this.meta = meta;
    if (before) {
      before.leave();
      this.live = before.live;
      this.live.app = this;
    }
    this.listening = new AbortController();
    this.solutions = meta.samples.map((_, index) => new Solution(meta, bytes, index));
    this.passing = new Set(this.solutions);
    this.listed = this.solutions;
    this.starred = new Set(this.remembered());
    this.trails = true;
    this.animateAll = false;
    this.a = this.solutions[0];
    this.b = this.hovered = null;
    const logs = this.solutions.map((s) => s.log_p);
    [this.lowest, this.highest] = [Math.min(...logs), Math.max(...logs)];
    this.stage = new Stage(meta, bytes, this.solutions);
    this.views = before?.views?.show(this.stage) ?? new Views(this.stage);
    this.views.onRestored = () => { this.player.stale = true; this.tiles.refresh(); };
    this.theme(this.dark);
    this.recorder = new Recorder(this);
    this.gif = new Gif(this);
    this.player = new Player(this);
    this.tiles = new Tiles(this);
    this.details = new Details(this);
    this.map = new SolutionMap(this);
    this.filters = new Filters(this);
    this.filters.apply();
    this.choose(this.a, false, false);
    this.keys();
    const { signal } = this.listening;
    document.getElementById('theme').addEventListener('click', () => this.theme(!this.dark), { signal });
    document.getElementById('help-open').addEventListener('click', () => document.getElementById('help').showModal(), { signal });
    const chosen = meta.candidates < meta.distinct ? ` (chosen among ${meta.candidates.toLocaleString()})` : '';
    const scenario = [meta.scenario ?? '', ...meta.overrides.map((set) => `--set ${set}`)].join(' ');
    const shown = this.solutions.length;
    this.summarise = () => {
      const more = this.solutions.length - shown, found = more ? ` and ${more} found here` : '';
      document.getElementById('summary').textContent = !meta.distinct ? [`${this.solutions.length} found here`, scenario].filter(Boolean).join(' · ') :
        `${shown} of ${meta.distinct.toLocaleString()} distinct solutions${chosen}${found} · ${scenario} · seed ${meta.seed}`;
    };
    this.summarise();
    if (!this.live && meta.live && !ALONE.has('solution')) {
      this.live = new Live(this);
      this.live.begin();
    }
  }

  // Makes room for others.
  leave() {
    this.over = true;
    this.listening.abort();
    this.recorder.stop(false);
    this.gif.stop();
    this.player.sound.stop();
    this.player.controls.dispose();
    const main = PRISTINE.cloneNode(true), focused = document.activeElement;
    for (const id of STAYS) main.querySelector(`#${id}`).replaceWith(document.getElementById(id));
    document.querySelector('main').replaceWith(main);
    if (main.contains(focused)) focused.focus({ preventScroll: true });
  }

  // Adds a solution that was found here; `whole` is the length of its description, the description, and bytes.
  add(whole, found) {
    const { meta, solutions } = this, { meta: more, bytes } = opened(whole.buffer);
    const here = (list) => list.map((one) => ({ ...one, bytes }));
    meta.names.push(...more.names);
    meta.models.push(...here(more.models));
    meta.props.push(...here(more.props));
    meta.sounds.push(...more.sounds);
    meta.samples.push({ ...more.sample, live: true });
    // Its numbers have ranges of their own.
    const solution = new Solution(Object.assign(Object.create(meta), more.ranges), bytes, solutions.length);
    solutions.push(solution);
    solutions.forEach((one, k) => Object.assign(one, { outcome: more.outcomes[k], path: more.paths[k] }));
    [this.lowest, this.highest] = [Math.min(this.lowest, solution.log_p), Math.max(this.highest, solution.log_p)];
    this.stage.include(solution);
    this.filters.include(solution);
    if (!meta.distinct && [4, 12, 40].includes(solutions.length)) this.filters.again();
    this.filters.apply();
    this.summarise();
    this.wake();
  }

  logShare(solution) { return (solution.log_p - this.lowest) / Math.max(this.highest - this.lowest, 1e-9); }

  get dark() { return document.documentElement.dataset.theme === 'dark'; }

  theme(dark) {
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    this.stage.theme(dark);
    this.tiles?.refresh();
    this.map?.draw();
    if (this.player) { this.player.stale = true; this.player.drawMarks(); }
    this.wake();
  }

  // Chooses a solution, or, `beside` the chosen one, another to compare it with.
  choose(solution, beside, play = !calm) {
    this.recorder.stop(false);
    this.gif.stop();
    if (beside && solution !== this.a) this.b = this.b === solution ? null : solution;
    else this.a = solution;
    if (this.b === this.a) this.b = null;
    if (this.pinning && solution !== this.pinning) [this.a, this.b, this.pinning] = [this.pinning, solution, null];
    const span = (text, kind) => { const b = Object.assign(document.createElement('b'), { textContent: text, className: kind }); const s = document.createElement('span'); s.append(b); return s; };
    const legend = document.getElementById('legend');
    legend.replaceChildren(...(this.b ? [span(`A ${this.a.name}`, ''), span(`B ${this.b.name}`, 'b')] : [span(this.pinning ? `A ${this.a.name}: now choose B` : this.a.name, '')]));
    this.player.load(play);
    this.details.show();
    this.tiles.mark();
    this.map.draw();
  }

  compare() {
    if (this.b) { this.b = null; this.pinning = null; } else this.pinning = this.pinning ? null : this.a;
    this.choose(this.a, false, false);
  }

  hover(solution, from, event) {
    if (this.hovered !== solution) {
      const before = this.hovered;
      if (before && this.hoveredFrom === 'tile') this.tiles.stale.add(before);
      Object.assign(this, { hovered: solution, hoveredFrom: from, hoveredSince: performance.now() });
      this.map.draw();
    }
    const preview = document.getElementById('preview');
    preview.hidden = !(solution && from === 'map');
    if (!preview.hidden) {
      preview.lastElementChild.textContent = `${solution.name} · ${this.filters.caption(solution)}`;
      preview.style.left = `${Math.max(8, Math.min(event.clientX - 260, window.innerWidth - 250))}px`;
      preview.style.top = `${Math.max(8, Math.min(event.clientY - 80, window.innerHeight - 200))}px`;
    }
    this.wake();
  }

  star(solution) {
    if (!this.starred.delete(solution.id)) this.starred.add(solution.id);
    try { localStorage.setItem(this.memory, JSON.stringify([...this.starred])); } catch { /* a page from disk may not remember */ }
    this.tiles.mark();
    this.details.show();
    this.map.draw();
    if (this.filters.starredOnly) this.filters.apply();
  }

  get memory() { return `plaus-stars-${this.meta.hash}-${this.meta.seed}`; }

  remembered() {
    try {
      const known = new Set(this.meta.samples.map((s) => s.id));
      return JSON.parse(localStorage.getItem(this.memory) ?? '[]').filter((id) => known.has(id));
    } catch { return []; }
  }

  show(solutions) {
    this.listed = solutions;
    this.passing = new Set(solutions);
    this.tiles.show(solutions);
    this.map.draw();
  }

  setAnimateAll(on) {
    this.animateAll = on;
    document.getElementById('animate-all').classList.toggle('on', on);
    this.tiles.refresh();
  }

  toggleTrails() {
    this.trails = document.getElementById('trails').classList.toggle('on');
    this.player.stale = true;
    this.wake();
  }

  move(step) {
    const list = this.listed;
    if (!list.length) return;
    const at = list.indexOf(this.a), next = list[(at + step + list.length) % list.length];
    this.choose(next, false);
    this.tiles.tile(next).scrollIntoView({ block: 'nearest' });
  }

  keys() {
    const { player } = this;
    const actions = {
      ' ': () => player.toggle(), b: () => this.compare(), s: () => this.star(this.a), t: () => this.toggleTrails(), o: () => player.sound.toggle(), r: () => player.reset(), m: () => this.map.toggle(), v: () => player.view.next(), i: () => player.toggleSlow(), e: () => this.recorder.toggle(), g: () => this.gif.toggle(),
      a: () => this.setAnimateAll(!this.animateAll), d: () => this.details.download(), c: () => this.details.copy(), j: () => this.move(1), k: () => this.move(-1),
      ArrowLeft: (shift) => (shift ? player.jump(-1) : (player.pause(), player.seek(player.time - 1 / 60))),
      ArrowRight: (shift) => (shift ? player.jump(1) : (player.pause(), player.seek(player.time + 1 / 60))),
      '?': () => document.getElementById('help').showModal(),
    };
    addEventListener('keydown', (event) => {
      const on = event.target.closest?.('button, select, dialog, input, textarea');
      if (event.ctrlKey || event.metaKey || event.altKey || (on && (on.tagName !== 'BUTTON' || event.key === ' '))) return;
      const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!action) return;
      event.preventDefault();
      action(event.shiftKey);
    }, { signal: this.listening.signal });
  }

  // Draws while something moves, then sleeps.
  wake() {
    if (this.awake || this.over) return;
    this.awake = true;
    this.last = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    if (this.over) return;
    const passed = Math.min(Math.max(now - this.last, 0), 200), seconds = passed / 1000;
    this.last = now;
    this.player.step(seconds);
    const { jobs, moving } = this.tiles.jobs(now);
    const preview = document.getElementById('preview'), previewing = !preview.hidden && this.hovered;
    if (previewing) {
      const time = cycle(((now - this.hoveredSince) / 1000) * +this.player.speed.value, this.hovered.duration);
      jobs.push({ canvas: preview.firstElementChild, solution: this.hovered, time, flash: true, moving: true });
    }
    const main = this.player.job();
    if ((main?.moving || jobs.some((job) => job.moving)) && this.frames) this.views.pace(passed);
    this.views.draw(main ? [main, ...jobs] : jobs);
    this.frames = (this.frames ?? 0) + 1;
    if (main && this.recorder.recorder) this.recorder.frame();
    if (main) this.live?.steer?.place();
    if (this.player.playing || moving || previewing || this.player.stale) requestAnimationFrame((next) => this.tick(next));
    else this.awake = false;
  }
}

// The page of a scenario that was found one solution of: `about` is what the keeper says of it, `whole` the solution.
function appOf(about, whole, before, { name, scenario }) {
  const { meta: { sample, ranges, view, outcomes, paths, ...shared }, bytes } = opened(whole.buffer);
  const meta = {
    from: null, frame: null, alone: false, ...shared, ...ranges, ...view, name, scenario, overrides: [], scalars: about.scalars, seed: about.seed, chains: about.chains,
    hash: `${name}-changed`, run: '', until: null, distinct: 0, candidates: 0, live: { independent: about.independent, climbs: about.climbs },
    samples: [{ ...sample, live: true, outcome: outcomes[0], path: paths[0] }],
  };
  window.gallery = new App(meta, bytes, before);
  document.getElementById('message').textContent = '';
  if (!calm) window.gallery.player.play();
}

// What the page's address asks for: `?solution=0:17` is a player of that one, without the rest of the page; `&camera=` a camera of it.
const ALONE = new URLSearchParams(location.search);

// Shows one solution alone if the address asks for it; what is wrong with that, or nothing.
function alone(app) {
  if (!ALONE.has('solution')) return '';
  document.documentElement.dataset.alone = '';
  document.getElementById('whole').href = location.pathname.split('/').pop();
  const wanted = app.solutions.find(({ id }) => id === ALONE.get('solution'));
  if (!wanted) return `This page has no solution ${ALONE.get('solution')}.`;
  app.choose(wanted, false, false);
  if (ALONE.has('camera')) app.player.view.choose(ALONE.get('camera'));
  return '';
}

async function begin() {
  const message = document.getElementById('message');
  document.documentElement.dataset.theme = matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  try {
    const data = document.getElementById('data');
    if (document.getElementById('live-module') && typeof WebAssembly === 'object' && !ALONE.has('solution')) unpackLive();
    if (!data.textContent.trim()) { window.gallery = new Playground(); return; }
    const { meta, bytes } = await unpack(data);
    window.gallery = new App(meta, bytes);
    requestAnimationFrame(() => window.gallery.views.drawn(() => { document.documentElement.dataset.ready = performance.now().toFixed(0); }));
    message.textContent = alone(window.gallery);
    if (!calm) window.gallery.player.play();
  } catch (error) {
    console.error(error);
    message.textContent = `This browser cannot show the gallery: ${error.message}. It needs WebGL 2 and DecompressionStream (browsers of 2023 and later).`;
  }
}

begin();
