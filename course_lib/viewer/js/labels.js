/* global THREE */
import { studio } from "./materials.js";

/** @param {any} scene @returns {any[]} the texts that are shown */
export function textsOf(scene) {
  /** @type {any[]} */
  const texts = [];
  scene.traverseVisible((/** @type {any} */ object) => object.userData.mask && texts.push(object));
  return texts;
}

/** A line between two labels [px]. */
const LINE_GAP = 1;
/** The number of names between a frame and its name, above which they are drawn on top of each other. */
const MOST_STACKED = 8;

/**
 * Compute the rectangles of texts in a picture: distances in [m], lengths in [px] with y up.
 * @param {any[]} texts @param {any} camera a three.js camera @param {number} pixel [m] at a distance of 1 m, or anywhere
 * @param {number} width of the picture in pixels @param {number} height
 * @param {boolean} isStudio in which labels have a limited size
 */
function rectangles(texts, camera, pixel, width, height, isStudio = false) {
  camera.updateMatrixWorld();
  return texts.map((text) => {
    text.updateWorldMatrix(true, false);
    const position = new THREE.Vector3().setFromMatrixPosition(text.matrixWorld);
    const depth = -position.clone().applyMatrix4(camera.matrixWorldInverse).z;
    const scale = pixel * (camera.isOrthographicCamera ? 1 : Math.max(depth, 1e-6));
    position.project(camera);
    const { size, capital, isBelow } = text.userData;
    const { x: low, y: high } = studio.letters.value;
    const letters = capital / scale; // [px]
    const enlarged = isStudio ? Math.max(low, Math.min(high, letters)) / Math.max(letters, 1e-6) : 1;
    const half = size.map((/** @type {number} */ side) => (enlarged * side) / scale / 2);
    const y = (position.y * height) / 2 - (isBelow ? half[1] : 0);
    return { text, depth, x: (position.x * width) / 2, y, wide: half[0], high: half[1] };
  });
}

/** @typedef {ReturnType<typeof rectangles>[number]} Rectangle */

/** @param {Rectangle} one @param {Rectangle} other @returns {boolean} */
const overlap = (one, other) =>
  Math.abs(one.x - other.x) < one.wide + other.wide && Math.abs(one.y - other.y) < one.high + other.high;

/**
 * Lower the names of frames until none overlaps another, so that frames at the same position have a name each.
 * @param {any[]} texts @param {any} camera a three.js camera @param {number} pixel see `rectangles`
 * @param {number} width @param {number} height @returns {() => void} moves them back
 */
export function stackNames(texts, camera, pixel, width, height) {
  const names = texts.filter((text) => text.userData.isBelow);
  const boxes = names.length < 2 ? [] : rectangles(names, camera, pixel, width, height).filter((box) => box.depth > 0);
  /** @type {Rectangle[]} */
  const placed = [];
  for (const box of boxes.sort((one, other) => Math.round(other.y) - Math.round(one.y))) {
    const y = box.y;
    for (const other of [...placed].sort((one, another) => another.y - one.y))
      if (overlap(box, other)) box.y = other.y - other.high - box.high - LINE_GAP;
    if (y - box.y > MOST_STACKED * 2 * box.high) box.y = y;
    placed.push(box);
    box.text.userData.uniforms.lowered = (y - box.y) / (2 * box.high);
  }
  return () => names.forEach((text) => (text.userData.uniforms.lowered = 0));
}

/**
 * Hide each text that overlaps one nearer to the eye, like the labels of frames at the same position.
 * @param {any[]} texts @param {any} camera a three.js camera @param {number} pixel see `rectangles` @param {number} width
 * @param {number} height @param {boolean} isStudio @returns {() => void} shows the hidden texts again
 */
export function withoutOverlaps(texts, camera, pixel, width, height, isStudio = false) {
  const boxes = rectangles(texts, camera, pixel, width, height, isStudio);
  /** @type {typeof boxes} */
  const visible = [];
  /** @type {any[]} */
  const hidden = [];
  for (const box of boxes.sort((one, other) => one.depth - other.depth)) {
    if (visible.some((other) => overlap(box, other))) hidden.push(box.text);
    else visible.push(box);
  }
  for (const text of hidden) text.visible = false;
  return () => hidden.forEach((text) => (text.visible = true));
}

/**
 * Prepare the labels of the look "Studio", which are in front of everything and never overlap.
 * @param {any} scene @param {any} camera a three.js camera @param {number} pixel see `rectangles` @param {number} width
 * @param {number} height @returns {() => void} restores them
 */
export function inFront(scene, camera, pixel, width, height) {
  const texts = textsOf(scene);
  const showAll = withoutOverlaps(texts, camera, pixel, width, height, true);
  for (const text of texts) text.renderOrder = 1;
  return () => {
    showAll();
    for (const text of texts) text.renderOrder = 0;
  };
}
