// The form of an item: one line for each row of the rubric, or a single line for the task. Unsaved input is a draft,
// which the browser stores, so that it survives the end of the page or the server.

import { createElement, find, formatPoints, setText } from "./elements.js";

/** @typedef {import("./types").Details} Details */
/** @typedef {import("./types").MarkEntry} MarkEntry */
/** @typedef {import("./types").Draft} Draft */
/**
 * A line of the form.
 * @typedef {{ name: string, row: string, text: string, maximum: number }} Line `name`: the start of its fields' ids; `row`:
 *   the row's number in the rubric, or "" for the task
 */

/** The name of the line for the whole task. */
const WHOLE = "whole";

export class Form {
  /** @type {Details | null} */
  item = null;
  /** @type {Line[]} */
  lines = [];
  /** @type {Record<string, string>} the saved values, by the ids of their fields */
  saved = {};
  person = "";
  /** @type {HTMLInputElement | HTMLTextAreaElement | null} */
  lastComment = null;

  constructor() {
    find("fields", HTMLElement).addEventListener("input", () => this.storeDraft());
    find("used", HTMLSelectElement).addEventListener("change", () => this.insertComment());
    find("fields", HTMLElement).addEventListener("focusin", (event) => {
      if (event.target instanceof HTMLTextAreaElement) this.lastComment = event.target;
    });
  }

  /** The key of the draft in the browser's storage. */
  get draftKey() {
    return `marking ${this.item?.key} ${this.person}`;
  }

  /**
   * Show the fields of an item with its saved values and the person's draft.
   * @param {Details} item
   * @param {string} person
   */
  show(item, person) {
    [this.item, this.person] = [item, person];
    const rows = item.rubric.map((row, i) => ({ name: `row${i + 1}`, row: String(i + 1), text: row.text, maximum: row.points }));
    this.lines = rows.length ? rows : [{ name: WHOLE, row: "", text: "Points for the task", maximum: item.points }];
    this.saved = Object.assign({}, ...this.lines.map((line) => this.savedValues(line)));
    const fields = this.lines.map((line, i) => this.drawLine(line, i));
    if (rows.length) {
      const comment = `${WHOLE}-comment`;
      this.saved[comment] = this.savedValues({ name: WHOLE, row: "", text: "", maximum: 0 })[comment];
      fields.push(this.drawComment(WHOLE, "Comment on the task"));
    }
    find("fields", HTMLElement).replaceChildren(...fields);
    this.lastComment = this.field(`${WHOLE}-comment`);
    this.fill(this.draft()?.fields ?? {});
    this.offerComments();
  }

  /**
   * @param {Line} line
   * @returns {Record<string, string>} its saved points and comment, by the ids of their fields
   */
  savedValues(line) {
    const text = line.row ? line.text : "";
    const marks = (this.item?.marks ?? []).filter((mark) => mark.row === text);
    const points = marks.filter((mark) => mark.points !== null).at(-1)?.points;
    return { [`${line.name}-points`]: points === undefined ? "" : String(points), [`${line.name}-comment`]: marks.at(-1)?.comment ?? "" };
  }

  /**
   * @param {Line} line
   * @param {number} i its index
   */
  drawLine(line, i) {
    const id = `${line.name}-points`;
    const number = createElement("input", { id, type: "number", min: "0", max: String(line.maximum), step: "any", autocomplete: "off" });
    const text = [createElement("kbd", {}, String(i + 1)), ` ${line.text} `];
    const full = createElement("button", { type: "button", click: () => this.setPoints(line, line.maximum) }, "full");
    const none = createElement("button", { type: "button", click: () => this.setPoints(line, 0) }, "none");
    for (const button of [full, none]) button.setAttribute("aria-label", `${button.textContent} points: ${line.text}`);
    const points = createElement("span", { class: "points" }, number, ` of ${formatPoints(line.maximum)} `, full, none);
    const label = createElement("label", { for: id }, ...text);
    return createElement("div", { class: "row" }, label, points, this.drawComment(line.name, "Comment"));
  }

  /**
   * @param {string} name of the line
   * @param {string} label
   */
  drawComment(name, label) {
    const id = `${name}-comment`;
    const text = createElement("textarea", { id, rows: "1", maxlength: "10000" });
    return createElement("div", { class: "comment" }, createElement("label", { for: id }, label), text);
  }

  /** @param {string} id */
  field(id) {
    const field = document.getElementById(id);
    return field instanceof HTMLInputElement || field instanceof HTMLTextAreaElement ? field : null;
  }

  /**
   * @param {Line} line
   * @param {number} points
   */
  setPoints(line, points) {
    const field = this.field(`${line.name}-points`);
    if (!field) return;
    field.value = String(points);
    field.focus();
    this.storeDraft();
  }

  /**
   * Handle a digit key: full points for a line, or none if it has full points.
   * @param {number} number of the line, from 1
   * @param {boolean} isHalf half of the points instead
   */
  onDigit(number, isHalf) {
    const line = this.lines[number - 1];
    if (!line) return;
    const isFull = this.field(`${line.name}-points`)?.value === String(line.maximum);
    this.setPoints(line, isHalf ? line.maximum / 2 : isFull ? 0 : line.maximum);
    // The next key is a key of the page again.
    this.field(`${line.name}-points`)?.blur();
  }

  /** @returns {Record<string, string>} the current values, by the ids of their fields */
  values() {
    return Object.fromEntries(Object.keys(this.saved).map((id) => [id, this.field(id)?.value ?? ""]));
  }

  /** @param {Record<string, string>} draft values that replace the saved ones */
  fill(draft) {
    for (const id of Object.keys(this.saved)) {
      const field = this.field(id);
      if (field) field.value = draft[id] ?? this.saved[id];
    }
    this.showState();
  }

  /** @returns {Record<string, string>} the values that differ from the saved ones */
  get changes() {
    return Object.fromEntries(Object.entries(this.values()).filter(([id, value]) => value !== this.saved[id]));
  }

  get isChanged() {
    return Object.keys(this.changes).length > 0;
  }

  showState() {
    setText("unsaved", this.isChanged ? "Not saved yet" : "");
  }

  /** Store the draft with the revision of the marks that it began with; remove it if nothing is changed. */
  storeDraft() {
    if (!this.item) return;
    if (this.isChanged) this.storeDraftFor(this.draft()?.revision ?? this.item.revision);
    else this.removeDraft();
    this.showState();
  }

  /** @param {string} revision the latest marks that the person has seen */
  storeDraftFor(revision) {
    localStorage.setItem(this.draftKey, JSON.stringify({ revision, fields: this.changes }));
  }

  removeDraft() {
    localStorage.removeItem(this.draftKey);
  }

  /** @returns {Draft | null} */
  draft() {
    try {
      return JSON.parse(localStorage.getItem(this.draftKey) ?? "null");
    } catch {
      return null;
    }
  }

  /** @param {string} id of a field @returns {string} its description */
  label(id) {
    const [name, kind] = id.split("-");
    const line = this.lines.find((line) => line.name === name);
    return `${line?.text ?? "the task"}, ${kind}`;
  }

  /**
   * @returns {MarkEntry[]} the marks to save
   * @throws {RangeError} a number of points is invalid; the message is for the person
   */
  entries() {
    const [values, changes] = [this.values(), this.changes];
    const lines = [...this.lines];
    if (this.item?.rubric.length) lines.push({ name: WHOLE, row: "", text: "", maximum: 0 });
    return lines
      .map((line) => ({ line, points: `${line.name}-points`, comment: `${line.name}-comment` }))
      .filter(({ points, comment }) => points in changes || comment in changes)
      .map(({ line, points, comment }) => ({
        row: line.row,
        points: this.parsePoints(line, values[points] ?? ""),
        comment: values[comment],
      }));
  }

  /**
   * @param {Line} line
   * @param {string} text of its field
   * @returns {number | null} null if it is empty
   */
  parsePoints(line, text) {
    const field = this.field(`${line.name}-points`);
    const isInRange = Number(text) >= 0 && Number(text) <= line.maximum;
    const isInvalid = field instanceof HTMLInputElement && (field.validity.badInput || !isInRange);
    // Saved points can be replaced or withdrawn, but not be deleted.
    const isDeleted = text === "" && this.saved[`${line.name}-points`];
    if (isInvalid || isDeleted) {
      field?.focus();
      throw new RangeError(`${line.text}: expected 0 to ${formatPoints(line.maximum)} points`);
    }
    return text === "" ? null : Number(text);
  }

  /** List the comments that were used before for this task. */
  offerComments() {
    const options = (this.item?.used ?? []).map(([row, comment]) =>
      createElement("option", { value: comment }, row ? `${row}: ${comment}` : comment),
    );
    const first = createElement("option", { value: "" }, options.length ? "choose one" : "none yet");
    find("used", HTMLSelectElement).replaceChildren(first, ...options);
  }

  /** Append the chosen comment to the last used comment field. */
  insertComment() {
    const select = find("used", HTMLSelectElement);
    const field = this.lastComment?.isConnected ? this.lastComment : (this.field(`${WHOLE}-comment`) ?? this.field("row1-comment"));
    if (!field || !select.value) return;
    field.value = [field.value.trim(), select.value].filter(Boolean).join(" ");
    select.value = "";
    field.focus();
    this.storeDraft();
  }
}
