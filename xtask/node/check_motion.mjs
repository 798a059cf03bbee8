// Plays compact motion with the reader that the docs link to, and compares it with tables of poses:
// node check_motion.mjs A.json A.csv …
import { readFileSync } from 'node:fs';
import { clips, pose } from './motion.mjs';

const files = process.argv.slice(2);
let failed = 0;
for (let k = 0; k < files.length; k += 2) {
  const text = readFileSync(files[k], 'utf8'), [clip] = clips(text);
  const bodies = new Map(clip.bodies.map((body) => [body.name, body]));
  const [head, ...lines] = readFileSync(files[k + 1], 'utf8').trim().split('\n').map((line) => line.split(','));
  const column = Object.fromEntries(head.map((name, index) => [name, index]));
  const worst = { off: 0, turn: 0 };
  for (const cells of lines) {
    const { position, orientation } = pose(bodies.get(cells[column.body]), +cells[column.t]);
    const of = (names) => names.map((name) => +cells[column[name]]);
    worst.off = Math.max(worst.off, Math.hypot(...of(['x', 'y', 'z']).map((x, axis) => x - position[axis])));
    const dot = of(['qx', 'qy', 'qz', 'qw']).reduce((sum, part, index) => sum + part * orientation[index], 0);
    worst.turn = Math.max(worst.turn, 2 * Math.acos(Math.min(1, Math.abs(dot))));
  }
  const wrong = !lines.length || !(worst.off <= 5e-4) || !(worst.turn <= Math.PI / 1800);
  failed += wrong;
  console.log(`${wrong ? 'WRONG' : 'ok'} ${files[k]}: ${text.length} bytes, ${(1e3 * worst.off).toFixed(3)} mm, ${worst.turn.toExponential(1)} rad`);
}
console.log(`${files.length / 2} files checked, ${failed} wrong`);
process.exit(failed || !files.length ? 1 : 0);
