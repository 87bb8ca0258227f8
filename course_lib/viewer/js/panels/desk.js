/* global DESK_STYLE */
import { Panels } from "./panels.js";
import { part } from "./parts.js";

/** What Python says of all panels, and the desks of a page that show it. */
export class DeskState {
  /** @param {(order: any) => void} send carries an order to Python */
  constructor(send) {
    /** @type {Record<string, any>} */
    this.values = {};
    /** @type {Set<Desk>} */
    this.desks = new Set();
    /** @param {string} act @param {any} [order] */
    this.act = (act, order = {}) => send({ type: "desk", act, ...order });
    this.act("open");
  }

  /** @param {{changed: Record<string, any>, gone: string[]}} news */
  take({ changed, gone }) {
    Object.assign(this.values, changed);
    for (const key of gone) delete this.values[key];
    for (const desk of this.desks) desk.update(changed);
  }

  /** @param {string} name of a list of rows */
  rows(name) {
    return (this.values[name] ?? []).map((/** @type {string} */ key) => this.values[`row ${key}`]);
  }
}

/** RViz's tools, panels and status line around one view; there once Python has said something. */
export class Desk {
  /**
   * @param {HTMLElement} element gets all of it @param {HTMLElement} host holds the view
   * @param {import("../view.js").View} view @param {DeskState} state
   */
  constructor(element, host, view, state) {
    this.view = view;
    this.state = state;
    /** @type {Panels | null} */
    this.panels = null;
    const style = part("style", { textContent: DESK_STYLE });
    this.frame = part("div", { className: "course-viewer" }, style, host);
    this.frame.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
      if (!event.ctrlKey && !event.metaKey && !event.altKey) event.stopPropagation(); // they are not the notebook's
    });
    host.classList.add("course-host");
    element.append(this.frame);
    state.desks.add(this);
    this.update(state.values);
  }

  dispose() {
    clearTimeout(this.panels?.turning);
    this.state.desks.delete(this);
    this.frame.remove();
  }

  /** @param {Record<string, any>} changed values */
  update(changed) {
    if (!this.state.values.tree) return;
    this.panels ??= new Panels(this.frame, this.view, this.state);
    this.panels.update(changed);
  }
}
