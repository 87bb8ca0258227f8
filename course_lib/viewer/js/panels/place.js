import { icon } from "../icons.js";
import { button, part } from "./parts.js";

const LAB = ".jp-LabShell"; // around all that JupyterLab shows
const BESIDE = ".jupyterlab-sidecar"; // the panel that Python has JupyterLab open

/** Where a view is shown: in a cell, or in a panel beside the notebook; then one line in the cell says so. */
export class Place {
  /**
   * @param {import("../link.js").Link} link @param {HTMLElement} element holds the frame
   * @param {HTMLElement} frame the view with its panels @param {HTMLElement} host the view
   */
  constructor(link, element, frame, host) {
    this.link = link;
    this.element = element;
    this.frame = frame;
    this.beside = false;
    this.opener = button(icon("beside"), "Beside the notebook", () => link.send({ type: "dock", open: true }));
    this.opener.className = "course-opener";
    this.opener.hidden = true;
    host.append(this.opener);
    const back = button("Show it here", "Show the view in this cell again", () => this.close());
    this.line = part("div", { className: "course-elsewhere", hidden: true }, "The view is beside the notebook. ", back);
    element.append(this.line);
    this.sizes = new ResizeObserver(() => this.look()); // called once the element is in the page
    this.sizes.observe(element);
    link.places.add(this);
  }

  /** See where the element is now: hosts put it into the page after it was made. */
  look() {
    const inLab = this.element.closest(LAB) !== null;
    this.beside = inLab && this.element.closest(BESIDE) !== null;
    this.opener.hidden = !inLab || this.beside;
    this.arrange();
    const { link } = this;
    if (!inLab || link.asked || !link.model.get("beside") || [...link.places].some((one) => one.beside)) return;
    link.asked = true; // Python does nothing if the panel is there, or about to be
    link.send({ type: "dock", open: true, again: false });
  }

  arrange() {
    const isBeside = [...this.link.places].some((one) => one.beside);
    for (const { beside, frame, line } of this.link.places) {
      frame.hidden = isBeside && !beside;
      line.hidden = !frame.hidden;
    }
  }

  close() {
    this.link.asked = true; // it was closed by hand
    this.link.send({ type: "dock", open: false });
  }

  dispose() {
    this.sizes.disconnect();
    this.link.places.delete(this);
    this.line.remove();
    if (this.beside) this.close();
    this.arrange();
  }
}
