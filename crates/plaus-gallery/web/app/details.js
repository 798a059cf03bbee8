// Facts about the chosen solution, and actions on it.

// What statisticians call things.
const MEANING = {
  sample: 'its name in commands: the chain that found it, and its number there',
  'log p': 'how likely this solution is: the logarithm of its probability density times a constant; of two, the one with more is more likely',
  prior: 'the part of log p that the laws of the random numbers give', constraint: 'the part of log p that the requirements give',
  k: 'how much of what is asked for happens: pins that end as they should, or letters that are right',
  m: 'how many pins that should stand do stand, near their spots', pinfall: 'how many pins fell', board: 'the board of the lane on which the ball met the first pin, counted from the bowler’s right; 0 if it met none',
  impacts: 'how often things struck each other',
  chain: 'which of the samplers that work side by side found it', iteration: 'the step of that chain that found it',
};

// Names that need words beside them.
const CALLED = { k: 'as asked (k)', m: 'standing as asked (m)', board: 'first pin met at board', 'log p': 'how likely (log p)', '  prior': 'by the laws (prior)', '  constraint': 'by what is asked (constraint)' };

// What is shown for the name of a column: ‘rest_x_1’ is ‘rest x, no. 1’.
const told = (name) => CALLED[name] ?? name.replace(/_(\d+)(?=:|$)/, ', no. $1').replaceAll('_', ' ');

class Details {
  constructor(app) {
    this.app = app;
    this.box = document.getElementById('details');
  }

  show() {
    const { app, box } = this, { a, b, meta } = app;
    const at = (time) => (Number.isFinite(time) ? `at ${time.toFixed(3)} s` : 'never');
    const rows = [
      ...a.asked.map(({ what, found }) => [what, at(found), b && at(b.asked.find((one) => one.what === what)?.found)]),
      ...meta.scalars.map(({ name, unit }, k) => [name, a.scalars[k], b?.scalars[k], unit]),
      ['duration', `${a.duration.toFixed(2)} s`, b && `${b.duration.toFixed(2)} s`], ['impacts', a.hits, b?.hits],
      ['sample', a.id, b?.id], ['log p', a.log_p, b?.log_p], ['  prior', a.log_prior, b?.log_prior], ['  constraint', a.log_constraint, b?.log_constraint],
      ['chain', a.chain, b?.chain], ['iteration', a.iteration, b?.iteration],
    ];
    const show = (value) => (typeof value === 'number' && !Number.isInteger(value) ? value.toFixed(3) : String(value ?? '–'));
    const heading = document.createElement('h2'), list = document.createElement('dl'), buttons = document.createElement('div'), code = document.createElement('code');
    heading.textContent = b ? `A: ${a.name}, B: ${b.name}` : a.name;
    for (const [name, value, other, unit] of rows) {
      const dt = document.createElement('dt'), dd = document.createElement('dd');
      dt.textContent = `${told(name)}${unit ? ` (${unit})` : ''}`;
      dt.title = MEANING[name.trim()] ?? (unit === undefined ? '' : `${name} in tables`);
      dd.textContent = show(value);
      if (b) dd.append(Object.assign(document.createElement('i'), { textContent: show(other) }));
      list.append(dt, dd);
    }
    list.tabIndex = 0; // it scrolls
    buttons.className = 'buttons';
    const starred = app.starred.has(a.id);
    const add = (id, text, title, action) => {
      const button = Object.assign(document.createElement('button'), { id, textContent: text, title });
      button.addEventListener('click', () => action(button));
      buttons.append(button);
      return button;
    };
    add('star', starred ? '★ Starred' : '☆ Star', 'Star (s)', () => app.star(a)).classList.toggle('on', starred);
    add('compare', b ? 'End A/B' : 'Compare …', 'This one is A, the next one that you choose is B (b)', () => app.compare());
    add('download', 'Download GLB', 'The animation for Blender, Godot, browsers (d)', () => this.download());
    if (app.recorder.kind) add('video', app.recorder.recorder ? 'Stop recording' : 'Record video', 'Plays it once, at the chosen speed and camera, and saves a video (e)', () => app.recorder.toggle());
    add('gif', 'Download GIF', 'A loop at the chosen speed and camera (g)', () => app.gif.toggle());
    if (!a.live) add('embed', 'Copy embed', 'HTML that shows this clip alone, from this page', () => this.copy(this.embedding(a), 'embed'));
    add('copy', 'Copy command', 'The command that exports it (c)', () => this.copy());
    code.id = 'command';
    code.textContent = this.command(a);
    box.replaceChildren(heading, list, buttons, code);
    if (app.live?.samplers.size) {
      add('like', 'More like this', 'Workers go on from this solution, by small changes', () => app.live.like(a));
      add('unlike', 'Something else', 'Workers go on from the solutions least like this one', () => app.live.unlike(a));
    }
    const [file, gif] = ['glb-about', 'gif-about'].map((id) => Object.assign(document.createElement('p'), { id, className: 'hint' }));
    file.textContent = a.live ? 'The GLB is right to 0.2 mm and 0.03°.' : app.live?.keeper ? 'The GLB is the file that the command writes, to the byte.' :
      'The GLB is of the page’s own motion, right to about 1 mm and 1°; the command writes a smaller one, right to 0.2 mm and 0.03°.';
    code.before(file, gif);
    app.gif.tell();
    if (a.live) code.after(Object.assign(document.createElement('p'), { className: 'hint', textContent: `Found here: “Save” writes ${app.live.file}, from which this command rebuilds it.` }));
    const stars = app.solutions.filter((s) => app.starred.has(s.id) && !s.live);
    if (stars.length) {
      add('copy-starred', `Copy ${stars.length} ★`, 'The command that exports all starred solutions', () => this.copy(this.exporting(stars), 'copy-starred'));
    }
  }

  get run() {
    const { run } = this.app.meta;
    return /^[\w./:\\-]+$/.test(run) ? run : `'${run.replaceAll("'", "'\\''")}'`;
  }

  get until() {
    const { until } = this.app.meta;
    return until ? ` --until ${until}` : '';
  }

  command(solution) {
    if (solution.live) return `plaus replay ${this.app.live.file} --sample ${solution.id}`;
    const file = `sample-${solution.id.replace(':', '-')}.glb`;
    return `plaus export ${this.run} --format glb --sample ${solution.id}${this.until} --out ${file}`;
  }

  exporting(solutions) {
    return `plaus export ${this.run} --format glb ${solutions.map((s) => `--sample ${s.id}`).join(' ')}${this.until} --out starred`;
  }

  // Shows one clip of this page in another.
  embedding({ id, name }) {
    const page = location.pathname.split('/').pop() || 'gallery.html', view = this.app.player.view.view;
    const camera = view === 'first' ? '' : `&camera=${encodeURIComponent(view)}`;
    return `<iframe src="${page}?solution=${encodeURIComponent(id)}${camera}" width="640" height="400" title="${name}"></iframe>`;
  }

  copy(text = this.command(this.app.a), id = 'copy') {
    const done = (ok) => {
      const button = document.getElementById(id);
      if (!button) return;
      const before = button.textContent;
      button.textContent = ok ? 'Copied' : 'Select it below';
      setTimeout(() => { if (button.textContent !== before) button.textContent = before; }, 1200);
    };
    const byHand = () => {
      const area = Object.assign(document.createElement('textarea'), { value: text });
      document.body.append(area);
      area.select();
      const ok = document.execCommand('copy');
      area.remove();
      return ok;
    };
    if (navigator.clipboard) navigator.clipboard.writeText(text).then(() => done(true), () => done(byHand()));
    else done(byHand());
  }

  download() {
    const { app } = this;
    if (!app.live?.export(app.a)) this.give(app.a, glbOf(app, app.a));
  }

  give({ id }, glb) { save(new Blob([glb], { type: 'model/gltf-binary' }), `${this.app.meta.name}-${id.replace(':', '-')}.glb`); }
}
