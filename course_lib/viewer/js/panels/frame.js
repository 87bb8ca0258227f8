/* global PANEL_STYLE */
import { Panels } from "./panels.js";
import { createElement } from "./elements.js";

/** @typedef {import("../protocol.js").PanelState} PanelState */
/** @typedef {import("../protocol.js").PanelRow} Row */
/** @typedef {import("../protocol.js").Command} Command */

/** The last state of all panels received from Python, and the frames of a page that show it. */
export class PanelStore {
  /** @param {(command: any) => void} send sends a command to Python @param {boolean} isAtRest whether the panels are read-only */
  constructor(send, isAtRest = false) {
    this.isAtRest = isAtRest;
    this.values = /** @type {PanelState} */ ({}); // complete after the first message from Python
    /** @type {Record<string, Row>} */
    this.rows = {};
    /** @type {Set<PanelFrame>} */
    this.frames = new Set();
    this.isWatched = false; // whether a panel of the page is open, so that Python sends changed rows
    /** @param {Command} command */
    this.act = (command) => send({ type: "panels", ...command });
    this.act({ act: "OpenPanels" });
  }

  /** @param {import("../protocol.js").PanelUpdate} update */
  apply({ changed, rows, gone }) {
    Object.assign(this.values, changed);
    Object.assign(this.rows, rows);
    for (const key of gone) delete this.rows[key];
    for (const frame of this.frames) frame.update(changed);
  }

  /** Report whether a panel is open. */
  reportOpenPanels() {
    const isWatched = [...this.frames].some(({ panels }) => panels?.isOpen);
    if (isWatched === this.isWatched || this.isAtRest) return;
    this.isWatched = isWatched;
    this.act({ act: "WatchRows", watched: isWatched });
  }

  /** @param {string[]} keys @returns {Row[]} */
  rowsOf(keys) {
    return keys.map((key) => this.rows[key]);
  }
}

/** RViz's tools, panels and status line around one view; created after the first message from Python. */
export class PanelFrame {
  /**
   * @param {HTMLElement} element contains everything @param {HTMLElement} host contains the view
   * @param {import("../view.js").View} view @param {PanelStore} state
   */
  constructor(element, host, view, state) {
    this.view = view;
    this.state = state;
    /** @type {Panels | null} */
    this.panels = null;
    const style = createElement("style", { textContent: PANEL_STYLE });
    this.frame = createElement("div", { className: "course-viewer" }, style, host);
    this.frame.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
      if (!event.ctrlKey && !event.metaKey && !event.altKey) event.stopPropagation(); // these keys must not reach the notebook
    });
    this.frame.classList.toggle("course-resting", state.isAtRest);
    host.classList.add("course-host");
    element.append(this.frame);
    state.frames.add(this);
    this.update(state.values);
  }

  dispose() {
    clearTimeout(this.panels?.turnTimer);
    this.state.frames.delete(this);
    this.state.reportOpenPanels();
    this.frame.remove();
  }

  /** @param {Partial<PanelState>} changed */
  update(changed) {
    if (!this.state.values.tree) return;
    this.panels ??= new Panels(this.frame, this.view, this.state);
    this.panels.update(changed);
  }
}
