export {
  BufferAttribute, BufferGeometry, Color, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry,
  LineBasicMaterial, LineSegments, Mesh, PerspectiveCamera, RawShaderMaterial, Scene, Vector3, Vector4, WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
