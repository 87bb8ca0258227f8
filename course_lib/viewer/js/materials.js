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

const PLACED = `
  attribute vec3 start;
  attribute vec4 startTint;
  uniform float pixel;
  uniform vec3 size;
  uniform bool inPixels;
  uniform bool grow;
  varying vec4 vColor;
  float pixelAt(vec4 here) { return pixel * (isOrthographic ? 1.0 : -here.z); }`;

// Ogre's billboard chain: at each point the strip is as wide as asked, at right angles to the line that
// joins its neighbours and to the direction of the eye.
const STRIP = `${PLACED}
  attribute vec3 before;
  attribute vec3 end;
  attribute vec3 after;
  attribute vec4 endTint;
  void main() {
    bool first = position.x < 0.0;
    vec4 here = modelViewMatrix * vec4(first ? start : end, 1.0);
    vec3 along = mat3(modelViewMatrix) * (first ? end - before : after - start);
    vec3 across = cross(along, isOrthographic ? vec3(0.0, 0.0, 1.0) : -here.xyz);
    float width = size.x > 0.0 ? size.x : pixelAt(here);
    here.xyz += across / max(length(across), 1e-9) * width * position.y;
    vColor = first ? startTint : endTint;
    gl_Position = projectionMatrix * here;
  }`;

// RViz's nogp/billboard.vert: what faces the eye keeps its upper side along the node's y; boxes keep the
// node's axes, and text and pixels those of the picture. Dots are the graphics library's own points.
const SPOT = `${PLACED}
  attribute float shade;
  varying vec2 vUv;
  void main() {
    vec4 here = modelViewMatrix * vec4(start, 1.0);
    float unit = (inPixels ? pixelAt(here) : 1.0) * (grow ? start.z : 1.0);
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
    #if defined(DOT)
      gl_PointSize = max(size.x * unit / pixelAt(here), 1.0);
    #else
      here.xyz += axes * (position * size * unit);
      #ifdef TEXTURED
        vUv = uv;
      #else
        vColor.rgb *= shade;
      #endif
    #endif
    gl_Position = projectionMatrix * here;
  }`;

/** @type {Map<string, any>} They live as long as the page: a marker that is sent anew compiles nothing. */
const made = new Map();

/**
 * @param {"surface" | "strip" | "spot"} kind @param {boolean} transparent RViz blends without writing depth
 * @param {"SMOOTH" | "FLAT" | "TEXTURED" | "FACING" | "BOX" | "DOT" | ""} [define] how it is shaded or placed
 * @param {boolean} [doubleSided] @returns {any} a THREE.ShaderMaterial that others use too
 */
export function material(kind, transparent, define = "", doubleSided = true) {
  const key = [kind, transparent, define, doubleSided].join();
  let found = made.get(key);
  if (!found) {
    found = new THREE.ShaderMaterial({
      vertexShader: { surface: SURFACE, strip: STRIP, spot: SPOT }[kind],
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
