import { bytesOf, decode } from "./decode.js";
import { encode } from "./encode.js";
import { Film } from "./film.js";
import { Mirror } from "./mirror.js";
import { Desk, DeskState } from "./panels/desk.js";
import { Place } from "./panels/place.js";
import { timeBelow } from "./panels/time.js";
import { Player } from "./player.js";
import { pictureOf } from "./renderer.js";
import { View } from "./view.js";

const LOOKS = ["OpenPanels", "LookAgain", "TurnView", "HomeView", "SelectObject"]; // orders that change no display
const ENDED = "The kernel has ended: the picture stands still. Run the notebook's cells again.";
const SAVE_AFTER = 3000; // [ms] after a change; others may come meanwhile

/**
 * Keeps a mirror equal to the scene in the kernel.
 * Of the model, an anywidget's or one that stands for it, get, set, on, off and send are used.
 */
export class Link {
  /** @param {any} model its state holds a snapshot, and the number of the last batch in it */
  constructor(model) {
    this.model = model;
    this.mirror = new Mirror();
    this.page = Math.random().toString(36).slice(2); // tells the pages apart that show one scene
    this.number = model.get("number");
    this.lostAt = 0; // [ms] when the scene was asked for, as a batch was lost
    this.saving = 0; // a timer
    /** @type {Set<(time: any) => void>} */
    this.timeBars = new Set();
    /** @type {Set<Place>} */
    this.places = new Set();
    this.asked = false; // for the panel beside the notebook
    /** @type {Record<string, (message: any, buffers: DataView[]) => void>} what is done with which message */
    this.orders = {
      reset: ({ number, page }, [scene]) => {
        if ((page ?? this.page) !== this.page) return;
        [this.number, this.lostAt] = [number, 0];
        this.mirror.reset(bytesOf(scene));
      },
      batch: ({ number }, [changes]) => {
        if (number > this.number + 1) return this.resync();
        const isNext = number === this.number + 1;
        this.number = Math.max(this.number, number);
        if (isNext) this.mirror.apply(bytesOf(changes));
      },
      status: ({ text }) => this.say(text),
      desk: (news) => this.desk.take(news),
      capture: ({ width, height }) =>
        this.send({ type: "picture", png: pictureOf(this.mirror, width, height) }),
      time: (time) => this.timeBars.forEach((update) => update(time)),
    };
    /** @param {any} message @param {DataView[]} [buffers] */
    this.receive = (message, buffers) => {
      this.attempt(() => this.orders[message.type]?.(message, buffers ?? []));
      if (message.ask) this.send({ type: "ack" });
      this.saving ||= setTimeout(() => this.save(), SAVE_AFTER);
    };
    /** @type {Player | null} of a view at rest */
    this.player = null;
    this.attempt(() => this.start());
    this.wake = () => this.send({ type: document.hidden ? "hide" : "ready" }); // a laptop may have slept, too
    document.addEventListener("visibilitychange", this.wake);
    model.on("msg:custom", this.receive);
    model.on("comm_live_update", () => model.comm_live || this.ended());
    this.wake();
    const panels = model.get("panels"); // of a view at rest
    this.desk = new DeskState((order) => (panels ? this.refuse(order) : this.send(order)), Boolean(panels));
    if (panels) this.desk.take(JSON.parse(panels));
  }

  /** Show the scene, or the end of a film that can be played. */
  start() {
    const film = this.model.get("film");
    const content = film?.byteLength ? decode(bytesOf(film)) : {};
    if (!content.batches) return this.mirror.apply(bytesOf(this.model.get("snapshot")));
    this.player = new Player(new Film(content, this.mirror), (time) => this.timeBars.forEach((update) => update(time)));
  }

  /** @param {import("./protocol.js").Order} order that a view at rest cannot carry out */
  refuse({ act }) {
    if (!LOOKS.includes(act)) this.say("This view is at rest. Run its cell again to change it.");
  }

  /** @param {any} message for Python: it also tells which page this is, and how far it has come */
  send(message) {
    this.model.send({ page: this.page, number: this.number, ...message });
  }

  /** @param {() => void} change of the scene; a wrong one does not keep the others from being seen */
  attempt(change) {
    try {
      change();
    } catch (error) {
      this.say(`A part of the scene cannot be shown: ${error}`);
    }
  }

  /** Have the notebook saved with the scene as it is now, if the page saves the state of widgets. */
  save() {
    this.saving = 0;
    this.model.set("number", this.number);
    this.model.set("snapshot", new DataView(encode(this.mirror.whole()).buffer));
  }

  /** Ask for the whole scene, again if no answer comes. */
  resync() {
    if (Date.now() - this.lostAt < 2000) return;
    this.lostAt = Date.now();
    this.send({ type: "resync" });
  }

  /** @param {string} text shown in all views for a while */
  say(text) {
    this.said = text;
    for (const view of this.mirror.views) view.say(text);
  }

  /** @param {HTMLElement} element @returns {() => void} removes the view */
  show(element) {
    const host = document.createElement("div");
    host.style.cssText = `width:100%;height:${this.model.get("height")}px;overflow:hidden`;
    const label = this.model.get("label");
    /** @param {import("./protocol.js").Click} click */
    const onClick = (click) => desk.panels?.gestures.click(click) || this.send({ type: "click", ...click });
    const view = new View(host, this.mirror, { label, onClick });
    const desk = new Desk(element, host, view, this.desk);
    const endTime = timeBelow(this, desk.frame);
    const place = new Place(this, element, desk.frame, host);
    this.count();
    return () => {
      endTime();
      place.dispose();
      view.dispose();
      desk.dispose();
      this.count();
    };
  }

  /** Say that the kernel has gone, and close its panel: its pictures stand still in their cells again. */
  async ended() {
    for (const view of this.mirror.views) view.say(ENDED, Infinity);
    const name = this.model.get("panel");
    if (name) (await this.model.widget_manager.get_model(name)).close(true);
  }

  /** Tell how many views this page has, so that what nobody sees can end. */
  count() {
    this.send({ type: "views", count: this.mirror.views.size });
  }

  close() {
    clearTimeout(this.saving);
    document.removeEventListener("visibilitychange", this.wake);
    this.model.off("msg:custom", this.receive);
    for (const view of [...this.mirror.views]) view.dispose();
    this.mirror.clear("");
  }
}
