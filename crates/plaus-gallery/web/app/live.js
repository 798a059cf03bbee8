// The sampler in the page: workers go on from where the run ended, and what they find that looks clearly different becomes tiles and dots.

// Most workers that sample; most solutions that are added, so that the page stays within memory; how often workers that fail are replaced.
const MOST_WORKERS = 4, MOST_FOUND = 300, MOST_REPLACED = 8;
// How long a worker may be silent, in milliseconds, before it is replaced.
const LONGEST_SILENCE = 60000;

// What a live page samples with: the schema, the run and the module, unpacked side by side while the first picture is made.
let unpacking = null;

function unpackLive() {
  const unpacked = async (id) => {
    const element = document.getElementById(id), packed = bytesOf(element.textContent.trim());
    element.remove();
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip')));
  };
  const text = async (id) => (await unpacked(id)).text(), module = async () => WebAssembly.compile(await (await unpacked('live-module')).arrayBuffer());
  unpacking = Promise.all([text('live-schema'), text('live-run'), module()]);
  unpacking.catch(() => {}); // who waits for it is told
}

class Live {
  constructor(app) {
    this.app = app;
    this.samplers = new Map();
    this.found = [];
    this.waiting = [];
    this.iterations = 0;
    this.replaced = 0;
    this.going = true;
    this.told = '';
    this.box = document.getElementById('live');
    this.box.hidden = !app.meta.samples;
    const [toggle, save, back] = ['live-toggle', 'live-save', 'live-back'].map((id) => document.getElementById(id));
    Object.assign(this, { toggle, save, back });
    toggle.addEventListener('click', () => this.go(!this.going));
    save.addEventListener('click', () => this.keeper?.postMessage({ save: true }));
    back.addEventListener('click', () => this.restart());
    setInterval(() => this.look(), 5000);
    this.show();
  }

  async begin() {
    if (typeof WebAssembly !== 'object') {
      this.end('This browser has no WebAssembly, so nothing is sampled here: the page shows the solutions of the run.');
      return;
    }
    try {
      if (!unpacking) unpackLive();
      const [schema, run, module] = await unpacking;
      Object.assign(this, { schema, module, schemaTree: JSON.parse(schema) });
      this.source = URL.createObjectURL(new Blob([document.getElementById('live-worker').textContent], { type: 'text/javascript' }));
      this.steer = new Steer(this);
      if (this.app.meta.samples) this.open(run, this.app.meta.chains);
      else this.run = run;
      this.app.details.show();
    } catch (error) {
      this.end(`Nothing is sampled here: ${error.message}`);
    }
  }

  // Begins to sample a scenario: `run` is its text for the module.
  open(run, chains) {
    this.run = run;
    this.next = Math.max(this.next ?? 0, chains);
    this.keeper?.terminate();
    for (const sampler of this.samplers.keys()) sampler.terminate();
    this.samplers.clear();
    this.waiting = [];
    this.openKeeper();
    const cores = Math.max(navigator.hardwareConcurrency || 1, 1);
    for (let k = 0; k < Math.min(Math.max(cores - 1, 1), MOST_WORKERS); k++) this.openSampler();
    // Until the first solution is there, a core is left to what compares solutions and to the picture.
    this.isOneShort = cores > 1 && cores <= MOST_WORKERS;
  }

  // The worker of the last core.
  openLast() {
    if (!this.isOneShort || this.over) return;
    this.isOneShort = false;
    this.openSampler();
  }

  // Another scenario in place of the present one, whose solutions stay until the first of this is found.
  change(run, chains, how) {
    this.box.hidden = false;
    Object.assign(this, { over: false, going: true, fresh: true, found: [], near: null, wanted: null, iterations: 0, replaced: 0, told: '', how, since: performance.now() });
    this.open(run, chains);
    this.show();
  }

  // Tries other values; the keeper says what is wrong with them, or how to sample them.
  edit(edits) {
    if (this.keeper) this.keeper.postMessage({ edit: edits });
  }

  // Replaces workers that are silent.
  look() {
    if (!this.going) return;
    if (this.iterations) this.openLast();
    for (const [sampler, heard] of this.samplers) {
      if (performance.now() - heard > LONGEST_SILENCE) this.heard({ failed: 'it was silent for a minute' }, sampler);
    }
  }

  worker(message, heard) {
    const worker = new Worker(this.source);
    worker.onmessage = ({ data }) => heard(data, worker);
    worker.onerror = (event) => { event.preventDefault(); heard({ failed: event.message || 'it was stopped' }, worker); };
    worker.postMessage({ module: this.module, schema: this.schema, live: this.run, ...message });
    return worker;
  }

  // Chains beyond the run's, each once, so no random number is used twice.
  openSampler() {
    const sampler = this.worker({ chain: this.next++, go: this.going }, (data, worker) => this.heard(data, worker));
    const draws = this.near?.draws;
    if (draws) sampler.postMessage({ near: draws[this.samplers.size % draws.length], chain: this.next++ });
    this.samplers.set(sampler, performance.now());
    this.show();
  }

  heard({ found, iterations, failed }, worker) {
    if (!this.samplers.has(worker)) return;
    this.samplers.set(worker, performance.now());
    if (found) {
      for (const one of parts(found)) this.offer(one);
    }
    if (iterations) { this.iterations += iterations; this.show(); }
    if (failed) {
      worker.terminate();
      this.samplers.delete(worker);
      this.replaced += 1;
      const again = this.replaced <= MOST_REPLACED;
      this.told = `A worker stopped (${failed}) and ${again ? 'was replaced' : 'is left out'}.`;
      if (again) this.openSampler();
      else if (!this.samplers.size) this.end(`Sampling ended: workers stopped too often (${failed}).`);
      this.show();
    }
  }

  // The keeper says which solutions are new to the page, one after the other.
  openKeeper() {
    this.busy = true;
    this.ready = false;
    this.keeper = this.worker({ keeper: true }, (data, worker) => this.kept(data, worker));
  }

  kept({ opened, about, added, drawn, saved, glb, of, failed, live, problems }, worker) {
    if (worker !== this.keeper) return;
    if (failed) {
      this.end(`Sampling ended: what compares solutions stopped (${failed}).`);
      return;
    }
    if (opened) {
      Object.assign(this, { ready: true, about });
      this.steer.show(about.scenario);
      if (this.fresh) this.how ??= about.climbs ? 'each solution looked for by a climb of its own from a fresh draw: found, not weighted' : about.independent ? 'independent draws' : 'chains from fresh draws';
    }
    if (problems) this.steer.refuse(problems);
    if (live) this.change(live, this.about.chains, 'from the states known that suit it best, under what must happen now');
    if (added) {
      this.openLast();
      this.found.push(this.asked);
      if (this.fresh) {
        this.fresh = false;
        this.told = `The first solution came after ${((performance.now() - this.since) / 1000).toFixed(1)} s.`;
        appOf(this.about, added, this.app, this.app.meta);
      } else this.app.add(added);
    }
    if (drawn && this.wanted.draws.push(drawn) === this.wanted.count) {
      const near = this.wanted;
      this.wanted = null;
      this.restart(near);
    }
    if (glb) this.app.details.give(this.app.solutions[of], glb);
    if (saved) save(new Blob([saved], { type: 'application/json' }), this.file);
    if (opened || added !== undefined) { this.busy = false; this.asked = null; this.feed(); }
    this.show();
  }

  offer(found) {
    // Those that wait are few: a worker tells only what looks different from all that it found.
    if (this.waiting.length < 1000) this.waiting.push(found);
    this.feed();
  }

  feed() {
    if (this.busy || !this.keeper) return;
    if (this.found.length >= MOST_FOUND) {
      this.waiting = [];
      if (this.going) this.end(`${MOST_FOUND} solutions were found here, as many as a page holds: sampling has ended.`, true);
      return;
    }
    if (!this.waiting.length) return;
    this.busy = true;
    this.asked = this.waiting.shift();
    this.keeper.postMessage({ add: this.asked });
  }

  go(going) {
    this.going = going;
    for (const sampler of this.samplers.keys()) {
      this.samplers.set(sampler, performance.now());
      sampler.postMessage({ go: going });
    }
    this.show();
  }

  // The file of `plaus export`, made by the module; whether it will come.
  export(solution) {
    this.keeper?.postMessage({ glb: solution.index, label: labelOf(this.app.meta, solution) });
    return Boolean(this.keeper);
  }

  // More like one: all chains begin at it.
  like(solution) { this.beginAt([solution], `from ${solution.name} on, by small changes: neighbours first, in time any solution`); }

  // Something else: each chain begins at another of those least like it.
  unlike(solution) {
    const away = ({ path }) => Math.hypot(path[0] - solution.path[0], path[1] - solution.path[1]);
    const others = this.app.solutions.filter((one) => one !== solution).sort((a, b) => away(b) - away(a));
    this.beginAt(others.slice(0, MOST_WORKERS), `from the solutions least like ${solution.name} on, by small changes: in time any solution`);
  }

  beginAt(solutions, how) {
    if (!this.ready || this.wanted || !solutions.length) return;
    this.wanted = { how, draws: [], count: solutions.length };
    for (const { index } of solutions) this.keeper.postMessage({ draw: index });
  }

  // Without a place to begin at, workers go on from the run's chains again.
  restart(near = null) {
    this.near = near;
    for (const sampler of this.samplers.keys()) sampler.terminate();
    const count = this.samplers.size;
    this.samplers.clear();
    this.waiting = [];
    for (let k = 0; k < count; k++) this.openSampler();
    if (near && !this.going) this.go(true);
  }

  end(why, keep = false) {
    for (const sampler of this.samplers.keys()) sampler.terminate();
    this.samplers.clear();
    this.going = false;
    this.over = true;
    this.told = why;
    if (!keep) { this.keeper?.terminate(); this.keeper = null; this.ready = false; }
    this.app.details.show();
    this.show();
  }

  get file() { return `${this.app.meta.name}-live.json`; }

  show() {
    const { found, going, toggle, save, back, near, over, fresh } = this, { independent } = this.app.meta.live;
    const count = `${found.length} new ${found.length === 1 ? 'solution' : 'solutions'}`;
    const how = near ? near.how : this.how ? this.how : independent ? 'independent draws' : 'from where the run ended';
    const many = this.samplers.size, at = `${many} ${many === 1 ? 'worker' : 'workers'}`;
    const state = over ? '' : going ? `Sampling with ${at}, ${how}. ` : `Paused. `;
    const old = fresh && this.app.solutions.length ? 'Those shown are of what had to happen before. ' : '';
    const text = over && !this.iterations ? this.told : `${state}${old}${count} in ${Math.round(this.iterations).toLocaleString('en')} iterations. ${this.told}`;
    document.getElementById('live-state').textContent = text;
    toggle.hidden = over === true;
    toggle.textContent = going ? 'Pause' : 'Go on';
    save.hidden = !found.length || !this.keeper;
    save.textContent = `Save ${found.length} new`;
    back.textContent = this.how ? 'Back to how it was begun' : 'Back to the run’s chains';
    back.hidden = !near || over === true;
  }
}

// The items of a list in JSON, each as its text.
function parts(list) {
  const found = [];
  let depth = 0, start = 0, quoted = false;
  for (let k = 0; k < list.length; k++) {
    const c = list[k];
    if (quoted) { if (c === '\\') k++; else if (c === '"') quoted = false; continue; }
    if (c === '"') quoted = true;
    else if (c === '{' || c === '[') { if (++depth === 2) start = k; }
    else if ((c === '}' || c === ']') && depth-- === 2) found.push(list.slice(start, k + 1));
  }
  return found;
}
