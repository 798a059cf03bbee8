// Plays what `plaus export --format json` writes: bodies of a clip at any time. Copy it into a game.
export function clips(text) {
  return JSON.parse(text).clips.map((clip) => ({ ...clip, bodies: clip.bodies.map(body) }));
}

// Times in seconds, positions in metres and quaternions (x, y, z, w) as arrays.
function body({ t, p, tq, q, step, ...about }) {
  const places = { times: summed(t, 1).map((x) => x / 128000), values: summed(p, 3).map((x) => x * step), width: 3 };
  const turns = q ? { times: summed(tq, 1).map((x) => x / 128000), values: summed(q, 4), width: 4 } : null;
  return { ...about, places, turns };
}

// Each number is the difference from the previous one of the same component.
function summed(differences, width) {
  const all = Float64Array.from(differences);
  for (let k = width; k < all.length; k++) all[k] += all[k - width];
  return all;
}

// Place and orientation of a body at a time.
export function pose({ places, turns }, time) {
  const turned = turns ? between(turns, time) : [0, 0, 0, 1], size = Math.hypot(...turned);
  return { position: between(places, time), orientation: turned.map((x) => x / size) };
}

// A straight line between two keys; before the first key and after the last, that key.
function between({ times, values, width }, time) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  const length = times[high] - times[low];
  const share = length > 0 ? Math.min(Math.max((time - times[low]) / length, 0), 1) : 0;
  return Array.from({ length: width }, (_, k) => {
    const from = values[width * low + k];
    return from + share * (values[width * high + k] - from);
  });
}
