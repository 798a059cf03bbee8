// Solutions: closed-form pieces of motion, evaluated at any time.

class Solution {
  constructor(meta, bytes, index) {
    Object.assign(this, meta.samples[index]);
    this.index = index;
    this.meta = meta;
    this.bytes = bytes;
    this.columns = null;
  }

  // What people call it.
  get name() { return `Clip ${this.index + 1}`; }

  // Unpacks on first use.
  open() {
    if (this.columns) return this.columns;
    const meta = this.meta, columns = new Columns(this.bytes, this.at);
    let count = 0;
    const firsts = this.tracks.map(([, , pieces]) => { const first = count; count += pieces; return first; });
    const open = { firsts, count };
    open.start = columns.take(Float32Array, count);
    const scaled = (n, Kind, scale, low) => {
      const out = new Float32Array(n * count);
      for (let axis = 0; axis < n; axis++) {
        const column = columns.take(Kind, count);
        for (let k = 0; k < count; k++) out[n * k + axis] = (low ? low[axis] : 0) + column[k] * (low ? scale[axis] : scale);
      }
      return out;
    };
    const size = meta.high.map((high, axis) => (high - meta.low[axis]) / 65535);
    open.position = scaled(3, Uint16Array, size, meta.low);
    open.velocity = scaled(3, Int16Array, meta.velocity / 32767);
    open.acceleration = scaled(3, Int16Array, meta.acceleration / 32767);
    if (this.turning) {
      open.orientation = scaled(4, Int16Array, 1 / 32767);
      open.spin = scaled(3, Int16Array, meta.spin / 32767);
      open.own = scaled(1, Int16Array, meta.spin / 32767);
    }
    const hits = this.hits;
    const time = columns.take(Float32Array, hits), speed = columns.take(Float32Array, hits);
    const pair = [columns.take(Uint16Array, hits), columns.take(Uint16Array, hits)];
    const shares = [0, 1, 2].map(() => columns.take(Uint16Array, hits));
    open.impacts = Array.from(time, (t, k) => ({
      time: t, speed: speed[k], body: meta.names[pair[0][k]], other: meta.names[pair[1][k]],
      point: [0, 1, 2].map((axis) => meta.low[axis] + shares[axis][k] * size[axis]),
    }));
    const pairs = (count) => { const sides = [columns.take(Uint16Array, count), columns.take(Uint16Array, count)]; return (k) => [sides[0][k], sides[1][k]]; };
    const length = columns.take(Float32Array, hits), impulse = columns.take(Float32Array, hits), struck = pairs(hits);
    open.strikes = Array.from(time, (start, k) => ({ start, length: length[k], impulse: impulse[k], pair: struck(k) }));
    const [begin, end, ...kinds] = Array.from({ length: 6 }, () => columns.take(Float32Array, this.rubs)), rubbed = pairs(this.rubs);
    open.rubs = Array.from(begin, (start, k) => ({
      start, end: end[k], kinds: [[kinds[0][k], kinds[1][k]], [kinds[2][k], kinds[3][k]]], pair: rubbed(k),
    }));
    return (this.columns = open);
  }

  get impacts() { return this.open().impacts; }
  get strikes() { return this.open().strikes; }
  get rubbing() { return this.open().rubs; }

  // The piece of a track that is valid at a time.
  piece(track, time) {
    const { firsts, start } = this.open();
    let low = firsts[track], high = low + this.tracks[track][2] - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (start[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  // When a body appears that is not there from the start; else 0.
  appears(track) { const { firsts, start } = this.open(); return this.tracks[track][3] ? start[firsts[track]] : 0; }

  // Position of a track at a time, and orientation if asked for.
  pose(track, time, position, orientation) {
    const open = this.open(), k = this.piece(track, time), t = Math.max(time - open.start[k], 0);
    const p = open.position, v = open.velocity, a = open.acceleration, i = 3 * k;
    position.set(p[i] + t * (v[i] + 0.5 * t * a[i]), p[i + 1] + t * (v[i + 1] + 0.5 * t * a[i + 1]), p[i + 2] + t * (v[i + 2] + 0.5 * t * a[i + 2]));
    if (orientation) this.turn(k, t, orientation);
  }

  // Rot(spin·t) · R₀ · Rot(e₃, own·t)
  turn(k, t, q) {
    const open = this.open();
    if (!open.orientation) { q.identity(); return; }
    q.fromArray(open.orientation, 4 * k).normalize();
    const [x, y, z] = open.spin.subarray(3 * k, 3 * k + 3), rate = Math.hypot(x, y, z);
    if (rate > 0) q.premultiply(scratch.q.setFromAxisAngle(scratch.v.set(x / rate, y / rate, z / rate), rate * t));
    if (open.own[k]) q.multiply(scratch.q.setFromAxisAngle(scratch.v.set(0, 0, 1), open.own[k] * t));
  }
}

const scratch = { q: new THREE.Quaternion(), v: new THREE.Vector3() };
