/* global THREE */
import { setGlow } from "../materials.js";

const [HOVERED, PRESSED] = [0.15, 0.25]; // added to the colors of a control below the pointer
const GREEN = 0x00ff00; // of the arrow of RViz's pose tools
/** @typedef {import("../protocol.js").ToolButton} ToolButton */
/** @typedef {import("../protocol.js").Click} Click */
/** @type {Record<ToolButton["gesture"], string>} */
const HINTS = {
  interact: "",
  camera: "",
  pose: "Click and drag to set position and orientation.",
  point: "Click on a point to publish it.",
  select: "Click on an object to see its message and frame.",
  focus: "Click on a point to look at it, or beside all objects to look in that direction.",
  measure: "Click on two points to measure their distance. Right-click to reset.",
};

/** The actions of the mouse in a view while one of RViz's tools is selected. */
export class Gestures {
  /**
   * @param {import("../view.js").View} view @param {(command: import("./frame.js").Command) => void} act called with a command
   * @param {(text: string) => void} showHint shows a hint @param {() => void} selectFirstTool selects the first tool
   */
  constructor(view, act, showHint, selectFirstTool) {
    this.view = view;
    this.act = act;
    this.showHint = showHint;
    this.selectFirstTool = selectFirstTool;
    /** @type {ToolButton} */
    this.tool = { label: "", key: "", gesture: "camera" };
    /** @type {string[]} */
    this.handles = []; // nodes with interactive markers below them
    /** @type {{path: string, button: number} | null} */
    this.pressed = null; // the control that the pointer has pressed
    this.glowing = ""; // the path of the control that is drawn brighter
    this.wantsMenu = false;
    /** @type {import("../protocol.js").ToolSettings} */
    this.settings = { color: "#808000", single: true }; // RViz's, of Measure and of Publish Point
    /** @type {any} */
    this.start = null; // where an arrow or a line begins
    this.yaw = 0; // [rad] of the arrow
    /** @type {any} */
    this.overlay = null; // shown over the scene
    view.handleByTool = (event) => this.onEvent(event);
  }

  /** @param {ToolButton} tool */
  useTool(tool) {
    this.tool = tool;
    this.start = null;
    this.showOverlay(null);
    this.highlight("", 0);
    this.showHint(HINTS[tool.gesture]);
    this.view.canvas.style.cursor = isForCamera(tool.gesture) ? "" : "crosshair";
  }

  /** @param {any} event of the pointer or the keyboard @returns {boolean} whether it is handled */
  onEvent(event) {
    const gesture = this.tool.gesture;
    if (gesture === "camera" || !event.type.startsWith("pointer")) return false;
    if (gesture === "interact") return this.handles.length > 0 && this.interact(event);
    if (gesture === "pose") return this.pose(event);
    if (event.type === "pointermove" && !event.buttons) this.hover(event);
    if (gesture === "measure" && event.type === "pointerdown" && event.button === 2) this.useTool(this.tool);
    return false; // the view is turned, and reports clicks
  }

  /** @param {PointerEvent} event on an interactive marker or not @returns {boolean} whether it is handled */
  interact(event) {
    const kind = event.type.slice("pointer".length);
    if (!this.pressed && (kind === "up" || (kind === "move" && event.buttons))) return false; // the camera is turned
    const { origin, direction, path, point } = this.view.pick(event);
    if (!this.pressed) {
      const isOver = Boolean(path && this.handles.some((handle) => path.startsWith(`${handle}/`)));
      this.view.canvas.style.cursor = isOver ? "grab" : "";
      this.highlight(isOver ? controlOf(path ?? "") : "", kind === "down" ? PRESSED : HOVERED);
      if (!isOver || kind !== "down") return false;
      this.pressed = { path: path ?? "", button: event.button };
      this.view.canvas.setPointerCapture(event.pointerId);
      this.view.canvas.focus({ preventScroll: true });
    }
    const { shiftKey: shift, ctrlKey: ctrl } = event;
    const { clientWidth, clientHeight } = this.view.canvas;
    const from = { ...this.view.orbit.pose(), pixel: this.view.orbit.pixel(clientWidth, clientHeight) };
    this.act({ act: "UseControl", event: kind, origin, direction, point, shift, ctrl, ...this.pressed, ...from });
    if (kind === "up" || kind === "cancel") {
      this.highlight(controlOf(this.pressed?.path ?? ""), HOVERED);
      [this.pressed, this.wantsMenu] = [null, true];
    }
    event.preventDefault();
    return true;
  }

  /** @param {string} path of the control that is drawn brighter, or "" for none @param {number} glow */
  highlight(path, glow) {
    const { nodes } = this.view.mirror;
    const [before, now] = [nodes.get(this.glowing), nodes.get(path)];
    if (this.glowing && before && before !== now) setGlow(before, 0);
    if (path && now) setGlow(now, glow);
    if (this.glowing || path) this.view.mirror.invalidateViews();
    this.glowing = path;
  }

  /** @param {Click} click reported by the view @returns {boolean} whether the tool handled it */
  click(click) {
    const gesture = this.tool.gesture;
    if (isForCamera(gesture) || click.button !== 0) return !isForCamera(gesture);
    if (gesture === "select") this.select(click);
    else if (gesture === "focus") {
      const { origin, direction } = click;
      this.view.lookAt(click.point ?? origin.map((part, axis) => part + direction[axis])); // 1 m ahead
      this.selectFirstTool();
    } else if (!click.point) this.showHint("Nothing is there.");
    else if (gesture === "measure") this.measure(click.point);
    else if (gesture === "point") {
      this.act({ act: "PublishGesture", tool: this.tool.label, point: click.point });
      if (this.settings.single) this.selectFirstTool();
    }
    return true;
  }

  /** @param {Click} click reported by the view */
  select({ path, index }) {
    const node = path === undefined ? null : this.view.mirror.nodes.get(path);
    this.showOverlay(node ? new THREE.BoxHelper(node, 0xffffff) : null);
    this.act({ act: "SelectObject", path, index });
  }

  /** @param {number[]} point [m] */
  measure(point) {
    const to = new THREE.Vector3(...point);
    if (this.start) this.measureTo(to);
    else this.showOverlay(null);
    this.start = this.start ? null : to;
  }

  /** @param {any} end of the line [m] */
  measureTo(end) {
    this.drawLine(this.start, end);
    this.showHint(`[Length: ${Number(this.start.distanceTo(end).toPrecision(6))}m] ${HINTS.measure}`);
  }

  /** @param {PointerEvent} event shows the point below the pointer, or the line to it */
  hover(event) {
    const isMeasuring = this.tool.gesture === "measure" && this.start;
    if (!isMeasuring && this.tool.gesture !== "point") return;
    const { point } = this.view.pick(event);
    if (isMeasuring) return point && this.measureTo(new THREE.Vector3(...point));
    const text = point ? `[${point.map((/** @type {number} */ part) => part.toFixed(3)).join(", ")}]` : HINTS.point;
    this.showHint(text);
  }

  /** @param {PointerEvent} event a press for the place on the ground, a drag for the direction */
  pose(event) {
    const ground = this.pointOnGround(event);
    if (event.type === "pointerdown" && event.button === 0 && !event.shiftKey) {
      [this.start, this.yaw] = [ground, 0];
      this.view.canvas.setPointerCapture(event.pointerId);
      this.view.canvas.focus({ preventScroll: true });
    } else if (!this.start) return false;
    if (ground && this.start) this.yaw = Math.atan2(ground.y - this.start.y, ground.x - this.start.x);
    if (this.start && event.type === "pointerup") {
      this.act({ act: "PublishGesture", tool: this.tool.label, point: this.start.toArray(), angle: this.yaw });
      this.selectFirstTool();
    } else if (this.start) this.drawArrow(this.start, this.yaw);
    event.preventDefault();
    return true;
  }

  /** @param {any} event @returns {any} the point below the pointer on the ground plane of the fixed frame */
  pointOnGround(event) {
    const { origin, direction } = this.view.pick(event);
    const distance = -origin[2] / direction[2];
    if (!(distance > 0)) return null;
    return new THREE.Vector3(origin[0] + distance * direction[0], origin[1] + distance * direction[1], 0);
  }

  /** @param {any} position [m] @param {number} yaw [rad] */
  drawArrow(position, yaw) {
    const material = new THREE.MeshBasicMaterial({ color: GREEN });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.1, 0.1, 2, 16).translate(0, 1, 0), material); // [m]
    const head = new THREE.Mesh(new THREE.ConeGeometry(0.175, 0.5, 16).translate(0, 2.25, 0), material);
    const arrow = new THREE.Group().add(shaft, head);
    arrow.position.copy(position);
    arrow.rotation.z = yaw - Math.PI / 2;
    this.showOverlay(arrow);
  }

  /** @param {any} from [m] @param {any} to [m] */
  drawLine(from, to) {
    const shape = new THREE.BufferGeometry().setFromPoints([from, to]);
    this.showOverlay(new THREE.Line(shape, new THREE.LineBasicMaterial({ color: this.settings.color, depthTest: false })));
  }

  /** @param {any} object shown over the scene, replacing the previous one; it is never picked */
  showOverlay(object) {
    if (this.overlay) this.view.mirror.dispose(this.overlay);
    this.overlay = object;
    object?.traverse((/** @type {any} */ child) => (child.raycast = () => {}));
    if (object) this.view.mirror.scene.add(object);
    this.view.mirror.invalidateViews();
  }
}

/** @param {string} path of an object @returns {string} of its control, above the numbers of its markers and their parts */
const controlOf = (path) => path.split("/").slice(0, -2).join("/");

/** @param {ToolButton["gesture"]} gesture @returns {boolean} whether the mouse turns the view while no control is pressed */
const isForCamera = (gesture) => gesture === "camera" || gesture === "interact";
