// Plays a GLB file in three.js.
globalThis.self ??= globalThis; // three.js expects this from a browser
const { AnimationMixer } = await import('three');
const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');

export const NAME = 'three.js', TIMES = 'exact';

export async function play(bytes) {
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const { animations, scene } = await new GLTFLoader().parseAsync(buffer, '');
  if (animations.length !== 1) throw new Error(`${animations.length} animations`);
  const mixer = new AnimationMixer(scene), action = mixer.clipAction(animations[0]);
  action.clampWhenFinished = true;
  action.setLoop(2200, 1); // once
  action.play();
  const places = animations[0].tracks.filter((track) => track.name.endsWith('.position'));
  const keyed = new Map(places.map((track) => [track.name.slice(0, -9), new Set(track.times)]));
  let now = -1;
  const poseAt = (time, body) => {
    if (time !== now) mixer.setTime(time);
    now = time;
    const { position, quaternion } = scene.getObjectByName(body);
    return { position: position.toArray(), orientation: quaternion.toArray() };
  };
  return { facts: scene.userData, keyed, poseAt };
}
