import { editorFor } from "./editors.js";
import { part } from "./parts.js";

/** Rows in a tree with a value each, as RViz's panels have them. */
export class Tree {
  /**
   * @param {string} label @param {(act: string, order: any) => void} act told what is edited
   * @param {(row: any) => string} listFor id of a list of suggestions for a row
   */
  constructor(label, act, listFor) {
    this.act = act;
    this.listFor = listFor;
    this.element = part("div", { className: "course-tree", role: "treegrid", ariaLabel: label });
    this.element.onkeydown = (event) => this.key(event);
    /** @type {Map<string, any>} the rows that were drawn, by key */
    this.drawn = new Map();
    /** @type {Map<string, boolean>} which were opened or closed by hand */
    this.opened = new Map();
    /** @type {import("./editors.js").Row[]} */
    this.rows = [];
    this.chosen = "";
  }

  /** @param {import("./editors.js").Row[]} rows parents first */
  update(rows) {
    this.rows = rows;
    const depths = new Map();
    const parents = new Set(rows.map((row) => row.parent));
    const shown = [];
    for (const row of rows) {
      const above = this.drawnDepth(depths, row.parent);
      depths.set(row.key, { depth: above.depth + 1, open: above.open && this.isOpen(row) });
      if (above.open) shown.push(this.draw(row, above.depth + 1, parents.has(row.key)));
    }
    shown.forEach((element, index) => {
      const there = this.element.children[index];
      if (there !== element) this.element.insertBefore(element, there ?? null);
    });
    while (this.element.children.length > shown.length) this.element.lastChild?.remove();
    for (const key of this.drawn.keys()) if (!depths.has(key)) this.drawn.delete(key);
    this.choose(this.drawn.has(this.chosen) ? this.chosen : (rows[0]?.key ?? ""), false);
  }

  drawnDepth(depths, parent) {
    return depths.get(parent) ?? { depth: 0, open: true };
  }

  isOpen(row) {
    return this.opened.get(row.key) ?? row.open ?? false;
  }

  /** @param {import("./editors.js").Row} row @param {number} depth @param {boolean} isParent */
  draw(row, depth, isParent) {
    const shape = JSON.stringify([row.editor, row.checked === undefined, isParent]);
    let it = this.drawn.get(row.key);
    if (it?.shape !== shape) this.drawn.set(row.key, (it = this.made(row, shape)));
    const { element, label, mark, tick, editor } = it;
    element.ariaLevel = String(depth);
    element.style.paddingInlineStart = `${(depth - 1) * 14 + 2}px`;
    if (isParent) element.ariaExpanded = String(this.isOpen(row));
    label.textContent = row.label;
    label.title = row.title ?? "";
    mark.textContent = row.mark ? `${row.mark} ` : "";
    mark.title = row.word ?? "";
    mark.ariaLabel = row.word ?? "";
    element.dataset.level = row.level ?? "";
    if (row.checked !== undefined) tick.checked = row.checked;
    editor.update(row.editor ? row.value : row.text);
    return element;
  }

  made(row, shape) {
    const set = (value) => this.act("set", { row: row.key, value });
    const editor = editorFor(row, set, this.listFor(row));
    const twisty = part("span", { className: "course-twisty", ariaHidden: "true" });
    twisty.onclick = () => this.toggle(row.key);
    const label = part("span");
    const tick = part("input", { type: "checkbox", ariaLabel: `Show ${row.label}` });
    tick.onchange = () => set(tick.checked);
    const mark = part("span", { role: "img", className: "course-mark" });
    const name = part("span", { role: "gridcell", className: "course-name" }, twisty, mark, label);
    const cell = part("span", { role: "gridcell", className: "course-value" });
    cell.append(row.checked === undefined ? editor.element : tick);
    const element = part("div", { role: "row", tabIndex: -1 }, name, cell);
    element.onfocus = () => this.choose(row.key, false);
    element.onmousedown = () => this.choose(row.key, false);
    element.dataset.key = row.key;
    label.ondblclick = () => this.toggle(row.key);
    return { element, label, mark, tick, editor, twisty, shape };
  }

  /** @param {string} key */
  toggle(key) {
    const row = this.rows.find((one) => one.key === key);
    if (row) this.opened.set(key, !this.isOpen(row));
    this.update(this.rows);
  }

  /** @param {string} key @param {boolean} focus */
  choose(key, focus = true) {
    this.chosen = key;
    for (const [name, { element }] of this.drawn) {
      element.tabIndex = name === key ? 0 : -1;
      element.ariaSelected = String(name === key);
    }
    if (focus) this.drawn.get(key)?.element.focus();
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const focused = /** @type {any} */ (event.target);
    if (event.key === "Escape" && focused.role !== "row") this.choose(this.chosen);
    else if (focused.role === "row") this.rowKey(event, focused);
    else return;
    event.stopPropagation();
  }

  rowKey(event, element) {
    const key = element.dataset.key;
    const isOpen = element.ariaExpanded === "true";
    const at = [...this.element.children].indexOf(element);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const next = /** @type {any} */ (this.element.children[at + (step ?? 0)]);
    if (step) next && this.choose(next.dataset.key);
    else if (event.key === "ArrowRight" && element.ariaExpanded === "false") this.toggle(key);
    else if (event.key === "ArrowLeft" && isOpen) this.toggle(key);
    else if (event.key === "ArrowLeft") this.choose(this.rows.find((row) => row.key === key)?.parent || key);
    else if (event.key === "Enter" || event.key === "F2") element.querySelector("input,select")?.focus();
    else if (event.key === " ") element.querySelector("input[type=checkbox]")?.click();
    else if (event.key === "Delete") this.act("remove", { row: key });
    else return;
    event.preventDefault();
  }
}
