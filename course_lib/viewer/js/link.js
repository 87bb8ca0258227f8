import { bytesOf } from "./decode.js";
import { Mirror } from "./mirror.js";
import { View } from "./view.js";

/** Keeps a mirror equal to the scene in the kernel, over a widget's model. */
export class Link {
  /** @param {any} model its state holds a snapshot, and the number of the last batch in it */
  constructor(model) {
    this.model = model;
    this.mirror = new Mirror();
    this.number = model.get("number");
    this.mirror.apply(bytesOf(model.get("snapshot")));
    model.send({ type: "ready", number: this.number });
  }

  /** @param {{type: string, number: number}} message @param {DataView[]} buffers */
  receive(message, buffers) {
    if (message.type === "reset") {
      this.number = message.number;
      this.mirror.reset(bytesOf(buffers[0]));
    } else if (message.number === this.number + 1) {
      this.number = message.number;
      this.mirror.apply(bytesOf(buffers[0]));
    } else if (message.number > this.number) this.model.send({ type: "resync" }); // one was lost
  }

  /** @param {HTMLElement} element @returns {() => void} removes the view */
  show(element) {
    const host = document.createElement("div");
    host.style.cssText = `width:100%;height:${this.model.get("height")}px;overflow:hidden`;
    element.append(host);
    const label = this.model.get("label");
    const view = new View(host, this.mirror, { label, onClick: (click) => this.model.send(click) });
    this.count();
    return () => {
      view.dispose();
      host.remove();
      this.count();
    };
  }

  /** Tell how many views this page has, so that what nobody sees can end. */
  count() {
    this.model.send({ type: "views", count: this.mirror.views.size });
  }

  close() {
    for (const view of [...this.mirror.views]) view.dispose();
    this.mirror.clear("");
  }
}
