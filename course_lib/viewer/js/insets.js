/* global THREE */
import { Orbit } from "./orbit.js";

/** Width of a picture, and gap between pictures, as fractions of the view's width. */
export const [SHARE, GAP] = [0.3, 0.01];

const MOTION_INTERVAL = 100; // [ms] between two pictures of the scene in a corner, in coarse pictures of a motion

/** @param {any} object @returns {boolean} whether the object and all its ancestors are visible */
export const isShown = (object) => !object || (object.visible && isShown(object.parent));

/** @param {any} inset @returns {any} an empty group that refers to its picture */
export function buildInset(inset) {
  const { pixels, rows, columns } = inset;
  const canvas = Object.assign(document.createElement("canvas"), { width: columns, height: rows });
  const image = new ImageData(columns, rows);
  image.data.fill(255);
  for (let i = 0; i < rows * columns; i++) {
    for (let part = 0; part < 3; part++) image.data[4 * i + part] = pixels[3 * i + part];
  }
  canvas.getContext("2d")?.putImageData(image, 0, 0);
  const group = new THREE.Group();
  group.userData.inset = { ...inset, picture: canvas };
  return group;
}

/**
 * Return the positions of pictures, one below the other at the right; many pictures are smaller.
 * @param {any[]} insets @param {number} width of the view @param {number} height
 * @returns {number[][]} left, top, width, height of each
 */
function boxes(insets, width, height) {
  const [wide, gap] = [SHARE * width, GAP * width];
  const needed = insets.reduce((sum, { aspect }) => sum + wide / aspect, 0);
  const shrink = Math.min(1, (height - gap * (insets.length + 1)) / needed);
  let top = gap;
  return insets.map(({ aspect }) => {
    const box = [width - gap - wide * shrink, top, wide * shrink, (wide / aspect) * shrink].map(Math.round);
    top += (wide / aspect) * shrink + gap;
    return box.map((part, i) => (i > 1 ? Math.max(part, 1) : part));
  });
}

/**
 * Draw all pictures over a view.
 * @param {CanvasRenderingContext2D} context @param {import("./mirror.js").Mirror} mirror
 * @param {import("./quality.js").Quality} quality
 * @param {(camera: any, target: CanvasRenderingContext2D, width: number, height: number) => void} render draws the scene
 *   over a transparent background into another canvas
 */
export function drawInsets(context, mirror, quality, render) {
  const groups = [...mirror.insets].filter(isShown);
  groups.sort((a, b) => (a.parent.userData.path < b.parent.userData.path ? -1 : 1));
  const insets = groups.map((group) => group.userData.inset);
  const places = boxes(insets, context.canvas.width, context.canvas.height);
  insets.forEach((inset, i) => {
    const [left, top, width, height] = places[i];
    const name = groups[i].parent.userData.path.split("/").at(-2); // of its display
    const writeName = () => {
      if (!name) return;
      context.font = `${Math.max(11, width / 14)}px sans-serif`;
      context.fillStyle = "#0008";
      context.fillRect(left, top, context.measureText(name).width + 8, Math.max(16, width / 9));
      context.fillStyle = "#fff";
      context.fillText(name, left + 4, top + Math.max(12, width / 12));
    };
    if (!inset.camera) {
      context.drawImage(inset.picture, left, top, width, height);
      return writeName();
    }
    // It does not depend on the view's own camera, which turns more often than the scene changes.
    const size = `${width} ${height}`;
    const state = `${mirror.version} ${quality.scale} ${quality.cell}`;
    const { cached } = inset;
    const isRecent = quality.cell > 0 && performance.now() - cached?.at < MOTION_INTERVAL;
    if (cached?.size !== size || (cached.state !== state && !isRecent)) {
      const canvas = drawInset(inset, mirror, width, height, render);
      inset.cached = { canvas, size, state, at: performance.now() };
    }
    context.drawImage(inset.cached.canvas, left, top);
    writeName();
  });
}

/**
 * Draw one picture with the scene as its camera sees it.
 * @param {any} inset @param {import("./mirror.js").Mirror} mirror @param {number} width in pixels @param {number} height
 * @param {(camera: any, target: CanvasRenderingContext2D, width: number, height: number) => void} render
 * @returns {HTMLCanvasElement}
 */
function drawInset(inset, mirror, width, height, render) {
  const canvas = inset.cached?.canvas ?? document.createElement("canvas");
  Object.assign(canvas, { width, height }); // this clears it
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.imageSmoothingQuality = "medium";
  context.fillStyle = `rgb(${mirror.background.join()})`;
  context.fillRect(0, 0, width, height);
  const [left, top, wide, high] = inset.area;
  const paint = () => context.drawImage(inset.picture, left * width, top * height, wide * width, high * height);
  if (inset.is_behind) paint();
  const hidden = /** @type {string[]} */ (inset.hidden_paths).map((path) => mirror.nodes.get(path)).filter((node) => node?.visible);
  for (const node of hidden) node.visible = false;
  const orbit = new Orbit();
  orbit.setCamera(inset.camera);
  render(orbit.camera(width, height), context, width, height);
  for (const node of hidden) node.visible = true;
  context.globalAlpha = inset.overlay_alpha;
  paint();
  context.globalAlpha = 1;
  return canvas;
}
