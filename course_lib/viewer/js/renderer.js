/* global THREE */
import { drawInsets } from "./insets.js";
import { Orbit } from "./orbit.js";
import { pixel } from "./materials.js";

// Browsers keep 16 WebGL contexts at most: all views of a page share one and copy its picture.

/** @type {any} */
let shared = null;
/** @type {Set<{invalidate: () => void}>} */
export const views = new Set();

function renderer() {
  if (!shared) {
    shared = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    shared.outputEncoding = THREE.LinearEncoding; // colours are shown as they were given
    const current = shared;
    current.domElement.addEventListener("webglcontextlost", () => {
      if (shared !== current) return;
      shared = null; // the next picture starts a new one
      current.dispose();
      for (const view of views) view.invalidate();
    });
  }
  return shared;
}

/**
 * Draw a scene into a 2-D canvas, which has its size already.
 * @param {HTMLCanvasElement} canvas @param {import("./mirror.js").Mirror} mirror
 * @param {any} camera a three.js camera
 */
export function draw(canvas, mirror, camera) {
  const { width, height } = canvas;
  const engine = renderer();
  const size = engine.getSize(new THREE.Vector2());
  if (size.x !== width || size.y !== height) engine.setSize(width, height, false);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  /** @param {any} from @param {number} w @param {number} h */
  const render = (from, w, h, alpha = 0) => {
    engine.setViewport(0, 0, w, h);
    engine.setClearColor(new THREE.Color(...mirror.background.map((part) => part / 255)), alpha);
    pixel.value = metresPerPixel(from, h);
    mirror.light.position.setFromMatrixColumn(from.matrixWorld, 2);
    engine.render(mirror.scene, from);
    return engine.domElement;
  };
  context.drawImage(render(camera, width, height, 1), 0, 0);
  drawInsets(context, mirror, render);
}

/** @param {any} camera @param {number} height in pixels @returns {number} see `pixel` */
export function metresPerPixel(camera, height) {
  if (camera.isOrthographicCamera) return (camera.top - camera.bottom) / height;
  return (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
}

/** @param {import("./mirror.js").Mirror} mirror @param {number} width in pixels @param {number} height @returns {string} a PNG as a data address */
export function pictureOf(mirror, width, height) {
  const orbit = new Orbit();
  orbit.look(mirror.camera);
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  draw(canvas, mirror, orbit.camera(width, height));
  return canvas.toDataURL("image/png");
}
