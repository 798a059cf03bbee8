// Filters and order.

class Filters {
  constructor(app) {
    this.app = app;
    this.box = document.getElementById('filters');
    this.variables = this.list();
    this.chains = new Set(app.solutions.map((s) => s.chain));
    this.starredOnly = false;
    this.order = 'different';
    this.spans = new Map();
    this.build();
  }

  // Everything a solution can be filtered and sorted by.
  list() {
    const { meta } = this.app;
    const fixed = [
      { name: 'log p', of: (s) => s.log_p }, { name: 'log constraint', of: (s) => s.log_constraint },
      { name: 'iteration', of: (s) => s.iteration, whole: true }, { name: 'duration', unit: 's', of: (s) => s.duration },
    ];
    const scalars = meta.scalars.map(({ name, unit, draw }, k) => ({ name, unit, draw, of: (s) => s.scalars[k] ?? NaN }));
    const asked = [...new Set(this.app.solutions.flatMap((s) => s.asked.map(({ what }) => what)))].map((what) => ({
      name: what, unit: 's', of: (s) => s.asked.find((one) => one.what === what)?.found ?? NaN,
    }));
    // Outcomes come before random variables.
    return [...fixed, ...asked, ...scalars.filter((s) => !s.draw), ...scalars.filter((s) => s.draw)].map((v) => this.ranged(v));
  }

  ranged(variable) {
    const values = this.app.solutions.map(variable.of).filter(Number.isFinite);
    return { ...variable, low: Math.min(...values), high: Math.max(...values), values };
  }

  // Makes room for one more solution.
  include(solution) {
    this.chains.add(solution.chain);
    for (const variable of this.variables) {
      const value = variable.of(solution);
      if (Number.isFinite(value)) variable.values.push(value);
    }
  }

  // Ranges anew, once there are more solutions; unless someone uses them.
  again() {
    const { app, box, order } = this, isUsed = order !== 'different' || app.passing.size + 1 < app.solutions.length || box.contains(document.activeElement);
    if (isUsed) return;
    box.replaceChildren();
    Object.assign(this, { variables: this.list(), spans: new Map() });
    this.build();
  }

  build() {
    const { box, variables, app } = this;
    const count = document.createElement('strong');
    count.id = 'count';
    const sort = this.select('sort', 'Order', [['different', 'most different first'], ...(app.meta.live ? [['new', 'newest first']] : []), ...variables.flatMap(({ name }, k) => [[`+${k}`, `${told(name)} ↑`], [`-${k}`, `${told(name)} ↓`]])]);
    sort.addEventListener('change', () => { this.order = sort.value; this.apply(); });
    const stars = this.button('only-starred', '★ only', 'Only starred solutions');
    stars.addEventListener('click', () => { this.starredOnly = stars.classList.toggle('on'); this.apply(); });
    const all = this.button('animate-all', 'Animate all', 'Animate all visible tiles (a)');
    all.addEventListener('click', () => app.setAnimateAll(!app.animateAll));
    box.append(count, this.label('Order', sort), stars, all);
    if (this.chains.size > 1) box.append(this.chainButtons());
    for (const k of [0, 1]) this.addSpan(variables[k]);
    const more = this.select('more', 'Filter by', [['', 'filter by …'], ...variables.slice(2).map(({ name }, k) => [String(k + 2), told(name)])]);
    more.addEventListener('change', () => {
      if (more.value) this.addSpan(variables[more.value]);
      more.value = '';
    });
    box.append(more);
    const clear = this.button('clear', 'Clear', 'Remove all filters');
    clear.classList.remove('toggle');
    clear.addEventListener('click', () => this.clear());
    box.append(clear);
  }

  chainButtons() {
    const group = document.createElement('div'), all = [...this.chains].sort((a, b) => a - b);
    group.className = 'choice';
    group.id = 'chains';
    for (const chain of all) {
      const button = this.button(`chain-${chain}`, String(chain), `Chain ${chain}`);
      button.classList.add('on');
      button.addEventListener('click', () => {
        if (button.classList.toggle('on')) this.chains.add(chain); else this.chains.delete(chain);
        this.apply();
      });
      group.append(button);
    }
    return this.label('Chains', group);
  }

  // A range with a histogram and two handles.
  addSpan(variable) {
    if (this.spans.has(variable) || !(variable.high > variable.low)) return;
    const span = document.createElement('div');
    span.className = 'span';
    span.dataset.name = variable.name;
    span.innerHTML = '<span></span><output></output><div class="double"><canvas></canvas><input type="range"><input type="range"></div><output></output>';
    span.firstElementChild.textContent = told(variable.name);
    const [low, high] = span.querySelectorAll('input'), [first, last] = span.querySelectorAll('output');
    const show = (value) => (variable.whole ? String(Math.round(value)) : short(value));
    const step = variable.whole ? 1 : 'any';
    for (const [input, value, name] of [[low, variable.low, 'lowest'], [high, variable.high, 'highest']]) {
      Object.assign(input, { min: variable.low, max: variable.high, step });
      input.value = value;
      input.setAttribute('aria-label', `${name} ${told(variable.name)}`);
      input.addEventListener('input', () => {
        if (+low.value > +high.value) (input === low ? (low.value = high.value) : (high.value = low.value));
        update();
        this.apply();
      });
    }
    // Rounding of the handles must not exclude the ends.
    const slack = 1e-6 * (variable.high - variable.low);
    const limits = () => [+low.value <= variable.low + slack ? -Infinity : +low.value, +high.value >= variable.high - slack ? Infinity : +high.value];
    const update = () => { first.textContent = show(+low.value); last.textContent = `${show(+high.value)} ${variable.unit ?? ''}`; };
    update();
    const reset = () => { low.value = variable.low; high.value = variable.high; update(); };
    this.spans.set(variable, { limits, reset });
    const more = document.getElementById('more');
    if (more) this.box.insertBefore(span, more); else this.box.append(span);
    this.histogram(span.querySelector('canvas'), variable);
  }

  histogram(canvas, { values, low, high }) {
    Object.assign(canvas, { width: 118, height: 26 });
    const bins = new Array(24).fill(0), pen = canvas.getContext('2d');
    for (const value of values) bins[Math.min(23, Math.floor((24 * (value - low)) / (high - low)))]++;
    pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--soft');
    bins.forEach((count, k) => pen.fillRect((118 * k) / 24, 26, 118 / 24 - 1, (-26 * count) / Math.max(...bins)));
  }

  passes(solution) {
    if (!this.chains.has(solution.chain) || (this.starredOnly && !this.app.starred.has(solution.id))) return false;
    for (const [variable, { limits }] of this.spans) {
      const [low, high] = limits(), value = variable.of(solution);
      if ((low !== -Infinity || high !== Infinity) && !(value >= low && value <= high)) return false;
    }
    return true;
  }

  apply() {
    const { app } = this, passing = app.solutions.filter((s) => this.passes(s));
    if (this.order === 'new') passing.reverse();
    else if (this.order !== 'different') {
      const sign = this.order[0] === '-' ? -1 : 1, { of } = this.variables[this.order.slice(1)];
      passing.sort((a, b) => sign * (of(a) - of(b)));
    }
    document.getElementById('count').textContent = `${passing.length} of ${app.solutions.length} solutions`;
    app.show(passing);
  }

  // What a tile says of a solution: the number that tiles are ordered by, or how long it takes.
  caption(solution) {
    const { name, unit, whole, of } = this.variables[this.order.slice(1)] ?? {}, value = of?.(solution);
    if (!of || name === 'duration') return `${solution.duration.toFixed(2)} s`;
    return Number.isFinite(value) ? `${whole ? value : short(value)}${unit ? ` ${unit}` : ''}` : '–';
  }

  clear() {
    for (const { reset } of this.spans.values()) reset();
    this.chains = new Set(this.app.solutions.map((s) => s.chain));
    this.box.querySelectorAll('#chains button').forEach((button) => button.classList.add('on'));
    this.starredOnly = false;
    document.getElementById('only-starred').classList.remove('on');
    this.apply();
  }

  button(id, text, title) {
    const button = document.createElement('button');
    Object.assign(button, { id, textContent: text, title, className: 'toggle' });
    return button;
  }

  select(id, title, options) {
    const select = document.createElement('select');
    Object.assign(select, { id, title });
    select.setAttribute('aria-label', title);
    select.append(...options.map(([value, text]) => new Option(text, value)));
    return select;
  }

  label(text, element) {
    const label = document.createElement(element.tagName === 'SELECT' ? 'label' : 'div');
    if (element.tagName !== 'SELECT') Object.assign(label, { className: 'span' });
    label.append(`${text} `, element);
    return label;
  }
}

// Three digits; 0 for a value that is only rounding error.
function short(value) {
  return Math.abs(value) < 5e-4 ? '0' : String(+value.toPrecision(3));
}
