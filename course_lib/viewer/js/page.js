import { decode } from "./decode.js";
import { Film } from "./film.js";
import { Mirror } from "./mirror.js";
import { TimeBar } from "./panels/time.js";
import { Player } from "./player.js";
import { pictureOf } from "./renderer.js";
import { View } from "./view.js";

/** @param {string} text base64 */
const fromBase64 = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));

/** @param {string} text a scene, a film or a part of one, zipped, in base64 */
export async function unpacked(text) {
  const stream = new Blob([fromBase64(text)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return decode(await new Response(stream).arrayBuffer());
}

/** Show every scene that is written into the page and not shown yet. */
export async function mountAll() {
  for (const data of document.querySelectorAll(".course-scene > script"))
    mount(/** @type {HTMLElement} */ (data.parentElement), await unpacked(data.textContent ?? ""));
}

/** @param {HTMLElement} host @param {any} content a scene or a film */
export function mount(host, content) {
  host.textContent = "";
  const mirror = new Mirror();
  const picture = Object.assign(document.createElement("div"), { style: "flex:1;min-height:0" });
  host.style.cssText += ";display:flex;flex-direction:column";
  host.append(picture);
  const alone = host.dataset.alone === "true";
  new View(picture, mirror, { label: host.dataset.label ?? "", alone });
  if (content.batches) play(new Film(content, mirror), host, alone ? document.body : host);
  else mirror.take(content);
}

/** @param {Film} film @param {HTMLElement} host gets a time bar @param {HTMLElement} keys where its keys are heard */
function play(film, host, keys) {
  /** @type {TimeBar} */
  const bar = new TimeBar(host, (change) => player.act(change), keys);
  /** @type {Player} */
  const player = new Player(film, (time) => bar.update(time));
}

/**
 * Draw a scene at once, as the data address of a PNG.
 * @param {string} scene a snapshot in base64 @param {number} width in pixels @param {number} height
 */
export function picture(scene, width, height) {
  const mirror = new Mirror();
  mirror.take(decode(fromBase64(scene)));
  return pictureOf(mirror, width, height);
}
