/* global THREE */
import { material } from "./materials.js";

/** @type {Record<string, () => any>} */
const UNIT_SHAPES = {
  box: () => new THREE.BoxGeometry(1, 1, 1),
  sphere: () => new THREE.SphereGeometry(0.5, 32, 20),
  cylinder: () => new THREE.CylinderGeometry(0.5, 0.5, 1, 32).rotateX(Math.PI / 2),
  cone: () => new THREE.ConeGeometry(0.5, 1, 32).rotateX(Math.PI / 2),
};

/**
 * One colour for each of some things, from as many or from one.
 * @param {Uint8Array} colors RGBA @param {number} count @returns {Uint8Array}
 */
export function spread(colors, count) {
  if (colors.length !== 4 || count === 1) return colors;
  const all = new Uint8Array(4 * count);
  for (let i = 0; i < all.length; i++) all[i] = colors[i % 4];
  return all;
}

/** @param {Uint8Array} colors */
export function seesThrough(colors) {
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
  const count = solids.placements.length / 12;
  const geometry = UNIT_SHAPES[solids.shape]();
  const tint = new THREE.InstancedBufferAttribute(spread(solids.colors, count), 4, true);
  geometry.setAttribute("tint", tint);
  const shading = solids.lit ? "SMOOTH" : "";
  const see = seesThrough(solids.colors);
  const mesh = new THREE.InstancedMesh(geometry, material("surface", see, shading, false), count);
  for (let i = 0; i < count; i++) writeMatrix(mesh.instanceMatrix.array, 16 * i, solids.placements, 12 * i);
  mesh.frustumCulled = false; // three.js would ask for the unit shape alone
  return mesh;
}

/** @param {any} sheet drawn with sharp cells, as three.js draws a DataTexture */
export function buildSheet({ cells, colors, rows, columns, width: cell, behind }) {
  const [width, height] = [columns * cell, rows * cell];
  const see = seesThrough(colors);
  const pixels = new Uint8Array(4 * cells.length);
  const [words, palette] = [pixels, colors.slice()].map((bytes) => new Uint32Array(bytes.buffer));
  for (let i = 0; i < words.length; i++) words[i] = palette[cells[i]];
  const map = new THREE.DataTexture(pixels, columns, rows, THREE.RGBAFormat);
  map.needsUpdate = true;
  const paint = new THREE.MeshBasicMaterial({ map, side: THREE.DoubleSide, transparent: see && !behind });
  paint.depthWrite = !see && !behind;
  if (behind) paint.blending = THREE.CustomBlending; // among what is opaque, as it comes first
  paint.blendSrcAlpha = THREE.OneFactor; // as in three.js's own blending: the view stays opaque
  Object.assign(paint, { polygonOffset: true, polygonOffsetUnits: 16 }); // as RViz's maps: farther away
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(width, height).translate(width / 2, height / 2, 0), paint);
  mesh.renderOrder = behind ? -1 : 0;
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
  return new THREE.Mesh(geometry, material("surface", seesThrough(mesh.colors), shading));
}
