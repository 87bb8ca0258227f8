// The resolution of views. At rest, and with a fast graphics card, a picture is rendered larger than it is displayed,
// which smooths its edges. During motion on a machine without a graphics card, edges are not smoothed, then large
// meshes are drawn with fewer triangles, and finally the picture is rendered smaller than it is displayed.

/**
 * @typedef {{scale: number, cell: number}} Quality rendered pixels per displayed pixel; approximate width of a triangle of
 *   a large mesh in displayed pixels, or 0 for all triangles
 */
/** @type {Quality[]} */
const LEVELS = [
  { scale: 2, cell: 0 },
  { scale: 1, cell: 0 },
  { scale: 1, cell: 3 },
  { scale: 0.8, cell: 5 },
  { scale: 0.6, cell: 8 },
  { scale: 0.45, cell: 12 },
];
const [TOO_SLOW, FAST] = [14, 4]; // [ms] per picture, above which a coarser level is chosen, and below which a finer one
const MUCH = 2.5; // multiple of TOO_SLOW from which on two levels are skipped in one step
const MOVING = 900; // [ms] maximum time between two pictures of a motion; busy machines draw two per second
const [SELDOM, OFTEN] = [12, 3]; // number of pictures between two measurements, each of which waits for the graphics card

let level = 1; // level of all views of the page during motion
let isSoftware = false;
let left = OFTEN; // number of pictures until the next measurement

/** @param {any} gl the context of the page's views; without a graphics card, the initial level is coarse */
export function expectSpeed(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  if (!isSoftware && /swiftshader|llvmpipe|software|basic render/i.test(name)) level = 3;
  isSoftware = level > 1;
}

/** @param {number} sinceLast [ms] since the last picture of a view @returns {Quality} of the next one */
export const qualityAfter = (sinceLast) => (sinceLast > MOVING ? atRest() : LEVELS[level]);

/** @returns {Quality} of pictures at rest; tests of pages without a graphics card request a coarser one */
export const atRest = () => ({ ...LEVELS[0], scale: /** @type {any} */ (globalThis).courseRestScale ?? LEVELS[0].scale });

/**
 * Draw a picture of a motion; at intervals wait for its completion, and choose the level of the next pictures.
 * @param {CanvasRenderingContext2D} context @param {() => void} paint
 */
export function paintMeasured(context, paint) {
  if (--left > 0) return paint();
  context.getImageData(0, 0, 1, 1); // waits for the previous pictures
  const start = performance.now();
  paint();
  context.getImageData(0, 0, 1, 1);
  const took = performance.now() - start;
  const step = took > MUCH * TOO_SLOW ? 2 : took > TOO_SLOW ? 1 : took < FAST ? -1 : 0;
  level = Math.max(0, Math.min(level + step, LEVELS.length - 1));
  left = step > 0 ? OFTEN : SELDOM;
}
