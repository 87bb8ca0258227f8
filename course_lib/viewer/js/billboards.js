/* global THREE */
import { material, pixel } from "./materials.js";
import { seesThrough, spread } from "./surfaces.js";

const CORNERS = new Float32Array([-0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0]);

/**
 * Draw one quad per instance, turned to the camera by its shader.
 * @param {any} shared material
 * @param {Record<string, any>} uniforms values of this object
 * @param {Record<string, any>} attributes of each instance
 */
function quads(shared, uniforms, attributes) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(CORNERS.slice(), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  for (const [name, value] of Object.entries(attributes)) geometry.setAttribute(name, value);
  const mesh = new THREE.Mesh(geometry, shared);
  mesh.frustumCulled = false;
  mesh.onBeforeRender = () => {
    for (const [name, value] of Object.entries(uniforms)) shared.uniforms[name].value = value;
    shared.uniformsNeedUpdate = true;
  };
  mesh.raycast = (caster, hits) => hitQuads(mesh, uniforms, caster, hits);
  return mesh;
}

/**
 * Find the strips or squares within half their width of a ray, or within two pixels.
 * @param {any} mesh
 * @param {Record<string, any>} uniforms
 * @param {any} caster
 * @param {any[]} hits
 */
function hitQuads(mesh, uniforms, caster, hits) {
  const { start, end } = mesh.geometry.attributes;
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

/** @param {any} lines */
export function buildLines(lines) {
  const { points } = lines;
  const count = points.length / 3;
  const colors = spread(lines.colors, count);
  const step = lines.strip ? 1 : 2;
  const starts = Array.from({ length: Math.max(Math.ceil((count - 1) / step), 0) }, (_, k) => k * step);
  const pick = (from, size, of) => {
    const out = new from.constructor(size * starts.length);
    starts.forEach((i, k) => out.set(from.subarray(size * of(i), size * of(i) + size), size * k));
    return perInstance(out, size);
  };
  return quads(material("strip", seesThrough(colors)), { size: [lines.width, 0] }, {
    before: pick(points, 3, (i) => (lines.strip ? Math.max(i - 1, 0) : i)), // pairs have no neighbours
    start: pick(points, 3, (i) => i),
    end: pick(points, 3, (i) => i + 1),
    after: pick(points, 3, (i) => (lines.strip ? Math.min(i + 2, count - 1) : i + 1)),
    startTint: pick(colors, 4, (i) => i),
    endTint: pick(colors, 4, (i) => i + 1),
  });
}

/** @param {any} points */
export function buildPoints(points) {
  const colors = spread(points.colors, points.points.length / 3);
  return quads(material("square", seesThrough(colors)), { size: points.size, inPixels: points.pixels }, {
    start: perInstance(points.points, 3),
    startTint: perInstance(colors, 4),
  });
}

/** @param {any} text */
export function buildText(text) {
  const mask = new THREE.DataTexture(text.mask, text.columns, text.rows, THREE.LuminanceFormat);
  mask.flipY = true;
  mask.unpackAlignment = 1;
  mask.magFilter = THREE.LinearFilter;
  mask.minFilter = THREE.LinearMipmapLinearFilter;
  mask.generateMipmaps = true;
  mask.needsUpdate = true;
  const size = [text.columns * text.pixel, text.rows * text.pixel];
  const mesh = quads(material("square", true, "TEXTURED"), { size, inPixels: false, mask }, {
    start: perInstance(new Float32Array(3), 3),
    startTint: perInstance(text.color, 4),
  });
  mesh.userData.mask = mask;
  return mesh;
}
