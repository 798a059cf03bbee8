// Unpacking: base64 → gzip → length of the description, description (JSON), bytes that its offsets point into.

async function unpack(element) {
  const text = element.textContent.trim();
  const packed = bytesOf(text);
  element.remove();
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return opened(await new Response(stream).arrayBuffer());
}

// Length of a description, the description, bytes.
function opened(whole) {
  const length = new DataView(whole).getUint32(0, true);
  const meta = JSON.parse(new TextDecoder().decode(new Uint8Array(whole, 4, length)));
  const bytes = whole.slice(4 + length);
  return { meta, bytes };
}

// Bytes of base64, by a plain loop: a callback for each of millions of characters takes several times as long.
function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; k++) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

// Reads columns of numbers one after the other.
class Columns {
  constructor(bytes, at) { this.bytes = bytes; this.at = at; }
  take(Kind, count) {
    const end = this.at + count * Kind.BYTES_PER_ELEMENT;
    const column = new Kind(this.bytes.slice(this.at, end));
    this.at = end;
    return column;
  }
}

// A mesh in the form that three.js needs.
function geometryOf(bytes, mesh) {
  const columns = new Columns(bytes, mesh.at);
  const count = mesh.corners;
  const positions = new Float32Array(3 * count), normals = new Float32Array(3 * count);
  for (let axis = 0; axis < 3; axis++) {
    const shares = columns.take(Uint16Array, count), size = (mesh.high[axis] - mesh.low[axis]) / 65535;
    for (let k = 0; k < count; k++) positions[3 * k + axis] = mesh.low[axis] + shares[k] * size;
  }
  for (let axis = 0; axis < 3; axis++) {
    const parts = columns.take(Int8Array, count);
    for (let k = 0; k < count; k++) normals[3 * k + axis] = parts[k] / 127;
  }
  if (columns.at % 2) columns.at++;
  const indices = columns.take(mesh.wide ? Uint32Array : Uint16Array, mesh.indices);
  return assemble(positions, normals, indices);
}

// Heights over a grid.
function fieldOf(bytes, grid) {
  const shares = new Columns(bytes, grid.at).take(Uint16Array, grid.count);
  const columns = grid.columns, rows = grid.count / columns, size = (grid.high - grid.low) / 65535;
  const height = (c, r) => grid.low + size * shares[Math.min(Math.max(r, 0), rows - 1) * columns + Math.min(Math.max(c, 0), columns - 1)];
  const positions = new Float32Array(3 * grid.count), normals = new Float32Array(3 * grid.count), indices = [];
  for (let r = 0; r < rows; r++) {
    for (let c = 0; c < columns; c++) {
      const k = r * columns + c;
      positions.set([grid.origin[0] + c * grid.step[0], grid.origin[1] + height(c, r), grid.origin[2] + r * grid.step[1]], 3 * k);
      const dx = (height(c + 1, r) - height(c - 1, r)) / (2 * grid.step[0]), dz = (height(c, r + 1) - height(c, r - 1)) / (2 * grid.step[1]);
      const length = Math.hypot(dx, 1, dz);
      normals.set([-dx / length, 1 / length, -dz / length], 3 * k);
      if (r && c) indices.push(k - columns - 1, k - 1, k, k - columns - 1, k, k - columns);
    }
  }
  return assemble(positions, normals, new Uint32Array(indices));
}

function assemble(positions, normals, indices) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
  geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}
