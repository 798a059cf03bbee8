// A video of the chosen solution, as it plays: the stage is drawn over the page's sky, frame by frame, and the browser encodes it.

// What browsers can encode, the first that one can; bits per second; the longer side of the picture, in pixels.
const ENCODINGS = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'], RATE_OF_BITS = 8e6, LONGER_SIDE = 1280;

class Recorder {
  constructor(app) {
    this.app = app;
    this.kind = typeof MediaRecorder === 'function' ? ENCODINGS.find((kind) => MediaRecorder.isTypeSupported(kind)) : undefined;
  }

  get button() { return document.getElementById('video'); }

  toggle() { if (this.recorder) this.stop(false); else this.start(); }

  start() {
    const { app } = this, { player } = app, { clientWidth, clientHeight } = player.canvas, share = LONGER_SIDE / Math.max(clientWidth, clientHeight);
    if (!this.kind) return this.say('This browser records no video');
    // Codecs want even numbers.
    const even = (length) => 2 * Math.round((share * length) / 2);
    this.canvas = Object.assign(document.createElement('canvas'), { width: even(clientWidth), height: even(clientHeight) });
    this.pen = this.canvas.getContext('2d');
    this.sky = this.skyOf(this.canvas.height, this.pen);
    player.seek(0);
    this.frame();
    const stream = this.canvas.captureStream(), chunks = [], solution = app.a;
    if (player.sound.on) player.sound.tracks().forEach((track) => stream.addTrack(track));
    this.recorder = new MediaRecorder(stream, { mimeType: this.kind, videoBitsPerSecond: RATE_OF_BITS });
    this.recorder.ondataavailable = ({ data }) => { if (data.size) chunks.push(data); };
    this.recorder.onstop = () => {
      stream.getTracks().forEach((track) => track.stop());
      if (!this.whole) return;
      const ending = this.kind.startsWith('video/mp4') ? 'mp4' : 'webm';
      save(new Blob(chunks, { type: this.kind.split(';')[0] }), `${app.meta.name}-${solution.id.replace(':', '-')}.${ending}`);
    };
    this.recorder.start();
    player.play();
    this.say('Stop recording');
  }

  // The page's sky, behind a picture of so many pixels' height.
  skyOf(height, pen) {
    const sky = pen.createLinearGradient(0, 0, 0, height), { dark } = this.app;
    sky.addColorStop(0, dark ? '#2b313d' : '#eef2f7');
    sky.addColorStop(1, dark ? '#15181e' : '#cfd7e2');
    return sky;
  }

  // A picture was drawn: it becomes a frame.
  frame() {
    const { canvas, pen, app, sky } = this;
    pen.fillStyle = sky;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(app.player.canvas, 0, 0, canvas.width, canvas.height);
  }

  // Only a whole one is kept.
  stop(whole) {
    const { recorder } = this;
    if (!recorder) return;
    this.recorder = null;
    this.whole = whole;
    recorder.stop();
    this.say('Record video');
  }

  say(text) { if (this.button) this.button.textContent = text; }
}

// Gives the user a file.
function save(blob, name) {
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
