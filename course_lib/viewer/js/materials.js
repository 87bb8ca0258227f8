/* global THREE */

// RViz's light shines from the camera along its direction, so the brightness of a face is the part of
// its normal that points at the viewer (z in view space). There is no other light, and no gloss.

/** Metres per pixel at a distance of 1 m, or anywhere without perspective; set for each view. */
export const pixel = { value: 0.001 };

/** Rendered pixels per displayed pixel. */
export const density = { value: 1 };

/** Uniforms of the look "Studio", see studio.js; directions are in the camera's frame. */
export const studio = {
  isStudio: { value: false },
  isLight: { value: false }, // whether its background is light
  sun: { value: new THREE.Vector3(0, 0, 1) },
  sky: { value: new THREE.Vector3(0, 0, 1) },
  shade: { value: null },
  taps: { value: 0 },
  soft: { value: 0 },
  middle: { value: new THREE.Vector2() }, // of the ground, around which thin lines are visible
  reach: { value: 1 }, // [m] from the middle, at which they have faded
  letters: { value: new THREE.Vector2() }, // range of the height of a label's capital letters in displayed pixels
  toShade: { value: new THREE.Matrix4() },
};

// The visible fraction of the sun. A few points are looked up in the shadow map, with a different rotation for each
// pixel. They lie the closer to each other, the closer the objects that cast the shadow: it is sharp below a foot and
// soft below a body.
export const SHADOW = `
  uniform sampler2D shade;
  uniform float taps, soft;
  varying vec3 vShade;
  // three.js packs a depth into the four channels of a color.
  const vec4 UNPACK = 255.0 / 256.0 / vec4(16777216.0, 65536.0, 256.0, 1.0);
  // The number of points in the sun, and the mean distance of the others from what is in front of them.
  vec2 lookUp(float width) {
    float turn = 6.2832 * fract(52.9829 * fract(dot(gl_FragCoord.xy, vec2(0.06711, 0.00584))));
    float lit = 0.0, sum = 0.0;
    for (int i = 0; i < 16; i++) {
      if (float(i) >= taps) break;
      float radius = width * sqrt((float(i) + 0.5) / taps), angle = turn + 2.3999632 * float(i);
      vec4 packed = texture2D(shade, vShade.xy + radius * vec2(cos(angle), sin(angle)));
      float ahead = vShade.z - dot(packed, UNPACK) - 0.006;
      lit += step(ahead, 0.0);
      sum += max(ahead, 0.0);
    }
    return vec2(lit, sum / max(taps - lit, 1.0));
  }
  float sunlight() {
    if (taps < 0.5 || any(greaterThan(abs(vShade - 0.5), vec3(0.5)))) return 1.0;
    vec2 wide = lookUp(soft);
    return (wide.x < taps && soft > 0.0 ? lookUp(clamp(0.12 * wide.y, 0.002, soft)).x : wide.x) / taps;
  }`;

const FRAGMENT = `
  varying vec4 vColor;
  uniform bool isStudio;
  uniform float glow;
  #if defined(SMOOTH) || defined(FLAT)
    uniform vec3 sun, sky;
    ${SHADOW}
    vec3 inStudio(vec3 color, vec3 normal) {
      vec3 n = normal.z < 0.0 ? -normal : normal;
      float up = 0.5 + 0.5 * dot(n, sky), direct = max(dot(n, sun), 0.0);
      direct *= direct > 0.0 ? sunlight() : 0.0;
      vec3 around = mix(vec3(0.27, 0.26, 0.26), vec3(0.58, 0.60, 0.63), up);
      float gloss = pow(max(dot(n, normalize(sun + vec3(0.0, 0.0, 1.0))), 0.0), 48.0);
      // A weak light at the right of the camera, so that the sides of things differ where the sun does not reach them.
      float fill = max(dot(n, vec3(0.56, 0.25, 0.79)), 0.0);
      vec3 lit = color * (around + 0.48 * direct + 0.27 * fill) + 0.12 * gloss * direct;
      // Every surface mirrors a little of the sky, most at its edges, which gives dark parts of a robot their shape.
      float mirror = 0.05 + 0.3 * pow(max(1.0 - n.z, 0.0), 3.0);
      return mix(lit, mix(vec3(0.42, 0.42, 0.43), vec3(0.86, 0.89, 0.94), up), mirror);
    }
  #endif
  #if defined(SMOOTH)
    varying vec3 vNormal;
  #elif defined(FLAT)
    varying vec3 vPosition;
  #endif
  #ifdef THIN
    varying vec2 vAway;
  #endif
  #ifdef TEXTURED
    uniform sampler2D mask;
    uniform float density;
    varying vec2 vUv, vHalf;
    const float CORNER = 4.0;  // [px]
  #endif
  #ifdef CUBE
    varying vec3 vEye, vRight, vUp;
    varying float vIsWhole;
    // The brightness where the ray of this pixel enters the box, whose sides are at -1 and 1; 0 if it passes the box.
    float brightness() {
      vec3 at = vRight * (gl_PointCoord.x - 0.5) + vUp * (0.5 - gl_PointCoord.y);
      vec3 ray = (isOrthographic ? vec3(0.0) : at) - vEye + 1e-6;
      vec3 first = (-sign(ray) - at) / ray, last = (sign(ray) - at) / ray;
      float enter = max(max(first.x, first.y), first.z), leave = min(min(last.x, last.y), last.z);
      vec3 sides = mix(vec3(0.6, 0.4, 0.9), vec3(0.6, 1.0, 0.5), step(0.0, ray));  // BOX_SHADES of billboards.js
      vec3 entered = step(enter, first);
      return enter > leave && vIsWhole < 0.5 ? 0.0 : dot(entered, sides) / dot(entered, vec3(1.0));
    }
  #endif
  void main() {
    gl_FragColor = vColor;
    #if defined(DISC) || defined(BALL)
      float fromMiddle = 2.0 * length(gl_PointCoord - 0.5);
      if (fromMiddle > 1.0) discard;
      #ifdef BALL
        gl_FragColor.rgb *= 1.0 - 0.2 * fromMiddle;
      #endif
    #endif
    #ifdef CUBE
      float bright = brightness();
      if (bright == 0.0) discard;
      gl_FragColor.rgb *= bright;
    #endif
    #ifdef THIN
      if (isStudio) gl_FragColor.a *= 1.0 - smoothstep(0.35, 1.0, length(vAway));
    #endif
    #if defined(SMOOTH)
      vec3 normal = normalize(vNormal);
      gl_FragColor.rgb = isStudio ? inStudio(vColor.rgb, normal) : vColor.rgb * abs(normal.z);
    #elif defined(FLAT)
      vec3 normal = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
      gl_FragColor.rgb = isStudio ? inStudio(vColor.rgb, normal) : vColor.rgb * abs(normal.z);
    #endif
    #ifdef TEXTURED
      float ink = texture2D(mask, vUv).r;
      gl_FragColor.a *= ink;
      if (isStudio) {  // on a plate with round corners; bright letters are dark here
        vec2 corner = abs(2.0 * vUv - 1.0) * vHalf - vHalf + CORNER;
        float inside = CORNER - length(max(corner, 0.0));  // [px] from the edge of the plate
        float plate = clamp(inside * density + 0.5, 0.0, 1.0), rim = 1.0 - clamp((inside - 1.0) * density + 0.5, 0.0, 1.0);
        vec3 color = dot(vColor.rgb, vec3(0.3, 0.59, 0.11)) > 0.6 ? vec3(0.12, 0.14, 0.18) : 0.75 * vColor.rgb;
        gl_FragColor = vec4(mix(mix(vec3(1.0), vec3(0.72, 0.75, 0.79), rim), color, ink), vColor.a * plate * mix(0.88, 1.0, ink));
      }
      if (gl_FragColor.a < 0.01) discard;
    #endif
    gl_FragColor.rgb += glow;
  }`;

const SURFACE = `
  attribute vec4 tint;
  varying vec4 vColor;
  uniform bool isStudio;
  uniform mat4 toShade;
  varying vec3 vShade;
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
    if (isStudio) {
      vec4 world = vec4(position, 1.0);
      #ifdef USE_INSTANCING
        world = instanceMatrix * world;
      #endif
      vShade = (toShade * modelMatrix * world).xyz;
    }
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
  uniform float pixel, density;
  uniform vec3 size;
  uniform bool inPixels, isStudio, isLight;
  uniform bool grow;
  varying vec4 vColor;
  // Points and lines that are nearly white are gray on a light ground, where they would be invisible.
  vec3 readable(vec3 color) {
    float white = smoothstep(0.6, 1.0, min(color.r, min(color.g, color.b)));
    return isLight ? color * (1.0 - 0.55 * white) : color;
  }
  float pixelAt(vec4 here) { return pixel * (isOrthographic ? 1.0 : -here.z); }`;

// Ogre's billboard chain: at each point the strip has the requested width, perpendicular to the line that
// connects its neighbors and to the viewing direction.
const STRIP = `${PLACED}
  attribute vec3 before;
  attribute vec3 end;
  attribute vec3 after;
  attribute vec4 endTint;
  #ifdef THIN
    uniform vec2 middle;
    uniform float reach;
    varying vec2 vAway;
  #endif
  void main() {
    bool first = position.x < 0.0;
    #ifdef THIN
      vAway = ((modelMatrix * vec4(first ? start : end, 1.0)).xy - middle) / reach;
    #endif
    vec4 here = modelViewMatrix * vec4(first ? start : end, 1.0);
    vec3 along = mat3(modelViewMatrix) * (first ? end - before : after - start);
    vec3 across = cross(along, isOrthographic ? vec3(0.0, 0.0, 1.0) : -here.xyz);
    float drawn = pixelAt(here) / min(density, 1.0);  // thinner ones would have gaps
    float width = size.x > 0.0 ? (density < 1.0 ? max(size.x, drawn) : size.x) : drawn;
    here.xyz -= across / max(length(across), 1e-9) * width * position.y;  // its front is seen
    vColor = first ? startTint : endTint;
    vColor.rgb = readable(vColor.rgb);
    gl_Position = projectionMatrix * here;
  }`;

// RViz's nogp/billboard.vert: shapes that face the eye are upright along the node's y; boxes keep the
// node's axes, and text and pixels the axes of the image. Dots are WebGL's own points.
const SPOT = `${PLACED}
  attribute float shade;
  varying vec2 vUv, vHalf;
  #ifdef CUBE
    varying vec3 vEye, vRight, vUp;
    varying float vIsWhole;
  #endif
  uniform float capital, lowered;
  uniform vec2 letters;
  void main() {
    vec4 here = modelViewMatrix * vec4(start, 1.0);
    float unit = (inPixels ? pixelAt(here) : 1.0) * (grow ? start.z : 1.0);
    #ifdef TEXTURED
      if (isStudio) unit *= clamp(capital / pixelAt(here), letters.x, letters.y) * pixelAt(here) / max(capital, 1e-6);
      vHalf = 0.5 * size.xy * unit / pixelAt(here);
    #endif
    mat3 axes = mat3(1.0);
    vColor = startTint;
    #ifndef TEXTURED
      vColor.rgb = readable(vColor.rgb);
    #endif
    #if defined(FACING)
      vec3 towards = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-here.xyz);
      vec3 right = cross(modelViewMatrix[1].xyz, towards);
      right /= max(length(right), 1e-9);
      axes = mat3(right, cross(towards, right), towards);
    #elif defined(BOX)
      axes = mat3(modelViewMatrix);
    #endif
    #ifdef CUBE
      // The eye, and the sides of the point, in the frame of the box, where its own sides are at -1 and 1.
      float wide = clamp(length(size) * unit / pixelAt(here) * density, 1.0, 1000.0);
      mat3 turn = mat3(modelViewMatrix);
      vec3 half_ = max(0.5 * size * unit, 1e-9);
      vEye = (isOrthographic ? vec3(0.0, 0.0, 1.0) : -here.xyz) * turn / half_;
      vRight = wide / density * pixelAt(here) * (vec3(1.0, 0.0, 0.0) * turn) / half_;
      vUp = wide / density * pixelAt(here) * (vec3(0.0, 1.0, 0.0) * turn) / half_;
      vIsWhole = step(wide, 2.0);  // smaller ones would have gaps
      gl_PointSize = wide;
    #elif defined(DOT) || defined(DISC) || defined(BALL)
      gl_PointSize = max(size.x * unit / pixelAt(here), 1.0) * density;
    #else
      here.xyz += axes * ((position - vec3(0.0, lowered, 0.0)) * size * unit);
      #ifdef TEXTURED
        vUv = uv;
      #else
        vColor.rgb *= shade;
      #endif
    #endif
    gl_Position = projectionMatrix * here;
  }`;

/** @type {Map<string, any>} They exist as long as the page, so that a new marker compiles no shader. */
const materials = new Map();

/**
 * @param {"surface" | "strip" | "spot"} kind @param {boolean} transparent RViz blends without writing depth
 * @param {"SMOOTH" | "FLAT" | "TEXTURED" | "FACING" | "BOX" | "DOT" | "DISC" | "BALL" | "CUBE" | "THIN" | ""} [define] how it is shaded or placed
 * @param {boolean} [doubleSided] @returns {any} a THREE.ShaderMaterial that others use too
 */
export function material(kind, transparent, define = "", doubleSided = true) {
  const key = [kind, transparent, define, doubleSided].join();
  let shared = materials.get(key);
  if (!shared) {
    shared = new THREE.ShaderMaterial({
      vertexShader: { surface: SURFACE, strip: STRIP, spot: SPOT }[kind],
      fragmentShader: FRAGMENT,
      defines: define ? { [define]: "" } : {},
      uniforms: { pixel, density, ...studio, size: { value: [0, 0, 0] }, inPixels: { value: false }, grow: { value: false }, mask: { value: null }, capital: { value: 1 }, lowered: { value: 0 }, glow: { value: 0 } },
      side: doubleSided ? THREE.DoubleSide : THREE.FrontSide,
      transparent,
      depthWrite: !transparent,
      extensions: { derivatives: true },
    });
    materials.set(key, shared);
  }
  return shared;
}

/** @param {any} top of a tree whose objects are drawn brighter @param {number} glow is added to their colors; 0 restores them */
export function setGlow(top, glow) {
  top.traverse((/** @type {any} */ object) => {
    const shared = object.material;
    if (!shared?.uniforms?.glow) return;
    const prepare = (object.userData.prepare ??= object.onBeforeRender);
    const setUniform = (/** @type {number} */ value) => {
      shared.uniforms.glow.value = value;
      shared.uniformsNeedUpdate = true;
    };
    object.onBeforeRender = (/** @type {any[]} */ ...all) => {
      prepare.apply(object, all);
      if (glow) setUniform(glow);
    };
    object.onAfterRender = () => glow && setUniform(0);
  });
}
