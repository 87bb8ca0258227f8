import { icon } from "../icons.js";
import { Gestures } from "./gestures.js";
import { ask, button, part } from "./parts.js";
import { Tree } from "./tree.js";

const TURNED_AFTER = 150; // [ms] after the last turn of a view by hand

/** RViz's tools, Displays and Views panels and status line. */
export class Panels {
  /**
   * @param {HTMLElement} frame gets them @param {import("../view.js").View} view what they are around
   * @param {import("./desk.js").DeskState} state what they show
   */
  constructor(frame, view, state) {
    this.frame = frame;
    this.view = view;
    this.state = state;
    this.id = `desk${Math.random().toString(36).slice(2)}`;
    this.turning = 0; // a timer
    const act = state.act;
    this.gestures = new Gestures(view, act, (text) => this.say(this.notice, "", "", text, ""), () => this.choose(0));
    /** @param {import("./editors.js").Row} row */
    const listFor = ({ editor }) =>
      editor && ["frame", "topic"].includes(editor.kind) ? this.id + (editor.type ?? "frames") : "";
    this.tree = new Tree("Displays", act, listFor);
    this.properties = new Tree("Current view", act, listFor);
    this.toolTree = new Tree("Tool Properties", act, listFor);
    const tools = part("details", {}, part("summary", { textContent: "Tool Properties" }), this.toolTree.element);
    this.selection = part("pre", { className: "course-selection", tabIndex: 0, ariaLabel: "Selection", hidden: true });
    this.status = part("span", { className: "course-line" });
    this.notice = part("output", { className: "course-line course-notice" });
    this.words = part("div", { className: "course-unseen", id: `${this.id}words` });
    this.lists = part("div", { hidden: true });
    const left = this.dock("Displays", this.memberButtons(), this.tree.element);
    this.right = this.dock("Views", this.viewControls(), this.properties.element, tools, this.selection);
    /** @type {any[]} */
    this.buttons = state.values.tools.map(this.toolButton, this);
    const bar = part("div", { className: "course-tools", role: "toolbar", ariaLabel: "Tools" }, ...this.buttons);
    const words = [left.opener, this.status, this.notice, this.right.opener];
    const line = part("div", { className: "course-lines" }, ...words);
    const place = part("div", { className: "course-view" }, view.host);
    const middle = part("div", { className: "course-middle" }, left, place, this.right);
    frame.firstChild?.after(bar, middle, line, this.words, this.lists);
    Object.assign(frame, { role: "group", ariaLabel: "RViz" });
    frame.addEventListener("keydown", (event) => this.key(event));
    view.onTurn = () => this.turned();
    view.canvas.setAttribute("aria-describedby", this.words.id);
    this.choose(0);
  }

  /** @param {Record<string, any>} changed values: lists that did not change stay, as somebody may be in them */
  update(changed) {
    const { values } = this.state;
    this.tree.update(this.state.rows("tree"));
    this.properties.update(this.state.rows("view"));
    this.updateViews(values.views);
    this.toolTree.update(this.state.rows("toolRows"));
    Object.assign(this.view.orbit, values.hands);
    this.gestures.settings = values.settings;
    const { level, mark, word, text } = values.status;
    const notice = values.notice.text ? values.notice : null;
    this.say(this.status, mark, word, text, level);
    if (JSON.stringify(notice) !== this.noticed) this.say(this.notice, "", "", notice?.text ?? "", notice?.level ?? "");
    this.noticed = JSON.stringify(notice);
    if (values.selection && values.selection !== this.selection.textContent) this.toggle(this.right, true);
    this.selection.textContent = values.selection;
    this.selection.hidden = !values.selection;
    this.words.textContent = values.summary;
    if (changed.topics && this.addable?.isConnected) this.fillAddable();
    if (changed.topics || changed.frames) this.lists.replaceChildren(...this.suggestions(values));
  }

  /** @param {any} element @param {string} mark @param {string} word @param {string} text @param {string} level */
  say(element, mark, word, text, level) {
    element.textContent = [mark, text].filter(Boolean).join(" ");
    element.title = word ? `${word}: ${text}` : text;
    element.dataset.level = level;
  }

  /** @param {string} name @param {HTMLElement[]} parts @returns {any} with the button that opens it */
  dock(name, ...parts) {
    const dock = part("section", { className: "course-dock", ariaLabel: name }, ...parts);
    dock.opener = button(name, `${name} panel`, () => this.toggle(dock, dock.hidden));
    this.toggle(dock, false);
    return dock;
  }

  /** @param {any} dock @param {boolean} open */
  toggle(dock, open) {
    dock.hidden = !open;
    dock.opener.ariaExpanded = String(open);
  }

  /** @param {[string, string, string]} tool @param {number} index */
  toolButton([label, key, gesture], index) {
    const made = button(icon(label), `${label} (${key})`, () => this.choose(index));
    made.append(part("span", {}, label));
    made.dataset.gesture = gesture;
    return made;
  }

  /** @param {number} index of the tool that the mouse is for from now on */
  choose(index) {
    const [label, , gesture] = this.state.values.tools[index];
    this.buttons.forEach((one, at) => (one.ariaPressed = String(at === index)));
    this.gestures.take({ label, gesture });
    this.tool = index;
  }

  memberButtons() {
    const order = () => ({ row: this.tree.chosen });
    const { act } = this.state;
    return part(
      "div",
      { role: "toolbar", ariaLabel: "Displays" },
      button("Add", "Add a display", () => this.add()),
      button("Duplicate", "Duplicate the chosen display", () => act("duplicate", order())),
      button("Rename", "Rename the chosen display", () => {
        const row = this.state.values[`row ${this.tree.chosen}`];
        ask(this.frame, "Rename", part("input", { value: row.label }), (name) => act("rename", { row: row.key, name }));
      }),
      button("Remove", "Remove the chosen display (Delete)", () => act("remove", order())),
      button("Open", "Open a layout (Ctrl+O)", () => this.open()),
      button("Save", "Save the layout (Ctrl+S)", () => this.save()),
    );
  }

  add() {
    this.addable = part("select", { size: 14 });
    this.fillAddable();
    const row = this.tree.chosen; // a group gets it
    ask(this.frame, "Add", this.addable, (choice) => this.state.act("add", { ...JSON.parse(choice), row }));
    this.state.act("look"); // the graph may have new topics
  }

  fillAddable() {
    const { types, topics, undrawn } = this.state.values;
    /** @param {string} label @param {[string, string][]} all values with what is shown of them */
    const choices = (label, all) =>
      part("optgroup", { label }, ...all.map(([value, text]) => new Option(text, value)));
    const note = (/** @type {string} */ name) => (undrawn.includes(name) ? " (RViz2 only)" : "");
    const byTopic = topics.map((/** @type {string[]} */ [topic, type, name]) => [
      JSON.stringify({ class: name, topic }),
      `${topic} (${type}) → ${name.split("/").pop()}${note(name)}`,
    ]);
    const byType = types.map((/** @type {string[]} */ [name, short]) => [JSON.stringify({ class: name }), short]);
    const { value } = this.addable;
    this.addable.replaceChildren(choices("By topic", byTopic), choices("By display type", byType));
    this.addable.value = value;
    if (this.addable.selectedIndex < 0) this.addable.selectedIndex = 0;
  }

  open() {
    const files = this.state.values.layouts[1].map((/** @type {string} */ name) => new Option(name, name));
    if (!files.length) return this.say(this.notice, "", "", "No .rviz file is in the notebook's folder.", "");
    const list = part("select", { size: 8 }, ...files);
    list.selectedIndex = 0;
    ask(this.frame, "Open", list, (name) => this.state.act("load", { name }));
  }

  save() {
    const field = part("input", { value: this.state.values.layouts[0] });
    ask(this.frame, "Save", field, (name) => this.state.act("save", { name }));
  }

  viewControls() {
    const act = (/** @type {any} */ order) => this.state.act("view", order);
    this.types = part("select", { ariaLabel: "Type of view", onchange: () => act({ class: this.types.value }) });
    this.saved = part("select", { ariaLabel: "Saved views", size: 3 });
    this.saved.ondblclick = () => chosen((select) => act({ select }));
    /** @param {string} title @param {(name: string) => void} told */
    const name = (title, told) =>
      ask(this.frame, title, part("input", { value: this.saved.value || this.types.value }), told);
    /** @param {(index: number) => void} told */
    const chosen = (told) => {
      if (this.saved.selectedIndex >= 0) told(this.saved.selectedIndex);
      else this.say(this.notice, "", "", "Choose a saved view first.", "");
    };
    return part(
      "div",
      {},
      part("div", { role: "toolbar", ariaLabel: "Views" }, this.types,
        button("Save", "Save the current view", () => name("Save view", (save) => act({ save }))),
        button("Use", "Use the chosen saved view", () => chosen((select) => act({ select }))),
        button("Rename", "Rename the chosen saved view", () =>
          chosen((rename) => name("Rename view", (text) => act({ rename, name: text })))),
        button("Remove", "Remove the chosen saved view", () => chosen((remove) => act({ remove })))),
      this.saved,
    ); // prettier-ignore
  }

  /** @param {any[]} views */
  updateViews([type, types, saved]) {
    fill(this.types, types);
    this.types.value = type;
    fill(this.saved, saved);
    this.saved.hidden = !saved.length;
  }

  /** @param {Record<string, any>} values @returns {HTMLElement[]} */
  suggestions({ frames, topics }) {
    /** @type {Record<string, string[]>} */
    const lists = { frames };
    for (const [topic, type] of topics) (lists[type] ??= []).push(topic);
    return Object.entries(lists).map(([name, words]) =>
      part("datalist", { id: this.id + name }, ...words.map((word) => new Option(word, word))),
    );
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    const layout = { s: () => this.save(), o: () => this.open() }[event.key];
    if (event.ctrlKey || event.metaKey) {
      if (!layout || target.closest("dialog")) return;
      layout();
    } else if (event.altKey || target.matches("input, select, textarea, dialog *")) return;
    else if (event.key === "Escape" && this.tool) this.choose(0);
    else if (event.key === "z") this.returnHome();
    else {
      const index = this.state.values.tools.findIndex((/** @type {string[]} */ [, key]) => key === event.key);
      if (index < 0) return;
      this.choose(index);
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Look from where a new view does, as RViz's key Z has it. */
  returnHome() {
    clearTimeout(this.turning);
    this.view.turnedAt = -Infinity; // the hands are off
    this.state.act("view", { home: true });
  }

  /** Tell Python where the view looks from now, once it rests. */
  turned() {
    clearTimeout(this.turning);
    this.turning = setTimeout(() => {
      const { eye, target, up, scale } = this.view.orbit;
      this.state.act("camera", { eye: eye.toArray(), target: target.toArray(), up: up.toArray(), scale });
    }, TURNED_AFTER);
  }
}

/** @param {HTMLSelectElement} list @param {string[]} words its choices, replaced only when they are others */
function fill(list, words) {
  if (words.join("\n") === [...list.options].map((option) => option.value).join("\n")) return;
  const chosen = list.selectedIndex;
  list.replaceChildren(...words.map((word) => new Option(word, word)));
  list.selectedIndex = chosen;
}
