// The player: time, the scrubber with impacts marked, and the 3D view of the chosen solution.

// How much slower it is around strong impacts; which are strong, as a share of the fastest; the most of them, how far apart they are, and what is
// slow before and after one, in s of the animation.
const SLOW = 1 / 6, STRONG = 0.3, MOST_STRONG = 8, STRONG_APART = 0.15, SLOW_BEFORE = 0.05, SLOW_AFTER = 0.1;

class Player {
  constructor(app) {
    this.app = app;
    this.time = 0;
    this.playing = false;
    this.rest = 0;
    this.canvas = document.getElementById('stage');
    this.marks = document.getElementById('marks');
    this.scrub = document.getElementById('scrub');
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => { this.stale = true; app.wake(); });
    this.controls.addEventListener('start', () => { this.touched = this.turning = true; });
    this.controls.addEventListener('end', () => { this.turning = false; this.stale = true; app.wake(); });
    this.stale = true;
    document.getElementById('play').addEventListener('click', () => this.toggle());
    document.getElementById('view-reset').addEventListener('click', () => this.reset());
    document.getElementById('trails').addEventListener('click', () => app.toggleTrails());
    this.sound = new Sound(app.meta.sounds);
    this.speed = document.getElementById('speed');
    this.speed.value = this.gentle();
    this.speed.addEventListener('change', () => app.gif.tell());
    this.scrub.addEventListener('input', () => { this.pause(); this.seek(+this.scrub.value); });
    new ResizeObserver(() => { this.fit(); this.drawMarks(); app.gif.tell(); }).observe(this.canvas);
    this.view = new Camera(this);
    this.view.offer(app.a);
    this.slow = document.getElementById('slow');
    this.slow.addEventListener('click', () => this.toggleSlow());
    this.reset();
  }

  get duration() { return Math.max(this.app.a.duration, this.app.b?.duration ?? 0); }

  // Very short animations are shown slowly at first.
  gentle() {
    const durations = this.app.solutions.map((s) => s.duration).sort((a, b) => a - b), middle = durations[durations.length >> 1];
    return middle < 0.8 ? '0.25' : middle < 1.6 ? '0.5' : '1';
  }

  // Keeps the direction and distance that the user chose; otherwise fits the view again.
  fit() {
    const aspect = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    if (!this.touched) return this.reset();
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.stale = true;
    this.app.wake();
  }

  reset() {
    this.app.views.fitted(this.camera, this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1), this.view.from);
    const { low, high } = this.app.stage.frame;
    this.controls.target.copy(low).lerp(high, 0.5);
    this.view.approach();
    this.controls.update();
    this.touched = false;
    this.stale = true;
    this.app.wake();
  }

  // A solution was chosen: plays it from the start.
  load(play) {
    this.scrub.max = this.duration;
    this.view.offer(this.app.a);
    this.seek(0);
    this.drawMarks();
    if (play) this.play();
  }

  play() {
    if (this.time >= this.duration) this.time = 0;
    this.playing = true;
    this.rest = 0;
    this.label();
    this.app.wake();
  }

  pause() {
    this.playing = false;
    this.app.recorder?.stop(false);
    this.sound.stop();
    this.stale = true;
    this.app.wake();
    this.label();
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  label() { document.getElementById('play').textContent = this.playing ? '❚❚' : '▶'; }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.scrub.value = this.time;
    document.getElementById('clock').textContent = `${this.time.toFixed(2)} / ${this.duration.toFixed(2)} s`;
    this.stale = true;
    this.app.wake();
  }

  // To the previous or next impact.
  jump(direction) {
    const times = this.app.a.impacts.map((hit) => hit.time), slack = 1e-4;
    const target = direction > 0 ? times.find((t) => t > this.time + slack) : times.findLast((t) => t < this.time - slack);
    this.pause();
    this.seek(target ?? (direction > 0 ? this.duration : 0));
  }

  // Seconds of motion in a second of the clock.
  get rate() { return this.rateAt(this.time); }

  rateAt(time) { return +this.speed.value * (this.isSlow && isNear(this.app.a, time) ? SLOW : 1); }

  toggleSlow() {
    this.isSlow = this.slow.classList.toggle('on');
    this.slow.setAttribute('aria-pressed', this.isSlow);
    this.app.gif.tell();
  }

  step(seconds) {
    const { app, playing, time, duration, rate } = this;
    this.sound.follow(app.a, playing && time < duration ? time : null, rate);
    if (!this.playing) return;
    if (this.time >= this.duration) {
      this.rest += seconds;
      if (this.rest > 0.8) { this.rest = 0; app.recorder.stop(true); this.seek(0); }
      return;
    }
    this.seek(this.time + seconds * rate);
  }

  job() {
    const { app } = this;
    if (!this.stale) return null;
    this.view.follow();
    this.stale = false;
    return { canvas: this.canvas, camera: this.camera, solution: app.a, other: app.b, time: this.time, trails: app.trails, until: true, flash: true, moving: this.playing || this.turning, cut: this.view.cut };
  }

  // Impacts are ticks, taller for faster impacts. Times asked for are diamonds, their windows bars.
  drawMarks() {
    const { marks, app } = this, ratio = window.devicePixelRatio || 1, width = marks.clientWidth, height = marks.clientHeight;
    if (!width) return;
    Object.assign(marks, { width: width * ratio, height: height * ratio });
    const pen = marks.getContext('2d'), css = getComputedStyle(document.documentElement), handle = 6;
    pen.scale(ratio, ratio);
    pen.fillStyle = css.getPropertyValue('--line');
    pen.fillRect(0, height / 2 - 2, width, 4);
    const rows = [[app.a, '--accent', -1], [app.b, '--b', 1]];
    for (const [solution, colour, side] of rows) {
      if (!solution) continue;
      const strongest = Math.max(1e-9, ...solution.impacts.map((hit) => hit.speed));
      pen.fillStyle = css.getPropertyValue(colour);
      pen.globalAlpha = solution.impacts.length > 200 ? 0.35 : 0.85;
      for (const { time, speed } of solution.impacts) {
        const tall = (height / 2 - 3) * (strongest > 1e-9 ? 0.25 + 0.75 * Math.sqrt(speed / strongest) : 0.6);
        const x = handle + ((width - 2 * handle) * time) / this.duration;
        pen.fillRect(x - 0.75, side < 0 ? height / 2 - tall : height / 2, 1.5, tall);
      }
      pen.globalAlpha = 1;
      this.drawAsked(pen, solution, (time) => handle + ((width - 2 * handle) * time) / this.duration, height, side);
    }
  }

  drawAsked(pen, { asked }, place, height, side) {
    const edge = side < 0 ? 4 : height - 4, clamp = (time, open) => Math.min(Math.max(time ?? open, 0), this.duration);
    for (const { from, to, found } of asked) {
      if (from !== null || to !== null) {
        const left = place(clamp(from, 0)), right = place(clamp(to, this.duration));
        pen.globalAlpha = 0.3;
        pen.fillRect(left, edge - 2, Math.max(right - left, 1), 4);
        pen.globalAlpha = 1;
      }
      if (!Number.isFinite(found)) continue;
      const x = place(found);
      pen.beginPath();
      for (const [dx, dy] of [[0, -4], [4, 0], [0, 4], [-4, 0]]) pen.lineTo(x + dx, edge + dy);
      pen.fill();
    }
  }
}

// The strongest impacts of a solution.
function strongOf(solution) {
  if (!solution.strong) {
    const fast = [...solution.impacts].sort((a, b) => b.speed - a.speed), strong = [];
    for (const { time, speed } of fast) {
      if (strong.length === MOST_STRONG || speed < STRONG * fast[0].speed) break;
      if (strong.every((other) => Math.abs(other - time) >= STRONG_APART)) strong.push(time);
    }
    solution.strong = strong;
  }
  return solution.strong;
}

// Whether a strong impact is near in time.
function isNear(solution, time) { return strongOf(solution).some((hit) => time > hit - SLOW_BEFORE && time < hit + SLOW_AFTER); }
