import { decode } from "./decode.js";
import { encode } from "./encode.js";
import { SceneRecording } from "./recording.js";
import { Mirror } from "./mirror.js";
import { Desk, DeskState } from "./panels/desk.js";
import { arrange, Place } from "./panels/place.js";
import { timeBelow } from "./panels/time.js";
import { Player } from "./player.js";
import { pictureOf } from "./renderer.js";
import { View } from "./view.js";

const LOOKS = ["OpenPanels", "LookAgain", "TurnView", "HomeView", "SelectObject"]; // orders that change no display
const SAVE_AFTER = 3000; // [ms] after a change, to wait for further changes
const AWAY_AFTER = 3000; // [ms] without a view in sight, because the user may only scroll past
const ENDED = "The kernel of this view has ended. To go on, run the cells again, or only what you need: resume().";
const CAPTION = "Picture of a 3D view. Run the cells in JupyterLab to bring it to life.";
const CLOSED_AFTER = 1000; // [ms] after the end of a kernel its side panel is gone
const KEPT_WIDTH = 480; // [px] of the picture that is saved with the notebook, as in widget.py
const KEPT_HEIGHT = 360; // [px] a side panel is higher than wide
const OVER = ["dead", "terminating", "restarting", "autorestarting"]; // JupyterLab's statuses of a kernel that has ended

/**
 * Keeps a mirror equal to the scene in the kernel.
 * It uses get, set, on, off and send of the model, which is anywidget's or a substitute.
 */
export class Link {
  /** @param {any} model its state holds a snapshot, and the number of the last batch in it */
  constructor(model) {
    this.model = model;
    this.mirror = new Mirror();
    this.page = Math.random().toString(36).slice(2); // identifies this page among all pages that show the scene
    this.number = model.get("number");
    this.lostAt = 0; // [ms] time of the last request for the scene after a lost batch
    this.saving = 0; // a timer
    /** @type {Set<(time: any) => void>} */
    this.timeBars = new Set();
    /** @type {Set<Place>} */
    this.places = new Set();
    this.asked = false; // whether the side panel has been requested
    this.opens = false; // whether it is being opened
    this.ended = false; // whether the kernel has ended, so that nothing can be sent
    /** @type {any} the last picture of a view that was in the side panel */
    this.lastBeside = null;
    /** @type {Record<string, (message: any, buffers: DataView[]) => void>} handlers by the type of a message */
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
    /** @type {Player | null} plays the recording of a view at rest */
    this.player = null;
    this.attempt(() => this.start());
    this.seen = true; // whether a view is in sight
    this.looking = 0; // a timer
    this.wake = () => this.send({ type: document.hidden ? "hide" : this.seen ? "ready" : "away" });
    document.addEventListener("visibilitychange", this.wake);
    model.on("msg:custom", this.receive);
    model.on("comm_live_update", () => model.comm_live || this.end());
    model.on("change:beside", () => {
      this.asked = false;
      for (const place of this.places) place.look();
    });
    this.session = model.widget_manager?.context?.sessionContext; // JupyterLab's
    /** @param {any} _ @param {string} status */
    this.watch = (_, status) => OVER.includes(status) && this.end();
    this.session?.statusChanged.connect(this.watch);
    this.wake();
    const panels = model.get("panels"); // of a view at rest
    this.desk = new DeskState((order) => (panels ? this.refuse(order) : this.send(order)), Boolean(panels));
    if (panels) this.desk.take(JSON.parse(panels));
  }

  /** Show the scene, or the end of a recording that can be played. */
  start() {
    const bytes = this.model.get("recording");
    const content = bytes?.byteLength ? decode(bytes) : {};
    if (!content.batches) return this.mirror.take(decode(this.model.get("snapshot")));
    const isSeen = () => [...this.mirror.views].some((view) => view.seen);
    const recording = new SceneRecording(content, this.mirror);
    this.player = new Player(recording, (time) => this.timeBars.forEach((update) => update(time)), isSeen);
    if (this.model.get("plays")) this.player.replay();
  }

  /** @param {import("./protocol.js").Order} order that a view at rest cannot execute */
  refuse({ act }) {
    if (!LOOKS.includes(act)) this.say("This view is at rest. Run its cell again to change it.");
  }

  /** @param {any} message for Python; the page's id and the number of its last batch are added */
  send(message) {
    this.model.send({ page: this.page, number: this.number, ...message });
  }

  /** @param {() => void} change of the scene; an exception does not prevent the other changes */
  attempt(change) {
    try {
      change();
    } catch (error) {
      this.say(`A part of the scene cannot be shown: ${error}`);
    }
  }

  /** Save the current scene with the notebook, if the page saves the state of widgets. */
  save() {
    this.saving = 0;
    this.model.set("number", this.number);
    // The widget manager compares it with the last one byte by byte; at the number it finds a difference.
    const scene = { number: this.number, ...this.mirror.whole() };
    this.model.set("snapshot", new DataView(encode(scene).buffer));
  }

  /** Request the whole scene, and repeat the request if no response arrives. */
  resync() {
    if (Date.now() - this.lostAt < 2000) return;
    this.lostAt = Date.now();
    this.send({ type: "resync" });
  }

  /** @param {string} text shown in all views for a limited time, or until the condition has ended */
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
    const place = new Place(this, element, desk.frame, view);
    element.classList.add("course-keeps"); // the JupyterLab extension queries such elements when it saves a notebook
    /** @type {any} */
    let kept = 0; // number of pictures at the last save of the notebook, or the picture that was kept then
    const courseKeeps = () => {
      // A cell whose view is beside the notebook keeps the picture of that one.
      const shown = [view, ...this.mirror.views].find(({ pictures, canvas }) => pictures && canvas.clientWidth);
      const source = shown ? shown.pictures : this.lastBeside;
      if (!source || source === kept) return null;
      kept = source;
      return shown ? keptPicture(shown.canvas) : this.lastBeside;
    };
    Object.assign(element, { courseKeeps });
    this.count();
    return () => {
      endTime();
      const { pictures, canvas } = view;
      // Another view takes the panel: the cells keep the last picture that was there.
      if (place.beside && pictures) this.lastBeside = keptPicture(canvas);
      place.dispose();
      view.dispose();
      desk.dispose();
      this.count();
    };
  }

  /** Freeze the views after the kernel has ended, and move them back to their cells. A view at rest needs no kernel. */
  async end() {
    this.ended = true;
    if (!this.model.get("panels")) this.say(ENDED, true);
    const name = this.model.get("panel");
    if (name) (await this.model.widget_manager.get_model(name)).close(true);
    setTimeout(arrange, CLOSED_AFTER);
  }

  /** Report the number of views in this page, so that Python can close scenes without views. */
  count() {
    this.send({ type: "views", count: this.mirror.views.size });
    this.look();
  }

  /** Report whether a view is in sight; that none is in sight is reported with a delay. */
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

/** @param {HTMLCanvasElement} canvas of a view @returns {{"image/png": string}} its picture, with a line below how to go on */
function keptPicture(canvas) {
  const scale = Math.min(KEPT_WIDTH / canvas.width, KEPT_HEIGHT / canvas.height);
  const [width, height] = [Math.round(scale * canvas.width), Math.round(scale * canvas.height)];
  const small = Object.assign(document.createElement("canvas"), { width: KEPT_WIDTH, height: height + 20 });
  const context = /** @type {CanvasRenderingContext2D} */ (small.getContext("2d"));
  context.fillStyle = "white";
  context.fillRect(0, 0, small.width, small.height);
  context.drawImage(canvas, 0, 0, width, height);
  context.font = "12px CourseSans, sans-serif";
  context.fillStyle = "black";
  context.fillText(CAPTION, 4, height + 14);
  return { "image/png": small.toDataURL("image/png").split(",")[1] };
}
