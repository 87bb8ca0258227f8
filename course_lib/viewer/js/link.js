import { decode } from "./decode.js";
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
const SAVE_AFTER = 3000; // [ms] after a change; others may come meanwhile
const AWAY_AFTER = 3000; // [ms] without a view in sight: somebody may only scroll past
const ENDED = "The kernel of this view has ended. Restart it and run the cells again.";
const OVER = ["dead", "terminating", "restarting", "autorestarting"]; // JupyterLab's words on a kernel

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
        this.mirror.reset(decode(scene));
      },
      batch: ({ number }, [changes]) => {
        if (number > this.number + 1) return this.resync();
        const isNext = number === this.number + 1;
        this.number = Math.max(this.number, number);
        if (isNext) this.mirror.take(decode(changes));
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
    this.seen = true; // some view is in sight
    this.looking = 0; // a timer
    this.wake = () => this.send({ type: document.hidden ? "hide" : this.seen ? "ready" : "away" });
    document.addEventListener("visibilitychange", this.wake);
    model.on("msg:custom", this.receive);
    model.on("comm_live_update", () => model.comm_live || this.end());
    this.session = model.widget_manager?.context?.sessionContext; // JupyterLab's
    /** @param {any} _ @param {string} status */
    this.watch = (_, status) => OVER.includes(status) && this.end();
    this.session?.statusChanged.connect(this.watch);
    this.wake();
    const panels = model.get("panels"); // of a view at rest
    this.desk = new DeskState((order) => (panels ? this.refuse(order) : this.send(order)), Boolean(panels));
    if (panels) this.desk.take(JSON.parse(panels));
  }

  /** Show the scene, or the end of a film that can be played. */
  start() {
    const film = this.model.get("film");
    const content = film?.byteLength ? decode(film) : {};
    if (!content.batches) return this.mirror.take(decode(this.model.get("snapshot")));
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

  /** @param {string} text shown in all views for a while, or until it is over */
  say(text, lasts = false) {
    if (lasts) this.mirror.lasting = text;
    for (const view of this.mirror.views) view.say(text, lasts);
  }

  /** @param {HTMLElement} element @returns {() => void} removes the view */
  show(element) {
    const host = document.createElement("div");
    host.style.cssText = `width:100%;height:${this.model.get("height")}px;overflow:hidden`;
    const label = this.model.get("words") || this.model.get("label");
    /** @param {import("./protocol.js").Click} click */
    const onClick = (click) => desk.panels?.gestures.click(click) || this.send({ type: "click", ...click });
    const view = new View(host, this.mirror, { label, onClick, onSight: () => this.look() });
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

  /** The kernel has gone: its pictures stand still, in their cells again. A view at rest needs none. */
  async end() {
    if (!this.model.get("panels")) this.say(ENDED, true);
    const name = this.model.get("panel");
    if (name) (await this.model.widget_manager.get_model(name)).close(true);
  }

  /** Tell how many views this page has, so that what nobody sees can end. */
  count() {
    this.send({ type: "views", count: this.mirror.views.size });
    this.look();
  }

  /** Tell whether a view is in sight, after a while if none is. */
  look() {
    const seen = [...this.mirror.views].some((view) => view.seen);
    if (seen === this.seen) return;
    this.seen = seen;
    clearTimeout(this.looking);
    this.looking = setTimeout(this.wake, seen ? 0 : AWAY_AFTER);
  }

  close() {
    clearTimeout(this.saving);
    clearTimeout(this.looking);
    this.session?.statusChanged.disconnect(this.watch);
    document.removeEventListener("visibilitychange", this.wake);
    this.model.off("msg:custom", this.receive);
    for (const view of [...this.mirror.views]) view.dispose();
    this.mirror.clear("");
  }
}
