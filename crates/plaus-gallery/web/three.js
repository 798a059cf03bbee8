// What the gallery uses of three.js; build.mjs makes one classic script of it, because modules cannot be loaded from file://.
export {
  ACESFilmicToneMapping, AmbientLight, BasicShadowMap, Box3, BufferAttribute, BufferGeometry, CanvasTexture, CircleGeometry, Color, DirectionalLight,
  DoubleSide, DynamicDrawUsage, Float32BufferAttribute, Group, HemisphereLight, InstancedMesh, Line, LineBasicMaterial, LineSegments,
  Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial, MeshStandardMaterial, NoToneMapping, PCFShadowMap, PCFSoftShadowMap,
  PerspectiveCamera, PlaneGeometry, PMREMGenerator, Points, PointsMaterial, Quaternion, RepeatWrapping, Scene, ShadowMaterial, SRGBColorSpace,
  RingGeometry, SphereGeometry, Vector2, Vector3, VSMShadowMap, WebGLRenderer, REVISION,
} from 'three';
export { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
export { RoomEnvironment } from 'three/examples/jsm/environments/RoomEnvironment.js';
export { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
export { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
export { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
