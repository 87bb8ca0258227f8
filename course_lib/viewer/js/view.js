/* global THREE */
import { icon } from "./icons.js";
import { isShown } from "./insets.js";
import { Orbit } from "./orbit.js";
import { button, part } from "./panels/parts.js";
import { textsOf, withoutOverlaps } from "./labels.js";
import { createVersions } from "./coarse.js";
import { atRest, isMotion, MotionQuality } from "./quality.js";
import { draw, finish, metresPerPixel, views } from "./renderer.js";

const CLICK = 4; // [px] maximum motion of the pointer during a click
const TURN = 0.005; // [rad] per pixel, as in RViz
const HANDS_OFF = 500; // [ms] after the last turn of a view by hand
const SAY_FOR = 10_000; // [ms]
const REST_AFTER = 700; // [ms] without a change, after which a picture is drawn with the highest quality
const CORNER =
  "position:absolute;padding:1px 6px;font:13px/1.5 system-ui,sans-serif;color-scheme:light dark;" +
  "color:var(--jp-ui-font-color1,CanvasText);background:var(--jp-layout-color1,Canvas)";
/** @type {Record<string, number[]>} */
const ARROWS = { ArrowLeft: [-16, 0], ArrowRight: [16, 0], ArrowUp: [0, -16], ArrowDown: [0, 16] }; // [px]

/** One picture of a scene on the page, with a camera of its own. */
export class View {
  /**
   * @param {HTMLElement} host is filled by the view @param {import("./mirror.js").Mirror} mirror
   * @param {{label: string, alone?: boolean, onSight?: () => void, onClick?: (click: import("./protocol.js").Click) => void}} options
   *   `alone`: nothing else on the page uses the wheel; `onSight`: called when the view enters or leaves the visible area
   */
  constructor(host, mirror, options) {
    this.mirror = mirror;
    this.options = options;
    this.orbit = new Orbit();
    if (mirror.camera) this.orbit.look(mirror.camera);
    this.request = 0;
    this.pictures = 0; // number of pictures that were drawn
    this.drawnAt = -Infinity; // [ms] time of the last picture
    this.quality = new MotionQuality();
    this.resting = 0; // a timer
    this.hasRested = false; // whether nothing has changed for REST_AFTER
    this.seen = true;
    this.silence = 0; // a timer
    this.turnedAt = -Infinity; // [ms] time of the last turn by hand
    /** @type {((event: Event) => boolean) | null} handles the events that a tool needs */
    this.grab = null;
    this.onTurn = () => {};
    /** @type {HTMLCanvasElement} */
    this.canvas = part("canvas", { tabIndex: 0, role: "img", ariaLabel: options.label });
    this.canvas.style.cssText = "display:block;width:100%;height:100%;touch-action:none;outline-offset:-2px";
    this.words = part("output", { style: `${CORNER};left:0;bottom:0;pointer-events:none` }); // error messages
    this.full = button(icon("full"), "Full screen (F)", () => this.toggleFull());
    this.full.style.cssText = `${CORNER};right:0;top:0;border:0;cursor:pointer;opacity:0.7`;
    host.style.position = "relative";
    this.apart = button(icon("apart"), "Labels do not overlap: nearer ones hide others", () => {
      this.apart.ariaPressed = String(this.apart.ariaPressed === "false");
      this.invalidate();
    });
    this.apart.ariaPressed = "false";
    this.apart.hidden = true;
    this.apart.style.cssText = `${CORNER};right:54px;top:0;border:0;cursor:pointer;opacity:0.7`;
    host.append(this.canvas, this.words, this.full, this.apart);
    this.host = host;
    this.listen();
    this.sizes = new ResizeObserver(() => this.invalidate());
    this.sizes.observe(this.canvas);
    this.sight = new IntersectionObserver((entries) => {
      this.seen = entries[entries.length - 1].isIntersecting;
      this.invalidate();
      options.onSight?.();
    });
    this.sight.observe(this.canvas);
    mirror.views.add(this);
    views.add(this);
    this.say(mirror.lasting, true);
    this.invalidate();
  }

  dispose() {
    this.sizes.disconnect();
    this.sight.disconnect();
    cancelAnimationFrame(this.request);
    clearTimeout(this.resting);
    this.mirror.views.delete(this);
    views.delete(this);
    clearTimeout(this.silence);
    for (const part of [this.canvas, this.words, this.full, this.apart]) part.remove();
  }

  /** @param {string} text shown in a corner for a limited time, or until its condition has ended; for screen readers, too */
  say(text, lasts = false) {
    [this.words.textContent, this.words.hidden] = [text, !text];
    clearTimeout(this.silence);
    if (!lasts) this.silence = setTimeout(() => this.say(this.mirror.lasting, true), SAY_FOR);
  }

  toggleFull() {
    const whole = this.host.closest(".course-viewer") ?? this.host; // the view together with its panels
    if (document.fullscreenElement) document.exitFullscreen();
    else whole.requestFullscreen().catch((error) => this.say(`No full screen: ${error.message}`));
    this.canvas.focus({ preventScroll: true });
  }

  /** Draw again, with the next frame of the page. */
  invalidate() {
    if (this.request || !this.seen) return;
    this.canvas.ariaBusy = "true"; // until a picture has the highest quality
    this.request = requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.request = 0;
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) {
      this.canvas.ariaBusy = "false";
      return;
    }
    const ratio = Math.min(window.devicePixelRatio, 2);
    const [width, height] = [Math.round(clientWidth * ratio), Math.round(clientHeight * ratio)];
    if (this.canvas.width !== width) this.canvas.width = width; // only if it differs, because this clears the canvas
    if (this.canvas.height !== height) this.canvas.height = height;
    const goesOn = this.mirror.tick();
    const camera = this.orbit.camera(clientWidth, clientHeight);
    const texts = textsOf(this.mirror.scene);
    const isStudio = this.mirror.style === "Studio"; // its labels never overlap
    this.apart.hidden = texts.length < 2 || isStudio;
    const pixel = metresPerPixel(camera, height);
    const isApart = !isStudio && this.apart.ariaPressed === "true";
    const showAll = isApart ? withoutOverlaps(texts, camera, pixel, width, height) : () => {};
    this.paint(camera);
    this.pictures++;
    showAll();
    if (goesOn) this.invalidate();
  }

  /** @param {any} camera a three.js camera */
  paint(camera) {
    const now = performance.now();
    // A single change is drawn with the highest quality, but the first picture of a turn by hand must not be late.
    const isMoving = !this.hasRested && (isMotion(now - this.drawnAt) || isMotion(now - this.turnedAt));
    this.hasRested = false;
    this.drawnAt = now;
    clearTimeout(this.resting);
    if (!isMoving) {
      draw(this.canvas, this.mirror, camera, atRest());
      this.quality.rest();
      this.canvas.ariaBusy = "false";
      return;
    }
    // Until the versions of meshes exist, drawing takes longer than it will.
    const isReady = !this.quality.isCoarse || createVersions();
    this.quality.paint((quality) => draw(this.canvas, this.mirror, camera, quality), finish, isReady);
    this.resting = setTimeout(() => {
      this.hasRested = true;
      this.invalidate();
    }, REST_AFTER);
  }

  listen() {
    /** @param {string} name @param {(event: any) => void} act */
    const on = (name, act) =>
      this.canvas.addEventListener(name, (event) => this.grab?.(event) || act(event), { passive: false });
    /** @type {{x: number, y: number, far: number, button: number} | null} */
    let drag = null;
    on("pointerdown", (event) => {
      drag = { x: event.clientX, y: event.clientY, far: 0, button: buttonOf(event) };
      this.canvas.setPointerCapture(event.pointerId);
      this.canvas.focus({ preventScroll: true });
      event.preventDefault();
    });
    on("pointermove", (event) => {
      if (!drag) return;
      const [dx, dy] = [event.clientX - drag.x, event.clientY - drag.y];
      drag = { ...drag, x: event.clientX, y: event.clientY, far: drag.far + Math.hypot(dx, dy) };
      const box = this.canvas.getBoundingClientRect();
      this.move(drag.button, dx, dy, [event.clientX - box.left, event.clientY - box.top]);
    });
    on("pointerup", (event) => {
      if (drag && drag.far < CLICK) this.options.onClick?.(this.pick(event));
      drag = null;
    });
    on("pointercancel", () => (drag = null));
    on("contextmenu", (event) => event.preventDefault());
    on("wheel", (event) => {
      if (!this.options.alone && !event.ctrlKey && document.activeElement !== this.canvas) return;
      this.move(event.shiftKey ? 3 : 2, 0, 10 * Math.sign(event.deltaY || event.deltaX));
      claim(event);
    });
    on("keydown", (event) => {
      const [dx, dy] = ARROWS[event.key] ?? [0, 0];
      if (dx || dy) this.move(event.shiftKey ? 1 : 0, dx, dy);
      else if (event.key === "+" || event.key === "-") this.move(2, 0, event.key === "-" ? 10 : -10);
      else if (event.key === "f" && !event.ctrlKey && !event.metaKey) this.toggleFull();
      else return;
      claim(event);
    });
  }

  /**
   * Rotate (left), pan (middle), zoom (right) or move ahead (3).
   * @param {number} button @param {number} dx @param {number} dy @param {number[]} [at] the pointer, in pixels
   */
  move(button, dx, dy, at) {
    if (this.orbit.locked) return this.say("Unlock camera in settings to enable mouse interaction.");
    if (button === 0) this.orbit.rotate(dx * TURN, dy * TURN);
    else if (button === 1) this.orbit.pan(dx, dy, this.canvas, at);
    else if (button === 3 && !this.orbit.lift) this.orbit.dolly(dy * 0.01);
    else this.orbit.zoom(Math.exp(dy * 0.01));
    this.turned();
  }

  /** @param {number[]} point the new focal point [m], as set by RViz's Focus Camera */
  lookAt(point) {
    this.orbit.lookAt(point);
    this.turned();
  }

  turned() {
    this.turnedAt = performance.now();
    this.onTurn();
    this.invalidate();
  }

  /** @param {any} camera as Python describes it; ignored while the user turns the view */
  look(camera) {
    if (performance.now() - this.turnedAt > HANDS_OFF) this.orbit.look(camera);
  }

  /** @param {MouseEvent} event @returns {import("./protocol.js").Click} the object under the pointer, and the point in the scene's frame */
  pick(event) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * x - 1, 1 - 2 * y), this.orbit.camera(box.width, box.height));
    const [origin, direction] = [caster.ray.origin.toArray(), caster.ray.direction.toArray()];
    const click = { button: event.button, origin, direction };
    const hit = caster.intersectObject(this.mirror.scene, true).find((/** @type {any} */ found) => isShown(found.object));
    if (!hit) return click;
    const normal = hit.face?.normal.clone().transformDirection(hit.object.matrixWorld).toArray() ?? null;
    const index = hit.instanceId ?? hit.index ?? hit.faceIndex ?? null;
    return { ...click, path: pathOf(hit.object), point: hit.point.toArray(), normal, index };
  }
}

/** @param {PointerEvent} event @returns {number} the button; with Shift, left pans and right moves ahead (3) */
const buttonOf = ({ button, shiftKey }) => (shiftKey ? (button === 2 ? 3 : 1) : button);

/** @param {Event} event that must not reach the surrounding page */
function claim(event) {
  event.preventDefault();
  event.stopPropagation();
}

/** @param {any} object @returns {string} */
const pathOf = (object) => object.userData.path ?? pathOf(object.parent);
