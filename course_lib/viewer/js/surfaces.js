/* global THREE */
import { material } from "./materials.js";
import { castsShadow } from "./studio.js";
import { makeCoarse } from "./coarse.js";

export const MOST_VERTICES = 200_000; // limit for all instances of an object together; beyond it they are drawn as instances to save memory
const TILE = 4096; // [px] side of a texture that every graphics card supports

/** @type {Record<string, () => any>} */
const UNIT_SHAPES = {
  box: () => new THREE.BoxGeometry(1, 1, 1),
  sphere: () => new THREE.SphereGeometry(0.5, 32, 20),
  cylinder: () => new THREE.CylinderGeometry(0.5, 0.5, 1, 32).rotateX(Math.PI / 2),
  cone: () => new THREE.ConeGeometry(0.5, 1, 32).rotateX(Math.PI / 2),
};

/**
 * Return one color per element, from as many colors or a single one.
 * @param {Uint8Array} colors RGBA @param {number} count @returns {Uint8Array}
 */
export function spread(colors, count) {
  if (colors.length !== 4 || count === 1) return colors;
  const all = new Uint8Array(4 * count);
  for (let i = 0; i < all.length; i++) all[i] = colors[i % 4];
  return all;
}

/** @param {Uint8Array} colors */
export function isTransparent(colors) {
  for (let i = 3; i < colors.length; i += 4) if (colors[i] < 255) return true;
  return false;
}

/**
 * Write the twelve numbers of an affine transform, column by column, into a three.js matrix.
 * @param {Float32Array | number[]} elements @param {number} offset @param {Float32Array} columns
 * @param {number} from
 */
export function writeMatrix(elements, offset, columns, from) {
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 3; r++) elements[offset + 4 * c + r] = columns[from + 3 * c + r];
    elements[offset + 4 * c + 3] = c === 3 ? 1 : 0;
  }
}

/** @param {any} solids */
export function buildSolids(solids) {
  const shape = UNIT_SHAPES[solids.shape]();
  const vertices = (solids.placements.length / 12) * shape.attributes.position.count;
  return vertices <= MOST_VERTICES ? mergeSolids(solids, shape) : instanceSolids(solids, shape);
}

/** @param {any} solids @param {any} shape @returns {any} a mesh of all shapes, because software takes 25 microseconds per instance */
function mergeSolids(solids, shape) {
  const count = solids.placements.length / 12;
  const { position, normal } = shape.attributes;
  const each = position.count;
  const [places, normals] = [new Float32Array(3 * each * count), new Float32Array(3 * each * count)];
  const index = new Uint32Array(shape.index.count * count);
  const colors = spread(solids.colors, count);
  const tints = new Uint8Array(4 * each * count);
  const matrix = new THREE.Matrix4();
  const turn = new THREE.Matrix3();
  const vector = new THREE.Vector3();
  for (let i = 0; i < count; i++) {
    writeMatrix(matrix.elements, 0, solids.placements, 12 * i);
    turn.getNormalMatrix(matrix);
    for (let v = 0; v < each; v++) {
      vector.fromBufferAttribute(position, v).applyMatrix4(matrix).toArray(places, 3 * (i * each + v));
      vector.fromBufferAttribute(normal, v).applyMatrix3(turn).normalize().toArray(normals, 3 * (i * each + v));
      for (let part = 0; part < 4; part++) tints[4 * (i * each + v) + part] = colors[4 * i + part];
    }
    for (let k = 0; k < shape.index.count; k++) index[i * shape.index.count + k] = shape.index.array[k] + i * each;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  geometry.setAttribute("tint", new THREE.BufferAttribute(tints, 4, true));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  const mesh = new THREE.Mesh(geometry, material("surface", isTransparent(colors), solids.lit ? "SMOOTH" : "", false));
  const raycast = mesh.raycast.bind(mesh);
  mesh.raycast = (/** @type {any} */ caster, /** @type {any[]} */ hits) => {
    /** @type {any[]} */
    const own = [];
    raycast(caster, own);
    for (const hit of own) hits.push({ ...hit, instanceId: Math.floor((3 * hit.faceIndex) / shape.index.count) });
  };
  return castsShadow(mesh);
}

/** @param {any} solids @param {any} geometry of one @returns {any} */
function instanceSolids(solids, geometry) {
  const count = solids.placements.length / 12;
  const tint = new THREE.InstancedBufferAttribute(spread(solids.colors, count), 4, true);
  geometry.setAttribute("tint", tint);
  const shading = solids.lit ? "SMOOTH" : "";
  const see = isTransparent(solids.colors);
  const mesh = new THREE.InstancedMesh(geometry, material("surface", see, shading, false), count);
  for (let i = 0; i < count; i++) writeMatrix(mesh.instanceMatrix.array, 16 * i, solids.placements, 12 * i);
  mesh.frustumCulled = false; // three.js would test only the unit shape
  return castsShadow(mesh);
}

/** @param {any} sheet drawn with sharp cells, in tiles if it is larger than the textures of some graphics cards */
export function buildSheet(sheet) {
  const { cells, rows, columns } = sheet;
  const group = new THREE.Group();
  for (let top = 0; top < rows; top += TILE) {
    for (let left = 0; left < columns; left += TILE) {
      const [high, wide] = [Math.min(TILE, rows - top), Math.min(TILE, columns - left)];
      const part = new Uint8Array(high * wide);
      for (let row = 0; row < high; row++) {
        const start = (top + row) * columns + left;
        part.set(cells.subarray(start, start + wide), row * wide);
      }
      group.add(buildTile({ ...sheet, cells: part, rows: high, columns: wide }, left, top));
    }
  }
  return group.children.length === 1 ? group.children[0] : group;
}

/** @param {any} sheet @param {number} left column of its first cell @param {number} top row of its first cell */
function buildTile({ cells, colors, rows, columns, width: cell, is_behind }, left, top) {
  const [width, height] = [columns * cell, rows * cell];
  const see = isTransparent(colors);
  const pixels = new Uint8Array(4 * cells.length);
  const [words, palette] = [pixels, colors.slice()].map((bytes) => new Uint32Array(bytes.buffer));
  for (let i = 0; i < words.length; i++) words[i] = palette[cells[i]];
  const map = new THREE.DataTexture(pixels, columns, rows, THREE.RGBAFormat);
  map.needsUpdate = true;
  const paint = new THREE.MeshBasicMaterial({ map, side: THREE.DoubleSide, transparent: see && !is_behind });
  paint.depthWrite = !see && !is_behind;
  if (is_behind) paint.blending = THREE.CustomBlending; // drawn with the opaque objects, because it comes first
  paint.blendSrcAlpha = THREE.OneFactor; // as in three.js's own blending, so that the view stays opaque
  Object.assign(paint, { polygonOffset: true, polygonOffsetUnits: 16 }); // farther away, like RViz's maps
  const geometry = new THREE.PlaneGeometry(width, height).translate(left * cell + width / 2, top * cell + height / 2, 0);
  const mesh = new THREE.Mesh(geometry, paint);
  mesh.renderOrder = is_behind ? -1 : 0;
  return mesh;
}

/** @param {any} mesh */
export function buildMesh(mesh) {
  const count = mesh.vertices.length / 3;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(mesh.vertices, 3));
  geometry.setAttribute("tint", new THREE.BufferAttribute(spread(mesh.colors, count), 4, true));
  geometry.setIndex(new THREE.BufferAttribute(mesh.faces, 1));
  if (mesh.normals) geometry.setAttribute("normal", new THREE.BufferAttribute(mesh.normals, 3));
  const shading = mesh.lit ? (mesh.normals ? "SMOOTH" : "FLAT") : "";
  const object = new THREE.Mesh(geometry, material("surface", isTransparent(mesh.colors), shading));
  makeCoarse(object);
  return castsShadow(object);
}
