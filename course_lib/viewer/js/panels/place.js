import { icon } from "../icons.js";
import { button, part } from "./parts.js";

const LAB = ".jp-LabShell"; // the element around JupyterLab's whole page
const ONE_AT_A_TIME = '[data-shell-mode="single-document"]'; // JupyterLab's simple mode, in which a panel hides the notebook
const BESIDE = ".jupyterlab-sidecar"; // the panel that JupyterLab opens for Python
const ROOM = 1200; // [px] width of the page from which on there is room for 79 columns of code and a view
const OPENING = 4000; // [ms] that a panel may take to open before the view is shown in its cell
const SWAP = 400; // [ms] in which a panel that remains receives its next view

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
    this.beside = false;
    /** @type {Element | null} */
    this.panel = null;
    this.opener = button(icon("beside"), "Beside the notebook", () => link.send({ type: "dock", action: "open" }));
    this.opener.className = "course-opener";
    this.opener.hidden = true;
    view.host.append(this.opener);
    const close = () => link.send({ type: "dock", action: "close" });
    const back = button("Show it here", "Show the view in this cell again", close);
    const take = () => link.send({ type: "dock", action: "take" });
    this.taker = button("Show it there", "Show this view beside the notebook", take);
    this.words = part("span");
    this.line = part("div", { className: "course-elsewhere", hidden: true }, this.words, this.taker, back);
    element.append(this.line);
    this.sizes = new ResizeObserver(() => this.look()); // called once the element is in the page
    this.sizes.observe(element);
    link.places.add(this);
    places.add(this);
  }

  /** Update the location of the element, which hosts insert into the page after it was created. */
  look() {
    const lab = this.element.closest(LAB);
    const [wasBeside, lastPanel] = [this.beside, this.panel];
    this.panel = lab && this.element.closest(BESIDE);
    this.beside = this.panel !== null;
    this.opener.hidden = !lab || this.beside;
    if (this.beside !== wasBeside) {
      this.view.orbit.isTall = this.beside;
      this.view.invalidate();
      arrange();
    } else this.arrange();
    if (lastPanel && !this.panel) this.leave(lastPanel);
    const { link } = this;
    if (this.beside && !wasBeside) {
      // The extension of JupyterLab divides the page between the notebook and the panel.
      const detail = { context: link.model.widget_manager?.context };
      this.element.dispatchEvent(new CustomEvent("course-docked", { bubbles: true, detail }));
    }
    const hasRoom = lab !== null && !lab.matches(ONE_AT_A_TIME) && window.innerWidth >= ROOM;
    if (!hasRoom || link.asked || link.ended || !link.model.get("beside") || isDocked(link)) return;
    link.asked = link.opens = true; // Python ignores this if the panel exists or is being opened
    link.send({ type: "dock", action: "join" });
    setTimeout(() => {
      link.opens = false;
      arrange();
    }, OPENING);
    arrange();
  }

  /** Show the view here, or the line of text. */
  arrange() {
    const { link, frame, line } = this;
    const hasPanel = isDocked(link);
    frame.hidden = !this.beside && link.model.get("beside") && (link.opens || hasPanel);
    line.hidden = !frame.hidden;
    const isOther = hasPanel && ![...link.places].some((one) => one.beside);
    this.words.textContent = isOther ? "Another view is beside the notebook." : "The view is beside the notebook.";
    this.taker.hidden = !isOther;
  }

  dispose() {
    this.sizes.disconnect();
    this.link.places.delete(this);
    places.delete(this);
    this.line.remove();
    if (this.panel) this.leave(this.panel);
  }

  /** @param {Element} panel that no longer has this view: another view took it, it was moved, or the user has closed it */
  leave(panel) {
    const { link } = this;
    const name = link.model.get("panel"); // empty after Python has removed the view from the panel
    setTimeout(() => {
      arrange();
      if (name && !link.ended && !panel.isConnected) link.send({ type: "dock", action: "gone", panel: name });
    }, SWAP);
  }
}

/** Show each view of the page in its cell, unless a side panel has it. */
export function arrange() {
  for (const place of places) place.arrange();
}

/** @param {import("../link.js").Link} link @returns {boolean} whether a view of the same notebook is in the side panel */
function isDocked(link) {
  const manager = link.model.widget_manager;
  return [...places].some((one) => one.panel?.isConnected && one.link.model.widget_manager === manager);
}
