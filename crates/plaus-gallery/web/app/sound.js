// Sound of a solution: how things are struck and rubbed, and how they ring. Model and numbers are those of exported
// sound (docs/sound.md). Here it is computed on demand, and off by default.

// Samples a second; silence after the last moment, in s; size of what roughness consists of, in m; the loudest moment.
const RATE = 48000, TAIL = 0.6, GRAIN = 1e-3, LOUDEST = 0.891;
// Samples over which rolling and slipping fade in and out.
const EDGE = 48;
// The sound restarts if it is farther than this from the picture, in s of listening.
const APART = 0.12;

class Sound {
  constructor(things) {
    this.things = things;
    this.on = false;
    this.button = document.getElementById('sound');
    this.button.addEventListener('click', () => this.toggle());
  }

  toggle() {
    this.on = !this.on;
    this.button.classList.toggle('on', this.on);
    this.button.setAttribute('aria-pressed', this.on);
    if (this.on) this.context ??= new AudioContext({ sampleRate: RATE });
    else this.stop();
  }

  // Plays the sound of a solution from a time on; `null` starts nothing.
  follow(solution, time, speed) {
    if (!this.on || time === null) return;
    const { playing, context } = this;
    if (playing && playing.solution === solution && playing.speed === speed) {
      const heard = playing.from + (context.currentTime - playing.begun) * speed;
      if (Math.abs(heard - time) < APART * speed) return;
    }
    this.stop();
    const source = new AudioBufferSourceNode(context, { buffer: this.buffer(solution), playbackRate: speed });
    source.connect(context.destination);
    if (this.heardBy) source.connect(this.heardBy);
    source.start(0, time);
    this.playing = { source, solution, speed, from: time, begun: context.currentTime };
  }

  // What is heard, for a recording.
  tracks() {
    this.heardBy ??= new MediaStreamAudioDestinationNode(this.context);
    return this.heardBy.stream.getAudioTracks().map((track) => track.clone());
  }

  stop() {
    this.playing?.source.stop();
    this.playing = null;
  }

  // Pressure a metre away, in Pa, sample by sample.
  heard(solution) { return pressure(solution, this.things); }

  // The last one played is kept.
  buffer(solution) {
    if (this.last?.solution !== solution) {
      const air = this.heard(solution);
      const loudest = air.reduce((most, x) => Math.max(most, Math.abs(x)), 1e-30);
      const buffer = this.context.createBuffer(1, air.length, RATE);
      buffer.copyToChannel(Float32Array.from(air, (x) => (x * LOUDEST) / loudest), 0);
      this.last = { solution, buffer };
    }
    return this.last.buffer;
  }
}

function pressure(solution, things) {
  const count = Math.ceil((solution.duration + TAIL) * RATE), forces = new Map(), air = new Float64Array(count);
  const force = (thing) => forces.get(thing) ?? forces.set(thing, new Float64Array(count)).get(thing);
  for (const { start, length, impulse, pair } of solution.strikes) pair.forEach((thing) => strike(force(thing), start, length, impulse));
  solution.rubbing.forEach(({ start, end, kinds, pair }, number) => kinds.forEach(([speed, strength], kind) => {
    for (const thing of pair) rub(force(thing), start, end, speed, strength, 2 * number + kind);
  }));
  for (const [thing, pressed] of forces) {
    const { click, modes } = things[thing];
    if (click) for (let k = 1; k < count; k++) air[k] += click * RATE * (pressed[k] - pressed[k - 1]);
    for (const mode of modes) ring(mode, pressed, air);
  }
  return air;
}

// Half a sine wave; each sample has its mean over the sample.
function strike(force, start, length, impulse) {
  const soFar = (t) => 0.5 * (1 - Math.cos(Math.PI * Math.min(Math.max(t / length, 0), 1)));
  const last = Math.min(Math.ceil((start + length) * RATE), force.length - 1);
  for (let k = Math.max(Math.floor(start * RATE), 0); k <= last; k++) {
    force[k] += impulse * (soFar((k + 1) / RATE - start) - soFar(k / RATE - start)) * RATE;
  }
}

// A random force that follows grains of a surface. It comes and goes within a millisecond around its ends.
function rub(force, start, end, speed, strength, noise) {
  if (!(speed > 0 && strength > 0)) return;
  const first = Math.max(Math.floor(start * RATE - EDGE / 2), 0), last = Math.min(Math.floor(end * RATE + EDGE / 2), force.length);
  const step = Math.min(speed / GRAIN / RATE, 1);
  for (let k = first; k < last; k++) {
    const along = (k - first) * step, grain = Math.floor(along), smooth = 0.5 * (1 - Math.cos(Math.PI * (along - grain)));
    const a = uneven(noise, grain), b = uneven(noise, grain + 1), edge = Math.min(Math.min(k - first, last - 1 - k) / EDGE, 1);
    force[k] += strength * edge * (a + (b - a) * smooth);
  }
}

// A number from -1 to 1 for each index: a hash (Wellons, "lowbias32").
function uneven(noise, place) {
  let x = (Math.imul(noise + 1, 0x9e3779b1) + place) | 0;
  x = Math.imul(x ^ (x >>> 16), 0x21f0aaad);
  x = Math.imul(x ^ (x >>> 15), 0x735a2d97);
  return ((x ^ (x >>> 15)) >>> 0) / 2147483648 - 1;
}

// A resonator that a force drives.
function ring([omega, fades, loud], force, air) {
  const decay = Math.exp(-fades / RATE), first = 2 * decay * Math.cos(omega / RATE), second = -decay * decay, factor = loud / RATE;
  let before = 0, last = 0;
  for (let k = 0; k < force.length; k++) {
    const now = first * last + second * before + force[k];
    air[k] += factor * (now - last * decay);
    before = last;
    last = now;
  }
}
