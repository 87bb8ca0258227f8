import { editorFor } from "./editors.js";
import { createElement, setChanged } from "./elements.js";

/** A tree of rows with values, as in RViz's panels. */
export class Tree {
  /**
   * @param {string} label @param {(command: import("./frame.js").Command) => void} act called with each edit
   * @param {(row: any) => string} listFor id of a list of suggestions for a row
   */
  constructor(label, act, listFor) {
    this.act = act;
    this.listFor = listFor;
    this.element = createElement("div", { className: "course-tree", role: "treegrid", ariaLabel: label });
    this.element.onkeydown = (/** @type {KeyboardEvent} */ event) => this.onKey(event);
    /** @type {Map<string, any>} the rows that were drawn, by key */
    this.drawnRows = new Map();
    /** @type {Map<string, boolean>} the rows that the user has expanded or collapsed */
    this.openStates = new Map();
    /** @type {import("./editors.js").Row[]} */
    this.rows = [];
    this.selected = "";
  }

  /** @param {import("./editors.js").Row[]} rows parents first */
  update(rows) {
    const before = new Map(this.rows.map((row) => [row.key, row.open ?? false]));
    this.rows = rows;
    // A property that expands or collapses rows overrides what the user did with them earlier.
    for (const row of rows) {
      const isOpen = row.open ?? false;
      if ((before.get(row.key) ?? isOpen) !== isOpen) this.openStates.delete(row.key);
    }
    const depths = new Map();
    const parents = new Set(rows.map((row) => row.parent));
    const shown = [];
    for (const row of rows) {
      const above = depths.get(row.parent) ?? { depth: 0, open: true };
      depths.set(row.key, { depth: above.depth + 1, open: above.open && this.isOpen(row) });
      if (above.open) shown.push(this.draw(row, above.depth + 1, parents.has(row.key)));
    }
    const isHere = this.element.contains(document.activeElement);
    const selected = this.drawnRows.get(this.selected)?.element;
    const index = [...this.element.children].indexOf(selected);
    const remaining = new Set(shown);
    for (const old of [...this.element.children]) if (!remaining.has(old)) old.remove();
    shown.forEach((element, index) => {
      const there = this.element.children[index]; // remaining rows are not moved, because they may have the focus
      if (there !== element) this.element.insertBefore(element, there ?? null);
    });
    for (const key of this.drawnRows.keys()) if (!depths.has(key)) this.drawnRows.delete(key);
    if (remaining.has(selected)) return this.select(this.selected, false);
    const next = shown[Math.min(Math.max(index, 0), shown.length - 1)]; // the row after the removed one
    this.select(next?.dataset.key ?? "", isHere);
  }

  /** @param {import("./editors.js").Row} row */
  isOpen(row) {
    return this.openStates.get(row.key) ?? row.open ?? false;
  }

  /** @param {import("./editors.js").Row} row @param {number} depth @param {boolean} isParent */
  draw(row, depth, isParent) {
    const shape = JSON.stringify([row.editor, row.checked === undefined, isParent]);
    let drawnRow = this.drawnRows.get(row.key);
    if (drawnRow?.shape !== shape) this.drawnRows.set(row.key, (drawnRow = this.createRow(row, shape)));
    const { element, name, label, mark, tick, editor } = drawnRow;
    setChanged(element, { ariaLevel: String(depth) });
    setChanged(name.style, { paddingInlineStart: `${(depth - 1) * 14 + 2}px` }); // the values stay in one column
    if (isParent) setChanged(element, { ariaExpanded: String(this.isOpen(row)) });
    drawnRow.description = row.title ?? "";
    setChanged(label, { textContent: row.label, title: drawnRow.description });
    const { icon, word, level } = row.mark ?? { icon: "", word: "", level: "" };
    setChanged(mark, { textContent: icon, hidden: !row.mark, title: word, ariaLabel: word });
    setChanged(element.dataset, { level });
    if (row.checked !== undefined) tick.checked = row.checked;
    editor.update(row.editor ? row.value : row.text);
    return element;
  }

  /** @param {import("./editors.js").Row} row @param {string} shape the row's structure */
  createRow(row, shape) {
    const set = (/** @type {any} */ value) => this.act({ act: "SetValue", row: row.key, value });
    const editor = editorFor(row, set, this.listFor(row));
    const twisty = createElement("span", { className: "course-twisty", ariaHidden: "true" });
    twisty.onclick = () => this.toggle(row.key);
    const label = createElement("span");
    const tick = createElement("input", { type: "checkbox", ariaLabel: `Show ${row.label}` });
    tick.onchange = () => set(tick.checked);
    const mark = createElement("span", { role: "img", className: "course-mark" });
    const name = createElement("span", { role: "gridcell", className: "course-name" }, twisty, mark, " ", label);
    const cell = createElement("span", { role: "gridcell", className: "course-value" });
    cell.append(row.checked === undefined ? editor.element : tick);
    const element = createElement("div", { role: "row", tabIndex: -1 }, name, cell);
    element.onfocus = () => this.select(row.key, false);
    element.onmousedown = () => this.select(row.key, false);
    element.dataset.key = row.key;
    label.onmouseenter = () => {
      const isCut = name.scrollWidth > name.clientWidth;
      label.title = [isCut ? label.textContent : "", drawn.description].filter(Boolean).join(": ");
    };
    label.ondblclick = () => this.toggle(row.key);
    const drawn = { element, name, label, mark, tick, editor, twisty, shape, description: "" };
    return drawn;
  }

  /** @param {string} key */
  toggle(key) {
    const row = this.rows.find((row) => row.key === key);
    if (row) this.openStates.set(key, !this.isOpen(row));
    this.update(this.rows);
  }

  /** @param {string} key @param {boolean} focus */
  select(key, focus = true) {
    this.selected = key;
    for (const [name, { element }] of this.drawnRows) {
      setChanged(element, { tabIndex: name === key ? 0 : -1, ariaSelected: String(name === key) });
    }
    if (focus) this.drawnRows.get(key)?.element.focus();
  }

  /** @param {KeyboardEvent} event */
  onKey(event) {
    const element = /** @type {any} */ (event.target);
    if (element.role === "row") return this.onRowKey(event, element);
    if (event.key !== "Escape") return;
    this.select(this.selected);
    event.stopPropagation();
  }

  /** @param {KeyboardEvent} event @param {any} element the row */
  onRowKey(event, element) {
    const key = element.dataset.key;
    const isOpen = element.ariaExpanded === "true";
    const index = [...this.element.children].indexOf(element);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const next = /** @type {any} */ (this.element.children[index + (step ?? 0)]);
    if (step) next && this.select(next.dataset.key);
    else if (event.key === "ArrowRight" && element.ariaExpanded === "false") this.toggle(key);
    else if (event.key === "ArrowLeft" && isOpen) this.toggle(key);
    else if (event.key === "ArrowLeft") this.select(this.rows.find((row) => row.key === key)?.parent || key);
    else if (event.key === "Enter" || event.key === "F2") element.querySelector("input,select")?.focus();
    else if (event.key === " ") element.querySelector("input[type=checkbox]")?.click();
    else if (event.key === "Delete") this.act({ act: "RemoveRow", row: key });
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
