import { icon } from "../icons.js";
import { button, createElement } from "./elements.js";

const LAB = ".jp-LabShell"; // the element around JupyterLab's whole page
const ONE_AT_A_TIME = '[data-shell-mode="single-document"]'; // JupyterLab's simple mode, in which a panel hides the notebook
const SIDE_PANEL = ".jupyterlab-sidecar"; // the panel that JupyterLab opens for Python
const MIN_WIDTH = 1200; // [px] width of the page from which on there is room for 79 columns of code and a view
const OPENING_TIME = 4000; // [ms] that a panel may take to open before the view is shown in its cell
const SWAP_TIME = 400; // [ms] in which a panel that remains receives its next view
const INSERTED_AFTER = [250, 1000, 4000]; // [ms] an element is in the page, depending on the load of the machine

/** @type {Set<Place>} all views of the page */
const places = new Set();

/** The location of a view: a cell, or the notebook's side panel, in which case its cells show a line of text. */
export class Place {
  /**
   * @param {import("../link.js").Link} link @param {HTMLElement} element holds the frame
   * @param {HTMLElement} frame the view with its panels @param {import("../view.js").View} view
   */
  constructor(link, element, frame, view) {
    this.link = link;
    this.element = element;
    this.frame = frame;
    this.view = view;
    this.isBeside = false;
    /** @type {Element | null} */
    this.panel = null;
    this.openButton = button(icon("beside"), "Beside the notebook", () => link.send({ type: "dock", action: "open" }));
    this.openButton.className = "course-opener";
    this.openButton.hidden = true;
    view.host.append(this.openButton);
    const close = () => link.send({ type: "dock", action: "close" });
    const back = button("Show it here", "Show the view in this cell again", close);
    const take = () => link.send({ type: "dock", action: "take" });
    this.takeButton = button("Show it there", "Show this view beside the notebook", take);
    this.text = createElement("span");
    this.line = createElement("div", { className: "course-elsewhere", hidden: true }, this.text, this.takeButton, back);
    element.append(this.line);
    this.resizeObserver = new ResizeObserver(() => this.updateLocation()); // called once the element is in sight
    this.resizeObserver.observe(element);
    // After Run All Cells the notebook shows its end: no view is in sight, but one of them should be beside it.
    this.timers = INSERTED_AFTER.map((time) => setTimeout(() => this.updateLocation(), time));
    link.places.add(this);
    places.add(this);
  }

  /** Update the location of the element, which hosts insert into the page after it was created. */
  updateLocation() {
    const lab = this.element.closest(LAB);
    const [wasBeside, lastPanel] = [this.isBeside, this.panel];
    this.panel = lab && this.element.closest(SIDE_PANEL);
    this.isBeside = this.panel !== null;
    this.openButton.hidden = !lab || this.isBeside;
    if (this.isBeside !== wasBeside) {
      this.view.orbit.isTall = this.view.options.alone = this.isBeside;
      this.view.invalidate();
      arrange();
    } else this.arrange();
    if (lastPanel && !this.panel) this.onPanelLeft(lastPanel);
    const { link } = this;
    if (this.isBeside && !wasBeside) {
      // The extension of JupyterLab divides the page between the notebook and the panel.
      const detail = { context: link.model.widget_manager?.context };
      this.element.dispatchEvent(new CustomEvent("course-docked", { bubbles: true, detail }));
    }
    const hasRoom = lab !== null && !lab.matches(ONE_AT_A_TIME) && window.innerWidth >= MIN_WIDTH;
    if (!hasRoom || link.hasRequestedPanel || link.hasEnded || !link.model.get("beside") || isDocked(link)) return;
    link.hasRequestedPanel = link.isPanelOpening = true; // Python ignores this if the panel exists or is being opened
    link.send({ type: "dock", action: "join" });
    setTimeout(() => {
      link.isPanelOpening = false;
      arrange();
    }, OPENING_TIME);
    arrange();
  }

  /** Show the view here, or the line of text. */
  arrange() {
    const { link, frame, line } = this;
    const hasPanel = isDocked(link);
    frame.hidden = !this.isBeside && link.model.get("beside") && (link.isPanelOpening || hasPanel);
    line.hidden = !frame.hidden;
    const isOther = hasPanel && ![...link.places].some((place) => place.isBeside);
    this.text.textContent = isOther ? "Another view is beside the notebook." : "The view is beside the notebook.";
    this.takeButton.hidden = !isOther;
  }

  dispose() {
    this.resizeObserver.disconnect();
    this.timers.forEach(clearTimeout);
    this.link.places.delete(this);
    places.delete(this);
    this.line.remove();
    if (this.panel) this.onPanelLeft(this.panel);
  }

  /** @param {Element} panel that no longer has this view: another view took it, it was moved, or the user has closed it */
  onPanelLeft(panel) {
    const { link } = this;
    const name = link.model.get("panel"); // empty after Python has removed the view from the panel
    setTimeout(() => {
      arrange();
      if (name && !link.hasEnded && !panel.isConnected) link.send({ type: "dock", action: "gone", panel: name });
    }, SWAP_TIME);
  }
}

/** Show each view of the page in its cell, unless a side panel has it. */
export function arrange() {
  for (const place of places) place.arrange();
}

/** @param {import("../link.js").Link} link @returns {boolean} whether a view of the same notebook is in the side panel */
function isDocked(link) {
  const manager = link.model.widget_manager;
  return [...places].some((place) => place.panel?.isConnected && place.link.model.widget_manager === manager);
}
