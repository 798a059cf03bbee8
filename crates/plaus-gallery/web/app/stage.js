// The world that is drawn: one set of bodies and scenery, posed anew for every picture.

class Stage {
  constructor(meta, bytes, solutions) {
    Object.assign(this, { meta, bytes, solutions });
    this.scene = new THREE.Scene();
    this.props = new Map();
    this.shown = new Set();
    this.trails = new Map();
    this.frame = this.commonFrame();
    this.size = this.frame.low.distanceTo(this.frame.high);
    this.bodies = [this.makeBodies(false)];
    this.bodies.push(this.makeBodies(true));
    this.flashes = this.makeFlashes();
    this.light();
  }

  // The box most solutions stay in, with what the scene wants to be seen.
  commonFrame() {
    const { solutions, meta } = this, low = new THREE.Vector3(), high = new THREE.Vector3();
    if (meta.alone) {
      const [a, b] = meta.frame.map((corner) => new THREE.Vector3().fromArray(corner));
      return { low: a.clone().min(b), high: a.max(b) };
    }
    const at = (values, share) => values.sort((a, b) => a - b)[Math.round(share * (values.length - 1))];
    for (let axis = 0; axis < 3; axis++) {
      low.setComponent(axis, at(solutions.map((s) => s.box[0][axis]), 0.1));
      high.setComponent(axis, at(solutions.map((s) => s.box[1][axis]), 0.9));
    }
    for (const corner of meta.frame ?? []) {
      low.min(scratch.v.fromArray(corner));
      high.max(scratch.v.fromArray(corner));
    }
    return { low, high };
  }

  // One instanced mesh for each part of each model.
  makeBodies(ghost) {
    const most = this.meta.models.map(() => 1);
    for (const { tracks } of this.solutions) {
      const counts = this.meta.models.map(() => 0);
      for (const [, model] of tracks) counts[model]++;
      counts.forEach((count, model) => { most[model] = Math.max(most[model], count); });
    }
    return this.meta.models.map((model, index) => model.parts.map((part) => {
      const source = ghost ? this.bodies[0][index] : null;
      const geometry = source ? source[model.parts.indexOf(part)].geometry : geometryOf(this.bytes, part.mesh);
      lay(geometry, 4 * model.reach);
      const mesh = new THREE.InstancedMesh(geometry, materialOf(part.look, ghost), most[index]);
      mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.castShadow = !ghost;
      mesh.receiveShadow = !ghost;
      mesh.count = 0;
      this.scene.add(mesh);
      return mesh;
    }));
  }

  makeFlashes() {
    const geometry = new THREE.RingGeometry(0.72, 1, 40);
    return Array.from({ length: 8 }, () => {
      const ring = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: '#ffffff', transparent: true, depthTest: false, depthWrite: false }));
      ring.visible = false;
      ring.renderOrder = 5;
      this.scene.add(ring);
      return ring;
    });
  }

  prop(index) {
    if (!this.props.has(index)) {
      if (this.props.size > 1500) this.forgetProps();
      const { look, mesh, grid } = this.meta.props[index];
      const geometry = grid ? fieldOf(this.bytes, grid) : geometryOf(this.bytes, mesh);
      lay(geometry, 0.6 * this.size);
      const drawn = new THREE.Mesh(geometry, materialOf(look, false));
      const clear = look.material === 'glass' || look.material === 'mark';
      drawn.castShadow = !clear;
      drawn.receiveShadow = look.material !== 'glass';
      drawn.visible = false;
      this.scene.add(drawn);
      this.props.set(index, drawn);
    }
    return this.props.get(index);
  }

  forgetProps() {
    for (const [index, drawn] of this.props) {
      if (this.shown.has(index)) continue;
      this.scene.remove(drawn);
      drawn.geometry.dispose();
      this.props.delete(index);
    }
  }

  light() {
    const { low, high } = this.frame, middle = low.clone().lerp(high, 0.5), radius = 0.75 * this.size;
    this.sky = new THREE.HemisphereLight(0xffffff, 0x8a7f72, 1.15);
    this.sun = new THREE.DirectionalLight(0xfff4e2, 2.4);
    this.sun.position.copy(middle).add(new THREE.Vector3(-0.55, 1.25, 0.7).multiplyScalar(2 * radius));
    this.sun.target.position.copy(middle);
    this.sun.castShadow = true;
    const camera = this.sun.shadow.camera;
    Object.assign(camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: 0.2 * radius, far: 6 * radius });
    this.sun.shadow.mapSize.set(software ? 1024 : 2048, software ? 1024 : 2048);
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.002 * this.size;
    this.sun.shadow.radius = 4;
    this.scene.add(this.sky, this.sun, this.sun.target);
    // Shadows need something to fall on, also beside the table.
    let floor = low.y;
    for (const index of this.solutions[0]?.props ?? []) floor = Math.min(floor, this.prop(index).geometry.boundingBox.min.y);
    this.ground = new THREE.Mesh(new THREE.CircleGeometry((software ? 1.5 : 6) * this.size, 64), new THREE.ShadowMaterial({ opacity: 0.28 }));
    this.ground.rotation.x = -Math.PI / 2;
    this.ground.position.set(middle.x, floor - 0.002 * this.size, middle.z);
    this.ground.receiveShadow = true;
    this.scene.add(this.ground);
  }

  theme(dark) {
    this.sky.intensity = dark ? 0.85 : 1.25;
    this.ground.material.opacity = dark ? 0.5 : 0.28;
  }

  // Ready to be drawn: a solution at a time, another over it, trails, flashes of impacts.
  pose({ solution, time, other = null, trails = true, until = false, flash = false, camera }) {
    const wanted = new Set(solution.props);
    for (const index of this.shown) if (!wanted.has(index)) this.props.get(index).visible = false;
    for (const index of wanted) this.prop(index).visible = true;
    this.shown = wanted;
    this.place(this.bodies[0], solution, time);
    this.place(this.bodies[1], other, time);
    this.drawTrails(solution, other, trails, until ? time : Infinity);
    this.flash(flash ? solution : null, time, camera);
  }

  place(bodies, solution, time) {
    const counts = this.meta.models.map(() => 0), at = new THREE.Vector3(), turned = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1), matrix = new THREE.Matrix4();
    solution?.tracks.forEach(([, model], track) => {
      const round = this.meta.models[model].round;
      solution.pose(track, Math.min(time, solution.duration), at, round ? null : turned);
      matrix.compose(at, round ? turned.identity() : turned, one);
      for (const mesh of bodies[model]) mesh.setMatrixAt(counts[model], matrix);
      counts[model]++;
    });
    bodies.forEach((parts, model) => parts.forEach((mesh) => {
      mesh.count = counts[model];
      mesh.visible = counts[model] > 0;
      mesh.instanceMatrix.needsUpdate = true;
    }));
  }

  drawTrails(solution, other, on, until) {
    for (const trail of this.trails.values()) trail.line.visible = false;
    if (!on) return;
    for (const [which, one] of [['a', solution], ['b', other]]) {
      if (!one) continue;
      const { line, times } = this.trail(one, which === 'b');
      line.visible = true;
      let count = times.length;
      if (until !== Infinity) { count = 0; while (count < times.length && times[count] <= until) count++; }
      line.geometry.instanceCount = count;
    }
  }

  trail(solution, ghost) {
    const key = `${solution.index}${ghost ? 'b' : ''}`;
    if (!this.trails.has(key)) {
      if (this.trails.size > 160) this.forgetTrails();
      const segments = trailOf(solution), ends = new Float32Array(6 * segments.length), colours = new Float32Array(6 * segments.length);
      const own = this.meta.models.map((model) => {
        const colour = new THREE.Color().setRGB(...model.parts[0].look.colour.map((c) => c / 255), THREE.SRGBColorSpace);
        return ghost ? new THREE.Color('#2f9bff') : colour;
      });
      segments.forEach((segment, k) => {
        ends.set(segment.ends, 6 * k);
        const { r, g, b } = own[segment.model];
        colours.set([r, g, b, r, g, b], 6 * k);
      });
      const geometry = new THREE.LineSegmentsGeometry();
      geometry.setPositions(ends);
      geometry.setColors(colours);
      const many = solution.tracks.length > 12;
      const material = new THREE.LineMaterial({ linewidth: many ? 1 : ghost ? 2 : 2.5, vertexColors: true, transparent: true, opacity: many ? 0.35 : 0.8, depthWrite: false });
      const line = new THREE.LineSegments2(geometry, material);
      line.frustumCulled = false;
      this.scene.add(line);
      this.trails.set(key, { line, times: segments.map((segment) => segment.time) });
    }
    return this.trails.get(key);
  }

  forgetTrails() {
    for (const { line } of this.trails.values()) {
      this.scene.remove(line);
      line.geometry.dispose();
      line.material.dispose();
    }
    this.trails.clear();
  }

  flash(solution, time, camera) {
    const last = 0.18, recent = solution ? solution.impacts.filter((hit) => hit.time <= time && time - hit.time < last).slice(-this.flashes.length) : [];
    const strongest = solution ? Math.max(1e-9, ...solution.impacts.map((hit) => hit.speed)) : 1;
    this.flashes.forEach((ring, k) => {
      const hit = recent[k];
      ring.visible = Boolean(hit);
      if (!hit) return;
      const age = (time - hit.time) / last, strength = strongest > 1e-9 ? Math.sqrt(hit.speed / strongest) : 0.5;
      ring.position.fromArray(hit.point);
      ring.quaternion.copy(camera.quaternion);
      ring.scale.setScalar(this.size * 0.05 * (0.3 + strength) * (0.3 + age));
      ring.material.opacity = 0.9 * (1 - age) * (0.3 + 0.7 * strength);
    });
  }
}
