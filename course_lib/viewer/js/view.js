/* global THREE */
import { icon } from "./icons.js";
import { GAP, isShown, SHARE } from "./insets.js";
import { Orbit } from "./orbit.js";
import { button, createElement } from "./panels/elements.js";
import { textsOf, withoutOverlaps } from "./labels.js";
import { createVersions } from "./coarse.js";
import { atRest, isMotion, MotionQuality } from "./quality.js";
import { draw, finish, metresPerPixel, views } from "./renderer.js";

const CLICK = 4; // [px] maximum motion of the pointer during a click
const TURN = 0.005; // [rad] per pixel, as in RViz
const NOTCH = 12; // [px] motion with the right button that zooms like one notch of the wheel, as in RViz
const TURN_PAUSE = 500; // [ms] after the last turn of a view by hand
const MESSAGE_TIME = 10_000; // [ms]
const REST_AFTER = 700; // [ms] without a change, after which a picture is drawn with the highest quality
/** Pictures whose times determine how often Python sends changes. */
const RECENT = 3;
const PICTURES = `${100 * (SHARE + GAP)}%`; // the width of a view that pictures take at its right edge
const CORNER =
  "position:absolute;padding:1px 6px;font:13px/1.5 system-ui,sans-serif;color-scheme:light dark;" +
  "color:var(--jp-ui-font-color1,CanvasText);background:var(--jp-layout-color1,Canvas)";
/** @type {Record<string, number[]>} */
const ARROWS = { ArrowLeft: [-16, 0], ArrowRight: [16, 0], ArrowUp: [0, -16], ArrowDown: [0, 16] }; // [px]

/** One picture of a scene on the page, with a camera of its own. */
export class View {
  /**
   * @param {HTMLElement} host is filled by the view @param {import("./mirror.js").Mirror} mirror
   * @param {{label: string, alone?: boolean, onSightChange?: () => void, onClick?: (click: import("./protocol.js").Click) => void}} options
   *   `alone`: nothing else on the page uses the wheel; `onSightChange`: called when the view enters or leaves the visible area
   */
  constructor(host, mirror, options) {
    this.mirror = mirror;
    this.options = options;
    this.orbit = new Orbit();
    if (mirror.camera) this.orbit.setCamera(mirror.camera);
    this.request = 0;
    /** @type {number} [ms] time of the change that the next picture will be the first to show */
    this.requestedAt = 0;
    /** @type {number[]} [ms] from a change to its picture, of the last pictures */
    this.drawingTimes = [0];
    this.pictures = 0; // number of pictures that were drawn
    this.drawnAt = -Infinity; // [ms] time of the last picture
    this.quality = new MotionQuality();
    this.restTimer = 0;
    this.hasRested = false; // whether nothing has changed for REST_AFTER
    this.isInSight = true;
    this.messageTimer = 0;
    this.turnedAt = -Infinity; // [ms] time of the last turn by hand
    /** @type {((event: Event) => boolean) | null} handles an event if the selected tool uses it */
    this.handleByTool = null;
    this.onTurn = () => {};
    /** @type {any} */
    this.focus = null; // the disc at the focal point
    /** @type {PointerEvent | null} */
    this.pointer = null; // its last motion over the view
    /** @type {HTMLCanvasElement} */
    this.canvas = createElement("canvas", { tabIndex: 0, role: "img", ariaLabel: options.label });
    this.canvas.style.cssText = "display:block;width:100%;height:100%;touch-action:none;outline-offset:-2px";
    this.message = createElement("output", { style: `${CORNER};left:0;bottom:0;pointer-events:none` }); // error messages
    this.fullScreenButton = button(icon("full"), "Full screen (F11)", () => this.toggleFull());
    this.fullScreenButton.style.cssText = `${CORNER};right:var(--course-pictures,0px);top:0;border:0;cursor:pointer;opacity:0.7`;
    host.style.position = "relative";
    this.separateButton = button(icon("apart"), "Labels do not overlap: nearer ones hide others", () => {
      this.separateButton.ariaPressed = String(this.separateButton.ariaPressed === "false");
      this.invalidate();
    });
    this.separateButton.ariaPressed = "false";
    this.separateButton.hidden = true;
    const fromRight = "calc(var(--course-pictures,0px) + var(--course-opener,27px))";
    this.separateButton.style.cssText = `${CORNER};right:${fromRight};top:0;border:0;cursor:pointer;opacity:0.7`;
    host.append(this.canvas, this.message, this.fullScreenButton, this.separateButton);
    this.host = host;
    this.addListeners();
    this.resizeObserver = new ResizeObserver(() => this.invalidate());
    this.resizeObserver.observe(this.canvas);
    this.sightObserver = new IntersectionObserver((entries) => {
      this.isInSight = entries[entries.length - 1].isIntersecting;
      this.invalidate();
      options.onSightChange?.();
    });
    this.sightObserver.observe(this.canvas);
    mirror.views.add(this);
    views.add(this);
    this.showMessage(mirror.lastingMessage, true);
    this.invalidate();
  }

  dispose() {
    this.resizeObserver.disconnect();
    this.sightObserver.disconnect();
    cancelAnimationFrame(this.request);
    clearTimeout(this.restTimer);
    this.mirror.views.delete(this);
    views.delete(this);
    clearTimeout(this.messageTimer);
    for (const element of [this.canvas, this.message, this.fullScreenButton, this.separateButton]) element.remove();
  }

  /** @param {string} text a message in a corner, and read by screen readers, for a limited time or until its condition has ended */
  showMessage(text, lasts = false) {
    [this.message.textContent, this.message.hidden] = [text, !text];
    clearTimeout(this.messageTimer);
    if (!lasts) this.messageTimer = setTimeout(() => this.showMessage(this.mirror.lastingMessage, true), MESSAGE_TIME);
  }

  toggleFull() {
    const frame = this.host.closest(".course-viewer") ?? this.host; // the view together with its panels
    if (document.fullscreenElement) document.exitFullscreen();
    else frame.requestFullscreen().catch((error) => this.showMessage(`No full screen: ${error.message}`));
    this.canvas.focus({ preventScroll: true });
  }

  /** Draw again, with the next frame of the page. */
  invalidate() {
    if (this.request || !this.isInSight) return;
    this.canvas.ariaBusy = "true"; // until a picture has the highest quality
    this.requestedAt = performance.now();
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
    const isAnimated = this.mirror.advanceAnimation();
    const camera = this.orbit.camera(clientWidth, clientHeight);
    const texts = textsOf(this.mirror.scene);
    const isStudio = this.mirror.style === "Studio"; // its labels never overlap
    this.separateButton.hidden = texts.length < 2 || isStudio;
    // The buttons stand beside the pictures in the corner, and do not hide them.
    const hasPictures = [...this.mirror.insets].some(isShown);
    this.host.style.setProperty("--course-pictures", hasPictures ? PICTURES : "0px");
    const pixel = metresPerPixel(camera, height);
    const isApart = !isStudio && this.separateButton.ariaPressed === "true";
    const showAll = isApart ? withoutOverlaps(texts, camera, pixel, width, height) : () => {};
    this.paint(camera);
    this.pictures++;
    this.drawingTimes = [...this.drawingTimes, performance.now() - this.requestedAt].slice(-RECENT);
    showAll();
    if (isAnimated) this.invalidate();
  }

  /** @param {any} camera a three.js camera */
  paint(camera) {
    const now = performance.now();
    // A single change is drawn with the highest quality, but the first picture of a turn by hand must not be late.
    const isMoving = !this.hasRested && (isMotion(now - this.drawnAt) || isMotion(now - this.turnedAt));
    this.hasRested = false;
    this.drawnAt = now;
    clearTimeout(this.restTimer);
    if (!isMoving) {
      draw(this.canvas, this.mirror, camera, atRest());
      this.quality.rest();
      this.canvas.ariaBusy = "false";
      return;
    }
    // Until the versions of meshes exist, drawing takes longer than it will.
    const isReady = !this.quality.isCoarse || createVersions();
    this.quality.paint((quality) => draw(this.canvas, this.mirror, camera, quality), finish, isReady);
    this.restTimer = setTimeout(() => {
      this.hasRested = true;
      this.invalidate();
    }, REST_AFTER);
  }

  addListeners() {
    /** @param {string} name @param {(event: any) => void} act */
    const on = (name, act) =>
      this.canvas.addEventListener(name, (event) => this.handleByTool?.(event) || act(event), { passive: false });
    /** @type {{x: number, y: number, distance: number, button: number} | null} */
    let press = null;
    /** @type {Map<number, PointerEvent>} the fingers on the view, by the ids of their pointers */
    const fingers = new Map();
    on("pointerdown", (event) => {
      if (event.pointerType === "touch") fingers.set(event.pointerId, event);
      const { clientX: x, clientY: y } = event;
      press = fingers.size > 1 ? null : { x, y, distance: 0, button: buttonOf(event) };
      this.showFocus(true);
      this.canvas.setPointerCapture(event.pointerId);
      this.canvas.focus({ preventScroll: true });
      event.preventDefault();
    });
    this.canvas.addEventListener("pointerleave", () => (this.pointer = null));
    this.canvas.addEventListener("pointermove", (event) => (this.pointer = event));
    on("pointermove", (event) => {
      if (fingers.size > 1) this.pinch(fingers, event);
      if (!press) return;
      const [dx, dy] = [event.clientX - press.x, event.clientY - press.y];
      press = { ...press, x: event.clientX, y: event.clientY, distance: press.distance + Math.hypot(dx, dy) };
      const box = this.canvas.getBoundingClientRect();
      this.drag(press.button, dx, dy, [event.clientX - box.left, event.clientY - box.top]);
    });
    on("pointerup", (event) => {
      fingers.delete(event.pointerId);
      if (press && press.distance < CLICK) this.options.onClick?.(this.pick(event));
      press = null;
      this.showFocus(false);
    });
    on("pointercancel", (event) => {
      fingers.delete(event.pointerId);
      press = null;
      this.showFocus(false);
    });
    on("contextmenu", consume); // otherwise JupyterLab opens its menu after each zoom
    on("wheel", (event) => {
      if (!this.options.alone && !event.ctrlKey && document.activeElement !== this.canvas) return;
      this.drag(event.shiftKey ? 3 : 2, 0, NOTCH * notchesOf(event));
      consume(event);
    });
    on("keydown", (event) => {
      const [dx, dy] = ARROWS[event.key] ?? [0, 0];
      if (dx || dy) this.drag(event.shiftKey ? 1 : 0, dx, dy);
      else if (event.key === "+" || event.key === "-") this.drag(2, 0, event.key === "-" ? NOTCH : -NOTCH);
      else if (event.key === "F11") this.toggleFull();
      else if (event.key === "f" && !event.ctrlKey && !event.metaKey) this.lookAtPointer();
      else return;
      consume(event);
    });
  }

  /**
   * Rotate (left), pan (middle), zoom (right) or move ahead (3).
   * @param {number} button @param {number} dx @param {number} dy @param {number[]} [at] the pointer, in pixels
   */
  drag(button, dx, dy, at) {
    if (this.orbit.locked) return this.showMessage("Unlock camera in settings to enable mouse interaction.");
    if (button === 0) this.orbit.rotate(dx * TURN, dy * TURN);
    else if (button === 1) this.orbit.pan(dx, dy, this.canvas, at);
    else if (button === 3 && this.orbit.hasDolly) this.orbit.dolly(dy * 0.01);
    else this.orbit.zoom(Math.exp(dy * 0.01));
    this.onTurned();
  }

  /**
   * Zoom by the distance of two fingers, and pan by their middle.
   * @param {Map<number, PointerEvent>} fingers @param {PointerEvent} event of one of them
   */
  pinch(fingers, event) {
    const before = fingers.get(event.pointerId);
    const other = [...fingers.values()].find(({ pointerId }) => pointerId !== event.pointerId);
    if (!before || !other) return;
    fingers.set(event.pointerId, event);
    const [from, to] = [before, event].map((at) => Math.hypot(at.clientX - other.clientX, at.clientY - other.clientY));
    if (from && to) this.drag(2, 0, 100 * Math.log(from / to));
    const box = this.canvas.getBoundingClientRect();
    const middle = [(event.clientX + other.clientX) / 2 - box.left, (event.clientY + other.clientY) / 2 - box.top];
    this.drag(1, (event.clientX - before.clientX) / 2, (event.clientY - before.clientY) / 2, middle);
  }

  /** @param {boolean} isShown whether a disc marks the focal point, as in RViz while a button is pressed */
  showFocus(isShown) {
    if (this.focus) this.mirror.dispose(this.focus);
    this.focus = isShown && this.orbit.focalSize ? new THREE.Mesh(new THREE.SphereGeometry(0.5, 24, 12)) : null;
    if (!this.focus) return this.invalidate();
    const color = this.orbit.lift ? 0x00ffff : 0xffff00;
    this.focus.material = new THREE.MeshBasicMaterial({ color, opacity: 0.5, transparent: true, depthWrite: false });
    this.focus.raycast = () => {};
    this.mirror.scene.add(this.focus);
    this.placeFocus();
    this.invalidate();
  }

  placeFocus() {
    if (!this.focus) return;
    const { point, distance } = this.orbit.focalPoint();
    const size = this.orbit.focalSize * (this.orbit.focalFixed ? 1 : distance);
    this.focus.position.copy(point);
    this.focus.scale.set(size, size, size / 5);
  }

  /** @param {number[]} point the new focal point [m], as set by RViz's Focus Camera */
  lookAt(point) {
    this.orbit.lookAt(point);
    this.onTurned();
  }

  /** Look at the point below the pointer, like RViz's key F. */
  lookAtPointer() {
    const point = this.pointer && this.pick(this.pointer).point;
    if (point) this.lookAt(point);
  }

  onTurned() {
    this.placeFocus();
    this.turnedAt = performance.now();
    this.onTurn();
    this.invalidate();
  }

  /** @param {any} camera as Python describes it; ignored while the user turns the view */
  setCamera(camera) {
    if (performance.now() - this.turnedAt > TURN_PAUSE) this.orbit.setCamera(camera);
  }

  /** @param {MouseEvent} event @returns {import("./protocol.js").Click} the object under the pointer, and the point in the scene's frame */
  pick(event) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * x - 1, 1 - 2 * y), this.orbit.camera(box.width, box.height));
    const [origin, direction] = [caster.ray.origin.toArray(), caster.ray.direction.toArray()];
    const click = { button: event.button, origin, direction };
    const hit = caster.intersectObject(this.mirror.scene, true).find((/** @type {any} */ hit) => isShown(hit.object));
    if (!hit) return click;
    const normal = hit.face?.normal.clone().transformDirection(hit.object.matrixWorld).toArray() ?? null;
    const index = hit.instanceId ?? hit.index ?? hit.faceIndex ?? null;
    return { ...click, path: pathOf(hit.object), point: hit.point.toArray(), normal, index };
  }
}

/**
 * @param {WheelEvent} event
 * @returns {number} the notches by which the wheel was turned, at most one; a touchpad sends small parts of one
 */
function notchesOf({ deltaX, deltaY, deltaMode, ctrlKey }) {
  const unit = deltaMode === 1 ? 33 : deltaMode === 2 ? 100 : ctrlKey ? 10 : 1; // lines, pages, a pinch, pixels
  return Math.max(-1, Math.min(1, (unit * (deltaY || deltaX)) / 100));
}

/** @param {PointerEvent} event @returns {number} the button; with Shift, left pans and right moves ahead (3) */
const buttonOf = ({ button, shiftKey }) => (shiftKey ? (button === 2 ? 3 : 1) : button);

/** @param {Event} event that must not reach the surrounding page */
function consume(event) {
  event.preventDefault();
  event.stopPropagation();
}

/** @param {any} object @returns {string} */
const pathOf = (object) => object.userData.path ?? pathOf(object.parent);
