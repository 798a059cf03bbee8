// A scenario to write, and solutions beside it.

// Longest text, in characters; how long reading it may take; how long it is sampled before someone must ask again, both in milliseconds.
const LONGEST_TEXT = 65536, LONGEST_READING = 20000, LONGEST_SAMPLING = 600000;

class Playground {
  constructor() {
    document.body.classList.add('playground');
    document.getElementById('playground').hidden = false;
    for (const id of ['text', 'run', 'link', 'problems', 'meaning', 'completion']) this[id] = document.getElementById(id);
    this.message = document.getElementById('message');
    this.message.textContent = 'Solutions appear here.';
    document.getElementById('summary').textContent = 'write a scenario, run it, and look at solutions';
    document.getElementById('text-hint').textContent =
      `Ctrl-Enter runs it; arrows and Enter choose a key. Nothing runs before you say so, and nothing leaves this page. At most ${MOST_WORKERS} workers sample for ${LONGEST_SAMPLING / 60000} minutes at a time, and find at most ${MOST_FOUND} solutions; each has at most 1 GiB of memory. A scenario has at most ${LONGEST_TEXT.toLocaleString('en')} characters.`;
    document.documentElement.dataset.theme = matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
    document.getElementById('theme').addEventListener('click', () => { if (!window.gallery.stage) document.documentElement.dataset.theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'; });
    // Until there is a solution, the page has no other parts.
    this.meta = { name: 'playground', live: { independent: false } };
    this.solutions = [];
    this.details = { show() {} };
    this.run.addEventListener('click', () => this.start());
    this.link.addEventListener('click', () => this.share());
    this.text.addEventListener('keydown', (event) => this.key(event));
    this.text.addEventListener('input', () => this.suggest());
    this.text.addEventListener('click', () => this.suggest());
    this.text.addEventListener('blur', () => this.hide());
    this.text.maxLength = LONGEST_TEXT;
    addEventListener('hashchange', () => this.load());
    this.begin();
  }

  // Makes room for solutions.
  leave() {}

  async begin() {
    const given = JSON.parse(document.getElementById('start').textContent);
    this.files = given.files;
    this.text.value = given.text;
    this.live = new Live(this);
    await this.live.begin();
    await this.load();
    setInterval(() => this.bound(), 1000);
    document.documentElement.dataset.ready = performance.now().toFixed(0);
  }

  // The scenario of a link; it is shown, not run.
  async load() {
    if (location.hash.length < 2) return;
    try {
      const packed = bytesOf(location.hash.slice(1).replaceAll('-', '+').replaceAll('_', '/'));
      const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader(), decoder = new TextDecoder('utf-8', { fatal: true });
      let text = '';
      for (let part = await reader.read(); !part.done; part = await reader.read()) {
        text += decoder.decode(part.value, { stream: true });
        if (text.length > LONGEST_TEXT) throw new Error('it is too long');
      }
      this.text.value = text;
      this.tell([]);
    } catch (error) {
      this.tell([{ message: `The link holds no scenario: ${error.message}` }]);
    }
  }

  async share() {
    const stream = new Blob([this.text.value]).stream().pipeThrough(new CompressionStream('deflate-raw'));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    let letters = '';
    for (const byte of bytes) letters += String.fromCharCode(byte);
    history.replaceState(null, '', `#${btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`);
    const said = (text) => { this.link.textContent = text; setTimeout(() => { this.link.textContent = 'Copy link'; }, 1500); };
    try { await navigator.clipboard.writeText(location.href); said('Copied'); } catch { said('It is the page’s address now'); }
  }

  start() {
    const { live } = this;
    if (!live.module) return;
    this.reader?.terminate();
    this.tell([]);
    const timer = setTimeout(() => { this.reader.terminate(); this.tell([{ message: 'Reading it took too long.' }]); }, LONGEST_READING);
    const done = (problems) => { clearTimeout(timer); this.reader.terminate(); this.tell(problems); };
    this.reader = live.worker({ live: undefined, read: { name: 'scenario', text: this.text.value, files: this.files } }, ({ live: run, problems, failed }) => {
      if (problems) done(problems);
      if (failed) done([{ message: `It could not be read: ${failed}` }]);
      if (!run) return;
      done([]);
      this.begun = performance.now();
      if (!window.gallery.stage) this.message.textContent = 'looking for a first solution …';
      live.change(run, 0, null);
    });
  }

  // Sampling ends after a while, unless someone goes on.
  bound() {
    const { live } = this;
    if (!live.going || !live.keeper) { this.begun = performance.now(); return; }
    if (performance.now() - this.begun < LONGEST_SAMPLING) return;
    live.told = `Paused after ${LONGEST_SAMPLING / 60000} minutes.`;
    live.go(false);
  }

  // What is wrong, with lines and columns; each leads to its place.
  tell(problems) {
    this.problems.replaceChildren(...problems.map(({ line, column, key, message }) => {
      const item = document.createElement('li'), place = document.createElement('button');
      if (line) {
        place.textContent = `${line}:${column}`;
        place.title = 'Go there';
        place.addEventListener('click', () => this.goTo(line, column));
        item.append(place, ' ');
      }
      item.append(key ? `${key}: ${message}` : message);
      return item;
    }));
  }

  goTo(line, column) {
    const lines = this.text.value.split('\n'), start = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    const at = start + [...lines[line - 1]].slice(0, column - 1).join('').length;
    this.text.focus();
    this.text.setSelectionRange(at, at);
    this.text.scrollTop = Math.max(0, (line - 5) * parseFloat(getComputedStyle(this.text).lineHeight));
  }

  key(event) {
    if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) { event.preventDefault(); this.hide(); this.start(); return; }
    if (event.key === ' ' && event.ctrlKey) { event.preventDefault(); this.suggest(true); return; }
    if (this.completion.hidden) return;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) this.mark((this.marked + step + this.offers.length) % this.offers.length);
    else if (event.key === 'Enter' && this.marked >= 0) this.take(this.marked);
    else if (event.key === 'Escape') this.hide();
    else return;
    event.preventDefault();
  }

  // Keys or words that may stand at the cursor.
  suggest(always = false) {
    const { text, completion } = this, at = text.selectionStart, { table, typed, kind, key } = placeIn(text.value.slice(0, at));
    const part = this.live.schemaTree && table && partAt(this.live.schemaTree, table);
    const inner = part && kind === 'value' ? resolved(this.live.schemaTree, part.properties?.[key]) : part;
    const all = !inner ? [] : kind === 'value' ? wordsOf(inner).map((name) => ({ name: `"${name}"`, about: '' })) : Object.entries(inner.properties ?? {}).map(([name, one]) => ({ name, about: resolved(this.live.schemaTree, one).description ?? '' }));
    const known = inner?.properties?.[typed];
    this.meaning.textContent = kind === 'value' && inner ? inner.description ?? '' : known ? resolved(this.live.schemaTree, known).description ?? '' : '';
    this.offers = all.filter(({ name }) => name.replace('"', '').startsWith(typed.replace('"', '')) && name !== typed).slice(0, 60);
    this.typed = typed;
    completion.hidden = !this.offers.length || !(always || typed);
    if (completion.hidden) { this.hide(); return; }
    completion.replaceChildren(...this.offers.map(({ name, about }, k) => {
      const option = Object.assign(document.createElement('li'), { id: `offer-${k}`, textContent: name, title: about });
      option.setAttribute('role', 'option');
      option.addEventListener('pointerdown', (event) => { event.preventDefault(); this.take(k); });
      return option;
    }));
    this.mark(-1);
    const before = text.value.slice(0, at).split('\n'), style = getComputedStyle(text), high = parseFloat(style.lineHeight);
    completion.style.top = `${Math.min(before.length * high + parseFloat(style.paddingTop) - text.scrollTop + 2, text.clientHeight)}px`;
    completion.style.left = `${Math.min(before.at(-1).length * 7.3 + 8, text.clientWidth - 220)}px`;
  }

  mark(k) {
    this.marked = k;
    [...this.completion.children].forEach((option, n) => option.setAttribute('aria-selected', n === k));
    this.completion.children[k]?.scrollIntoView({ block: 'nearest' });
    if (k >= 0) { this.text.setAttribute('aria-activedescendant', `offer-${k}`); this.meaning.textContent = this.offers[k].about; } else this.text.removeAttribute('aria-activedescendant');
  }

  take(k) {
    const { text, typed } = this, at = text.selectionStart;
    text.setRangeText(this.offers[k].name, at - typed.length, at, 'end');
    this.hide();
    text.focus();
  }

  hide() { this.completion.hidden = true; this.marked = -1; this.text.removeAttribute('aria-activedescendant'); }
}

// Where a text ends: in which table, a list of keys; whether a key or a value comes there, of which key; and what of it is typed.
function placeIn(text) {
  const start = text.lastIndexOf('\n') + 1, line = text.slice(start), header = line.match(/^\s*\[{1,2}\s*([\w.-]*)$/);
  if (line.includes('#')) return {};
  if (header) {
    const names = header[1].split('.'), typed = names.pop();
    return { table: names, typed, kind: 'key' };
  }
  const headers = [...text.slice(0, start).matchAll(/^\s*\[{1,2}\s*([\w.-]+)\s*\]{1,2}/gm)], table = headers.length ? headers.at(-1)[1].split('.') : [];
  // From the last line on that begins with a key: values may go on over several lines.
  const after = headers.length ? headers.at(-1).index + headers.at(-1)[0].length : 0, body = text.slice(after);
  const first = Math.max(0, ...[...body.matchAll(/^(?=[ \t]*[\w.-]+[ \t]*=|[ \t]*[\w.-]*$)/gm)].map(({ index }) => index).filter((index) => balanced(body.slice(0, index))));
  const open = [];
  let key = '', word = '', isValue = false;
  for (const letter of body.slice(first)) {
    if (letter === '=') { key = word.trim(); word = ''; isValue = true; } else if (letter === '{') { open.push(isValue ? key.split('.') : []); word = ''; key = ''; isValue = false; } else if (letter === '[') { open.push(isValue ? key.split('.') : []); word = ''; key = ''; isValue = false; } else if (letter === '}' || letter === ']') { open.pop(); word = ''; isValue = true; } else if (letter === ',') { word = ''; isValue = false; } else if (letter === '\n' && !open.length) { word = ''; isValue = false; } else word += letter;
  }
  return { table: [...table, ...open.flat()].filter(Boolean), typed: word.trimStart(), kind: isValue ? 'value' : 'key', key };
}

// Whether all brackets are closed.
function balanced(text) {
  let depth = 0;
  for (const letter of text.replace(/#.*|"[^"\n]*"/g, '')) depth += '[{'.includes(letter) ? 1 : ']}'.includes(letter) ? -1 : 0;
  return depth <= 0;
}

// The part of the schema at a list of keys; entries of lists have no key.
function partAt(schema, keys) {
  let part = resolved(schema, schema);
  for (const key of keys) {
    part = part && resolved(schema, part.properties?.[key]);
    while (part?.items || part?.anyOf) part = part.items ? resolved(schema, part.items) : resolved(schema, part.anyOf.find((one) => one.$ref || one.type === 'object'));
  }
  return part;
}
