// The queue of items with its filters, and the histogram of their points.

import { createElement, find, formatPoints, setText } from "./elements.js";

/** @typedef {import("./types").Item} Item */

const MAX_LISTED = 200;
const BINS = 10;
const STATES = { waiting: ["○", "waits"], marked: ["●", "marked"], checks: ["✓", "by checks"] };
const FILTERS = /** @type {const} */ (["exercise", "task", "check", "state-filter"]);

export class List {
  /** @type {Map<string, Item>} */
  items = new Map();
  /** @type {Record<string, string>} the items that are open on other pages, with the names of their graders */
  others = {};
  current = "";
  isAnonymous = false;
  person = "";

  /** @param {(key: string) => void} open */
  constructor(open) {
    this.open = open;
    for (const name of FILTERS) this.filter(name).addEventListener("change", () => this.draw());
    find("student", HTMLInputElement).addEventListener("input", () => this.draw());
  }

  /** @param {string} name */
  filter(name) {
    return find(name, HTMLSelectElement);
  }

  /** @param {Item} item @returns {string} its student, or a pseudonym */
  studentName(item) {
    return this.isAnonymous ? `Student ${item.alias}` : item.student;
  }

  /** @returns {Item[]} the items that match all filters except the state, in order */
  itemsOfAllStates() {
    const [exercise, task, check] = FILTERS.map((name) => this.filter(name).value);
    const student = find("student", HTMLInputElement).value.trim().toLowerCase();
    return [...this.items.values()]
      .filter((item) => !exercise || item.exercise === exercise)
      .filter((item) => !task || item.task === task)
      .filter((item) => !check || item.failed.includes(check))
      .filter((item) => this.studentName(item).toLowerCase().includes(student))
      .sort((a, b) => this.sortKey(a).localeCompare(this.sortKey(b)));
  }

  /** @param {Item} item; sorted by task first, so that a person marks one question for all students */
  sortKey(item) {
    return [item.exercise, item.task, this.studentName(item)].join("\n");
  }

  /** @returns {Item[]} the items that match all filters, and the current one */
  matchingItems() {
    const state = this.filter("state-filter").value;
    return this.itemsOfAllStates().filter((item) => !state || item.state === state || item.key === this.current);
  }

  /**
   * @param {number} step 1 or -1
   * @returns {string} the key of the next item that is not open on another page, or ""
   */
  next(step) {
    const items = this.matchingItems();
    const start = items.findIndex((item) => item.key === this.current);
    const before = items.slice(0, Math.max(start, 0));
    const order = step > 0 ? [...items.slice(start + 1), ...before] : before.reverse();
    return order.find((item) => !(item.key in this.others))?.key ?? "";
  }

  draw() {
    this.drawFilters();
    const items = this.matchingItems();
    const lines = items.slice(0, MAX_LISTED).map((item) => createElement("li", {}, this.drawItem(item)));
    find("list", HTMLElement).replaceChildren(...lines);
    const more = items.length > MAX_LISTED ? `; the first ${MAX_LISTED} are listed` : "";
    const waiting = this.itemsOfAllStates().filter((item) => item.state === "waiting").length;
    setText("count", `${items.length} of ${this.items.size} tasks, ${waiting} wait${more}`);
    this.drawHistogram();
  }

  /** @param {Item} item */
  drawItem(item) {
    const [sign, word] = STATES[item.state];
    const other = this.others[item.key] ? `, ${this.others[item.key]} has it open` : "";
    const draft = localStorage.getItem(`marking ${item.key} ${this.person}`) ? ", not saved yet" : "";
    const state = `${sign} ${word}, ${formatPoints(item.score)} of ${formatPoints(item.points)}${draft}${other}`;
    const button = createElement(
      "button",
      { type: "button", "data-key": item.key, click: () => this.open(item.key) },
      createElement("bdi", { class: "who" }, this.studentName(item)),
      createElement("span", {}, item.title),
      createElement("span", { class: "about" }, state),
    );
    if (item.key === this.current) button.setAttribute("aria-current", "true");
    return button;
  }

  /** Offer the values of the items: tasks of the chosen exercise, failed checks of the chosen task. */
  drawFilters() {
    const all = [...this.items.values()];
    const exercise = this.filter("exercise").value;
    const ofExercise = all.filter((item) => !exercise || item.exercise === exercise);
    const task = this.filter("task").value;
    const failed = ofExercise.filter((item) => !task || item.task === task).flatMap((item) => item.failed);
    setOptions(this.filter("exercise"), "all exercises", all.map((item) => item.exercise));
    setOptions(this.filter("task"), "all tasks", ofExercise.map((item) => item.task));
    setOptions(this.filter("check"), "any", failed);
  }

  drawHistogram() {
    const scored = this.itemsOfAllStates().filter((item) => item.state !== "waiting" && item.points > 0);
    const counts = Array(BINS).fill(0);
    for (const item of scored) counts[Math.min(Math.floor((BINS * item.score) / item.points), BINS - 1)] += 1;
    const maximum = Math.max(1, ...counts);
    const rows = counts.map((count, bin) => {
      const label = `${(100 / BINS) * bin} to ${(100 / BINS) * (bin + 1)} %`;
      const bar = createElement("div", { class: "bar" });
      bar.style.width = `${(100 * count) / maximum}%`;
      return createElement(
        "tr",
        {},
        createElement("th", { scope: "row" }, label),
        createElement("td", {}, String(count)),
        createElement("td", { class: "bars", "aria-hidden": "true" }, bar),
      );
    });
    const mean = scored.reduce((sum, item) => sum + item.score / item.points, 0) / scored.length;
    const meanText = scored.length ? `, mean ${Math.round(100 * mean)} %` : "";
    setText("spread", `${scored.length} tasks with points${meanText}`);
    find("bins", HTMLElement).replaceChildren(...rows);
  }
}

/**
 * Replace the options of a filter if they have changed.
 * @param {HTMLSelectElement} select
 * @param {string} none the label of the option without a value
 * @param {string[]} values
 */
function setOptions(select, none, values) {
  const current = select.value;
  const options = ["", ...[...new Set(values)].sort()];
  if (options.length === select.options.length && options.every((value, i) => select.options[i].value === value)) return;
  select.replaceChildren(...options.map((value) => createElement("option", { value }, value || none)));
  select.value = options.includes(current) ? current : "";
}
