/* global THREE */

// RViz's light shines from the camera along its direction, so the brightness of a face is the part of
// its normal that points at the viewer (z in view space). There is no other light, and no gloss.

/** Metres per pixel, one metre ahead of a camera with perspective, or anywhere without; set for each view. */
export const pixel = { value: 0.001 };

const FRAGMENT = `
  varying vec4 vColor;
  #if defined(SMOOTH)
    varying vec3 vNormal;
  #elif defined(FLAT)
    varying vec3 vPosition;
  #endif
  #ifdef TEXTURED
    uniform sampler2D mask;
    varying vec2 vUv;
  #endif
  void main() {
    gl_FragColor = vColor;
    #if defined(SMOOTH)
      gl_FragColor.rgb *= abs(normalize(vNormal).z);
    #elif defined(FLAT)
      gl_FragColor.rgb *= abs(normalize(cross(dFdx(vPosition), dFdy(vPosition))).z);
    #endif
    #ifdef TEXTURED
      gl_FragColor.a *= texture2D(mask, vUv).r;
      if (gl_FragColor.a < 0.01) discard;
    #endif
  }`;

const SURFACE = `
  attribute vec4 tint;
  varying vec4 vColor;
  #ifdef SMOOTH
    varying vec3 vNormal;
  #endif
  #ifdef FLAT
    varying vec3 vPosition;
  #endif
  void main() {
    mat4 place = modelViewMatrix;
    #ifdef USE_INSTANCING
      place = place * instanceMatrix;
    #endif
    vec4 position4 = place * vec4(position, 1.0);
    vColor = tint;
    #ifdef SMOOTH
      mat3 m = mat3(place);  // its cofactors turn normals right, however it stretches
      vNormal = cross(m[1], m[2]) * normal.x + cross(m[2], m[0]) * normal.y + cross(m[0], m[1]) * normal.z;
    #endif
    #ifdef FLAT
      vPosition = position4.xyz;
    #endif
    gl_Position = projectionMatrix * position4;
  }`;

// Ogre's billboard chain: at each point the strip is as wide as asked, at right angles to the line that
// joins its neighbours and to the direction of the eye.
const STRIP = `
  attribute vec3 before;
  attribute vec3 start;
  attribute vec3 end;
  attribute vec3 after;
  attribute vec4 startTint;
  attribute vec4 endTint;
  uniform float pixel;
  uniform vec3 size;
  varying vec4 vColor;
  void main() {
    bool first = position.x < 0.0;
    vec4 here = modelViewMatrix * vec4(first ? start : end, 1.0);
    vec3 along = mat3(modelViewMatrix) * (first ? end - before : after - start);
    vec3 across = cross(along, isOrthographic ? vec3(0.0, 0.0, 1.0) : -here.xyz);
    float width = size.x > 0.0 ? size.x : pixel * (isOrthographic ? 1.0 : -here.z);
    here.xyz += across / max(length(across), 1e-9) * width * position.y;
    vColor = first ? startTint : endTint;
    gl_Position = projectionMatrix * here;
  }`;

// RViz's nogp/billboard.vert: what faces the eye keeps its upper side along the node's y; boxes keep the
// node's axes, and text and pixels those of the picture.
const SPOT = `
  attribute float shade;
  attribute vec3 start;
  attribute vec4 startTint;
  uniform float pixel;
  uniform vec3 size;
  uniform bool inPixels;
  uniform bool grow;
  varying vec4 vColor;
  varying vec2 vUv;
  void main() {
    vec4 here = modelViewMatrix * vec4(start, 1.0);
    mat3 axes = mat3(1.0);
    vColor = startTint;
    #if defined(FACING)
      vec3 towards = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-here.xyz);
      vec3 right = cross(modelViewMatrix[1].xyz, towards);
      right /= max(length(right), 1e-9);
      axes = mat3(right, cross(towards, right), towards);
    #elif defined(BOX)
      axes = mat3(modelViewMatrix);
    #endif
    #ifdef TEXTURED
      vUv = uv;
    #else
      vColor.rgb *= shade;
    #endif
    float unit = inPixels ? pixel * (isOrthographic ? 1.0 : -here.z) : 1.0;
    if (grow) unit *= start.z;
    here.xyz += axes * (position * size * unit);
    gl_Position = projectionMatrix * here;
  }`;

const DOT = `
  attribute vec3 start;
  attribute vec4 startTint;
  uniform float pixel;
  uniform vec3 size;
  uniform bool inPixels;
  uniform bool grow;
  varying vec4 vColor;
  void main() {
    vec4 here = modelViewMatrix * vec4(start, 1.0);
    float unit = inPixels ? 1.0 : pixel * (isOrthographic ? 1.0 : -here.z);
    vColor = startTint;
    gl_Position = projectionMatrix * here;
    gl_PointSize = max(size.x / unit * (grow ? start.z : 1.0), 1.0);
  }`;

/** @type {Map<string, any>} They live as long as the page: a marker that is sent anew compiles nothing. */
const made = new Map();

/**
 * @param {"surface" | "strip" | "spot" | "dot"} kind @param {boolean} transparent RViz blends without writing depth
 * @param {"SMOOTH" | "FLAT" | "TEXTURED" | "FACING" | "BOX" | ""} [define] how it is shaded or placed
 * @param {boolean} [doubleSided] @returns {any} a THREE.ShaderMaterial that others use too
 */
export function material(kind, transparent, define = "", doubleSided = true) {
  const key = [kind, transparent, define, doubleSided].join();
  let found = made.get(key);
  if (!found) {
    found = new THREE.ShaderMaterial({
      vertexShader: { surface: SURFACE, strip: STRIP, spot: SPOT, dot: DOT }[kind],
      fragmentShader: FRAGMENT,
      defines: define ? { [define]: "" } : {},
      uniforms: { pixel, size: { value: [0, 0, 0] }, inPixels: { value: false }, grow: { value: false }, mask: { value: null } },
      side: doubleSided ? THREE.DoubleSide : THREE.FrontSide,
      transparent,
      depthWrite: !transparent,
      extensions: { derivatives: true },
    });
    made.set(key, found);
  }
  return found;
}
