/* global THREE */

/** @param {any} scene @returns {any[]} the texts that are shown */
export function textsOf(scene) {
  /** @type {any[]} */
  const texts = [];
  scene.traverseVisible((/** @type {any} */ object) => object.userData.mask && texts.push(object));
  return texts;
}

/**
 * Hide each text that lies over one nearer to the eye, as labels of frames in one place do.
 * @param {any[]} texts @param {any} camera a three.js camera @param {number} pixel [m] at a distance of 1 m, or anywhere
 * @param {number} width of the picture in pixels @param {number} height
 * @returns {() => void} shows them again
 */
export function withoutOverlaps(texts, camera, pixel, width, height) {
  camera.updateMatrixWorld();
  const boxes = texts.map((text) => {
    text.updateWorldMatrix(true, false);
    const place = new THREE.Vector3().setFromMatrixPosition(text.matrixWorld);
    const depth = -place.clone().applyMatrix4(camera.matrixWorldInverse).z;
    const scale = pixel * (camera.isOrthographicCamera ? 1 : Math.max(depth, 1e-6));
    place.project(camera);
    const [wide, high] = text.userData.size.map((/** @type {number} */ size) => size / scale / 2);
    return { text, depth, x: (place.x * width) / 2, y: (place.y * height) / 2, wide, high };
  });
  /** @type {typeof boxes} */
  const kept = [];
  /** @type {any[]} */
  const hidden = [];
  for (const box of boxes.sort((one, other) => one.depth - other.depth)) {
    const isOver = (/** @type {typeof box} */ other) =>
      Math.abs(box.x - other.x) < box.wide + other.wide && Math.abs(box.y - other.y) < box.high + other.high;
    if (kept.some(isOver)) hidden.push(box.text);
    else kept.push(box);
  }
  for (const text of hidden) text.visible = false;
  return () => hidden.forEach((text) => (text.visible = true));
}
