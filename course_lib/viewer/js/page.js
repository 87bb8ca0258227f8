import { decode } from "./decode.js";
import { SceneRecording } from "./recording.js";
import { Mirror } from "./mirror.js";
import { TimeBar } from "./panels/time.js";
import { Player } from "./player.js";
import { pictureOf } from "./renderer.js";
import { View } from "./view.js";

/** @param {string} text base64 */
function fromBase64(text) {
  const signs = atob(text);
  const bytes = new Uint8Array(signs.length); // Uint8Array.from takes ten times as long
  for (let i = 0; i < bytes.length; i++) bytes[i] = signs.charCodeAt(i);
  return bytes;
}

/** @param {string} text a compressed scene, recording or part of a recording, in base64 */
export async function unpacked(text) {
  const stream = new Blob([fromBase64(text)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return decode(await new Response(stream).arrayBuffer());
}

/** Show every scene of the page that is not displayed yet. */
export async function mountAll() {
  for (const data of document.querySelectorAll(".course-scene > script"))
    mount(/** @type {HTMLElement} */ (data.parentElement), await unpacked(data.textContent ?? ""));
}

/** @param {HTMLElement} host @param {any} content a scene or a recording */
export function mount(host, content) {
  host.textContent = "";
  const mirror = new Mirror();
  const picture = Object.assign(document.createElement("div"), { style: "flex:1;min-height:0" });
  host.style.cssText += ";display:flex;flex-direction:column";
  host.append(picture);
  const isAlone = host.dataset.alone === "true";
  const view = new View(picture, mirror, { label: host.dataset.label ?? "", alone: isAlone });
  if (content.batches) play(new SceneRecording(content, mirror), host, isAlone ? document.body : host, () => view.isInSight);
  else mirror.apply(content);
}

/**
 * Add a time bar, and start a replay.
 * @param {SceneRecording} recording @param {HTMLElement} host to which the bar is added; with `data-plays` it is a replay
 * @param {HTMLElement} keys the element whose keys it handles
 * @param {() => boolean} isSeen whether the scene is in sight
 */
function play(recording, host, keys, isSeen) {
  /** @type {TimeBar} */
  const bar = new TimeBar(host, (change) => player.apply(change), keys);
  /** @type {Player} */
  const player = new Player(recording, (time) => bar.update(time), isSeen);
  if (host.dataset.plays === "true") player.replay();
}

/**
 * Draw a scene synchronously, and return a PNG as a data URL.
 * @param {string} scene a snapshot in base64 @param {number} width in pixels @param {number} height
 */
export function picture(scene, width, height) {
  const mirror = new Mirror();
  mirror.apply(decode(fromBase64(scene)));
  return pictureOf(mirror, width, height);
}
