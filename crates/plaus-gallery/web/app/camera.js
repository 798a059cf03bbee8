// Cameras: the first view, three along the axes, and one that goes with a body.

// Where the eye is, seen from the middle; not quite from above, where "up" would say nothing.
const VIEWS = { first: null, front: [0, 0.12, 1], side: [1, 0.12, 0], above: [0, 1, 0.001] };
const VIEW_NAMES = { first: 'First view', front: 'Front', side: 'Side', above: 'Above' };
// Most bodies to follow; how far the eye then is from one, in its own reach, and at most as a share of the first view's distance.
const MOST_FOLLOWED = 12, NEAR = 30, NEAR_SHARE = 0.6;

class Camera {
  constructor(player) {
    this.player = player;
    this.view = 'first';
    this.select = document.getElementById('camera');
    this.select.addEventListener('change', () => this.choose(this.select.value));
  }

  // Offers the bodies of a solution, those that go farthest first.
  offer(solution) {
    const { meta } = this.player.app, names = solution.tracks.map(([name], track) => [meta.names[name], travelled(solution, track)]);
    names.sort((a, b) => b[1] - a[1]);
    const group = Object.assign(document.createElement('optgroup'), { label: 'Follow' });
    group.append(...names.slice(0, MOST_FOLLOWED).filter(([, way]) => way > 0).map(([name]) => new Option(name, `follow ${name}`)));
    this.select.replaceChildren(...Object.keys(VIEWS).map((view) => new Option(VIEW_NAMES[view], view)), ...(group.children.length ? [group] : []));
    if (![...this.select.options].some(({ value }) => value === this.view)) this.choose('first');
    this.select.value = this.view;
  }

  choose(view) {
    this.view = this.select.value = view;
    if (this.select.value !== view) this.view = this.select.value = 'first';
    this.player.reset();
  }

  next() {
    const all = [...this.select.options];
    this.choose(all[(this.select.selectedIndex + 1) % all.length].value);
  }

  // The eye's direction; `null` for the scene's own.
  get from() { return VIEWS[this.view] ?? null; }

  // The followed body's number in a solution, or -1.
  followed({ tracks }) {
    return this.view.startsWith('follow ') ? tracks.findIndex(([name]) => `follow ${this.player.app.meta.names[name]}` === this.view) : -1;
  }

  // From along an axis, walls between the eye and what moves are cut away, until someone turns the view.
  get cut() { return this.from && !this.player.touched ? new THREE.Vector3().fromArray(this.from).normalize() : null; }

  // Goes near the followed body, in the direction of the view.
  approach() {
    const { app, camera, controls } = this.player, track = this.followed(app.a);
    if (track < 0) return;
    const away = camera.position.clone().sub(controls.target), reach = app.meta.models[app.a.tracks[track][1]].reach;
    away.setLength(Math.min(NEAR * reach, NEAR_SHARE * away.length()));
    controls.target.copy(this.place(track));
    camera.position.copy(controls.target).add(away);
    camera.near = Math.min(camera.near, reach / 10);
    camera.updateProjectionMatrix();
  }

  place(track) {
    const { app, time } = this.player, at = new THREE.Vector3();
    app.a.pose(track, Math.min(time, app.a.duration), at, null);
    return at;
  }

  // Moves the eye as the followed body has moved.
  follow() {
    const { camera, controls } = this.player, track = this.followed(this.player.app.a);
    if (track < 0) return;
    const moved = this.place(track).sub(controls.target);
    if (moved.lengthSq() === 0) return;
    controls.target.add(moved);
    camera.position.add(moved);
    camera.updateMatrixWorld();
  }
}

// How far a body goes, from piece to piece of its motion.
function travelled(solution, track) {
  const { start, firsts } = solution.open(), first = firsts[track], times = [...start.subarray(first, first + solution.tracks[track][2]), solution.duration];
  const at = new THREE.Vector3(), before = new THREE.Vector3();
  return times.reduce((way, time, k) => {
    solution.pose(track, Math.min(Math.max(time, 0), solution.duration), at, null);
    const step = k ? at.distanceTo(before) : 0;
    before.copy(at);
    return way + step;
  }, 0);
}
