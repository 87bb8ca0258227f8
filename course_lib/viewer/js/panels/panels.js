import { icon } from "../icons.js";
import { Gestures } from "./gestures.js";
import { button, createElement, openDialog, setChanged } from "./elements.js";
import { Tree } from "./tree.js";

const TURNED_AFTER = 150; // [ms] after the last turn of a view by hand

/** @typedef {import("../protocol.js").PanelState} PanelState */

/** RViz's tools, Displays and Views panels and status line. */
export class Panels {
  /**
   * @param {HTMLElement} frame contains the panels @param {import("../view.js").View} view the view in the middle
   * @param {import("./frame.js").PanelStore} state the displayed state
   */
  constructor(frame, view, state) {
    this.frame = frame;
    this.view = view;
    this.state = state;
    this.id = `panels${Math.random().toString(36).slice(2)}`;
    this.turnTimer = 0;
    const act = state.act;
    this.gestures = new Gestures(view, act, (text) => this.showLine(this.notice, "", "", text, ""), () => this.selectTool(0));
    /** @param {import("./editors.js").Row} row */
    const listFor = ({ editor }) =>
      editor && ["frame", "topic"].includes(editor.kind) ? this.id + (editor.type ?? "frames") : "";
    this.tree = new Tree("Displays", act, listFor);
    this.properties = new Tree("Current view", act, listFor);
    this.toolTree = new Tree("Tool Properties", act, listFor);
    const tools = createElement("details", {}, createElement("summary", { textContent: "Tool Properties" }), this.toolTree.element);
    this.selection = createElement("pre", { className: "course-selection", tabIndex: 0, ariaLabel: "Selection", hidden: true });
    this.status = createElement("span", { className: "course-line" });
    this.notice = createElement("output", { className: "course-line course-notice" });
    this.summary = createElement("div", { className: "course-unseen", id: `${this.id}words` });
    this.lists = createElement("div", { hidden: true });
    this.left = this.createDock("Displays", this.displayButtons(), this.tree.element);
    this.right = this.createDock("Views", this.viewControls(), this.properties.element, tools, this.selection);
    /** @type {any[]} */
    this.buttons = state.values.toolbar.map(this.toolButton, this);
    const bar = createElement("div", { className: "course-tools", role: "toolbar", ariaLabel: "Tools" }, ...this.buttons);
    const parts = [this.left.opener, this.status, this.notice, this.right.opener];
    const line = createElement("div", { className: "course-lines" }, ...parts);
    const place = createElement("div", { className: "course-view" }, view.host);
    const middle = createElement("div", { className: "course-middle" }, this.left, place, this.right);
    frame.firstChild?.after(bar, middle, line, this.summary, this.lists);
    Object.assign(frame, { role: "group", ariaLabel: "RViz" });
    frame.addEventListener("keydown", (event) => this.onKey(event));
    view.onTurn = () => this.onTurned();
    view.canvas.setAttribute("aria-describedby", this.summary.id);
    this.selectTool(0);
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
    this.showLine(this.status, mark.icon, mark.word, text, mark.level);
    if (JSON.stringify(notice) !== this.lastNotice) this.showLine(this.notice, "", "", notice.text ?? "", notice.level ?? "");
    this.lastNotice = JSON.stringify(notice);
    const isSelected = values.selection && values.selection !== this.selection.textContent;
    setChanged(this.selection, { textContent: values.selection, hidden: !values.selection });
    if (isSelected) {
      this.toggle(this.right, true);
      this.right.scrollTop = this.selection.offsetTop; // below rows that may fill the panel
    }
    setChanged(this.summary, { textContent: values.summary });
    if (changed.topics && this.addable?.isConnected) this.fillAddable();
    if (changed.topics || changed.frames) this.lists.replaceChildren(...this.suggestions(values));
  }

  /** @param {any} element @param {string} mark @param {string} word @param {string} text @param {string} level */
  showLine(element, mark, word, text, level) {
    setChanged(element, { textContent: [mark, text].filter(Boolean).join(" "), title: word ? `${word}: ${text}` : text });
    setChanged(element.dataset, { level });
  }

  /** @param {string} name @param {HTMLElement[]} parts @returns {any} with the button that opens it */
  createDock(name, ...parts) {
    const dock = createElement("section", { className: "course-dock", ariaLabel: name }, ...parts);
    dock.opener = button(name, `${name} panel`, () => this.toggle(dock, dock.hidden));
    this.toggle(dock, false);
    return dock;
  }

  /** @param {any} dock @param {boolean} open */
  toggle(dock, open) {
    dock.hidden = !open;
    dock.opener.ariaExpanded = String(open);
    this.state.reportOpenPanels();
  }

  /** @returns {boolean} whether one of the panels is open */
  get isOpen() {
    return !this.left.hidden || !this.right.hidden;
  }

  /** @param {import("../protocol.js").ToolButton} tool @param {number} index */
  toolButton({ label, key, gesture }, index) {
    const element = button(icon(label), `${label} (${key})`, () => this.selectTool(index));
    element.append(createElement("span", {}, label));
    element.dataset.gesture = gesture;
    return element;
  }

  /** @param {number} index of the tool to select */
  selectTool(index) {
    this.buttons.forEach((element, i) => (element.ariaPressed = String(i === index)));
    this.gestures.useTool(this.state.values.toolbar[index]);
    this.tool = index;
  }

  displayButtons() {
    const { act } = this.state;
    return createElement(
      "div",
      { role: "toolbar", ariaLabel: "Displays" },
      button("Add", "Add a display", () => this.add()),
      button("Duplicate", "Duplicate the chosen display", () => act({ act: "DuplicateDisplay", row: this.tree.selected })),
      button("Rename", "Rename the chosen display", () => {
        const { key, label, checked } = this.state.rows[this.tree.selected];
        /** @param {string} name */
        const rename = (name) => act({ act: "RenameRow", row: key, name });
        if (checked === undefined) rename(label); // it is not a display, and the answer says so
        else openDialog(this.frame, "Rename", createElement("input", { value: label }), rename);
      }),
      button("Remove", "Remove the chosen display (Delete)", () => act({ act: "RemoveRow", row: this.tree.selected })),
      button("Open", "Open a layout (Ctrl+O)", () => this.open()),
      button("Save", "Save the layout (Ctrl+S)", () => this.save()),
    );
  }

  add() {
    const about = createElement("p", { className: "course-about", id: `${this.id}about` });
    this.addable = createElement("select", { size: 14, "aria-describedby": about.id });
    this.addable.onchange = () => {
      const { display } = JSON.parse(this.addable.value || "{}");
      about.textContent = this.state.values.types.find(({ name }) => name === display)?.about ?? "";
    };
    this.fillAddable();
    const row = this.tree.selected; // a display is added to the selected group
    /** @param {string} choice */
    const confirm = (choice) => this.state.act({ act: "AddDisplay", ...JSON.parse(choice), row });
    openDialog(this.frame, "Add", this.addable, confirm, about);
    this.state.act({ act: "RequestUpdate" }); // the graph may have new topics
  }

  fillAddable() {
    const { types, topics } = this.state.values;
    /** @param {string} label @param {[string, string][]} all values with their displayed texts */
    const choices = (label, all) =>
      createElement("optgroup", { label }, ...all.map(([value, text]) => new Option(text, value)));
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
    this.addable.onchange();
  }

  /** @param {import("../protocol.js").ContextMenu} menu of an interactive marker */
  openMenu({ path = "", entries = [] }) {
    this.gestures.wantsMenu = false;
    const options = entries.map(({ id, text, opens }) => createElement("option", { value: id, disabled: Boolean(opens) }, text));
    const list = createElement("select", { size: Math.max(entries.length, 2) }, ...options);
    list.onclick = () => list.value && list.form.requestSubmit();
    openDialog(this.frame, "Choose", list, (entry) => this.state.act({ act: "ChooseEntry", path, entry: Number(entry) }));
  }

  open() {
    const files = this.state.values.layouts.files.map((name) => new Option(name, name));
    if (!files.length) return this.showLine(this.notice, "", "", "No .rviz file is in the notebook's folder.", "");
    const list = createElement("select", { size: 8 }, ...files);
    list.selectedIndex = 0;
    openDialog(this.frame, "Open", list, (name) => this.state.act({ act: "LoadLayout", name }));
  }

  save() {
    const field = createElement("input", { value: this.state.values.layouts.last });
    openDialog(this.frame, "Save", field, (name) => this.state.act({ act: "SaveLayout", name }));
  }

  viewControls() {
    const { act } = this.state;
    const change = () => act({ act: "ChangeView", view: this.types.value });
    this.types = createElement("select", { ariaLabel: "Type of view", onchange: change });
    this.saved = createElement("select", { ariaLabel: "Saved views", size: 3 });
    const use = () => withSelectedView((index) => act({ act: "UseView", index }));
    this.saved.ondblclick = use;
    /** @param {string} title @param {(name: string) => void} onValue */
    const askName = (title, onValue) =>
      openDialog(this.frame, title, createElement("input", { value: this.saved.value || this.types.value }), onValue);
    /** @param {(index: number) => void} onValue */
    const withSelectedView = (onValue) => {
      const isChosen = this.saved.selectedIndex >= 0;
      this.showLine(this.notice, "", "", isChosen ? "" : "Choose a saved view first.", "");
      if (isChosen) onValue(this.saved.selectedIndex);
    };
    return createElement(
      "div",
      {},
      createElement("div", { role: "toolbar", ariaLabel: "Views" }, this.types,
        button("Zero", "Jump to 0,0,0 with the current view controller (Z)", () => this.returnHome()),
        button("Save", "Save the current view", () =>
          askName("Save view", (text) => act({ act: "SaveView", name: text }))),
        button("Use", "Use the chosen saved view", use),
        button("Rename", "Rename the chosen saved view", () =>
          withSelectedView((index) => askName("Rename view", (text) => act({ act: "RenameView", index, name: text })))),
        button("Remove", "Remove the chosen saved view", () =>
          withSelectedView((index) => act({ act: "RemoveView", index })))),
      this.saved,
    ); // prettier-ignore
  }

  /** @param {import("../protocol.js").ViewChoice} views */
  updateViews({ type, types, saved }) {
    fill(this.types, types);
    this.types.value = type;
    fill(this.saved, saved);
    setChanged(this.saved, { hidden: !saved.length });
  }

  /** @param {PanelState} values @returns {HTMLElement[]} */
  suggestions({ frames, topics }) {
    /** @type {Record<string, string[]>} */
    const lists = { frames };
    for (const { topic, type } of topics) (lists[type] ??= []).push(topic);
    return Object.entries(lists).map(([name, words]) =>
      createElement("datalist", { id: this.id + name }, ...[...new Set(words)].map((word) => new Option(word, word))),
    );
  }

  /** @param {KeyboardEvent} event */
  onKey(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    const layout = { s: () => this.save(), o: () => this.open() }[event.key];
    if (event.ctrlKey || event.metaKey) {
      if (!layout || target.closest("dialog")) return;
      layout();
    } else if (event.altKey || target.matches("input, select, textarea, dialog *")) return;
    else if (event.key === "Escape" && this.tool) this.selectTool(0);
    else if (event.key === "z") this.returnHome();
    else {
      const index = this.state.values.toolbar.findIndex(({ key }) => key === event.key);
      if (index < 0) return;
      this.selectTool(index);
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Restore the default camera, like RViz's key Z. */
  returnHome() {
    clearTimeout(this.turnTimer);
    this.view.turnedAt = -Infinity; // the view is not being turned by hand
    this.state.act({ act: "HomeView" });
  }

  /** Report the camera to Python once the view has stopped moving. */
  onTurned() {
    clearTimeout(this.turnTimer);
    this.turnTimer = setTimeout(() => {
      this.state.act({ act: "TurnView", ...this.view.orbit.pose() });
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
