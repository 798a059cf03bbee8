// Reads GLB files with the Khronos validator and with three.js, and compares what three.js plays with a table of poses:
// node check_glb.mjs A.glb A.poses.csv …
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';

globalThis.self ??= globalThis; // what three.js expects of a browser
const { AnimationMixer, Quaternion, Vector3 } = await import('three');
const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');

// Blender makes one of keys less than a hundredth of a frame of 1/24 s apart, so that files have none that are: between
// impacts that follow each other faster, a body is where it is only to what it moves in that time.
const CROWDED = 2 * 0.0102 / 24;
// What bodies of the scenes, at 3 m/s and 150 rad/s, move and turn in half of that.
const CROWDED_OFF = { place: 1.3e-3, turn: 0.064 };

const files = process.argv.slice(2);
let failed = 0, checked = 0;
for (let k = 0; k < files.length; k += 2) {
  const bytes = new Uint8Array(readFileSync(files[k]));
  const { issues } = await validator.validateBytes(bytes);
  const said = issues.messages.map(({ severity, code, pointer, message }) => `  ${severity} ${code} ${pointer ?? ''} ${message}`);
  const { worst, crowded, keys, size, bodies } = await play(bytes, readFileSync(files[k + 1], 'utf8'));
  // What every program must reach: half a millimetre and a tenth of a degree; at keys what single precision leaves.
  const wrong = issues.numErrors > 0 || !(worst.key <= 1e-5) || !(worst.between <= 5e-4) || !(worst.turn <= Math.PI / 1800)
    || !(crowded.place <= CROWDED_OFF.place) || !(crowded.turn <= CROWDED_OFF.turn);
  failed += wrong;
  checked++;
  console.log(`${wrong ? 'WRONG' : 'ok'} ${files[k]}: ${issues.numErrors} errors, ${issues.numWarnings} warnings; ${bodies} bodies, ${keys} poses; worst `
    + `${worst.key.toExponential(1)} of the scene's ${size.toFixed(2)} m at keys, ${(1e3 * worst.between).toFixed(3)} mm between; `
    + `${worst.turn.toExponential(1)} rad; ${crowded.count} among crowded impacts, ${(1e3 * crowded.place).toFixed(3)} mm, ${crowded.turn.toExponential(1)} rad`);
  if (issues.numErrors + issues.numWarnings) console.log(said.slice(0, 10).join('\n'));
}
console.log(`${checked} GLB files checked, ${failed} wrong`);
process.exit(failed || !checked ? 1 : 0);

// Plays a file in three.js at the times of the table, and at the middles between frames by the table's doubled rate.
async function play(bytes, table) {
  const gltf = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), '');
  if (gltf.animations.length !== 1) throw new Error(`${gltf.animations.length} animations`);
  const facts = gltf.scene.userData;
  for (const name of ['seed', 'sample', 'log_p', 'scalars']) if (!(name in facts)) throw new Error(`extras have no ${name}`);
  const mixer = new AnimationMixer(gltf.scene), action = mixer.clipAction(gltf.animations[0]);
  action.clampWhenFinished = true;
  action.setLoop(2200, 1); // once
  action.play();
  const [head, ...lines] = table.trim().split('\n').map((line) => line.split(','));
  const column = Object.fromEntries(head.map((name, index) => [name, index]));
  const rows = lines.map((cells) => ({
    time: +cells[column.t], body: cells[column.body], at: new Vector3(...['x', 'y', 'z'].map((axis) => +cells[column[axis]])),
    impact: cells[column.impact] === 'true', turned: new Quaternion(...['qx', 'qy', 'qz', 'qw'].map((part) => +cells[column[part]])),
  }));
  const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
  for (const { at } of rows) { low.min(at); high.max(at); }
  const size = low.distanceTo(high), worst = { key: 0, between: 0, turn: 0 };
  const crowded = { count: 0, place: 0, turn: 0 }, impacts = new Map();
  for (const { time, body, impact } of rows) if (impact) impacts.set(body, [...impacts.get(body) ?? [], time]);
  // The table has twice the frame rate of the file: times that the file has no key at are between keys.
  const keyed = new Map(gltf.animations[0].tracks.filter((track) => track.name.endsWith('.position')).map((track) => [track.name.slice(0, -9), new Set(track.times)]));
  let now = -1;
  for (const { time, body, at, turned } of rows) {
    if (time !== now) { mixer.setTime(time); now = time; }
    const node = gltf.scene.getObjectByName(body);
    const kind = keyed.get(body).has(Math.fround(time)) ? 'key' : 'between';
    const off = node.position.distanceTo(at), turn = node.quaternion.angleTo(turned) % (2 * Math.PI - 1e-6);
    if (kind === 'key') worst.key = Math.max(worst.key, off / size);
    if ((impacts.get(body) ?? []).filter((impact) => Math.abs(impact - time) < CROWDED).length > 1) {
      crowded.count++;
      crowded.place = Math.max(crowded.place, off);
      crowded.turn = Math.max(crowded.turn, turn);
      continue;
    }
    if (kind === 'between') worst.between = Math.max(worst.between, off);
    worst.turn = Math.max(worst.turn, turn);
  }
  return { worst, crowded, keys: rows.length, size, bodies: keyed.size };
}
