import { bytesOf } from "./decode.js";
import { Mirror } from "./mirror.js";
import { View } from "./view.js";

/**
 * Keeps a mirror equal to the scene in the kernel.
 * Of the model, an anywidget's or one that stands for it, get, set, on, off and send are used.
 */
export class Link {
  /** @param {any} model its state holds a snapshot, and the number of the last batch in it */
  constructor(model) {
    this.model = model;
    this.mirror = new Mirror();
    this.number = model.get("number");
    this.mirror.apply(bytesOf(model.get("snapshot")));
    /** @type {Record<string, (message: any, buffers: DataView[]) => void>} what is done with which message */
    this.orders = {
      reset: ({ number }, [scene]) => {
        this.number = number;
        this.mirror.reset(bytesOf(scene));
      },
      batch: ({ number }, [changes]) => {
        if (number <= this.number) return;
        if (number > this.number + 1) return model.send({ type: "resync" }); // one was lost
        this.number = number;
        this.mirror.apply(bytesOf(changes));
      },
    };
    this.receive = (message, buffers) => this.orders[message.type]?.(message, buffers ?? []);
    model.on("msg:custom", this.receive);
    model.send({ type: "ready", number: this.number });
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
    this.model.off("msg:custom", this.receive);
    for (const view of [...this.mirror.views]) view.dispose();
    this.mirror.clear("");
  }
}
