// The queue: what there is to mark, filtered, and how the points are spread.

import { find, make, round } from "./elements.js";

/** @typedef {import("./types").Item} Item */

const MOST = 200; // lines that are shown
const BINS = 10;
const STATES = { waiting: ["○", "waits"], marked: ["●", "marked"], checks: ["✓", "by checks"] };
const FILTERS = /** @type {const} */ (["exercise", "task", "check", "state-filter"]);

export class List {
  /** @type {Map<string, Item>} */
  items = new Map();
  /** @type {Record<string, string>} items that others have open, with their names */
  others = {};
  current = "";
  anonymous = false;
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

  /** @param {Item} item */
  named(item) {
    return this.anonymous ? `Student ${item.alias}` : item.student;
  }

  /** @returns {Item[]} those of all filters but the one of states, in order */
  chosen() {
    const [exercise, task, check] = FILTERS.map((name) => this.filter(name).value);
    const student = find("student", HTMLInputElement).value.trim().toLowerCase();
    return [...this.items.values()]
      .filter((item) => !exercise || item.exercise === exercise)
      .filter((item) => !task || item.task === task)
      .filter((item) => !check || item.failed.includes(check))
      .filter((item) => this.named(item).toLowerCase().includes(student))
      .sort((a, b) => this.place(a).localeCompare(this.place(b)));
  }

  /** @param {Item} item; task by task, so that a person marks one question for all */
  place(item) {
    return [item.exercise, item.task, this.named(item)].join("\n");
  }

  /** @returns {Item[]} */
  shown() {
    const state = this.filter("state-filter").value;
    return this.chosen().filter((item) => !state || item.state === state || item.key === this.current);
  }

  /**
   * @param {number} step 1 or -1
   * @returns {string} the key of the next item that nobody else has open, or ""
   */
  next(step) {
    const shown = this.shown();
    const start = shown.findIndex((item) => item.key === this.current);
    const order = step > 0 ? [...shown.slice(start + 1), ...shown.slice(0, Math.max(start, 0))] : shown.slice(0, Math.max(start, 0)).reverse();
    return order.find((item) => !(item.key in this.others))?.key ?? "";
  }

  draw() {
    this.drawFilters();
    const shown = this.shown();
    const lines = shown.slice(0, MOST).map((item) => make("li", {}, this.line(item)));
    find("list", HTMLElement).replaceChildren(...lines);
    const more = shown.length > MOST ? `; the first ${MOST} are listed` : "";
    const waiting = this.chosen().filter((item) => item.state === "waiting").length;
    find("count", HTMLElement).textContent = `${shown.length} of ${this.items.size} tasks, ${waiting} wait${more}`;
    this.drawHistogram();
  }

  /** @param {Item} item */
  line(item) {
    const [sign, word] = STATES[item.state];
    const other = this.others[item.key] ? `, ${this.others[item.key]} has it open` : "";
    const draft = localStorage.getItem(`marking ${item.key} ${this.person}`) ? ", not saved yet" : "";
    const about = `${sign} ${word}, ${round(item.score)} of ${round(item.points)}${draft}${other}`;
    const line = make(
      "button", { type: "button", "data-key": item.key, click: () => this.open(item.key) },
      make("bdi", { class: "who" }, this.named(item)), make("span", {}, item.title), make("span", { class: "about" }, about),
    );
    if (item.key === this.current) line.setAttribute("aria-current", "true");
    return line;
  }

  drawFilters() {
    const all = [...this.items.values()];
    const exercise = this.filter("exercise").value;
    const inside = all.filter((item) => !exercise || item.exercise === exercise);
    const task = this.filter("task").value;
    const failed = inside.filter((item) => !task || item.task === task).flatMap((item) => item.failed);
    offer(this.filter("exercise"), "all exercises", all.map((item) => item.exercise));
    offer(this.filter("task"), "all tasks", inside.map((item) => item.task));
    offer(this.filter("check"), "any", failed);
  }

  drawHistogram() {
    const scored = this.chosen().filter((item) => item.state !== "waiting" && item.points > 0);
    const counts = Array(BINS).fill(0);
    for (const item of scored) counts[Math.min(Math.floor((BINS * item.score) / item.points), BINS - 1)] += 1;
    const most = Math.max(1, ...counts);
    const rows = counts.map((count, bin) => {
      const label = `${(100 / BINS) * bin} to ${(100 / BINS) * (bin + 1)} %`;
      const bar = make("div", { class: "bar" });
      bar.style.width = `${(100 * count) / most}%`;
      const number = make("td", {}, String(count));
      return make("tr", {}, make("th", { scope: "row" }, label), number, make("td", { class: "bars", "aria-hidden": "true" }, bar));
    });
    const mean = scored.reduce((sum, item) => sum + item.score / item.points, 0) / scored.length;
    const words = scored.length ? `, mean ${Math.round(100 * mean)} %` : "";
    find("spread", HTMLElement).textContent = `${scored.length} tasks with points${words}`;
    find("bins", HTMLElement).replaceChildren(...rows);
  }
}

/**
 * @param {HTMLSelectElement} select
 * @param {string} none
 * @param {string[]} values
 */
function offer(select, none, values) {
  const chosen = select.value;
  const sorted = [...new Set(values)].sort();
  const wanted = ["", ...sorted];
  if (wanted.length === select.options.length && wanted.every((value, i) => select.options[i].value === value)) return;
  select.replaceChildren(...wanted.map((value) => make("option", { value }, value || none)));
  select.value = wanted.includes(chosen) ? chosen : "";
}
