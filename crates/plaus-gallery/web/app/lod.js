// Fewer triangles for small pictures: the corners that lie in one cell of a grid become one (Rossignac and Borrel, "Multi-resolution 3D
// approximations for rendering complex scenes", 1993). Cells are about a pixel wide, so the difference cannot be seen.

// Meshes with fewer triangles are not changed.
const FEW = 150;
// Largest side of a cell, in pixels; sides are at least half of it, because they double from level to level.
const CELL = 1.6;

// A geometry for pictures in which a pixel is `pixel` metres wide.
function atDetail(geometry, pixel) {
  if (geometry.index.count < 3 * FEW) return geometry;
  const levels = (geometry.userData.levels ??= new Map()), level = Math.floor(Math.log2(CELL * pixel));
  if (!levels.has(level)) {
    const made = coarser(geometry, 2 ** level), corners = (g) => g.getAttribute('position').count;
    const spares = made.index.count < 0.75 * geometry.index.count || corners(made) < 0.75 * corners(geometry);
    levels.set(level, spares ? made : geometry);
  }
  return levels.get(level);
}

function coarser(geometry, cell) {
  const from = geometry.getAttribute('position').array, normal = geometry.getAttribute('normal').array, count = from.length / 3;
  const cells = new Map(), corners = new Map(), cellOf = new Uint32Array(count), cornerOf = new Uint32Array(count);
  const numbered = (map, key) => { if (!map.has(key)) map.set(key, map.size); return map.get(key); };
  for (let k = 0; k < count; k++) {
    const i = 3 * k, [x, y, z] = [0, 1, 2].map((axis) => Math.floor(from[i + axis] / cell));
    cellOf[k] = numbered(cells, `${x},${y},${z}`);
    // Edges stay sharp: a place has one corner for each direction that its normals point to.
    const size = [0, 1, 2].map((axis) => Math.abs(normal[i + axis])), side = size.indexOf(Math.max(...size));
    cornerOf[k] = numbered(corners, 6 * cellOf[k] + 2 * side + (normal[i + side] > 0 ? 1 : 0));
  }
  const places = new Float64Array(3 * cells.size), members = new Uint32Array(cells.size), home = new Uint32Array(corners.size);
  const positions = new Float32Array(3 * corners.size), normals = new Float32Array(3 * corners.size);
  for (let k = 0; k < count; k++) {
    home[cornerOf[k]] = cellOf[k];
    members[cellOf[k]]++;
    for (let axis = 0; axis < 3; axis++) {
      places[3 * cellOf[k] + axis] += from[3 * k + axis];
      normals[3 * cornerOf[k] + axis] += normal[3 * k + axis];
    }
  }
  for (let c = 0; c < corners.size; c++) {
    const n = 3 * c, length = Math.hypot(normals[n], normals[n + 1], normals[n + 2]) || 1;
    for (let axis = 0; axis < 3; axis++) {
      positions[n + axis] = places[3 * home[c] + axis] / members[home[c]];
      normals[n + axis] /= length;
    }
  }
  const kept = [], index = geometry.index.array;
  for (let k = 0; k < index.length; k += 3) {
    const [a, b, c] = [cellOf[index[k]], cellOf[index[k + 1]], cellOf[index[k + 2]]];
    if (a !== b && b !== c && c !== a) kept.push(cornerOf[index[k]], cornerOf[index[k + 1]], cornerOf[index[k + 2]]);
  }
  const made = assemble(positions, normals, corners.size > 65535 ? new Uint32Array(kept) : new Uint16Array(kept));
  lay(made, geometry.userData.grain ?? 1);
  return made;
}
