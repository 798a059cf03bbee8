// A solution as animated glTF, in the layout of `plaus export --format glb`: straight lines between keys, a key at every impact. It is as right as
// the page's numbers of 16 bits.

// Name and facts, as text. Solutions that were found here have no run to tell of.
function labelOf(meta, solution) {
  if (solution.label) return solution.label;
  const { id, chain, iteration, log_p, log_prior, log_constraint, duration } = solution;
  const facts = { plaus: meta.plaus, scene: meta.scene, sample: id, chain, iteration, log_p, log_prior, log_constraint, satisfied: true, scalars: Object.fromEntries(meta.scalars.map(({ name }, k) => [name, solution.scalars[k]])), duration };
  return JSON.stringify({ name: `${meta.name}_${id.replace(':', '_')}`, facts });
}

function glbOf({ meta, stage }, solution, fps = 60) {
  const json = {
    asset: { version: '2.0', generator: `plaus gallery ${meta.plaus}` }, scene: 0, scenes: [], nodes: [], meshes: [], materials: [],
    accessors: [], bufferViews: [], animations: [],
  };
  const chunks = [];
  let length = 0;
  const store = (array, type, component, target, ranged) => {
    const width = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type], view = { buffer: 0, byteOffset: length, byteLength: array.byteLength };
    if (target) view.target = target;
    const padded = new Uint8Array(Math.ceil(array.byteLength / 4) * 4);
    padded.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    chunks.push(padded);
    length += padded.length;
    const accessor = { bufferView: json.bufferViews.push(view) - 1, componentType: component, count: array.length / width, type };
    if (ranged) {
      const low = new Array(width).fill(Infinity), high = new Array(width).fill(-Infinity);
      array.forEach((value, k) => { low[k % width] = Math.min(low[k % width], value); high[k % width] = Math.max(high[k % width], value); });
      Object.assign(accessor, { min: low, max: high });
    }
    return json.accessors.push(accessor) - 1;
  };
  const FLOAT = 5126;
  const paints = new Map();
  const material = (look) => {
    const key = `${look.colour}|${look.material}`;
    if (!paints.has(key)) {
      const [metallicFactor, roughnessFactor, opacity] = SURFACES[look.material] ?? SURFACES.matte;
      const { r, g, b } = new THREE.Color().setRGB(...look.colour.map((c) => c / 255), THREE.SRGBColorSpace);
      const paint = { name: look.name ?? key, pbrMetallicRoughness: { baseColorFactor: [r, g, b, opacity], metallicFactor, roughnessFactor } };
      if (opacity < 1) paint.alphaMode = 'BLEND';
      paints.set(key, json.materials.push(paint) - 1);
    }
    return paints.get(key);
  };
  const primitive = (geometry, look) => ({
    attributes: {
      POSITION: store(geometry.getAttribute('position').array, 'VEC3', FLOAT, 34962, true),
      NORMAL: store(unit(geometry.getAttribute('normal').array), 'VEC3', FLOAT, 34962),
    },
    indices: store(geometry.index.array, 'SCALAR', geometry.index.array instanceof Uint16Array ? 5123 : 5125, 34963),
    material: material(look),
  });
  const children = [];
  for (const index of solution.props) {
    const { name, look } = meta.props[index];
    const mesh = json.meshes.push({ name, primitives: [primitive(stage.prop(index).userData.whole, look)] }) - 1;
    children.push(json.nodes.push({ name, mesh }) - 1);
  }
  const { name: called, facts } = JSON.parse(labelOf(meta, solution)), animation = { name: called, channels: [], samplers: [] };
  const models = new Map();
  solution.tracks.forEach(([name, model], track) => {
    if (!models.has(model)) {
      const primitives = meta.models[model].parts.map((part, k) => primitive(stage.parts(model, false)[k].userData.whole, part.look));
      models.set(model, json.meshes.push({ name: meta.names[name], primitives }) - 1);
    }
    const keys = keysOf({ meta }, solution, track, fps), node = json.nodes.length;
    json.nodes.push({ name: meta.names[name], mesh: models.get(model), translation: Array.from(keys.places.subarray(0, 3)) });
    children.push(node);
    const input = store(keys.times, 'SCALAR', FLOAT, 0, true);
    const channel = (path, output, interpolation) => {
      animation.channels.push({ sampler: animation.samplers.push({ input, output, interpolation }) - 1, target: { node, path } });
    };
    channel('translation', store(keys.places, 'VEC3', FLOAT), 'LINEAR');
    const appears = solution.appears(track);
    if (appears > 0) {
      const input = store(new Float32Array([0, appears]), 'SCALAR', FLOAT, 0, true), output = store(new Float32Array([0, 0, 0, 1, 1, 1]), 'VEC3', FLOAT);
      animation.channels.push({ sampler: animation.samplers.push({ input, output, interpolation: 'STEP' }) - 1, target: { node, path: 'scale' } });
    }
    if (solution.turning) channel('rotation', store(keys.turns, 'VEC4', FLOAT), 'LINEAR');
  });
  const extras = { ...facts, fps, time_range: [0, solution.duration], last_frame: Math.ceil(solution.duration * fps) };
  json.nodes.push({ name: animation.name, children, extras });
  json.scenes.push({ name: animation.name, nodes: [json.nodes.length - 1], extras });
  json.animations.push({ ...animation, extras });
  json.buffers = [{ byteLength: length }];
  return container(json, chunks, length);
}

// Normals were sent as bytes: make them unit vectors again.
function unit(normals) {
  const out = new Float32Array(normals.length);
  for (let k = 0; k < normals.length; k += 3) {
    const size = Math.hypot(normals[k], normals[k + 1], normals[k + 2]) || 1;
    for (let axis = 0; axis < 3; axis++) out[k + axis] = normals[k + axis] / size;
  }
  return out;
}

// How far a body may be from a straight line between keys, in m and as a share of its reach; and the largest turn between keys, in rad. The numbers are those of `plaus export`.
const OFF = 2e-4, OFF_SHARE = 0.01, LARGEST_TURN = 0.5;

// Times, positions and orientations: at frames, at starts of pieces, and in between where a body falls or turns fast.
function keysOf({ meta }, solution, track, fps) {
  const open = solution.open(), [, model, count] = solution.tracks[track], first = open.firsts[track], end = solution.duration;
  const most = Math.min(OFF, OFF_SHARE * meta.models[model].reach);
  const times = new Set([0, end].map(Math.fround));
  for (let frame = 0; frame / fps < end; frame++) times.add(Math.fround(frame / fps));
  for (let k = first; k < first + count; k++) if (open.start[k] >= 0 && open.start[k] <= end) times.add(Math.fround(open.start[k]));
  const sorted = [...times].sort((a, b) => a - b), dense = [];
  sorted.forEach((time, index) => {
    dense.push(time);
    const next = sorted[index + 1];
    if (next === undefined) return;
    const k = solution.piece(track, time), length = next - time;
    const bend = length * Math.sqrt(Math.hypot(...open.acceleration.subarray(3 * k, 3 * k + 3)) / (8 * most));
    const turn = open.spin ? ((Math.hypot(...open.spin.subarray(3 * k, 3 * k + 3)) + Math.abs(open.own[k])) * length) / LARGEST_TURN : 0;
    const parts = Math.ceil(Math.max(bend, turn));
    for (let part = 1; part < parts; part++) dense.push(Math.fround(time + (length * part) / parts));
  });
  const distinct = [...new Set(dense)];
  const places = new Float32Array(3 * distinct.length), turns = new Float32Array(4 * distinct.length);
  const p = new THREE.Vector3(), q = new THREE.Quaternion(), before = new THREE.Quaternion();
  distinct.forEach((time, index) => {
    solution.pose(track, time, p, q);
    places.set([p.x, p.y, p.z], 3 * index);
    if (index && q.dot(before) < 0) q.set(-q.x, -q.y, -q.z, -q.w);
    before.copy(q);
    turns.set([q.x, q.y, q.z, q.w], 4 * index);
  });
  return { times: new Float32Array(distinct), places, turns };
}

function container(json, chunks, length) {
  let text = JSON.stringify(json);
  text += ' '.repeat((4 - (new TextEncoder().encode(text).length % 4)) % 4);
  const head = new TextEncoder().encode(text), file = new Uint8Array(28 + head.length + length), view = new DataView(file.buffer);
  const words = [0x46546c67, 2, file.length, head.length, 0x4e4f534a];
  words.forEach((word, k) => view.setUint32(4 * k, word, true));
  file.set(head, 20);
  view.setUint32(20 + head.length, length, true);
  view.setUint32(24 + head.length, 0x004e4942, true);
  let at = 28 + head.length;
  for (const chunk of chunks) { file.set(chunk, at); at += chunk.length; }
  return file;
}
