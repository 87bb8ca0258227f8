import { Mirror } from "./mirror.js";
import { Orbit } from "./orbit.js";
import { draw } from "./renderer.js";
import { View } from "./view.js";

/** @param {string} text */
export const fromBase64 = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));

/** @param {Uint8Array} bytes gzip */
export const inflated = async (bytes) =>
  new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());

/** Show every scene that is written into the page and not shown yet. */
export async function mountAll() {
  for (const host of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(".course-scene"))) {
    const data = host.querySelector("script");
    if (!data?.textContent) continue;
    const bytes = fromBase64(data.textContent);
    host.textContent = "";
    const mirror = new Mirror();
    mirror.apply(await inflated(bytes));
    new View(host, mirror, { label: host.dataset.label ?? "3D view", alone: host.dataset.alone === "true" });
  }
}

/**
 * Draw a scene at once.
 * @param {string} scene a snapshot in base64
 * @param {number} width in pixels
 * @param {number} height
 * @returns {string} the address of a PNG that holds its data
 */
export function picture(scene, width, height) {
  const mirror = new Mirror();
  mirror.apply(fromBase64(scene));
  const orbit = new Orbit();
  orbit.look(mirror.camera);
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  draw(canvas, mirror, orbit.camera(width, height));
  return canvas.toDataURL("image/png");
}
