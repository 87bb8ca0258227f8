/* global THREE */
import { withSimpleVersion } from "./coarse.js";
import { material, pixel, studio } from "./materials.js";
import { MOST_VERTICES, isTransparent, spread } from "./surfaces.js";

const BOX_SHADES = [0.6, 0.6, 0.4, 1, 0.9, 0.5]; // of the sides +x -x +y -y +z -z, as in RViz's nogp/box.frag
const MANY_POINTS = 20_000; // number of points from which on they are too small to show the orientation of their squares
const SIMPLE_POINTS = 1_000; // number of points from which on they have a version with one vertex each
const SIMPLE_LINES = 5_000; // number of pieces of lines, likewise: two vertices each instead of four, and no width
const square = () => new THREE.PlaneGeometry(1, 1);

/**
 * The shape that is drawn at a point, and the brightness of each of its vertices.
 * @type {Record<string, {define: "FACING" | "BOX", shape: () => any, shade: (i: number) => number}>}
 */
const POINT_SHAPES = {
  square: { define: "FACING", shape: square, shade: () => 1 },
  disc: { define: "FACING", shape: () => new THREE.CircleGeometry(0.5, 8), shade: () => 1 },
  tile: { define: "BOX", shape: square, shade: () => 1 },
  sphere: { define: "FACING", shape: () => new THREE.CircleGeometry(0.5, 32), shade: (i) => (i ? 0.8 : 1) },
  box: { define: "BOX", shape: () => new THREE.BoxGeometry(1, 1, 1), shade: (i) => BOX_SHADES[i >> 2] },
};

/** @type {Record<string, "DOT" | "DISC" | "BALL" | "CUBE">} The shapes that a shader can draw around one vertex. */
const DOTS = { square: "DOT", disc: "DISC", sphere: "BALL", box: "CUBE" };

/**
 * Draw one flat shape or box per instance, which its shader places.
 * @param {any} shared material @param {any} shape three.js geometry
 * @param {Record<string, any>} uniforms values of this object
 * @param {Record<string, any>} attributes of each instance
 */
function createInstances(shared, shape, uniforms, attributes) {
  const isMerged = attributes.start.count * shape.attributes.position.count <= MOST_VERTICES;
  const geometry = isMerged ? repeatShape(shape, attributes) : new THREE.InstancedBufferGeometry().copy(shape);
  if (!isMerged) {
    geometry.instanceCount = Infinity; // the attributes determine the number; `copy` would take that of the shape
    for (const [name, value] of Object.entries(attributes)) geometry.setAttribute(name, value);
  }
  return withUniforms(new THREE.Mesh(geometry, shared), uniforms, attributes);
}

/**
 * Write all instances into one geometry: software takes 25 microseconds per instance, for a square as for a sphere.
 * @param {any} shape @param {Record<string, any>} attributes of each instance @returns {any}
 */
function repeatShape(shape, attributes) {
  const { count } = attributes.start;
  const vertices = shape.attributes.position.count;
  const geometry = new THREE.BufferGeometry();
  for (const [name, { array, itemSize }] of Object.entries(shape.attributes)) {
    const all = new array.constructor(array.length * count);
    for (let i = 0; i < count; i++) all.set(array, array.length * i);
    geometry.setAttribute(name, new THREE.BufferAttribute(all, itemSize));
  }
  for (const [name, { array, itemSize, normalized }] of Object.entries(attributes)) {
    const all = new array.constructor(array.length * vertices);
    for (let to = 0; to < all.length; to += itemSize) {
      const from = itemSize * Math.floor(to / itemSize / vertices);
      for (let part = 0; part < itemSize; part++) all[to + part] = array[from + part];
    }
    geometry.setAttribute(name, new THREE.BufferAttribute(all, itemSize, normalized));
  }
  const corners = shape.index.array;
  const index = new Uint32Array(corners.length * count);
  for (let i = 0; i < index.length; i++) {
    const instance = Math.floor(i / corners.length);
    index[i] = corners[i - instance * corners.length] + instance * vertices;
  }
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  return geometry;
}

/**
 * @param {any} mesh whose vertices its shader moves @param {Record<string, any>} uniforms of this object
 * @param {Record<string, any>} attributes of each instance
 */
function withUniforms(mesh, uniforms, attributes) {
  const shared = mesh.material;
  mesh.frustumCulled = false;
  mesh.onBeforeRender = () => {
    for (const [name, value] of Object.entries(uniforms)) shared.uniforms[name].value = value;
    shared.uniformsNeedUpdate = true;
  };
  mesh.raycast = intersectInstances.bind(null, mesh, uniforms, attributes);
  return mesh;
}

/**
 * Find the strips or squares whose distance to a ray is at most half their width, or two pixels.
 * @param {any} mesh @param {Record<string, any>} uniforms @param {Record<string, any>} attributes of each instance
 * @param {any} caster @param {any[]} hits
 */
function intersectInstances(mesh, uniforms, { start, end }, caster, hits) {
  const [a, b, onRay, onLine] = [0, 0, 0, 0].map(() => new THREE.Vector3());
  const half = uniforms.inPixels ? 0 : Math.max(...uniforms.size) / 2;
  for (let index = 0; index < start.count; index++) {
    a.fromBufferAttribute(start, index).applyMatrix4(mesh.matrixWorld);
    b.fromBufferAttribute(end ?? start, index).applyMatrix4(mesh.matrixWorld);
    const squared = caster.ray.distanceSqToSegment(a, b, onRay, onLine);
    const distance = caster.ray.origin.distanceTo(onRay);
    const reach = Math.max(half, 2 * pixel.value * (caster.camera.isOrthographicCamera ? 1 : distance));
    if (squared <= reach * reach) hits.push({ distance, point: onLine.clone(), index, object: mesh });
  }
}

/** @param {ArrayLike<number>} array @param {number} size */
const perInstance = (array, size) => new THREE.InstancedBufferAttribute(array, size, size === 4);

/** @param {any} lines drawn in the order of materials.js: opaque by depth, transparent from far to near */
export function buildLines(lines) {
  const { points } = lines;
  const count = points.length / 3;
  const colors = spread(lines.colors, count);
  const step = lines.strip ? 1 : 2;
  const starts = Array.from({ length: Math.max(Math.ceil((count - 1) / step), 0) }, (_, k) => k * step);
  /** @param {any} from @param {number} size @param {(i: number) => number} of */
  const pick = (from, size, of) => {
    const out = new from.constructor(size * starts.length);
    starts.forEach((i, k) => out.set(from.subarray(size * of(i), size * of(i) + size), size * k));
    return perInstance(out, size);
  };
  const hasAlpha = isTransparent(colors);
  const isThin = hasAlpha && !lines.width; // like RViz's grid
  const full = createInstances(material("strip", hasAlpha, isThin ? "THIN" : "", false), square(), { size: [lines.width, 0, 0] }, {
    before: pick(points, 3, (i) => (lines.strip ? Math.max(i - 1, 0) : i)), // pairs have no neighbours
    start: pick(points, 3, (i) => i),
    end: pick(points, 3, (i) => i + 1),
    after: pick(points, 3, (i) => (lines.strip ? Math.min(i + 2, count - 1) : i + 1)),
    startTint: pick(colors, 4, (i) => i),
    endTint: pick(colors, 4, (i) => i + 1),
  });
  if (starts.length < SIMPLE_LINES) return full;
  const geometry = geometryOfDots(points, colors);
  geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(starts.flatMap((i) => [i, i + 1])), 1));
  const simple = new THREE.LineSegments(geometry, material("spot", hasAlpha, "DOT"));
  return withSimpleVersion(full, withUniforms(simple, { size: [0, 0, 0], inPixels: false, grow: false }, {}));
}

/** @param {Float32Array} points @param {Uint8Array} tints @returns {any} a geometry with one vertex per point */
function geometryOfDots(points, tints) {
  const geometry = new THREE.BufferGeometry();
  const position = new THREE.BufferAttribute(points, 3);
  geometry.setAttribute("position", position);
  geometry.setAttribute("start", position);
  geometry.setAttribute("startTint", new THREE.BufferAttribute(tints, 4, true));
  return geometry;
}

/**
 * Draw one vertex per point: squares or discs aligned with the image, or boxes, which are much faster than shapes.
 * @param {Float32Array} points @param {Uint8Array} tints @param {"DOT" | "DISC" | "BALL" | "CUBE"} define
 * @param {Record<string, any>} uniforms
 */
function createDots(points, tints, define, uniforms) {
  const geometry = geometryOfDots(points, tints);
  const dots = new THREE.Points(geometry, material("spot", isTransparent(tints), define));
  return withUniforms(dots, uniforms, { start: geometry.attributes.start });
}

/** @param {any} points */
export function buildPoints({ points, colors, size, pixels, spot, grow }) {
  const { define, shape, shade } = POINT_SHAPES[spot];
  const geometry = shape();
  const shades = Float32Array.from({ length: geometry.attributes.position.count }, (_, i) => shade(i));
  geometry.setAttribute("shade", new THREE.BufferAttribute(shades, 1));
  const tints = spread(colors, points.length / 3);
  const uniforms = { size, inPixels: pixels, grow };
  const dot = DOTS[spot];
  const count = points.length / 3;
  if (dot && spot !== "box" && count >= MANY_POINTS) return createDots(points, tints, dot, uniforms);
  const paint = material("spot", isTransparent(tints), pixels ? "" : define, spot === "tile");
  const full = createInstances(paint, geometry, uniforms, {
    start: perInstance(points, 3),
    startTint: perInstance(tints, 4),
  });
  if (!dot || pixels || count < SIMPLE_POINTS) return full;
  return withSimpleVersion(full, createDots(points, tints, dot, uniforms));
}

/** @param {any} text */
export function buildText(text) {
  const mask = new THREE.DataTexture(text.mask, text.columns, text.rows, THREE.LuminanceFormat);
  Object.assign(mask, { magFilter: THREE.LinearFilter, minFilter: THREE.LinearMipmapLinearFilter });
  Object.assign(mask, { flipY: true, unpackAlignment: 1, generateMipmaps: true, needsUpdate: true });
  const size = [text.columns * text.pixel, text.rows * text.pixel, 0];
  const shape = square().translate(0, text.below ? -0.5 : 0, 0);
  const uniforms = { size, inPixels: false, grow: false, mask, capital: text.height, lowered: 0 };
  const mesh = createInstances(material("spot", true, "TEXTURED", false), shape, uniforms, {
    start: perInstance(new Float32Array(3), 3),
    startTint: perInstance(text.color, 4),
  });
  const prepare = mesh.onBeforeRender;
  mesh.onBeforeRender = () => {
    prepare();
    mesh.material.depthTest = !studio.isStudio.value; // labels in Studio are in front of everything
  };
  mesh.userData.mask = mask;
  mesh.userData.capital = text.height; // [m]
  mesh.userData.size = size.slice(0, 2); // [m]
  mesh.userData.isBelow = text.below; // its origin, as the name of a frame
  mesh.userData.uniforms = uniforms;
  return mesh;
}
