// What must happen, to change on the page: a form of the requirements, and handles on the stage for those that have a place.

// What a requirement is about, rather than how strictly it is meant: always shown.
const ABOUT = /^(x_mm|y_mm|z_mm|centre_mm|face|axis|pins|leave|text|target|at_least|at_most|[a-z]+_s)$/;
// Names of things, which are not to change.
const NAMES = new Set(['body', 'with', 'on', 'to', 'of', 'joint', 'name', 'region']);

// A part of the schema with its references resolved.
function resolved(schema, part) {
  let whole = part ?? {};
  while (whole.$ref) whole = { ...schema.$defs[whole.$ref.split('/').pop()], ...whole, $ref: undefined };
  const others = whole.anyOf?.filter((one) => one.type !== 'null');
  if (others?.length === 1) whole = { ...resolved(schema, others[0]), ...whole, anyOf: undefined };
  return whole;
}

// The words that a value may be; empty if it may be others.
function wordsOf(part) {
  if (part.const !== undefined) return [part.const];
  return (part.oneOf ?? []).flatMap((one) => wordsOf(one));
}

const plainly = (key) => key.replace(/_(mm|s|ms|deg)$/, '').replaceAll('_', ' ');

// All values of a scenario that say what must happen: those that the schema marks as goals, and all below `require`.
function wishes(schema, value, part = schema, at = '', isGoal = false, group = '') {
  const whole = resolved(schema, part);
  if (Array.isArray(value) && value.some((one) => typeof one === 'object')) {
    return value.flatMap((one, k) => wishes(schema, one, whole.items, `${at}/${k}`, isGoal, group));
  }
  if (value && typeof value === 'object' && !Array.isArray(value)) {
    return Object.entries(value).flatMap(([key, inner]) => {
      const piece = whole.properties?.[key], isTable = inner && typeof inner === 'object' && !Array.isArray(inner);
      return wishes(schema, inner, piece, `${at}/${key}`, isGoal || piece?.['x-goal'] === true || `${at}/${key}` === '/require', isTable ? plainly(key) : group);
    });
  }
  const key = at.split('/').pop();
  if (!isGoal || NAMES.has(key) || value === null) return [];
  const isUsual = JSON.stringify(value) === JSON.stringify(whole.default) && !ABOUT.test(key);
  return [{ at, key, value, group, isUsual, unit: whole['x-unit'] ?? '', about: whole.description ?? '', words: wordsOf(whole), isWhole: [whole.type].flat().includes('integer'), items: resolved(schema, whole.items) }];
}

class Steer {
  constructor(live) {
    this.live = live;
    this.box = document.getElementById('steer');
    this.form = document.getElementById('wishes');
    this.form.addEventListener('submit', (event) => event.preventDefault());
    this.handles = [];
  }

  // Shows the requirements of a scenario.
  show(scenario) {
    const all = wishes(this.live.schemaTree, scenario), groups = new Map();
    this.all = all;
    this.inputs = new Map();
    for (const wish of all) {
      const table = wish.at.slice(0, wish.at.lastIndexOf('/'));
      if (!groups.has(table)) groups.set(table, []);
      groups.get(table).push(wish);
    }
    const numbered = new Map();
    this.form.replaceChildren(...[...groups].map(([table, some]) => {
      const set = document.createElement('fieldset'), legend = document.createElement('legend'), more = document.createElement('details'), summary = document.createElement('summary');
      const name = some[0].group || 'goal', count = (numbered.get(name) ?? 0) + 1;
      numbered.set(name, count);
      legend.textContent = count > 1 ? `${name} (${count})` : name;
      summary.textContent = 'more';
      more.append(summary, ...some.filter((wish) => wish.isUsual).map((wish) => this.field(wish)));
      set.append(legend, ...some.filter((wish) => !wish.isUsual).map((wish) => this.field(wish)), ...(more.childElementCount > 1 ? [more] : []));
      return set;
    }));
    this.box.hidden = !all.length;
    this.makeHandles(groups, numbered);
  }

  field(wish) {
    const label = document.createElement('label'), problem = document.createElement('span'), id = `wish${wish.at}`;
    const input = document.createElement(wish.words.length ? 'select' : 'input');
    if (wish.words.length) input.append(...wish.words.map((word) => new Option(word)));
    if (typeof wish.value === 'boolean') { input.type = 'checkbox'; input.checked = wish.value; } else input.value = Array.isArray(wish.value) ? wish.value.join(', ') : wish.value;
    if (typeof wish.value === 'number') input.inputMode = 'decimal';
    Object.assign(input, { id, name: wish.at, title: wish.about });
    problem.className = 'problem';
    problem.id = `${id}-problem`;
    problem.setAttribute('role', 'alert');
    input.setAttribute('aria-describedby', problem.id);
    label.append(`${plainly(wish.key)}${wish.unit ? ` (${wish.unit})` : ''} `, input, problem);
    input.addEventListener('change', () => this.ask([{ at: wish.at, value: this.typed(wish, input) }]));
    this.inputs.set(wish.at, { input, problem });
    return label;
  }

  // What was typed, as the scenario holds it; what is no number stays a text, and the sampler says so.
  typed({ value }, input) {
    const number = (text) => (text.trim() !== '' && Number.isFinite(+text) ? +text : text);
    if (typeof value === 'boolean') return input.checked;
    // Formulas may have blanks in them.
    if (Array.isArray(value)) return input.value.split(value.some((one) => /\s/.test(one)) ? /\s*[,;]\s*/ : /[\s,;]+/).filter(Boolean).map(number);
    return typeof value === 'number' ? number(input.value) : input.value;
  }

  ask(edits) {
    for (const { input, problem } of this.inputs.values()) { problem.textContent = ''; input.removeAttribute('aria-invalid'); }
    this.asked = edits;
    this.live.edit(edits);
  }

  // Beside the fields that they are about; else beside what was changed.
  refuse(problems) {
    for (const { key, message } of problems) {
      const at = `/${key.replaceAll('.', '/').replace(/\[(\d+)\]/g, '/$1')}`;
      const { input, problem } = this.inputs.get(at) ?? this.inputs.get(this.asked[0].at);
      problem.textContent = message;
      input.setAttribute('aria-invalid', 'true');
    }
    this.box.open = true;
  }

  // Places of requirements as handles: a point, the middle of a box, the centre of a ball.
  makeHandles(groups, numbered) {
    const box = document.getElementById('handles');
    this.handles = [];
    for (const [table, some] of groups) {
      const value = Object.fromEntries(some.map((wish) => [wish.key, wish.value]));
      const [x, y] = value.centre_mm ? [value.centre_mm[0], value.centre_mm[1]] : [value.x_mm, value.y_mm];
      const middle = (one) => (Array.isArray(one) ? (one[0] + one[1]) / 2 : one);
      if (![x, y].every((one) => Number.isFinite(middle(one)))) continue;
      const z = value.centre_mm?.[2] ?? middle(value.z_mm) ?? 0, name = some[0].group;
      const handle = { table, value, name, at: [middle(x), middle(y), Number.isFinite(z) ? z : 0] };
      handle.button = Object.assign(document.createElement('button'), { className: 'handle', title: `${name}: drag it, or use the arrow keys` });
      this.describe(handle);
      handle.button.addEventListener('pointerdown', (event) => this.drag(handle, event));
      handle.button.addEventListener('keydown', (event) => this.nudge(handle, event));
      this.handles.push(handle);
    }
    box.replaceChildren(...this.handles.map(({ button }) => button));
    this.place();
  }

  describe({ button, name, at }) { button.setAttribute('aria-label', `${name}: x ${at[0].toFixed(0)} mm, y ${at[1].toFixed(0)} mm; arrow keys move it`); }

  // Scenarios have z up and millimetres, the stage y up and metres.
  place() {
    const { player } = this.live.app, box = document.getElementById('handles');
    if (!player) return;
    if (this.handles.length && !box.childElementCount) box.replaceChildren(...this.handles.map(({ button }) => button));
    const { camera, canvas } = player;
    for (const { button, at } of this.handles) {
      const seen = new THREE.Vector3(at[0] / 1000, at[2] / 1000, -at[1] / 1000).project(camera);
      button.hidden = Math.abs(seen.z) > 1 || Math.abs(seen.x) > 1 || Math.abs(seen.y) > 1;
      button.style.left = `${((seen.x + 1) / 2) * canvas.clientWidth}px`;
      button.style.top = `${((1 - seen.y) / 2) * canvas.clientHeight}px`;
    }
  }

  // Where a pointer meets the handle's level plane, in the scenario's millimetres.
  under(handle, event) {
    const { camera, canvas } = this.live.app.player, box = canvas.getBoundingClientRect();
    const along = new THREE.Vector3((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height, 0.5).unproject(camera).sub(camera.position);
    const far = (handle.at[2] / 1000 - camera.position.y) / along.y, met = along.multiplyScalar(far).add(camera.position);
    return far > 0 && Number.isFinite(far) ? [1000 * met.x, -1000 * met.z] : null;
  }

  drag(handle, event) {
    const { button } = handle, from = this.under(handle, event), begun = [...handle.at];
    if (!from) return;
    event.preventDefault();
    button.focus();
    button.setPointerCapture(event.pointerId);
    const move = (moved) => {
      const to = this.under(handle, moved);
      if (to) this.moveTo(handle, [begun[0] + to[0] - from[0], begun[1] + to[1] - from[1]]);
    };
    const end = () => {
      button.removeEventListener('pointermove', move);
      if (handle.at.some((one, k) => one !== begun[k])) this.commit(handle);
    };
    button.addEventListener('pointermove', move);
    button.addEventListener('lostpointercapture', end, { once: true });
  }

  nudge(handle, event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const size = event.shiftKey ? 20 : 5;
    this.moveTo(handle, [handle.at[0] + size * step[0], handle.at[1] + size * step[1]]);
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.commit(handle), 400);
  }

  moveTo(handle, [x, y]) {
    handle.at = [+x.toFixed(1), +y.toFixed(1), handle.at[2]];
    this.describe(handle);
    this.place();
    for (const { at, value } of this.edits(handle)) {
      const field = this.inputs.get(at);
      if (field) field.input.value = Array.isArray(value) ? value.join(', ') : value;
    }
  }

  edits({ table, value, at }) {
    if (value.centre_mm) return [{ at: `${table}/centre_mm`, value: [at[0], at[1], value.centre_mm[2]] }];
    const moved = (old, to) => (Array.isArray(old) ? old.map((end) => +(end + to - (old[0] + old[1]) / 2).toFixed(1)) : to);
    return [{ at: `${table}/x_mm`, value: moved(value.x_mm, at[0]) }, { at: `${table}/y_mm`, value: moved(value.y_mm, at[1]) }];
  }

  commit(handle) { this.ask(this.edits(handle)); }
}
