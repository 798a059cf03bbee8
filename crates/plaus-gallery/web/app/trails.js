// Lines along the paths of bodies, kept while there is room.

// From this many bodies, lines are thin even in large pictures.
const MANY = 12;
// Number of lines kept.
const KEPT = 160;
// Most parts of a straight path: a body that leaves for ever is far away by then.
const MOST_PARTS = 200;

class Trails {
  // `size` is the size of the view, in metres.
  constructor(scene, meta, size) {
    Object.assign(this, { scene, meta, size });
    this.made = new Map();
    this.shown = [];
  }

  // Shows the paths of a solution, and of another, up to a time, in a picture of `width` by `height` CSS pixels; `plain` lines are faster.
  draw(solution, other, until, plain, [width, height]) {
    this.hide();
    for (const [one, ghost] of [[solution, false], [other, true]]) {
      if (!one) continue;
      const { line, times, thin } = this.of(one, ghost, plain);
      line.visible = true;
      this.shown.push(line);
      let count = times.length;
      if (until !== Infinity) { count = 0; while (count < times.length && times[count] <= until) count++; }
      if (thin) line.geometry.setDrawRange(0, 2 * count);
      else { line.geometry.instanceCount = count; line.material.resolution.set(width, height); }
    }
  }

  hide() {
    for (const line of this.shown) line.visible = false;
    this.shown = [];
  }

  of(solution, ghost, plain) {
    const many = solution.tracks.length > MANY, thin = many || (plain && solution.tracks.length > 2);
    const key = `${solution.index}${ghost ? 'b' : ''}${plain ? 'p' : ''}`;
    if (!this.made.has(key)) {
      if (this.made.size > KEPT) this.forget();
      const segments = trailOf(solution, plain ? this.size / 600 : 0, thin ? this.size / 6 : Infinity), ends = new Float32Array(6 * segments.length), colours = new Float32Array(6 * segments.length);
      const own = this.meta.models.map((model) => {
        const colour = new THREE.Color().setRGB(...model.parts[0].look.colour.map((c) => c / 255), THREE.SRGBColorSpace);
        return ghost ? new THREE.Color('#2f9bff') : colour;
      });
      segments.forEach((segment, k) => {
        ends.set(segment.ends, 6 * k);
        const { r, g, b } = own[segment.model];
        colours.set([r, g, b, r, g, b], 6 * k);
      });
      const line = thin ? this.thin(ends, colours, many ? 0.35 : 0.7) : this.wide(ends, colours, ghost ? 2 : 2.5);
      line.frustumCulled = line.visible = false;
      this.scene.add(line);
      this.made.set(key, { line, thin, times: segments.map((segment) => segment.time) });
    }
    return this.made.get(key);
  }

  // A pixel wide: a quarter of the corners of a wide one.
  thin(ends, colours, opacity) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(ends, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
    return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, opacity, depthWrite: false }));
  }

  wide(ends, colours, linewidth) {
    const geometry = new THREE.LineSegmentsGeometry();
    geometry.setPositions(ends);
    geometry.setColors(colours);
    return new THREE.LineSegments2(geometry, new THREE.LineMaterial({ linewidth, vertexColors: true, transparent: true, opacity: 0.8, depthWrite: false }));
  }

  forget() {
    this.hide();
    for (const { line } of this.made.values()) {
      this.scene.remove(line);
      line.geometry.dispose();
      line.material.dispose();
    }
    this.made.clear();
  }
}

// The paths of all bodies, as pairs of ends in order of time. Differences below `tolerance` are left out. No line is longer than `longest`,
// because some renderers do not draw a line one pixel wide that begins behind the camera.
function trailOf(solution, tolerance, longest) {
  const segments = [];
  solution.tracks.forEach(([, model], track) => {
    const points = simplified(wayOf(solution, track), tolerance);
    for (let k = 1; k < points.length; k++) {
      const [before, here] = [points[k - 1], points[k]], length = Math.hypot(...here.at.map((x, axis) => x - before.at[axis]));
      const parts = length > 0 ? Math.min(Math.ceil(length / longest) || 1, MOST_PARTS) : 0, end = (share) => here.at.map((x, axis) => before.at[axis] + share * (x - before.at[axis]));
      for (let part = 0; part < parts; part++) {
        const time = before.time + ((part + 1) / parts) * (here.time - before.time);
        segments.push({ ends: [...end(part / parts), ...end((part + 1) / parts)], time, model });
      }
    }
  });
  return segments.sort((a, b) => a.time - b.time);
}

// Points along the path of one body: where its motion changes, and in between where it is curved.
function wayOf(solution, track) {
  const open = solution.open(), first = open.firsts[track], count = solution.tracks[track][2], points = [], at = new THREE.Vector3();
  const step = solution.duration / Math.min(Math.max(12, Math.floor(6000 / solution.tracks.length)), 160), end = solution.duration;
  const add = (time) => { solution.pose(track, time, at, null); points.push({ time, at: at.toArray() }); };
  for (let k = first; k < first + count; k++) {
    const from = open.start[k], to = Math.min(k + 1 < first + count ? open.start[k + 1] : end, end);
    const bent = Math.hypot(...open.acceleration.subarray(3 * k, 3 * k + 3)) > 0, parts = bent ? Math.max(1, Math.ceil((to - from) / step)) : 1;
    for (let part = 0; part < parts; part++) add(from + ((to - from) * part) / parts);
  }
  add(end);
  return points;
}

// Leaves out points that lie near the line through those that stay (Ramer 1972; Douglas and Peucker 1973).
function simplified(points, tolerance) {
  if (!tolerance) return points;
  const stays = new Uint8Array(points.length), open = [[0, points.length - 1]];
  stays[0] = stays[points.length - 1] = 1;
  while (open.length) {
    const [from, to] = open.pop();
    let worst = tolerance, at = 0;
    for (let k = from + 1; k < to; k++) {
      const off = distance(points[k].at, points[from].at, points[to].at);
      if (off > worst) { worst = off; at = k; }
    }
    if (at) { stays[at] = 1; open.push([from, at], [at, to]); }
  }
  return points.filter((_, k) => stays[k]);
}

// From a point to a line that ends at `a` and `b`.
function distance(p, a, b) {
  const way = b.map((x, axis) => x - a[axis]), from = p.map((x, axis) => x - a[axis]), dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  const share = Math.min(Math.max(dot(from, way) / (dot(way, way) || 1), 0), 1);
  return Math.hypot(...from.map((x, axis) => x - share * way[axis]));
}
