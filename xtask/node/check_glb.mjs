// Reads GLB files with the Khronos validator, three.js and Babylon.js, and compares what they play with a table of
// poses: node check_glb.mjs A.glb A.poses.csv …
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';
import * as babylon from './babylon.mjs';
import * as three from './three.mjs';

// Blender merges keys that are less than a hundredth of a frame of 1/24 s apart, so files have no such keys. Between
// impacts that follow each other faster, a body's place is right only to within what it moves in that time.
const CROWDED = 2 * 0.0102 / 24;
// How far bodies of the scenes, at 3 m/s and 150 rad/s, move and turn in half of that time.
const CROWDED_OFF = { place: 1.3e-3, turn: 0.064 };

const files = process.argv.slice(2);
let failed = 0, checked = 0;
for (let k = 0; k < files.length; k += 2) {
  const bytes = new Uint8Array(readFileSync(files[k]));
  const { issues } = await validator.validateBytes(bytes);
  const said = issues.messages.map(({ severity, code, pointer, message }) => `  ${severity} ${code} ${pointer ?? ''} ${message}`);
  const table = poses(readFileSync(files[k + 1], 'utf8'));
  for (const program of [three, babylon]) {
    const { worst, crowded, bodies } = compare(table, await program.play(bytes), program.TIMES);
    // The accuracy that every program must reach: half a millimetre and a tenth of a degree; at keys, single precision.
    const wrong = issues.numErrors > 0 || !(worst.key <= 1e-5) || !(worst.between <= 5e-4) || !(worst.turn <= Math.PI / 1800)
      || !(crowded.place <= CROWDED_OFF.place) || !(crowded.turn <= CROWDED_OFF.turn);
    failed += wrong;
    checked++;
    console.log(`${wrong ? 'WRONG' : 'ok'} ${program.NAME} ${files[k]}: ${issues.numErrors} errors, ${issues.numWarnings} warnings; `
      + `${bodies} bodies, ${table.rows.length} poses; worst `
      + `${worst.key.toExponential(1)} of the scene's ${table.size.toFixed(2)} m at keys, ${(1e3 * worst.between).toFixed(3)} mm between; `
      + `${worst.turn.toExponential(1)} rad; ${crowded.count} among crowded impacts, ${(1e3 * crowded.place).toFixed(3)} mm, ${crowded.turn.toExponential(1)} rad`);
  }
  if (issues.numErrors + issues.numWarnings) console.log(said.slice(0, 10).join('\n'));
}
console.log(`${checked} times a GLB file was played, ${failed} times wrong`);
process.exit(failed || !checked ? 1 : 0);

// The rows of a table of poses, the times of each body's impacts, and the extent of all places.
function poses(table) {
  const [head, ...lines] = table.trim().split('\n').map((line) => line.split(','));
  const column = Object.fromEntries(head.map((name, index) => [name, index]));
  const rows = lines.map((cells) => ({
    time: +cells[column.t], body: cells[column.body], impact: cells[column.impact] === 'true',
    at: ['x', 'y', 'z'].map((axis) => +cells[column[axis]]), turned: ['qx', 'qy', 'qz', 'qw'].map((part) => +cells[column[part]]),
  }));
  const spans = [0, 1, 2].map((axis) => rows.map(({ at }) => at[axis])).map((all) => all.reduce((a, b) => Math.max(a, b)) - all.reduce((a, b) => Math.min(a, b)));
  const impacts = new Map();
  for (const { time, body, impact } of rows) if (impact) impacts.set(body, [...impacts.get(body) ?? [], time]);
  return { rows, impacts, size: Math.hypot(...spans) };
}

// What a program plays at the times of the table, which has twice the frame rate of the file. Times at which the file
// has no key are between keys; if a program rounds times, none is at a key.
function compare({ rows, impacts, size }, { facts, keyed, poseAt }, times) {
  for (const name of ['seed', 'sample', 'log_p', 'scalars']) if (!(name in facts)) throw new Error(`extras have no ${name}`);
  const worst = { key: 0, between: 0, turn: 0 }, crowded = { count: 0, place: 0, turn: 0 };
  for (const { time, body, at, turned } of rows) {
    const { position, orientation } = poseAt(time, body);
    const off = Math.hypot(...position.map((x, axis) => x - at[axis]));
    // The chord, not the cosine, whose rounding hides small angles.
    const chord = (sign) => Math.hypot(...turned.map((part, index) => part - sign * orientation[index]));
    const turn = 4 * Math.asin(Math.min(chord(1), chord(-1)) / 2);
    if ((impacts.get(body) ?? []).filter((impact) => Math.abs(impact - time) < CROWDED).length > 1) {
      crowded.count++;
      crowded.place = Math.max(crowded.place, off);
      crowded.turn = Math.max(crowded.turn, turn);
      continue;
    }
    if (times === 'exact' && keyed.get(body).has(Math.fround(time))) worst.key = Math.max(worst.key, off / size);
    else worst.between = Math.max(worst.between, off);
    worst.turn = Math.max(worst.turn, turn);
  }
  return { worst, crowded, bodies: keyed.size };
}
