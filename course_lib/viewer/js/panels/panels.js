import { icon } from "../icons.js";
import { Gestures } from "./gestures.js";
import { ask, button, part } from "./parts.js";
import { Tree } from "./tree.js";

const TURNED_AFTER = 150; // [ms] after the last turn of a view by hand

/** @typedef {import("../protocol.js").PanelState} PanelState */

/** RViz's tools, Displays and Views panels and status line. */
export class Panels {
  /**
   * @param {HTMLElement} frame contains the panels @param {import("../view.js").View} view the view in the middle
   * @param {import("./desk.js").DeskState} state the displayed state
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
    this.left = this.dock("Displays", this.memberButtons(), this.tree.element);
    this.right = this.dock("Views", this.viewControls(), this.properties.element, tools, this.selection);
    /** @type {any[]} */
    this.buttons = state.values.toolbar.map(this.toolButton, this);
    const bar = part("div", { className: "course-tools", role: "toolbar", ariaLabel: "Tools" }, ...this.buttons);
    const words = [this.left.opener, this.status, this.notice, this.right.opener];
    const line = part("div", { className: "course-lines" }, ...words);
    const place = part("div", { className: "course-view" }, view.host);
    const middle = part("div", { className: "course-middle" }, this.left, place, this.right);
    frame.firstChild?.after(bar, middle, line, this.words, this.lists);
    Object.assign(frame, { role: "group", ariaLabel: "RViz" });
    frame.addEventListener("keydown", (event) => this.key(event));
    view.onTurn = () => this.turned();
    view.canvas.setAttribute("aria-describedby", this.words.id);
    this.choose(0);
  }

  /** @param {Partial<PanelState>} changed fields; unchanged lists are not replaced, because they may have the focus */
  update(changed) {
    const { values } = this.state;
    this.tree.update(this.state.rowsOf(values.tree));
    this.properties.update(this.state.rowsOf(values.view));
    this.updateViews(values.views);
    this.toolTree.update(this.state.rowsOf(values.tools));
    Object.assign(this.view.orbit, values.drag);
    Object.assign(this.gestures, { settings: values.settings, handles: values.handles });
    if (changed.menu && this.gestures.wantsMenu) this.openMenu(changed.menu);
    const { mark, text } = values.status;
    const { notice } = values;
    this.say(this.status, mark.icon, mark.word, text, mark.level);
    if (JSON.stringify(notice) !== this.noticed) this.say(this.notice, "", "", notice.text ?? "", notice.level ?? "");
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
    this.state.look();
  }

  /** @returns {boolean} whether one of the panels is open */
  get isOpen() {
    return !this.left.hidden || !this.right.hidden;
  }

  /** @param {import("../protocol.js").ToolButton} tool @param {number} index */
  toolButton({ label, key, gesture }, index) {
    const made = button(icon(label), `${label} (${key})`, () => this.choose(index));
    made.append(part("span", {}, label));
    made.dataset.gesture = gesture;
    return made;
  }

  /** @param {number} index of the tool to select */
  choose(index) {
    this.buttons.forEach((one, at) => (one.ariaPressed = String(at === index)));
    this.gestures.take(this.state.values.toolbar[index]);
    this.tool = index;
  }

  memberButtons() {
    const { act } = this.state;
    return part(
      "div",
      { role: "toolbar", ariaLabel: "Displays" },
      button("Add", "Add a display", () => this.add()),
      button("Duplicate", "Duplicate the chosen display", () => act({ act: "DuplicateDisplay", row: this.tree.chosen })),
      button("Rename", "Rename the chosen display", () => {
        const { key, label } = this.state.rows[this.tree.chosen];
        ask(this.frame, "Rename", part("input", { value: label }), (name) => act({ act: "RenameRow", row: key, name }));
      }),
      button("Remove", "Remove the chosen display (Delete)", () => act({ act: "RemoveRow", row: this.tree.chosen })),
      button("Open", "Open a layout (Ctrl+O)", () => this.open()),
      button("Save", "Save the layout (Ctrl+S)", () => this.save()),
    );
  }

  add() {
    this.addable = part("select", { size: 14 });
    this.fillAddable();
    const row = this.tree.chosen; // a display is added to the selected group
    ask(this.frame, "Add", this.addable, (choice) => this.state.act({ act: "AddDisplay", ...JSON.parse(choice), row }));
    this.state.act({ act: "LookAgain" }); // the graph may have new topics
  }

  fillAddable() {
    const { types, topics } = this.state.values;
    /** @param {string} label @param {[string, string][]} all values with their displayed texts */
    const choices = (label, all) =>
      part("optgroup", { label }, ...all.map(([value, text]) => new Option(text, value)));
    /** @type {[string, string][]} */
    const byTopic = topics.map(({ topic, type, display }) => [
      JSON.stringify({ display, topic }),
      `${topic} (${type}) → ${display.split("/").pop()}`,
    ]);
    /** @type {[string, string][]} */
    const byType = types.map(({ name, short }) => [JSON.stringify({ display: name }), short]);
    const { value } = this.addable;
    this.addable.replaceChildren(choices("By topic", byTopic), choices("By display type", byType));
    this.addable.value = value;
    if (this.addable.selectedIndex < 0) this.addable.selectedIndex = 0;
  }

  /** @param {import("../protocol.js").ContextMenu} menu of an interactive marker */
  openMenu({ path = "", entries = [] }) {
    this.gestures.wantsMenu = false;
    const options = entries.map(({ id, text, opens }) => part("option", { value: id, disabled: Boolean(opens) }, text));
    const list = part("select", { size: Math.max(entries.length, 2) }, ...options);
    list.onclick = () => list.value && list.form.requestSubmit();
    ask(this.frame, "Menu", list, (entry) => this.state.act({ act: "ChooseEntry", path, entry: Number(entry) }));
  }

  open() {
    const files = this.state.values.layouts.files.map((name) => new Option(name, name));
    if (!files.length) return this.say(this.notice, "", "", "No .rviz file is in the notebook's folder.", "");
    const list = part("select", { size: 8 }, ...files);
    list.selectedIndex = 0;
    ask(this.frame, "Open", list, (name) => this.state.act({ act: "LoadLayout", name }));
  }

  save() {
    const field = part("input", { value: this.state.values.layouts.last });
    ask(this.frame, "Save", field, (name) => this.state.act({ act: "SaveLayout", name }));
  }

  viewControls() {
    const { act } = this.state;
    const change = () => act({ act: "ChangeView", view: this.types.value });
    this.types = part("select", { ariaLabel: "Type of view", onchange: change });
    this.saved = part("select", { ariaLabel: "Saved views", size: 3 });
    const use = () => chosen((index) => act({ act: "UseView", index }));
    this.saved.ondblclick = use;
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
        button("Save", "Save the current view", () =>
          name("Save view", (text) => act({ act: "SaveView", name: text }))),
        button("Use", "Use the chosen saved view", use),
        button("Rename", "Rename the chosen saved view", () =>
          chosen((index) => name("Rename view", (text) => act({ act: "RenameView", index, name: text })))),
        button("Remove", "Remove the chosen saved view", () =>
          chosen((index) => act({ act: "RemoveView", index })))),
      this.saved,
    ); // prettier-ignore
  }

  /** @param {import("../protocol.js").ViewChoice} views */
  updateViews({ type, types, saved }) {
    fill(this.types, types);
    this.types.value = type;
    fill(this.saved, saved);
    this.saved.hidden = !saved.length;
  }

  /** @param {PanelState} values @returns {HTMLElement[]} */
  suggestions({ frames, topics }) {
    /** @type {Record<string, string[]>} */
    const lists = { frames };
    for (const { topic, type } of topics) (lists[type] ??= []).push(topic);
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
      const index = this.state.values.toolbar.findIndex(({ key }) => key === event.key);
      if (index < 0) return;
      this.choose(index);
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Restore the default camera, like RViz's key Z. */
  returnHome() {
    clearTimeout(this.turning);
    this.view.turnedAt = -Infinity; // the view is not being turned by hand
    this.state.act({ act: "HomeView" });
  }

  /** Report the camera to Python once the view has stopped moving. */
  turned() {
    clearTimeout(this.turning);
    this.turning = setTimeout(() => {
      this.state.act({ act: "TurnView", ...this.view.orbit.seen() });
    }, TURNED_AFTER);
  }
}

/** @param {HTMLSelectElement} list @param {string[]} words its options, replaced only if they have changed */
function fill(list, words) {
  if (words.join("\n") === [...list.options].map((option) => option.value).join("\n")) return;
  const chosen = list.selectedIndex;
  list.replaceChildren(...words.map((word) => new Option(word, word)));
  list.selectedIndex = chosen;
}
