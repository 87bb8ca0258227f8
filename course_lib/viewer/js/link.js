import { decode } from "./decode.js";
import { encode } from "./encode.js";
import { SceneRecording } from "./recording.js";
import { Mirror } from "./mirror.js";
import { PanelFrame, PanelStore } from "./panels/frame.js";
import { arrange, Place } from "./panels/place.js";
import { timeBelow } from "./panels/time.js";
import { Player } from "./player.js";
import { pictureOf } from "./renderer.js";
import { View } from "./view.js";

const PASSIVE_COMMANDS = ["OpenPanels", "RequestUpdate", "TurnView", "HomeView", "SelectObject"]; // commands that change no display
const SAVE_AFTER = 3000; // [ms] after a change, to wait for further changes
const AWAY_AFTER = 3000; // [ms] without a view in sight, because the user may only scroll past
const ENDED = "The kernel of this view has ended. To go on, run the cells again, or only what you need: resume().";
const CAPTION = "Picture of a 3D view. Run the cells in JupyterLab to bring it to life.";
const CLOSED_AFTER = 1000; // [ms] after the end of a kernel its side panel is gone
const SAVED_WIDTH = 480; // [px] of the picture that is saved with the notebook, as in widget.py
const SAVED_HEIGHT = 360; // [px] a side panel is higher than wide
const CAPTION_FONT = "12px CourseSans, sans-serif";
const LINE_HEIGHT = 16; // [px]
// JupyterLab's statuses of a kernel that has ended. A restart by another window is seen as "starting" only.
const ENDED_STATUSES = ["dead", "terminating", "restarting", "autorestarting", "starting"];

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
    this.saveTimer = 0;
    /** @type {Set<(time: any) => void>} */
    this.timeBars = new Set();
    /** @type {any} the time that the next frame of the page will show */
    this.nextTime = null;
    /** @type {Set<Place>} */
    this.places = new Set();
    this.hasRequestedPanel = false; // whether the side panel has been requested
    this.isPanelOpening = false; // whether it is being opened
    this.hasEnded = false; // whether the kernel has ended, so that nothing can be sent
    /** @type {any} the last picture of a view that was in the side panel */
    this.lastBeside = null;
    /** @type {Record<string, (message: any, buffers: DataView[]) => void>} handlers by the type of a message */
    this.handlers = {
      reset: ({ number, page }, [scene]) => {
        if ((page ?? this.page) !== this.page) return;
        [this.number, this.lostAt] = [number, 0];
        this.mirror.reset(decode(scene));
      },
      batch: ({ number }, [changes]) => {
        if (number > this.number + 1) return this.resync();
        const isNext = number === this.number + 1;
        this.number = Math.max(this.number, number);
        if (isNext) this.mirror.apply(decode(changes));
      },
      status: ({ text }) => this.showMessage(text),
      panels: (update) => this.panelStore.apply(update),
      capture: ({ width, height }) =>
        this.send({ type: "picture", png: pictureOf(this.mirror, width, height) }),
      time: (time) => this.showTime(time),
    };
    /** @param {any} message @param {DataView[]} [buffers] */
    this.receive = (message, buffers) => {
      this.contain(() => this.handlers[message.type]?.(message, buffers ?? []));
      this.saveTimer ||= setTimeout(() => this.save(), SAVE_AFTER);
      if (!message.ask) return;
      // The least time of a few pictures of the slowest view in sight: one slow picture does not count.
      const times = [...this.mirror.views].map((view) => (view.isInSight ? Math.min(...view.drawingTimes) : 0));
      this.send({ type: "ack", drawing: Math.max(0, ...times) / 1000 });
    };
    /** @type {Player | null} plays the recording of a view at rest */
    this.player = null;
    this.contain(() => this.start());
    this.isInSight = true; // whether a view is in sight
    this.sightTimer = 0;
    this.reportVisibility = () => this.send({ type: document.hidden ? "hide" : this.isInSight ? "ready" : "away" });
    document.addEventListener("visibilitychange", this.reportVisibility);
    model.on("msg:custom", this.receive);
    model.on("comm_live_update", () => model.comm_live || this.onKernelEnd());
    model.on("change:beside", () => {
      this.hasRequestedPanel = false;
      for (const place of this.places) place.updateLocation();
    });
    this.session = model.widget_manager?.context?.sessionContext; // JupyterLab's
    /** @param {any} _ @param {string} status */
    this.onStatus = (_, status) => ENDED_STATUSES.includes(status) && this.onKernelEnd();
    this.session?.statusChanged.connect(this.onStatus);
    this.reportVisibility();
    const panels = model.get("panels"); // of a view at rest
    this.panelStore = new PanelStore((command) => (panels ? this.rejectCommand(command) : this.send(command)), Boolean(panels));
    if (panels) this.panelStore.apply(JSON.parse(panels));
  }

  /** Show the scene, or the end of a recording that can be played. */
  start() {
    const bytes = this.model.get("recording");
    const content = bytes?.byteLength ? decode(bytes) : {};
    if (!content.batches) return this.mirror.apply(decode(this.model.get("snapshot")));
    const isSeen = () => [...this.mirror.views].some((view) => view.isInSight);
    const recording = new SceneRecording(content, this.mirror);
    this.player = new Player(recording, (time) => this.timeBars.forEach((update) => update(time)), isSeen);
    if (this.model.get("plays")) this.player.replay();
  }

  /** @param {import("./protocol.js").Command} command that a view at rest cannot execute */
  rejectCommand({ act }) {
    if (!PASSIVE_COMMANDS.includes(act)) this.showMessage("This view is at rest. Run its cell again to change it.");
  }

  /** @param {any} message for Python; the page's id and the number of its last batch are added */
  send(message) {
    this.model.send({ page: this.page, number: this.number, ...message });
  }

  /** @param {() => void} change of the scene; its exception is reported, and does not prevent other changes */
  contain(change) {
    try {
      change();
    } catch (error) {
      this.showMessage(`A part of the scene cannot be shown: ${error}`);
    }
  }

  /** @param {any} time shown with the next picture, because each change of a text costs a frame of the page */
  showTime(time) {
    if (!this.nextTime) requestAnimationFrame(() => {
      this.timeBars.forEach((update) => update(this.nextTime));
      this.nextTime = null;
    });
    this.nextTime = time;
  }

  /** Save the current scene with the notebook, if the page saves the state of widgets. */
  save() {
    this.saveTimer = 0;
    this.model.set("number", this.number);
    // The widget manager compares it with the last one byte by byte; at the number it finds a difference.
    const scene = { number: this.number, ...this.mirror.snapshot() };
    this.model.set("snapshot", new DataView(encode(scene).buffer));
  }

  /** Request the whole scene, and repeat the request if no response arrives. */
  resync() {
    if (Date.now() - this.lostAt < 2000) return;
    this.lostAt = Date.now();
    this.send({ type: "resync" });
  }

  /** @param {string} text shown in all views for a limited time, or until the condition has ended */
  showMessage(text, lasts = false) {
    if (lasts) this.mirror.lastingMessage = text;
    for (const view of this.mirror.views) view.showMessage(text, lasts);
  }

  /** @param {HTMLElement} element @returns {() => void} removes the view */
  show(element) {
    const host = document.createElement("div");
    host.style.cssText = `width:100%;height:${this.model.get("height")}px;overflow:hidden`;
    const label = this.model.get("words") || this.model.get("label");
    /** @param {import("./protocol.js").Click} click */
    const onClick = (click) => panelFrame.panels?.gestures.click(click) || this.send({ type: "click", ...click });
    const view = new View(host, this.mirror, { label, onClick, onSightChange: () => this.onSightChange() });
    const panelFrame = new PanelFrame(element, host, view, this.panelStore);
    const removeTimeBar = timeBelow(this, panelFrame.frame);
    const place = new Place(this, element, panelFrame.frame, view);
    element.classList.add("course-keeps"); // the JupyterLab extension queries such elements when it saves a notebook
    /** @type {any} */
    let savedSource = 0; // number of pictures at the last save of the notebook, or the picture that was saved then
    const courseKeeps = () => {
      // A cell whose view is beside the notebook keeps the picture of that one.
      const visible = [view, ...this.mirror.views].find(({ pictures, canvas }) => pictures && canvas.clientWidth);
      const source = visible ? visible.pictures : this.lastBeside;
      if (!source || source === savedSource) return null;
      savedSource = source;
      return visible ? this.outputToSave(visible.canvas) : this.lastBeside;
    };
    Object.assign(element, { courseKeeps });
    this.reportViewCount();
    return () => {
      removeTimeBar();
      const { pictures, canvas } = view;
      // Another view takes the panel: the cells keep the last picture that was there.
      if (place.isBeside && pictures) this.lastBeside = this.outputToSave(canvas);
      place.dispose();
      view.dispose();
      panelFrame.dispose();
      this.reportViewCount();
    };
  }

  /** @param {HTMLCanvasElement} canvas @returns {Record<string, string>} its picture, and what it shows in words */
  outputToSave(canvas) {
    const { summary } = this.panelStore.values; // what the page knew first is out of date
    return { ...pictureToSave(canvas), ...(summary && { "text/plain": `${this.model.get("label")}. ${summary}` }) };
  }

  /** Freeze the views after the kernel has ended, and move them back to their cells. A view at rest needs no kernel. */
  async onKernelEnd() {
    this.hasEnded = true;
    if (!this.model.get("panels")) this.showMessage(ENDED, true);
    const name = this.model.get("panel");
    if (name) (await this.model.widget_manager.get_model(name)).close(true);
    setTimeout(arrange, CLOSED_AFTER);
  }

  /** Report the number of views in this page, so that Python can close scenes without views. */
  reportViewCount() {
    this.send({ type: "views", count: this.mirror.views.size });
    this.onSightChange();
  }

  /** Report whether a view is in sight; that none is in sight is reported with a delay. */
  onSightChange() {
    const isInSight = [...this.mirror.views].some((view) => view.isInSight);
    if (isInSight === this.isInSight) return;
    this.isInSight = isInSight;
    clearTimeout(this.sightTimer);
    this.sightTimer = setTimeout(this.reportVisibility, isInSight ? 0 : AWAY_AFTER);
  }

  close() {
    clearTimeout(this.saveTimer);
    clearTimeout(this.sightTimer);
    this.session?.statusChanged.disconnect(this.onStatus);
    document.removeEventListener("visibilitychange", this.reportVisibility);
    this.model.off("msg:custom", this.receive);
    for (const view of [...this.mirror.views]) view.dispose();
    this.mirror.clear("");
  }
}

/** @param {HTMLCanvasElement} canvas of a view @returns {{"image/png": string}} its picture, with a line below how to go on */
function pictureToSave(canvas) {
  const scale = Math.min(SAVED_WIDTH / canvas.width, SAVED_HEIGHT / canvas.height);
  const [width, height] = [Math.round(scale * canvas.width), Math.round(scale * canvas.height)];
  const small = document.createElement("canvas");
  const context = /** @type {CanvasRenderingContext2D} */ (small.getContext("2d"));
  context.font = CAPTION_FONT;
  const lines = wrap(CAPTION, width - 8, context);
  Object.assign(small, { width, height: height + 4 + LINE_HEIGHT * lines.length }); // which resets the font
  context.fillStyle = "white";
  context.fillRect(0, 0, small.width, small.height);
  context.drawImage(canvas, 0, 0, width, height);
  const image = context.getImageData(0, 0, width, height);
  image.data.forEach((part, i) => (image.data[i] = (part + 2) & ~3)); // every fourth brightness, for half the bytes
  context.putImageData(image, 0, 0);
  context.font = CAPTION_FONT;
  context.fillStyle = "black";
  lines.forEach((line, i) => context.fillText(line, 4, height + 14 + LINE_HEIGHT * i));
  return { "image/png": small.toDataURL("image/png").split(",")[1] };
}

/** @param {string} text @param {number} width [px] @param {CanvasRenderingContext2D} context @returns {string[]} lines of this width */
function wrap(text, width, context) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (context.measureText(longer).width > width && longer !== word) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}
