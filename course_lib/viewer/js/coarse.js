/* global THREE */

/**
 * Versions of large meshes with fewer triangles, and of objects with very many parts with one vertex per part. Software
 * takes about half a microsecond per triangle of any size; a robot has 80,000 triangles, most of them smaller than a pixel.
 */

const LARGE = 300; // number of triangles from which on a mesh has versions
const GRIDS = [48, 32, 21, 14, 9, 6, 4]; // cells along a mesh's longest side, in each of which vertices are merged
const MAX_FRACTION = 0.8; // maximum fraction of the triangles of the previous version; a version with more is omitted
/** Pairs of the four coefficients of a plane. */
const PAIRS = [0, 0, 1, 1, 2, 2, 3, 3, 0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3];
/** The other two axes. */
const NEXT = [[1, 2], [2, 0], [0, 1]];
const TIME_PER_PICTURE = 24; // [ms] to spend on versions per picture; the others are created during the next pictures

/**
 * @typedef {{cells: number, geometry: any}} Version cells along the longest side
 * @typedef {{mesh: any, full: any, versions: Version[] | null, center: any, side: number}} Large
 */

/** @type {Map<any, Large>} by mesh */
const large = new Map();

/** @type {Map<any, any>} the simple versions of objects with very many parts */
const simple = new Map();

/** @param {any} object @param {any} version with one vertex per part @returns {any} a group that draws one of them */
export function withSimpleVersion(object, version) {
  version.visible = false;
  version.raycast = () => {};
  simple.set(object, version);
  object.geometry.addEventListener("dispose", () => simple.delete(object));
  return new THREE.Group().add(object, version);
}

/** @param {any} mesh that may be drawn with fewer triangles */
export function makeCoarse(mesh) {
  const full = mesh.geometry;
  if (full.index.count < 3 * LARGE) return;
  full.computeBoundingBox();
  const { min, max } = full.boundingBox;
  const side = Math.max(max.x - min.x, max.y - min.y, max.z - min.z, 1e-9);
  const center = full.boundingBox.getCenter(new THREE.Vector3());
  /** @type {Large} */
  const entry = { mesh, full, versions: null, center, side };
  large.set(mesh, entry);
  full.addEventListener("dispose", () => {
    entry.versions?.forEach(({ geometry }) => geometry.dispose());
    large.delete(mesh);
  });
}

/** Create versions of some of the large meshes that have none yet. @returns {boolean} whether all have */
export function createVersions() {
  const until = performance.now() + TIME_PER_PICTURE;
  for (const entry of large.values()) {
    if (entry.versions) continue;
    if (performance.now() > until) return false;
    entry.versions = versionsOf(entry);
  }
  return true;
}

/**
 * Draw large meshes with fewer triangles, and objects with very many parts in their simple version.
 * @param {import("./quality.js").Quality} quality @param {any} camera @param {number} height [px] of the picture
 * @param {() => void} render
 */
export function drawCoarse(quality, camera, height, render) {
  for (const [object, version] of simple) [object.visible, version.visible] = [!quality.simple, quality.simple];
  if (quality.cell) for (const entry of large.values()) entry.mesh.geometry = versionFor(entry, camera, quality.cell, height);
  render();
  // Rays are intersected with the full version.
  for (const [object, version] of simple) [object.visible, version.visible] = [true, false];
  for (const { mesh, full } of large.values()) mesh.geometry = full;
}

/** @param {Large} entry @param {any} camera @param {number} cell @param {number} height @returns {any} the coarsest geometry that is fine enough */
function versionFor({ mesh, full, versions, center, side }, camera, cell, height) {
  const depth = Math.max(-center.clone().applyMatrix4(mesh.matrixWorld).applyMatrix4(camera.matrixWorldInverse).z, camera.near);
  const perMetre = (camera.projectionMatrix.elements[5] * height) / 2 / (camera.isOrthographicCamera ? 1 : depth);
  const wanted = (side * mesh.matrixWorld.getMaxScaleOnAxis() * perMetre) / cell;
  return versions?.filter(({ cells }) => cells >= wanted).pop()?.geometry ?? full;
}

/** @param {Large} entry @returns {Version[]} from fine to coarse */
function versionsOf({ full, side }) {
  /** @type {Version[]} */
  const versions = [];
  let last = full.index.array;
  for (const cells of GRIDS) {
    const faces = mergeVertices(full, last, side / cells);
    if (faces.length > MAX_FRACTION * last.length) continue;
    versions.push({ cells, geometry: compactGeometry(full, faces) });
    last = faces;
  }
  return versions;
}

/** @param {any} full @param {Uint32Array} faces @returns {any} a geometry of these faces with contiguous vertices */
function compactGeometry(full, faces) {
  const used = verticesOf(faces, full.attributes.position.count);
  const place = new Uint32Array(full.attributes.position.count);
  used.forEach((vertex, i) => (place[vertex] = i));
  const geometry = new THREE.BufferGeometry();
  for (const [name, { array, itemSize, normalized }] of Object.entries(full.attributes)) {
    const part = new array.constructor(itemSize * used.length);
    for (let i = 0; i < used.length; i++)
      for (let k = 0; k < itemSize; k++) part[itemSize * i + k] = array[itemSize * used[i] + k];
    geometry.setAttribute(name, new THREE.BufferAttribute(part, itemSize, normalized));
  }
  geometry.setIndex(new THREE.BufferAttribute(faces.map((vertex) => place[vertex]), 1));
  return geometry;
}

/** @param {Uint32Array} faces @param {number} count of all vertices @returns {Uint32Array} the vertices of the faces */
function verticesOf(faces, count) {
  const isUsed = new Uint8Array(count);
  return faces.filter((vertex) => !isUsed[vertex] && (isUsed[vertex] = 1));
}

/**
 * Merge the vertices in each cell of a grid whose normals point to the same side.
 * @param {any} geometry @param {Uint32Array} faces @param {number} size of a cell @returns {Uint32Array} the remaining triangles
 */
function mergeVertices(geometry, faces, size) {
  const positions = geometry.attributes.position.array;
  const normals = geometry.attributes.normal?.array;
  const { min } = geometry.boundingBox;
  /** @type {Map<number, number>} */
  const numbers = new Map(); // index of each cell
  const cellOf = new Int32Array(positions.length / 3).fill(-1);
  const used = verticesOf(faces, positions.length / 3);
  for (const i of used) {
    const at = 3 * i;
    let key = Math.floor((positions[at] - min.x) / size);
    key = key * 64 + Math.floor((positions[at + 1] - min.y) / size);
    key = key * 64 + Math.floor((positions[at + 2] - min.z) / size);
    if (normals) key = key * 8 + 4 * +(normals[at] > 0) + 2 * +(normals[at + 1] > 0) + +(normals[at + 2] > 0);
    cellOf[i] = numbers.get(key) ?? numbers.size;
    if (cellOf[i] === numbers.size) numbers.set(key, cellOf[i]);
  }
  const kept = representatives(positions, faces, used, cellOf, numbers.size);
  const seen = new Set();
  const triangles = [];
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [cellOf[faces[i]], cellOf[faces[i + 1]], cellOf[faces[i + 2]]];
    if (a === b || b === c || c === a) continue;
    const [low, high] = [Math.min(a, b, c), Math.max(a, b, c)];
    const key = (low * numbers.size + (a + b + c - low - high)) * numbers.size + high;
    if (seen.has(key)) continue; // both sides of a sheet have become the same triangle
    seen.add(key);
    triangles.push(kept[a], kept[b], kept[c]);
  }
  return new Uint32Array(triangles);
}

/**
 * Choose the vertex of each cell that remains: the nearest to the planes of all its triangles (Lindstrom 2000), so that
 * corners and edges are preserved, and the nearest to the mean of the vertices if these planes are equal.
 * @param {Float32Array} positions @param {Uint32Array} faces @param {Uint32Array} used indices of vertices
 * @param {Int32Array} cellOf @param {number} count of the cells @returns {Int32Array}
 */
function representatives(positions, faces, used, cellOf, count) {
  const planes = new Float64Array(11 * count); // sums of the pairwise products of the planes' four coefficients, and of the areas
  const corner = (/** @type {number} */ vertex, /** @type {number} */ axis) => positions[3 * vertex + axis];
  const plane = new Float64Array(4);
  const add = (/** @type {number} */ cell, /** @type {number} */ area) => {
    for (let k = 0; k < 10; k++) planes[11 * cell + k] += (k < 4 ? 1 : 2) * plane[PAIRS[2 * k]] * plane[PAIRS[2 * k + 1]];
    planes[11 * cell + 10] += area;
  };
  /** These loops create no arrays: with arrays, a robot of 160,000 triangles takes twice as long. */
  for (let f = 0; f < faces.length; f += 3) {
    const a = faces[f];
    const edge = (/** @type {number} */ i, /** @type {number} */ axis) => corner(faces[f + i], axis) - corner(a, axis);
    plane[3] = 0;
    let area = 0;
    for (let axis = 0; axis < 3; axis++) {
      const [y, z] = NEXT[axis];
      plane[axis] = edge(1, y) * edge(2, z) - edge(1, z) * edge(2, y);
      plane[3] -= plane[axis] * corner(a, axis);
      area += plane[axis] ** 2;
    }
    const [first, second, third] = [cellOf[a], cellOf[faces[f + 1]], cellOf[faces[f + 2]]];
    add(first, area);
    if (second !== first) add(second, area);
    if (third !== first && third !== second) add(third, area);
  }
  const means = new Float64Array(4 * count);
  for (const i of used) {
    const to = 4 * cellOf[i];
    for (let axis = 0; axis < 3; axis++) means[to + axis] += positions[3 * i + axis];
    means[to + 3]++;
  }
  const kept = new Int32Array(count);
  const errors = new Float64Array(count).fill(Infinity);
  for (const i of used) {
    const cell = cellOf[i];
    for (let axis = 0; axis < 3; axis++) plane[axis] = corner(i, axis);
    plane[3] = 1;
    let error = 0;
    for (let k = 0; k < 10; k++) error += plane[PAIRS[2 * k]] * plane[PAIRS[2 * k + 1]] * planes[11 * cell + k];
    error /= planes[11 * cell + 10] || 1;
    for (let axis = 0; axis < 3; axis++) error += 0.05 * (plane[axis] - means[4 * cell + axis] / means[4 * cell + 3]) ** 2;
    if (error < errors[cell]) [errors[cell], kept[cell]] = [error, i];
  }
  return kept;
}
