/* global THREE */
import { studio } from "./materials.js";

/** @param {any} scene @returns {any[]} the texts that are shown */
export function textsOf(scene) {
  /** @type {any[]} */
  const texts = [];
  scene.traverseVisible((/** @type {any} */ object) => object.userData.mask && texts.push(object));
  return texts;
}

/**
 * Hide each text that overlaps one nearer to the eye, like the labels of frames at the same position.
 * @param {any[]} texts @param {any} camera a three.js camera @param {number} pixel [m] at a distance of 1 m, or anywhere
 * @param {number} width of the picture in pixels @param {number} height
 * @param {boolean} isStudio in which labels have a limited size
 * @returns {() => void} shows the hidden texts again
 */
export function withoutOverlaps(texts, camera, pixel, width, height, isStudio = false) {
  camera.updateMatrixWorld();
  const boxes = texts.map((text) => {
    text.updateWorldMatrix(true, false);
    const position = new THREE.Vector3().setFromMatrixPosition(text.matrixWorld);
    const depth = -position.clone().applyMatrix4(camera.matrixWorldInverse).z;
    const scale = pixel * (camera.isOrthographicCamera ? 1 : Math.max(depth, 1e-6));
    position.project(camera);
    const { size, capital } = text.userData;
    const { x: low, y: high } = studio.letters.value;
    const letters = capital / scale; // [px]
    const enlarged = isStudio ? Math.max(low, Math.min(high, letters)) / Math.max(letters, 1e-6) : 1;
    const half = size.map((/** @type {number} */ side) => (enlarged * side) / scale / 2);
    return { text, depth, x: (position.x * width) / 2, y: (position.y * height) / 2, wide: half[0], high: half[1] };
  });
  /** @type {typeof boxes} */
  const visible = [];
  /** @type {any[]} */
  const hidden = [];
  for (const box of boxes.sort((one, other) => one.depth - other.depth)) {
    const isOver = (/** @type {typeof box} */ other) =>
      Math.abs(box.x - other.x) < box.wide + other.wide && Math.abs(box.y - other.y) < box.high + other.high;
    if (visible.some(isOver)) hidden.push(box.text);
    else visible.push(box);
  }
  for (const text of hidden) text.visible = false;
  return () => hidden.forEach((text) => (text.visible = true));
}

/**
 * Prepare the labels of the look "Studio", which are in front of everything and never overlap.
 * @param {any} scene @param {any} camera a three.js camera @param {number} pixel see `withoutOverlaps` @param {number} width
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
