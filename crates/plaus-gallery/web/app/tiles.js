// The tiles: pictures of all solutions that pass the filters; only the one pointed at moves, or all visible ones when asked to.

class Tiles {
  constructor(app) {
    this.app = app;
    this.box = document.getElementById('tiles');
    this.visible = new Set();
    this.stale = new Set();
    this.tiles = new Map();
    this.watch = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const solution = app.solutions[target.dataset.index];
        if (isIntersecting) { this.visible.add(solution); this.stale.add(solution); } else this.visible.delete(solution);
      }
      app.wake();
    }, { rootMargin: '80px' });
    new ResizeObserver(() => this.refresh()).observe(this.box);
  }

  tile(solution) {
    if (!this.tiles.has(solution)) this.tiles.set(solution, this.make(solution));
    return this.tiles.get(solution);
  }

  make(solution) {
    const { app } = this, tile = document.createElement('div');
    tile.className = 'tile';
    tile.dataset.index = solution.index;
    tile.dataset.id = solution.id;
    tile.innerHTML = '<canvas aria-hidden="true"></canvas><button class="pick"><span></span><span></span></button><button class="star" title="Star (s)">★</button>';
    const [name, value] = tile.querySelectorAll('.pick span');
    tile.lastElementChild.setAttribute('aria-label', `★ ${solution.name}`);
    name.textContent = solution.name;
    value.textContent = app.filters.caption(solution);
    tile.addEventListener('click', (event) => (event.target.closest('.star') ? app.star(solution) : app.choose(solution, event.shiftKey)));
    tile.addEventListener('pointerenter', (event) => { if (event.pointerType !== 'touch') app.hover(solution, 'tile'); });
    tile.addEventListener('pointerleave', () => app.hover(null, 'tile'));
    this.watch.observe(tile);
    return tile;
  }

  // Shows these solutions, in this order.
  show(solutions) {
    this.box.replaceChildren(...solutions.map((solution) => this.tile(solution)));
    for (const solution of solutions) this.tile(solution).querySelector('.pick span:last-child').textContent = this.app.filters.caption(solution);
    document.getElementById('nothing').hidden = solutions.length > 0;
    this.mark();
  }

  mark() {
    const { app } = this;
    for (const [solution, tile] of this.tiles) {
      tile.classList.toggle('a', solution === app.a);
      tile.classList.toggle('b', solution === app.b);
      const starred = tile.classList.toggle('starred', app.starred.has(solution.id));
      tile.lastElementChild.setAttribute('aria-pressed', starred);
    }
  }

  refresh() {
    for (const solution of this.visible) this.stale.add(solution);
    this.app.wake();
  }

  // What to draw now: tiles that move, and some that are out of date.
  jobs(now) {
    const { app } = this, jobs = [];
    const moving = new Set(app.animateAll ? this.visible : []);
    if (app.hovered && app.hoveredFrom === 'tile' && this.tiles.has(app.hovered)) moving.add(app.hovered);
    for (const solution of moving) {
      const since = app.animateAll ? now : now - app.hoveredSince;
      jobs.push({ canvas: this.canvas(solution), solution, time: cycle((since / 1000) * +app.player.speed.value, solution.duration), trails: true, flash: true, moving: true });
      this.stale.add(solution);
    }
    // Moving tiles come first.
    let budget = moving.size || app.player.playing ? 1 : software ? 3 : 12;
    for (const solution of this.stale) {
      if (moving.has(solution)) continue;
      if (!this.visible.has(solution)) { this.stale.delete(solution); continue; }
      if (budget-- <= 0) break;
      jobs.push({ canvas: this.canvas(solution), solution, time: solution.duration, trails: true });
      this.stale.delete(solution);
    }
    return { jobs, moving: moving.size > 0 || this.stale.size > 0 };
  }

  canvas(solution) { return this.tile(solution).firstElementChild; }
}

// From 0 to the end, then a moment's rest; in seconds of the animation.
function cycle(seconds, duration) {
  return Math.min(seconds % (duration + 0.7), duration);
}
