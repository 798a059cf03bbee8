// One WebGL context for all pictures: each is drawn into a scissored part of its canvas, then copied to its place on the page.

// Resolution of large moving pictures, along a side: if one is too slow, the next is used.
const DETAILS = [1, 0.75, 0.58, 0.45, 0.36];

class Views {
  constructor(stage) {
    this.stage = stage;
    this.renderer = new THREE.WebGLRenderer({ antialias: !software || navigator.hardwareConcurrency > 2, alpha: true, powerPreference: 'high-performance' });
    const { renderer } = this;
    renderer.setPixelRatio(1);
    renderer.setClearColor(0, 0);
    renderer.autoClear = false;
    renderer.toneMapping = THREE.ACESFilmicToneMapping;
    renderer.toneMappingExposure = 1.15;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = software ? THREE.BasicShadowMap : THREE.PCFShadowMap;
    this.width = this.height = 0;
    this.detail = software ? 2 : 0; // the first picture soon, then as sharp as time allows
    this.slow = 0;
    this.lost = false;
    renderer.domElement.addEventListener('webglcontextlost', (event) => { event.preventDefault(); this.lost = true; });
    renderer.domElement.addEventListener('webglcontextrestored', () => { this.lost = false; this.onRestored?.(); });
    if (!software) {
      const light = new THREE.PMREMGenerator(renderer);
      stage.scene.environment = light.fromScene(new THREE.RoomEnvironment(), 0.04).texture;
    }
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
  }

  // Draws another stage from now on.
  show(stage) {
    stage.scene.environment = this.stage.scene.environment;
    this.stage = stage;
    return this;
  }

  get ratio() { return software ? 1 : Math.min(window.devicePixelRatio || 1, 2); }

  // While pictures move, they lose detail until enough of them are drawn; `milliseconds` have passed since the last.
  pace(milliseconds) {
    this.slow = 0.8 * this.slow + 0.2 * milliseconds;
    if (this.slow > 42 && this.detail < DETAILS.length - 1) { this.detail++; this.slow = 28; }
    else if (this.slow < 19 && this.detail > 0) { this.detail--; this.slow = 28; }
  }

  // Draws all jobs: { canvas, camera?, solution, time, … } as Stage.pose takes them.
  draw(jobs) {
    if (this.lost) return;
    // As wide as the widest picture, so that the canvas stays small.
    const wide = Math.max(...jobs.map(({ canvas }) => Math.round(canvas.clientWidth * this.ratio)), 256);
    let batch = [], x = 0, y = 0, row = 0;
    const flush = () => { if (batch.length) this.drawBatch(batch); batch = []; x = y = row = 0; };
    for (const job of jobs) {
      const { canvas } = job, scale = this.ratio * (job.moving && canvas.clientWidth > 300 ? DETAILS[this.detail] : 1);
      const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
      if (!width || !height) continue;
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      if (x && x + width > wide) { x = 0; y += row; row = 0; }
      if (y && y + height > 2048) flush();
      batch.push({ job, x, y, width, height });
      x += width;
      row = Math.max(row, height);
    }
    flush();
  }

  // Calls back once everything asked for so far is drawn: software rendering may be far behind.
  drawn(then) {
    const gl = this.renderer.getContext(), fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (!fence || this.lost || gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED) { gl.deleteSync(fence); then(); } else setTimeout(look, 5);
    };
    setTimeout(look, 0); // between frames: each waits for its own pictures
  }

  // Copying costs as much as copying the whole canvas, so it shrinks when only small pictures were drawn for a while.
  fit(width, height) {
    const { renderer } = this, roomy = 2 * width * height < this.width * this.height;
    this.roomy = roomy ? (this.roomy ?? 0) + 1 : 0;
    if (width > this.width || height > this.height || this.roomy > 3) {
      const keep = this.roomy <= 3;
      this.width = keep ? Math.max(width, this.width) : width;
      this.height = keep ? Math.max(height, this.height) : height;
      this.roomy = 0;
      renderer.setSize(this.width, this.height, false);
    }
  }

  drawBatch(batch) {
    const { renderer, stage } = this;
    const width = Math.max(...batch.map((b) => b.x + b.width)), height = Math.max(...batch.map((b) => b.y + b.height));
    this.fit(width, height);
    renderer.setScissorTest(true);
    for (const { job, x, y, width: w, height: h } of batch) {
      const camera = job.camera ?? this.fitted(this.camera, w / h);
      stage.pose({ ...job, camera, width: w, height: h, seen: [job.canvas.clientWidth, job.canvas.clientHeight], plain: w <= 300 || (job.moving && this.detail > 1) });
      renderer.setViewport(x, y, w, h);
      renderer.setScissor(x, y, w, h);
      renderer.clear();
      renderer.render(stage.scene, camera);
    }
    for (const { job, x, y, width: w, height: h } of batch) {
      const pen = job.canvas.getContext('2d');
      pen.clearRect(0, 0, w, h);
      pen.drawImage(renderer.domElement, x, this.height - y - h, w, h, 0, 0, w, h);
    }
  }

  // Moves a camera so that the common frame just fills the picture, seen from a direction or as the scene wants.
  fitted(camera, aspect, direction = null) {
    const { low, high } = this.stage.frame, middle = low.clone().lerp(high, 0.5);
    const from = new THREE.Vector3().fromArray(direction ?? this.stage.meta.from ?? [0.45, 0.55, 1]).normalize();
    const right = new THREE.Vector3(0, 1, 0).cross(from).normalize(), up = from.clone().cross(right);
    const tall = Math.tan((camera.fov * Math.PI) / 360), broad = tall * aspect;
    let distance = 0;
    for (let corner = 0; corner < 8; corner++) {
      const offset = new THREE.Vector3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z).sub(middle);
      distance = Math.max(distance, offset.dot(from) + Math.max(Math.abs(offset.dot(right)) / broad, Math.abs(offset.dot(up)) / tall));
    }
    distance *= 1.07;
    camera.aspect = aspect;
    camera.near = distance / 100;
    camera.far = distance * 20;
    camera.position.copy(middle).addScaledVector(from, distance);
    camera.up.set(0, 1, 0);
    camera.lookAt(middle);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    return camera;
  }
}
