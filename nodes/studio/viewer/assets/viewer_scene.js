// Shapes that are drawn: spheres as one square each, force chains as prisms, the outline of the cell.
"use strict";
const grainlabScene = (() => {
  const COMMON = `precision highp float; precision highp int;
uniform mat4 projectionMatrix; uniform vec4 uClip; uniform vec3 uBack; uniform vec2 uFog;`;
  // Light from the upper left of the viewer, darker at the rim and, further away, paler.
  const SHADE = `
vec3 shade(vec3 colour, vec3 n, vec3 p) {
  vec3 v = normalize(-p);
  float key = max(dot(n, normalize(vec3(-0.45, 0.7, 0.75))), 0.0), facing = max(dot(n, v), 0.0);
  vec3 lit = colour * (0.34 + 0.72 * key) * (0.62 + 0.38 * smoothstep(0.0, 0.5, facing));
  lit += 0.10 * pow(max(dot(n, normalize(normalize(vec3(-0.45, 0.7, 0.75)) + v)), 0.0), 40.0);
  return mix(lit, uBack, 0.55 * smoothstep(uFog.x, uFog.y, -p.z));
}
float depthOf(vec3 p) { return 0.5 + 0.5 * (projectionMatrix[2][2] * p.z + projectionMatrix[3][2]) / -p.z; }`;

  const SPHERE_VERTEX = `${COMMON}
uniform mat4 viewMatrix; uniform float uSize; uniform float uPicked;
in vec4 sphere; in vec4 colour;
flat out vec4 vSphere; flat out vec3 vColour; out vec3 vAt;
void main() {
  vec3 c = (viewMatrix * vec4(sphere.xyz, 1.0)).xyz;
  float r = sphere.w * uSize, d = length(c);
  vec3 w = c / d, u = normalize(cross(w, vec3(0.0, 1.0, 0.0))), v = cross(u, w);
  float wide = r * d / sqrt(max(d * d - r * r, 1e-12));
  vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  vAt = c + (u * corner.x + v * corner.y) * wide;
  vSphere = vec4(c, r);
  vColour = float(gl_VertexID / 4) == uPicked ? vec3(1.0, 0.25, 0.55) : colour.rgb;
  gl_Position = dot(uClip.xyz, c) - r > uClip.w ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * vec4(vAt, 1.0);
}`;
  const SPHERE_FRAGMENT = `${COMMON}${SHADE}
flat in vec4 vSphere; flat in vec3 vColour; in vec3 vAt;
out vec4 pixel;
void main() {
  float a = dot(vAt, vAt), b = dot(vAt, vSphere.xyz), c = dot(vSphere.xyz, vSphere.xyz) - vSphere.w * vSphere.w;
  float under = b * b - a * c;
  if (under < 0.0) discard;
  float root = sqrt(under), near = (b - root) / a;
  vec3 p = near * vAt, n = (p - vSphere.xyz) / vSphere.w;
  bool face = false;
  if (dot(uClip.xyz, p) > uClip.w) {
    float cut = uClip.w / dot(uClip.xyz, vAt);
    if (cut < near || cut > (b + root) / a) discard;
    p = cut * vAt; face = true;
  }
  gl_FragDepth = depthOf(p);
  // The face of a cut has the colour of the legend.
  pixel = vec4(face ? vColour : shade(vColour, n, p), 1.0);
}`;
  // A ribbon towards the viewer, lit as a cylinder.
  const CHAIN_VERTEX = `${COMMON}
uniform mat4 viewMatrix;
in vec3 from; in vec3 to; in vec4 tint;
out vec3 vAt; out float vAcross; flat out vec3 vSide; flat out float vWide; flat out vec3 vColour;
void main() {
  vec3 a = (viewMatrix * vec4(from, 1.0)).xyz, b = (viewMatrix * vec4(to, 1.0)).xyz;
  vec3 at = (gl_VertexID & 2) == 0 ? a : b;
  vAcross = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  vSide = normalize(cross(b - a, a + b));
  vWide = tint.a;
  vAt = at + vSide * vAcross * vWide;
  vColour = tint.rgb;
  gl_Position = projectionMatrix * vec4(vAt, 1.0);
}`;
  const CHAIN_FRAGMENT = `${COMMON}${SHADE}
in vec3 vAt; in float vAcross; flat in vec3 vSide; flat in float vWide; flat in vec3 vColour;
out vec4 pixel;
void main() {
  float up = sqrt(max(1.0 - vAcross * vAcross, 0.0));
  vec3 front = normalize(cross(vSide, normalize(cross(-vAt, vSide))));
  vec3 n = vSide * vAcross + front * up * sign(dot(front, -vAt)), p = vAt + n * vWide * up * 0.5;
  if (dot(uClip.xyz, p) > uClip.w) discard;
  gl_FragDepth = depthOf(p);
  pixel = vec4(shade(vColour, n, p), 1.0);
}`;

  const material = (uniforms, vertexShader, fragmentShader) =>
    new THREE.RawShaderMaterial({ glslVersion: THREE.GLSL3, uniforms, vertexShader, fragmentShader, side: 2 });

  // Squares of four corners each, as one list: software renderers are slow with instances.
  const squares = (count, attributes, shaders, uniforms) => {
    const geometry = new THREE.BufferGeometry();
    for (const [name, values, size, normalised] of attributes) {
      const all = new values.constructor(4 * values.length);
      for (let n = 0; n < count; n++) {
        const one = values.subarray(size * n, size * (n + 1));
        for (let corner = 0; corner < 4; corner++) all.set(one, size * (4 * n + corner));
      }
      geometry.setAttribute(name, new THREE.BufferAttribute(all, size, normalised));
    }
    const index = new Uint32Array(6 * count);
    for (let n = 0; n < count; n++) index.set([0, 1, 2, 2, 1, 3].map((corner) => 4 * n + corner), 6 * n);
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    const mesh = new THREE.Mesh(geometry, material(uniforms, ...shaders));
    mesh.frustumCulled = false;
    return mesh;
  };

  // Draws only these squares of a mesh.
  const choose = (mesh, numbers, count) => {
    const index = mesh.geometry.index, array = index.array;
    for (let n = 0; n < count; n++) {
      const first = 4 * numbers[n], at = 6 * n;
      array[at] = first; array[at + 1] = first + 1; array[at + 2] = first + 2;
      array[at + 3] = first + 2; array[at + 4] = first + 1; array[at + 5] = first + 3;
    }
    index.clearUpdateRanges();
    index.addUpdateRange(0, 6 * count);
    index.needsUpdate = true;
    mesh.geometry.setDrawRange(0, 6 * count);
  };

  const spheres = (state, colours, uniforms) =>
    squares(state.n, [["sphere", state.spheres, 4], ["colour", colours, 4, true]], [SPHERE_VERTEX, SPHERE_FRAGMENT], uniforms);

  const chains = (state, colourOf, thickness, uniforms) => {
    const m = state.pieces.length, from = new Float32Array(3 * m), to = new Float32Array(3 * m), tint = new Float32Array(4 * m);
    state.pieces.forEach((piece, c) => {
      from.set(piece.slice(0, 3), 3 * c);
      to.set(piece.slice(3, 6), 3 * c);
      tint.set([...colourOf(piece[6]).map((v) => v / 255), thickness(piece[6])], 4 * c);
    });
    return squares(m, [["from", from, 3], ["to", to, 3], ["tint", tint, 4]], [CHAIN_VERTEX, CHAIN_FRAGMENT], uniforms);
  };

  const outline = (cell, colour) => {
    const corner = (n) => [0, 1, 2].map((r) => [0, 1, 2].reduce((x, c) => x + cell[3 * r + c] * (((n >> c) & 1) - 0.5), 0));
    const points = [];
    for (let n = 0; n < 8; n++) for (const c of [1, 2, 4]) if (!(n & c)) points.push(...corner(n), ...corner(n | c));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour }));
  };

  return { spheres, chains, outline, choose };
})();
