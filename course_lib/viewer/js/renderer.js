/* global THREE */
import { drawInsets } from "./insets.js";
import { Orbit } from "./orbit.js";
import { inFront, stackNames, textsOf } from "./labels.js";
import { density, pixel } from "./materials.js";
import { drawCoarse } from "./coarse.js";
import { backgroundOf, onGround, setUp } from "./studio.js";
import { atRest, expectSpeed } from "./quality.js";

// Browsers allow at most 16 WebGL contexts, so all views of a page share one and copy its picture.

/** @type {any} */
let shared = null;
/** @type {Set<{invalidate: () => void}>} */
export const views = new Set();

function renderer() {
  if (!shared) {
    shared = new THREE.WebGLRenderer({ antialias: false, alpha: true });
    shared.outputEncoding = THREE.LinearEncoding; // colors are displayed without conversion
    expectSpeed(shared.getContext());
    const current = shared;
    current.domElement.addEventListener("webglcontextlost", () => {
      if (shared !== current) return;
      shared = null; // the next picture creates a new context
      current.dispose();
      for (const view of views) view.invalidate();
    });
  }
  return shared;
}

/**
 * Draw a scene into a 2D canvas whose size has been set.
 * @param {HTMLCanvasElement} canvas @param {import("./mirror.js").Mirror} mirror
 * @param {any} camera a three.js camera @param {import("./quality.js").Quality} quality
 */
export function draw(canvas, mirror, camera, quality = atRest()) {
  const { width, height } = canvas;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const webgl = renderer();
  const limit = webgl.capabilities.maxTextureSize;
  const scale = Math.min(quality.scale, limit / Math.max(width, height));
  const [renderedWidth, renderedHeight] = [Math.ceil(width * scale), Math.ceil(height * scale)];
  const size = webgl.getSize(new THREE.Vector2());
  if (size.x !== renderedWidth || size.y !== renderedHeight) webgl.setSize(renderedWidth, renderedHeight, false);
  setUp(webgl, mirror, quality);
  context.imageSmoothingQuality = "medium";
  /**
   * @param {any} from @param {CanvasRenderingContext2D} target @param {number} w of the picture in pixels
   * @param {number} h
   */
  const render = (from, target, w, h, alpha = 0) => {
    const [widthOfPart, heightOfPart] = [Math.round(w * scale), Math.round(h * scale)];
    webgl.setViewport(0, 0, widthOfPart, heightOfPart);
    webgl.setClearColor(new THREE.Color(...backgroundOf(mirror).map((part) => part / 255)), alpha);
    pixel.value = metresPerPixel(from, h);
    density.value = scale;
    mirror.light.position.setFromMatrixColumn(from.matrixWorld, 2);
    const isStudio = mirror.style === "Studio";
    const restore = isStudio
      ? inFront(mirror.scene, from, pixel.value, w, h)
      : stackNames(textsOf(mirror.scene), from, pixel.value, w, h);
    const all = () => drawCoarse(quality, from, h, () => webgl.render(mirror.scene, from));
    if (alpha) onGround(mirror, from, all);
    else all();
    restore();
    // three.js counts from the lower left corner.
    target.drawImage(webgl.domElement, 0, renderedHeight - heightOfPart, widthOfPart, heightOfPart, 0, 0, w, h);
  };
  render(camera, context, width, height, 1);
  drawInsets(context, mirror, quality, render);
}

/** Wait until the graphics card has drawn everything; `finish` of WebGL does not wait in browsers. */
export function finish() {
  const gl = renderer().getContext();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}

/** @param {any} camera @param {number} height in pixels @returns {number} see `pixel` */
export function metresPerPixel(camera, height) {
  if (camera.isOrthographicCamera) return (camera.top - camera.bottom) / height;
  return (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
}

/** @param {import("./mirror.js").Mirror} mirror @param {number} width in pixels @param {number} height @returns {string} a PNG as a data URL */
export function pictureOf(mirror, width, height) {
  const orbit = new Orbit();
  orbit.setCamera(mirror.camera);
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  draw(canvas, mirror, orbit.camera(width, height));
  return canvas.toDataURL("image/png");
}
