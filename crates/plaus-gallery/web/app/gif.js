// A loop of the chosen solution as GIF, at the chosen speed and camera, in the clip's own colours; each picture holds only the pixels that change.

// The longer side, in pixels; pictures per second; most pictures: of a longer clip there are fewer a second; most bytes: a larger one gets half the pixels.
const GIF_SIDE = 640, GIF_RATE = 20, GIF_PICTURES = 300, GIF_BYTES = 16e6;
// Colours, but for the one of what does not change; pictures that they are taken from; how long the last one stays, in ms.
const GIF_COLOURS = 255, GIF_LOOKED_AT = 8, GIF_STAY = 1000;

class Gif {
  constructor(app) { this.app = app; }

  get button() { return document.getElementById('gif'); }

  // Its size in pixels, its times, and how long a picture stays, in ms.
  plan(shrunk = 1) {
    const { player } = this.app, { clientWidth, clientHeight } = player.canvas, share = (shrunk * GIF_SIDE) / Math.max(clientWidth, clientHeight, 1);
    const timesOf = (delay) => {
      const times = [];
      for (let time = 0; time < player.duration && times.length < 1e5; time += (delay / 1000) * player.rateAt(time)) times.push(time);
      return [...times, player.duration];
    };
    let delay = 1000 / GIF_RATE, times = timesOf(delay);
    // A GIF counts hundredths of a second.
    while (times.length > GIF_PICTURES) times = timesOf(delay = 10 * Math.ceil((delay * times.length) / GIF_PICTURES / 10 + 0.1));
    return { width: Math.max(Math.round(share * clientWidth), 1), height: Math.max(Math.round(share * clientHeight), 1), times, delay };
  }

  // What is said before it is made.
  get about() {
    const { width, height, times } = this.plan();
    return `${times.length} pictures of ${width} × ${height} pixels, at most ${GIF_BYTES / 1e6} MB`;
  }

  tell() {
    const told = document.getElementById('gif-about');
    if (told) told.textContent = `The GIF: ${this.about}.`;
  }

  toggle() { if (this.going) this.stop(); else this.make(); }

  stop() {
    this.going = null;
    if (this.button) this.button.textContent = 'Download GIF';
  }

  async make() {
    const { app } = this, { player } = app, solution = app.a, name = `${app.meta.name}-${solution.id.replace(':', '-')}.gif`, going = this.going = {};
    player.pause();
    const before = player.time, share = () => this.going === going && !app.over;
    try {
      for (let shrunk = 1; share(); shrunk *= Math.SQRT1_2) {
        const bytes = await this.encode(this.plan(shrunk), share);
        if (!bytes) continue;
        this.stop();
        save(new Blob([bytes], { type: 'image/gif' }), name);
      }
    } catch (error) {
      console.error(error);
      if (share()) { this.stop(); document.getElementById('message').textContent = `No GIF could be made: ${error.message}`; }
    }
    if (!app.over) player.seek(before);
  }

  // Its bytes; nothing if they are too many, or it is not wanted any more.
  async encode({ width, height, times, delay }, wanted) {
    const { app } = this, { player } = app, { GIFEncoder, quantize, applyPalette } = GIF;
    const canvas = document.createElement('canvas'), shot = document.createElement('canvas'), same = GIF_COLOURS;
    // The stage is drawn at the size that a canvas has on the page.
    Object.defineProperties(canvas, { clientWidth: { value: width / app.views.ratio }, clientHeight: { value: height / app.views.ratio } });
    Object.assign(shot, { width, height });
    const pen = shot.getContext('2d', { willReadFrequently: true }), sky = app.recorder.skyOf(height, pen);
    const pixels = (time) => {
      player.seek(time);
      app.views.draw([{ ...player.job(), canvas, moving: false }]);
      pen.fillStyle = sky;
      pen.fillRect(0, 0, width, height);
      pen.drawImage(canvas, 0, 0, width, height);
      return pen.getImageData(0, 0, width, height).data;
    };
    const pause = () => new Promise((resolve) => { setTimeout(resolve, 0); });
    const looked = [];
    for (let k = 0; k < GIF_LOOKED_AT && wanted(); k++) {
      const all = new Uint32Array(pixels((player.duration * k) / (GIF_LOOKED_AT - 1)).buffer);
      looked.push(all.filter((_, at) => at % GIF_LOOKED_AT === k));
      await pause();
    }
    if (!wanted()) return null;
    const few = new Uint32Array(looked.flatMap((one) => [...one])), palette = quantize(new Uint8Array(few.buffer), GIF_COLOURS);
    while (palette.length <= same) palette.push([0, 0, 0]);
    const colours = palette.slice(0, same), gif = GIFEncoder();
    let last = null;
    for (const [k, time] of times.entries()) {
      if (this.button) this.button.textContent = `Stop: GIF ${k + 1} of ${times.length}`;
      const now = applyPalette(pixels(time), colours), changed = now.slice();
      if (last) for (let at = 0; at < now.length; at++) if (now[at] === last[at]) changed[at] = same;
      gif.writeFrame(changed, width, height, {
        palette: k ? null : palette, delay: k + 1 < times.length ? delay : GIF_STAY, transparent: k > 0, transparentIndex: same, dispose: 1,
      });
      last = now;
      await pause();
      if (!wanted() || gif.bytesView().length > GIF_BYTES) return null;
    }
    gif.finish();
    return gif.bytes();
  }
}
