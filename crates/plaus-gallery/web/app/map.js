// The map: a dot for each solution; dots of similar solutions are near each other.

const RAMP = ['#46337e', '#2a788e', '#22a884', '#7ad151', '#fde725'];

function ramp(share) {
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1), k = Math.min(Math.floor(at), RAMP.length - 2), t = at - k;
  const [a, b] = [RAMP[k], RAMP[k + 1]].map((hex) => [1, 3, 5].map((from) => parseInt(hex.slice(from, from + 2), 16)));
  return `rgb(${a.map((v, i) => Math.round(v + t * (b[i] - v)))})`;
}

class SolutionMap {
  constructor(app) {
    this.app = app;
    this.canvas = document.getElementById('map');
    this.kind = 'path';
    const spread = (kind) => Math.max(...app.solutions.map((s) => Math.hypot(...s[kind])));
    if (spread('path') < 1e-9) this.kind = 'outcome';
    const { canvas } = this;
    canvas.addEventListener('pointermove', (event) => app.hover(this.nearest(event), 'map', event));
    canvas.addEventListener('pointerleave', () => app.hover(null, 'map'));
    canvas.addEventListener('click', (event) => {
      const solution = this.nearest(event);
      if (solution) app.choose(solution, event.shiftKey);
    });
    for (const [id, kind] of [['map-paths', 'path'], ['map-outcomes', 'outcome']]) document.getElementById(id).addEventListener('click', () => this.show(kind));
    new ResizeObserver(() => this.draw()).observe(canvas);
    this.show(this.kind);
  }

  show(kind) {
    this.kind = kind;
    document.getElementById('map-paths').classList.toggle('on', kind === 'path');
    document.getElementById('map-outcomes').classList.toggle('on', kind === 'outcome');
    this.draw();
  }

  toggle() { this.show(this.kind === 'path' ? 'outcome' : 'path'); }

  // Positions of dots, in CSS pixels, with equal scales along both axes, so that distances can be compared.
  layout() {
    const { canvas, app, kind } = this, points = app.solutions.map((s) => s[kind]);
    const low = [0, 1].map((axis) => Math.min(...points.map((p) => p[axis]))), high = [0, 1].map((axis) => Math.max(...points.map((p) => p[axis])));
    const pad = 16, w = canvas.clientWidth - 2 * pad, h = canvas.clientHeight - 2 * pad;
    const scale = Math.min(w / Math.max(high[0] - low[0], 1e-9), h / Math.max(high[1] - low[1], 1e-9), 1e7);
    this.scale = scale;
    return points.map(([x, y]) => [
      canvas.clientWidth / 2 + scale * (x - (low[0] + high[0]) / 2), canvas.clientHeight / 2 - scale * (y - (low[1] + high[1]) / 2),
    ]);
  }

  nearest(event) {
    const box = this.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    let best = null, least = 22;
    this.layout().forEach(([px, py], index) => {
      const solution = this.app.solutions[index], distance = Math.hypot(px - x, py - y);
      if (distance < least && this.app.passing.has(solution)) { best = solution; least = distance; }
    });
    return best;
  }

  draw() {
    const { canvas, app } = this, ratio = window.devicePixelRatio || 1;
    if (!canvas.clientWidth) return;
    Object.assign(canvas, { width: Math.round(canvas.clientWidth * ratio), height: Math.round(canvas.clientHeight * ratio) });
    const pen = canvas.getContext('2d'), css = getComputedStyle(document.documentElement), colour = (name) => css.getPropertyValue(name).trim();
    pen.scale(ratio, ratio);
    const places = this.layout(), radius = app.solutions.length > 300 ? 3 : 5;
    this.drawScale(pen, colour('--soft'));
    app.solutions.forEach((solution, index) => {
      const [x, y] = places[index], passes = app.passing.has(solution);
      pen.globalAlpha = passes ? 1 : 0.15;
      pen.fillStyle = ramp(app.logShare(solution));
      pen.beginPath();
      pen.arc(x, y, radius, 0, 7);
      pen.fill();
      pen.lineWidth = 1;
      pen.strokeStyle = colour('--panel');
      pen.stroke();
      if (app.starred.has(solution.id)) { pen.fillStyle = '#e8b100'; pen.font = '13px sans-serif'; pen.fillText('★', x + 4, y - 4); }
      pen.globalAlpha = 1;
      const ring = solution === app.a ? '--accent' : solution === app.b ? '--b' : solution === app.hovered ? '--text' : null;
      if (ring) {
        pen.strokeStyle = colour(ring);
        pen.lineWidth = 2.5;
        pen.beginPath();
        pen.arc(x, y, radius + 4, 0, 7);
        pen.stroke();
      }
    });
  }

  // A scale bar for distances on the map.
  drawScale(pen, colour) {
    const wanted = 60 / this.scale, power = 10 ** Math.floor(Math.log10(wanted)), step = [1, 2, 5, 10].map((n) => n * power).reduce((a, b) => (Math.abs(b - wanted) < Math.abs(a - wanted) ? b : a));
    const length = step * this.scale, y = this.canvas.clientHeight - 6;
    document.getElementById('map-unit').textContent = Number.isFinite(length) && length < 250 ? `bar: ${metres(step)} apart (RMS)` : '';
    if (!(length < 250)) return;
    pen.strokeStyle = colour;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(8, y - 4); pen.lineTo(8, y); pen.lineTo(8 + length, y); pen.lineTo(8 + length, y - 4);
    pen.stroke();
  }
}

function metres(x) {
  return x >= 1 ? `${+x.toPrecision(2)} m` : x >= 0.01 ? `${+(100 * x).toPrecision(2)} cm` : `${+(1000 * x).toPrecision(2)} mm`;
}
