// Materials.

const software = (() => {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const name = gl ? String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
})();

// Metalness, roughness, opacity; the same as in exported files.
const SURFACES = {
  matte: [0, 0.9, 1], glossy: [0, 0.25, 1], glass: [0, 0.08, 0.16], metal: [1, 0.3, 1], wood: [0, 0.55, 1], felt: [0, 1, 1], mark: [0, 0.8, 0.55],
};

// Planks, seen from any side: drawn once, and mapped by position in the world.
function grain(colour) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 256;
  const pen = canvas.getContext('2d');
  pen.fillStyle = `rgb(${colour})`;
  pen.fillRect(0, 0, 256, 256);
  let seed = 7;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let k = 0; k < 420; k++) {
    const y = random() * 256, dark = random() < 0.6;
    pen.strokeStyle = dark ? `rgba(60,30,5,${0.02 + 0.07 * random()})` : `rgba(255,235,205,${0.03 + 0.06 * random()})`;
    pen.lineWidth = 0.5 + 1.6 * random();
    pen.beginPath();
    pen.moveTo(-5, y);
    pen.bezierCurveTo(80, y + 8 * (random() - 0.5), 170, y + 8 * (random() - 0.5), 261, y);
    pen.stroke();
  }
  return tiled(canvas);
}

// Cloth: fibres in all directions, a little lighter and darker than the rest.
function cloth(colour) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 256;
  const pen = canvas.getContext('2d');
  pen.fillStyle = `rgb(${colour})`;
  pen.fillRect(0, 0, 256, 256);
  let seed = 11;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let k = 0; k < 9000; k++) {
    const [x, y, turn, length] = [256 * random(), 256 * random(), 6.3 * random(), 1 + 4 * random()];
    pen.strokeStyle = random() < 0.5 ? `rgba(0,0,0,${0.16 * random()})` : `rgba(255,255,255,${0.1 * random()})`;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + length * Math.cos(turn), y + length * Math.sin(turn));
    pen.stroke();
  }
  return tiled(canvas);
}

function tiled(canvas) {
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = 4;
  return texture;
}

// Texture coordinates, from the axis nearest to a corner's normal.
function lay(geometry, size) {
  const p = geometry.getAttribute('position'), n = geometry.getAttribute('normal'), uv = new Float32Array(2 * p.count);
  for (let k = 0; k < p.count; k++) {
    const [x, y, z] = [p.getX(k), p.getY(k), p.getZ(k)], up = Math.abs(n.getY(k)), side = Math.abs(n.getX(k));
    uv.set(up > 0.6 ? [x / size, z / size] : side > 0.6 ? [z / size, y / size] : [x / size, y / size], 2 * k);
  }
  geometry.setAttribute('uv', new THREE.BufferAttribute(uv, 2));
  geometry.userData.grain = size;
  return geometry;
}

const materials = new Map();

function materialOf(look, ghost) {
  const key = `${look.colour}|${look.material}|${ghost ? 1 : 0}`;
  if (materials.has(key)) return materials.get(key);
  const [metalness, roughness, opacity] = SURFACES[look.material] ?? SURFACES.matte;
  const colour = new THREE.Color().setRGB(...look.colour.map((c) => c / 255), THREE.SRGBColorSpace);
  if (ghost) colour.set('#2f9bff');
  // Without a graphics card every pixel counts: simpler laws of reflection.
  const shiny = roughness < 0.4, settings = { color: colour };
  if (!software) Object.assign(settings, { metalness, roughness, envMapIntensity: 0.55 });
  else if (shiny) Object.assign(settings, { shininess: 60, specular: 0x555555 });
  const seen = ghost ? 0.5 : opacity;
  if (seen < 1) Object.assign(settings, { transparent: true, opacity: seen, depthWrite: ghost });
  if (look.material === 'glass') settings.side = THREE.DoubleSide;
  if (look.material === 'wood' && !ghost) Object.assign(settings, { map: grain(look.colour), color: 0xffffff });
  if (look.material === 'felt' && !ghost) Object.assign(settings, { map: cloth(look.colour), color: 0xffffff });
  const Kind = !software ? THREE.MeshStandardMaterial : shiny ? THREE.MeshPhongMaterial : THREE.MeshLambertMaterial, material = new Kind(settings);
  materials.set(key, material);
  return material;
}
