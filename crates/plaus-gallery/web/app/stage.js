// From where on scenery is before what is to be seen, as a share of the way from its middle to its front.
const BEFORE = 0.3;

// The world to draw: one set of bodies and scenery, posed again for every picture.

class Stage {
  constructor(meta, bytes, solutions) {
    Object.assign(this, { meta, bytes, solutions });
    this.scene = new THREE.Scene();
    this.props = new Map();
    this.shown = new Set();
    this.frame = this.commonFrame();
    this.size = this.frame.low.distanceTo(this.frame.high);
    this.most = this.mostBodies();
    this.bodies = [new Map(), new Map()];
    this.maps = new Map();
    this.trails = new Trails(this.scene, meta, this.size);
    this.flashes = this.makeFlashes();
    this.light();
  }

  // The box that most solutions stay in, with what the scene wants to show.
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

  // The largest number of bodies of each model.
  mostBodies() {
    const most = this.meta.models.map(() => 1);
    for (const { tracks } of this.solutions) {
      const counts = this.meta.models.map(() => 0);
      for (const [, model] of tracks) counts[model]++;
      counts.forEach((count, model) => { most[model] = Math.max(most[model], count); });
    }
    return most;
  }

  // Makes room for the bodies of one more solution.
  include({ tracks }) {
    const counts = new Map();
    for (const [, model] of tracks) counts.set(model, (counts.get(model) ?? 0) + 1);
    for (const [model, count] of counts) {
      if (count <= (this.most[model] ?? 0)) continue;
      this.most[model] = count;
      for (const made of this.bodies) {
        for (const mesh of made.get(model) ?? []) { this.scene.remove(mesh); mesh.dispose(); }
        made.delete(model);
      }
    }
  }

  // One instanced mesh for each part of a model, made when it is first seen.
  parts(model, ghost) {
    const made = this.bodies[ghost ? 1 : 0];
    if (!made.has(model)) {
      const { parts, reach } = this.meta.models[model], solid = ghost ? this.parts(model, false) : null;
      made.set(model, parts.map((part, k) => {
        const whole = solid?.[k].userData.whole ?? lay(geometryOf(this.meta.models[model].bytes ?? this.bytes, part.mesh), 4 * reach);
        const mesh = new THREE.InstancedMesh(whole, materialOf(part.look, ghost), this.most[model]);
        mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
        mesh.userData.whole = whole;
        mesh.frustumCulled = mesh.visible = false;
        mesh.castShadow = mesh.receiveShadow = !ghost;
        this.scene.add(mesh);
        return mesh;
      }));
    }
    return made.get(model);
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
      const { look, mesh, grid, bytes = this.bytes } = this.meta.props[index];
      const geometry = lay(grid ? fieldOf(bytes, grid) : geometryOf(bytes, mesh), 0.6 * this.size);
      const drawn = new THREE.Mesh(geometry, materialOf(look, false));
      const clear = look.material === 'glass' || look.material === 'mark';
      drawn.castShadow = !clear;
      drawn.receiveShadow = look.material !== 'glass';
      drawn.visible = false;
      drawn.userData.whole = geometry;
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
    this.middle = middle;
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
    // Shadows need a surface, even beside the table.
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

  // Poses a solution at a time, perhaps with another over it, trails, and flashes of impacts; `plain` for pictures that are small or must be made fast.
  pose({ solution, time, other = null, trails = true, until = false, flash = false, camera, width, height, seen, plain, cut = null }) {
    // The width of a pixel, in the middle of the view.
    const far = camera.position.distanceTo(this.middle), pixel = (2 * far * Math.tan((camera.fov * Math.PI) / 360)) / height;
    this.shadows(width);
    const wanted = new Set(solution.props);
    for (const index of this.shown) if (!wanted.has(index)) this.props.get(index).visible = false;
    for (const index of wanted) {
      const prop = this.prop(index);
      prop.geometry = atDetail(prop.userData.whole, pixel);
      prop.visible = !cut || !this.isBefore(prop, cut);
    }
    this.shown = wanted;
    this.place(false, solution, time, pixel);
    this.place(true, other, time, pixel);
    this.trails.draw(trails ? solution : null, trails ? other : null, until ? time : Infinity, plain, seen);
    this.flash(flash ? solution : null, time, camera);
  }

  // Whether a piece of scenery is wholly before what is to be seen, looked at from a direction.
  isBefore(prop, from) {
    const { low, high } = this.frame, { min, max } = prop.userData.whole.boundingBox, half = high.clone().sub(low).multiplyScalar(0.5);
    const axes = ['x', 'y', 'z'], along = (a, b) => axes.reduce((sum, axis) => sum + from[axis] * (from[axis] > 0 ? a : b)[axis], 0);
    return along(min, max) > this.middle.dot(from) + BEFORE * axes.reduce((sum, axis) => sum + Math.abs(from[axis]) * half[axis], 0);
  }

  // A shadow map about as fine as the picture; one of each size is kept.
  shadows(width) {
    if (!software) return;
    const { shadow } = this.sun, size = Math.min(Math.max(2 ** Math.round(Math.log2(1.2 * width)), 256), 1024);
    if (shadow.mapSize.x === size) return;
    this.maps.set(shadow.mapSize.x, shadow.map);
    shadow.mapSize.set(size, size);
    shadow.map = this.maps.get(size) ?? null;
  }

  place(ghost, solution, time, pixel) {
    const counts = new Map(), at = new THREE.Vector3(), turned = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1), matrix = new THREE.Matrix4();
    solution?.tracks.forEach(([, model], track) => {
      if (Math.min(time, solution.duration) < solution.appears(track)) return;
      const { round } = this.meta.models[model], count = counts.get(model) ?? 0;
      solution.pose(track, Math.min(time, solution.duration), at, round ? null : turned);
      matrix.compose(at, round ? turned.identity() : turned, one);
      for (const mesh of this.parts(model, ghost)) mesh.setMatrixAt(count, matrix);
      counts.set(model, count + 1);
    });
    for (const [model, parts] of this.bodies[ghost ? 1 : 0]) {
      const count = counts.get(model) ?? 0;
      for (const mesh of parts) {
        mesh.count = count;
        mesh.visible = count > 0;
        if (!count) continue;
        mesh.geometry = atDetail(mesh.userData.whole, pixel);
        mesh.instanceMatrix.needsUpdate = true;
      }
    }
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
