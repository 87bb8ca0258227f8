import { decode } from "./decode.js";
import { Film } from "./film.js";
import { Mirror } from "./mirror.js";
import { TimeBar } from "./panels/time.js";
import { Player } from "./player.js";
import { pictureOf } from "./renderer.js";
import { View } from "./view.js";

/** @param {string} text base64 */
const fromBase64 = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));

/** @param {BlobPart} zipped */
async function inflated(zipped) {
  const stream = new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Show every scene that is written into the page and not shown yet. */
export async function mountAll() {
  for (const data of document.querySelectorAll(".course-scene > script"))
    await mount(/** @type {HTMLElement} */ (data.parentElement), data.textContent ?? "");
}

/** Show each scene that is in a script of its own, `data-scene`, once the page is scrolled near to it. */
export async function mountNear() {
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      load(/** @type {HTMLElement} */ (target));
    }
  }, { rootMargin: "300px" });
  for (const host of document.querySelectorAll(".course-scene[data-scene]")) near.observe(host);
}

/** @param {HTMLElement} host shows the scene that the script puts into its own element */
function load(host) {
  const script = document.createElement("script");
  script.src = host.dataset.scene ?? "";
  script.onload = () => mount(host, script.dataset.scene ?? "");
  script.onerror = () => host.append(`The 3D view cannot be shown: ${script.src} is missing.`);
  document.head.append(script);
}

/** @param {HTMLElement} host @param {string} text a scene or a film, zipped, in base64 */
async function mount(host, text) {
  const bytes = fromBase64(text);
  host.textContent = "";
  const content = decode(await inflated(bytes));
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
 * Draw a scene at once.
 * @param {string} scene a snapshot in base64 @param {number} width in pixels @param {number} height
 * @returns {string} a PNG as a data address
 */
export function picture(scene, width, height) {
  const mirror = new Mirror();
  mirror.apply(fromBase64(scene));
  return pictureOf(mirror, width, height);
}
