import { icon } from "../icons.js";
import { button, part } from "./parts.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4];
const TIME_STYLE = `
.course-time { display: flex; flex-wrap: wrap; gap: 2px 10px; align-items: center; padding: 2px 6px;
  font: 13px/1.6 system-ui, sans-serif; color: var(--jp-ui-font-color1, CanvasText);
  background: var(--jp-layout-color1, Canvas); }
.course-time:not(.course-viewer *) { color-scheme: light dark; }
.course-time input { flex: 1 1 8em; min-width: 6em; }
.course-time output { white-space: nowrap; font-variant-numeric: tabular-nums; }
.course-time button { min-width: 2.2em; }
.course-time button[aria-pressed="true"] { outline: 2px solid currentColor; outline-offset: -2px; }`;

/** @typedef {import("../protocol.js").TimeState} Time */
/** @typedef {import("../protocol.js").TimeChange} TimeChange */

/** RViz's Time panel: the time, and controls to play, pause, step, change the speed, seek and loop. */
export class TimeBar {
  /**
   * @param {HTMLElement} host @param {(change: TimeChange) => void} act called with each change
   * @param {HTMLElement} keys the element whose keys Space, comma, period, Home, End and L are handled
   */
  constructor(host, act, keys = host) {
    this.act = act;
    /** @type {Time} */
    this.time = { elapsed: 0, paused: true, rate: 1 };
    this.box = part("div", { className: "course-time", role: "group", ariaLabel: "Time" });
    this.play = button("", "", () => act({ paused: !this.time.paused }));
    this.back = button("−1", "Step back (comma)", () => act({ step: -1 }));
    this.step = button("+1", "Step (period)", () => act({ step: 1 }));
    this.scrub = part("input", { type: "range", step: "any", ariaLabel: "Time" });
    this.scrub.oninput = () => act({ now: Number(this.scrub.value) });
    this.loop = button(icon("loop"), "Loop (L)", () => act({ loop: !this.time.loop }));
    this.speed = part("select", { ariaLabel: "Speed", title: "Speed" });
    for (const rate of SPEEDS) this.speed.append(new Option(`${rate}×`, String(rate)));
    this.speed.onchange = () => act({ rate: Number(this.speed.value) });
    this.words = part("output", { ariaLive: "off" });
    const style = part("style", { textContent: TIME_STYLE });
    this.box.append(style, this.play, this.back, this.step, this.scrub, this.loop, this.speed, this.words);
    host.append(this.box);
    keys.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {Time} time */
  update(time) {
    this.time = time;
    const name = time.paused ? "Play (Space)" : "Pause (Space)";
    if (this.play.title !== name) {
      Object.assign(this.play, { title: name, ariaLabel: name });
      this.play.replaceChildren(icon(time.paused ? "play" : "pause"));
    }
    const range = time.range ?? [0, 0];
    for (const one of [this.back, this.scrub, this.loop]) one.hidden = !time.range;
    Object.assign(this.scrub, { min: range[0], max: range[1] });
    if (!this.scrub.matches(":active")) this.scrub.value = String(time.elapsed); // the user may be dragging it
    this.scrub.setAttribute("aria-valuetext", `${time.elapsed.toFixed(2)} of ${range[1].toFixed(2)} s`);
    this.loop.ariaPressed = String(time.loop ?? false);
    this.speed.value = String(time.rate);
    this.words.textContent = timeText(time);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const { range, paused, loop } = this.time;
    const ends = range ? { Home: { now: range[0] }, End: { now: range[1] }, ",": { step: -1 } } : {};
    /** @type {Record<string, TimeChange | undefined>} */
    const orders = { " ": { paused: !paused }, ".": { step: 1 }, l: range && { loop: !loop }, ...ends };
    const order = orders[event.key];
    const target = /** @type {HTMLElement} */ (event.target);
    if (!order || event.ctrlKey || event.altKey || event.metaKey || target.isContentEditable) return;
    if (event.key === " " ? target.matches("button, a") : target.matches("select, textarea")) return;
    if (target.matches("input:not([type=range], [type=checkbox])")) return;
    this.act(order);
    event.preventDefault();
    event.stopPropagation();
  }
}

/**
 * Show the time below a view once Python has sent it, and send the user's changes to Python.
 * @param {import("../link.js").Link} link @param {HTMLElement} element with the view @returns {() => void} removes the time bar
 */
export function timeBelow(link, element) {
  /** @type {TimeBar | null} */
  let bar = null;
  const update = (/** @type {Time} */ time) => {
    bar ??= new TimeBar(element, (change) => {
      if (link.player) link.player.act(change);
      else link.send({ type: "time", ...change });
    });
    bar.update(time);
  };
  link.timeBars.add(update);
  if (link.player) link.player.show();
  else link.send({ type: "time" }); // an empty change, to which Python responds if it has a time
  return () => {
    link.timeBars.delete(update);
    bar?.box.remove();
  };
}

/** @param {Time} time @returns {string} the text of RViz's Time panel */
function timeText({ now, elapsed, range, wall, wallElapsed, note }) {
  const parts = now === undefined ? [] : [`ROS Time: ${now.toFixed(2)}`];
  parts.push(`ROS Elapsed: ${elapsed.toFixed(2)}${range ? ` of ${range[1].toFixed(2)} s` : ""}`);
  if (wall !== undefined) parts.push(`Wall Time: ${wall.toFixed(2)}`);
  if (wallElapsed !== undefined) parts.push(`Wall Elapsed: ${wallElapsed.toFixed(2)}`);
  return [...parts, ...(note ? [note] : [])].join("  ");
}
