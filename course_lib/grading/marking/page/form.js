// The form of one item: a line for each row of the rubric, else one for the task, and what was typed but not saved.

import { find, make, round } from "./elements.js";

/** @typedef {import("./types").Details} Details */
/** @typedef {import("./types").Given} Given */
/** @typedef {import("./types").Draft} Draft */
/** @typedef {{ name: string, row: string, text: string, most: number }} Line name: the fields' ids; row: its number, "" is the task */

const WHOLE = "whole";

export class Form {
  /** @type {Details | null} */
  item = null;
  /** @type {Line[]} */
  lines = [];
  /** @type {Record<string, string>} what is on the disk */
  saved = {};
  person = "";
  /** @type {HTMLInputElement | HTMLTextAreaElement | null} */
  lastComment = null;

  constructor() {
    find("fields", HTMLElement).addEventListener("input", () => this.keep());
    find("used", HTMLSelectElement).addEventListener("change", () => this.reuse());
    find("fields", HTMLElement).addEventListener("focusin", (event) => {
      if (event.target instanceof HTMLTextAreaElement) this.lastComment = event.target;
    });
  }

  get place() {
    return `marking ${this.item?.key} ${this.person}`;
  }

  /**
   * @param {Details} item
   * @param {string} person
   */
  show(item, person) {
    [this.item, this.person] = [item, person];
    const rows = item.rubric.map((row, i) => ({ name: `row${i + 1}`, row: String(i + 1), text: row.text, most: row.points }));
    this.lines = rows.length ? rows : [{ name: WHOLE, row: "", text: "Points for the task", most: item.points }];
    this.saved = {};
    for (const line of this.lines) Object.assign(this.saved, this.marked(line));
    if (rows.length) this.saved[`${WHOLE}-comment`] = this.marked({ name: WHOLE, row: "", text: "", most: 0 })[`${WHOLE}-comment`];
    const fields = this.lines.map((line, i) => this.drawLine(line, i));
    if (rows.length) fields.push(this.drawComment(WHOLE, "Comment on the task"));
    find("fields", HTMLElement).replaceChildren(...fields);
    this.lastComment = this.field(`${WHOLE}-comment`);
    this.fill(this.draft()?.fields ?? {});
    this.offer();
  }

  /**
   * @param {Line} line
   * @returns {Record<string, string>} its points and comment on the disk
   */
  marked(line) {
    const text = line.row ? line.text : "";
    const marks = (this.item?.marks ?? []).filter((mark) => mark.row === text);
    const points = marks.filter((mark) => mark.points !== null).at(-1)?.points;
    return { [`${line.name}-points`]: points === undefined ? "" : String(points), [`${line.name}-comment`]: marks.at(-1)?.comment ?? "" };
  }

  /**
   * @param {Line} line
   * @param {number} i
   */
  drawLine(line, i) {
    const id = `${line.name}-points`;
    const number = make("input", { id, type: "number", min: "0", max: String(line.most), step: "any", autocomplete: "off" });
    const text = [make("kbd", {}, String(i + 1)), ` ${line.text} `];
    const full = make("button", { type: "button", click: () => this.set(line, line.most) }, "full");
    const none = make("button", { type: "button", click: () => this.set(line, 0) }, "none");
    for (const button of [full, none]) button.setAttribute("aria-label", `${button.textContent} points: ${line.text}`);
    const points = make("span", { class: "points" }, number, ` of ${round(line.most)} `, full, none);
    return make("div", { class: "row" }, make("label", { for: id }, ...text), points, this.drawComment(line.name, "Comment"));
  }

  /**
   * @param {string} name
   * @param {string} label
   */
  drawComment(name, label) {
    const id = `${name}-comment`;
    const text = make("textarea", { id, rows: "1", maxlength: "10000" });
    return make("div", { class: "comment" }, make("label", { for: id }, label), text);
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
  set(line, points) {
    const field = this.field(`${line.name}-points`);
    if (!field) return;
    field.value = String(points);
    field.focus();
    this.keep();
  }

  /**
   * @param {number} number of the line, from 1
   * @param {boolean} half
   */
  press(number, half) {
    const line = this.lines[number - 1];
    if (!line) return;
    const now = this.field(`${line.name}-points`)?.value;
    this.set(line, half ? line.most / 2 : now === String(line.most) ? 0 : line.most);
    this.field(`${line.name}-points`)?.blur(); // the next key is a key of the page again
  }

  /** @returns {Record<string, string>} */
  read() {
    return Object.fromEntries(Object.keys(this.saved).map((id) => [id, this.field(id)?.value ?? ""]));
  }

  /** @param {Record<string, string>} fields */
  fill(fields) {
    for (const id of Object.keys(this.saved)) {
      const field = this.field(id);
      if (field) field.value = fields[id] ?? this.saved[id];
    }
    this.tell();
  }

  /** @returns {Record<string, string>} the fields that differ from what is on the disk */
  get changes() {
    return Object.fromEntries(Object.entries(this.read()).filter(([id, value]) => value !== this.saved[id]));
  }

  get changed() {
    return Object.keys(this.changes).length > 0;
  }

  tell() {
    find("unsaved", HTMLElement).textContent = this.changed ? "Not saved yet" : "";
  }

  /** Keep what was typed, also if the page or the server ends. */
  keep() {
    if (!this.item) return;
    const revision = this.draft()?.revision ?? this.item.revision;
    if (this.changed) localStorage.setItem(this.place, JSON.stringify({ revision, fields: this.changes }));
    else this.forget();
    this.tell();
  }

  /** @param {string} revision of the marks that this person has seen by now */
  seen(revision) {
    localStorage.setItem(this.place, JSON.stringify({ revision, fields: this.changes }));
  }

  /** @param {string} id @returns {string} its name for people */
  label(id) {
    const [name, what] = id.split("-");
    const line = this.lines.find((one) => one.name === name);
    return `${line?.text ?? "the task"}, ${what}`;
  }

  forget() {
    localStorage.removeItem(this.place);
  }

  /** @returns {Draft | null} */
  draft() {
    try {
      return JSON.parse(localStorage.getItem(this.place) ?? "null");
    } catch {
      return null;
    }
  }

  /**
   * @returns {Given[]} what is to be saved
   * @throws {RangeError} with what is wrong, in words
   */
  given() {
    const [fields, changes] = [this.read(), this.changes];
    const lines = [...this.lines];
    if (this.item?.rubric.length) lines.push({ name: WHOLE, row: "", text: "", most: 0 });
    const given = [];
    for (const line of lines) {
      const [points, comment] = [`${line.name}-points`, `${line.name}-comment`];
      if (points in changes || comment in changes) given.push({ row: line.row, points: this.number(line, fields[points] ?? ""), comment: fields[comment] });
    }
    return given;
  }

  /**
   * @param {Line} line
   * @param {string} text
   * @returns {number | null}
   */
  number(line, text) {
    const field = this.field(`${line.name}-points`);
    const isBad = field instanceof HTMLInputElement && (field.validity.badInput || !(Number(text) >= 0 && Number(text) <= line.most));
    const isGone = text === "" && this.saved[`${line.name}-points`];
    if (isBad || isGone) {
      field?.focus();
      throw new RangeError(`${line.text}: expected 0 to ${round(line.most)} points`);
    }
    return text === "" ? null : Number(text);
  }

  offer() {
    const options = (this.item?.used ?? []).map(([row, comment]) => make("option", { value: comment }, row ? `${row}: ${comment}` : comment));
    find("used", HTMLSelectElement).replaceChildren(make("option", { value: "" }, options.length ? "choose one" : "none yet"), ...options);
  }

  reuse() {
    const select = find("used", HTMLSelectElement);
    const field = this.lastComment?.isConnected ? this.lastComment : this.field(`${WHOLE}-comment`) ?? this.field("row1-comment");
    if (!field || !select.value) return;
    field.value = [field.value.trim(), select.value].filter(Boolean).join(" ");
    select.value = "";
    field.focus();
    this.keep();
  }
}
