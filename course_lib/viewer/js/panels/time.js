import { icon } from "../icons.js";
import { button, createElement, setChanged } from "./elements.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4];
const TIME_STYLE = `
.course-time { display: flex; flex-wrap: wrap; gap: 2px 10px; align-items: center; padding: 2px 6px;
  font: 13px/1.6 system-ui, sans-serif; color: var(--jp-ui-font-color1, CanvasText);
  background: var(--jp-layout-color1, Canvas); }
.course-time:not(.course-viewer *) { color-scheme: light dark; }
.course-time input { flex: 1 1 8em; min-width: 6em; }
.course-time output { flex: 1 1 26em; display: flex; flex-wrap: wrap; gap: 0 10px; font-variant-numeric: tabular-nums; }
.course-time button { min-width: 2.2em; min-height: 24px; }
.course-time button[aria-pressed="true"] { outline: 2px solid currentColor; outline-offset: -2px; }`;

/** @typedef {import("../protocol.js").TimeState} Time */
/** @typedef {import("../protocol.js").TimeChange} TimeChange */

/** RViz's Time panel: the time, and controls to play, pause, step, change the speed, seek and loop. */
export class TimeBar {
  /**
   * @param {HTMLElement} host @param {(change: TimeChange) => void} onChange called with each change
   * @param {HTMLElement} keys the element whose keys Space, comma, period, Home, End and L are handled
   */
  constructor(host, onChange, keys = host) {
    this.onChange = onChange;
    /** @type {Time} */
    this.time = { elapsed: 0, paused: true, rate: 1 };
    this.element = createElement("div", { className: "course-time", role: "group", ariaLabel: "Time" });
    this.playButton = button("", "", () => onChange({ paused: !this.time.paused }));
    this.backButton = button("−1", "Step back (comma)", () => onChange({ step: -1 }));
    this.stepButton = button("+1", "Step (period)", () => onChange({ step: 1 }));
    this.slider = createElement("input", { type: "range", step: "any", ariaLabel: "Time" });
    this.slider.oninput = () => onChange({ now: Number(this.slider.value) });
    this.loopButton = button(icon("loop"), "Loop (L)", () => onChange({ loop: !this.time.loop }));
    this.speedSelect = createElement("select", { ariaLabel: "Speed", title: "Speed" });
    for (const rate of SPEEDS) this.speedSelect.append(new Option(`${rate}×`, String(rate)));
    this.speedSelect.onchange = () => onChange({ rate: Number(this.speedSelect.value) });
    this.text = createElement("output", { ariaLive: "off" });
    const style = createElement("style", { textContent: TIME_STYLE });
    const buttons = [this.playButton, this.backButton, this.stepButton];
    this.element.append(style, ...buttons, this.slider, this.loopButton, this.speedSelect, this.text);
    host.append(this.element);
    keys.addEventListener("keydown", (event) => this.onKey(event));
  }

  /** @param {Time} time */
  update(time) {
    this.time = time;
    const name = time.paused ? "Play (Space)" : "Pause (Space)";
    if (this.playButton.title !== name) {
      Object.assign(this.playButton, { title: name, ariaLabel: name });
      this.playButton.replaceChildren(icon(time.paused ? "play" : "pause"));
    }
    const range = time.range ?? [0, 0];
    for (const control of [this.backButton, this.slider, this.loopButton]) setChanged(control, { hidden: !time.range });
    setChanged(this.slider, { min: String(range[0]), max: String(range[1]) });
    if (!this.slider.matches(":active")) this.slider.value = String(time.elapsed); // the user may be dragging it
    if (time.range) setChanged(this.slider, { ariaValueText: `${time.elapsed.toFixed(2)} of ${range[1].toFixed(2)} s` });
    setChanged(this.loopButton, { ariaPressed: String(time.loop ?? false) });
    this.speedSelect.value = String(time.rate);
    const texts = timeTexts(time);
    // A narrow window breaks the line between two clocks.
    if (this.text.children.length !== texts.length)
      this.text.replaceChildren(...texts.flatMap(() => [createElement("span"), "  "]));
    texts.forEach((textContent, i) => setChanged(this.text.children[i], { textContent }));
  }

  /** @param {KeyboardEvent} event */
  onKey(event) {
    const { range, paused, loop } = this.time;
    const ends = range ? { Home: { now: range[0] }, End: { now: range[1] }, ",": { step: -1 } } : {};
    /** @type {Record<string, TimeChange | undefined>} */
    const orders = { " ": { paused: !paused }, ".": { step: 1 }, l: range && { loop: !loop }, ...ends };
    const order = orders[event.key];
    const target = /** @type {HTMLElement} */ (event.target);
    if (!order || event.ctrlKey || event.altKey || event.metaKey || target.isContentEditable) return;
    if (event.key === " " ? target.matches("button, a") : target.matches("select, textarea")) return;
    if (target.matches("input:not([type=range], [type=checkbox])")) return;
    this.onChange(order);
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
      if (link.player) link.player.apply(change);
      else link.send({ type: "time", ...change });
    });
    bar.update(time);
  };
  link.timeBars.add(update);
  if (link.player) link.player.show();
  else link.send({ type: "time" }); // an empty change, to which Python responds if it has a time
  return () => {
    link.timeBars.delete(update);
    bar?.element.remove();
  };
}

/** @param {Time} time @returns {string[]} the texts of RViz's Time panel */
function timeTexts({ now, elapsed, range, wall, wallElapsed, note }) {
  const parts = now === undefined ? [] : [`ROS Time: ${now.toFixed(2)}`];
  parts.push(`ROS Elapsed: ${elapsed.toFixed(2)}${range ? ` of ${range[1].toFixed(2)} s` : ""}`);
  if (wall !== undefined) parts.push(`Wall Time: ${wall.toFixed(2)}`);
  if (wallElapsed !== undefined) parts.push(`Wall Elapsed: ${wallElapsed.toFixed(2)}`);
  return [...parts, ...(note ? [note] : [])];
}
