// Plays a GLB file in Babylon.js, without a picture. It counts frames from 0 at the first key, in single precision.
import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
import { Logger } from '@babylonjs/core/Misc/logger.js';
import { ImportMeshAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/loaders/glTF/2.0/index.js';

export const NAME = 'Babylon.js', TIMES = 'rounded';
Logger.LogLevels = Logger.ErrorLogLevel;

export async function play(bytes) {
  const scene = new Scene(new NullEngine());
  scene.useRightHandedSystem = true;
  const { animationGroups } = await ImportMeshAsync(bytes, scene, { pluginExtension: '.glb' });
  if (animationGroups.length !== 1) throw new Error(`${animationGroups.length} animations`);
  const [group] = animationGroups, keyed = new Map();
  for (const { animation, target } of group.targetedAnimations) {
    if (animation.targetProperty === 'position') keyed.set(target.name, new Set());
  }
  const rate = group.targetedAnimations[0].animation.framePerSecond;
  const facts = scene.transformNodes.concat(scene.meshes).map((node) => node.metadata?.gltf?.extras).find(Boolean) ?? {};
  group.start(false);
  group.pause();
  let now = -1;
  const poseAt = (time, body) => {
    if (time !== now) group.goToFrame(Math.min(time * rate, group.to));
    now = time;
    const node = scene.getNodeByName(body);
    return { position: node.position.asArray(), orientation: (node.rotationQuaternion ?? { asArray: () => [0, 0, 0, 1] }).asArray() };
  };
  return { facts, keyed, poseAt };
}
