// The page on which graders mark. It loads items, saves marks, and shows the changes of other graders.

import { announce, createElement, find, formatPoints, setText } from "./elements.js";
import { Form } from "./form.js";
import { List } from "./list.js";

/** @typedef {import("./types").Details} Details */
/** @typedef {import("./types").Changes} Changes */
/** @typedef {import("./types").MarkEntry} MarkEntry */

const POLL_INTERVAL = 2000; // [ms]
const PAGE = crypto.randomUUID();
const NO_ANSWER =
  "The server does not answer. This browser has stored your input. Start `course mark … --serve` again, and open its address.";
const OTHER_ADDRESS = "The server was started again with another address: open that one. This browser has stored your input.";

const form = new Form();
/** @type {List} */
const list = new List((key) => void runAlone(() => open(key)));
const person = find("person", HTMLInputElement);
let number = 0; // of the last received change
let isBusy = false;

/** The server has rejected a request, or does not answer. */
class RequestError extends Error {
  /**
   * @param {number} code of HTTP, or 0 if there is no answer
   * @param {string} text
   */
  constructor(code, text) {
    super(text);
    this.code = code;
  }
}

/**
 * Send a request to the server.
 * @param {string} path
 * @param {object} [body] data to save
 * @returns {Promise<any>} the content of the answer
 * @throws {RequestError}
 */
async function request(path, body) {
  const post = { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  /** @type {Response} */
  let response;
  try {
    response = await fetch(path, body ? post : {});
  } catch {
    throw new RequestError(0, NO_ANSWER);
  }
  if (response.status === 403) throw new RequestError(403, OTHER_ADDRESS);
  const content = await response.json().catch(() => ({ error: `The server answers ${response.status}.` }));
  if (!response.ok) throw new RequestError(response.status, content.error);
  return content;
}

/** @param {unknown} error that concerns the whole page */
function reportError(error) {
  if (!(error instanceof RequestError)) throw error;
  setText("trouble", error.message);
}

/**
 * Report why marks are not saved.
 * @param {unknown} error
 * @returns {Promise<boolean>} whether another grader has saved the same marks
 */
async function onSaveError(error) {
  const isOurs = error instanceof RequestError || error instanceof RangeError;
  if (!isOurs || (error instanceof RequestError && [0, 403].includes(error.code))) reportError(error);
  if (isOurs) {
    setText("unsaved", `Not saved: ${error.message}`);
    announce(`Not saved: ${error.message}`);
  }
  if (!form.item || !(error instanceof RequestError && error.code === 409)) return false;
  return resolveConflict(await load(form.item.key));
}

const identity = () => new URLSearchParams({ page: PAGE, by: person.value });

/**
 * Load an item. From now on the pages of other graders show that it is open here.
 * @param {string} key
 * @returns {Promise<Details>}
 */
const load = (key) => request(`api/item/${key}?${identity()}`);

/**
 * Run an action unless another one is running. Meanwhile keys are ignored, because they would apply to the wrong task.
 * @param {() => Promise<unknown>} action
 */
async function runAlone(action) {
  if (isBusy) return;
  const [fields, panel, focused] = [find("form", HTMLElement), find("conflict", HTMLElement), document.activeElement];
  isBusy = fields.inert = true;
  try {
    await action();
  } finally {
    isBusy = fields.inert = false;
    if (!panel.hidden) panel.focus();
    else if (focused instanceof HTMLElement && fields.contains(focused)) focused.focus();
  }
}

/** @type {Promise<void>} ends after the last update; updates run in sequence, so that an old one never follows a new one */
let lastUpdate = Promise.resolve();
const update = () => (lastUpdate = lastUpdate.then(fetchChanges));

async function fetchChanges() {
  try {
    const changes = /** @type {Changes} */ (await request(`api/queue?since=${number}&${identity()}`));
    const hasOthersChanged = JSON.stringify(changes.others) !== JSON.stringify(list.others);
    number = changes.number;
    for (const item of changes.items) list.items.set(item.key, item);
    list.others = changes.others;
    setText("state", changes.state);
    setText("trouble", changes.problems.join(" "));
    if (changes.items.length || hasOthersChanged) list.draw();
    await showMarksOfOthers();
    if (!list.current) await runAlone(() => move(1));
  } catch (error) {
    reportError(error);
  }
}

/** Show the marks that another grader has saved for the open item. */
async function showMarksOfOthers() {
  const [latest, item] = [list.items.get(list.current), form.item];
  if (isBusy || !latest || !item || latest.revision === item.revision || item.key !== latest.key) return;
  await runAlone(async () => (form.isChanged ? resolveConflict(await load(latest.key)) : open(latest.key)));
}

/**
 * Open an item.
 * @param {string} key
 * @param {boolean} [onlyIfFree] not if it is open on another page
 * @returns {Promise<boolean>} whether it was not opened for this reason
 */
async function open(key, onlyIfFree = false) {
  try {
    const item = await load(key);
    list.others = item.others;
    if (onlyIfFree && key in item.others) return true;
    list.current = key;
    show(item);
    list.draw();
    find("list", HTMLElement).querySelector("[aria-current]")?.scrollIntoView({ block: "nearest" });
  } catch (error) {
    reportError(error);
  }
  return false;
}

/** @param {Details} item */
function show(item) {
  const isNew = form.item?.key !== item.key;
  find("conflict", HTMLElement).hidden = true;
  form.show(item, person.value);
  find("work", HTMLElement).hidden = false;
  find("empty", HTMLElement).hidden = true;
  drawTitle();
  drawChecks(item);
  drawHistory(item);
  if (isNew) {
    drawCode(item);
    drawScene(item);
    announce(find("title", HTMLElement).textContent ?? "");
  }
}

/** Show the student, or a pseudonym, and the title of the open item. */
function drawTitle() {
  const item = form.item;
  if (!item) return;
  const name = list.studentName(item);
  find("title", HTMLElement).replaceChildren(createElement("bdi", {}, name), `: ${item.title} (${item.task})`);
  setText("note", list.isAnonymous && item.note ? "Look at its ID, with names shown." : item.note);
  document.title = `${name}: ${item.title} - Marking`;
}

/** @param {Details} item; its own cells are highlighted, and the first of them is scrolled to */
function drawCode(item) {
  const { cells, problem } = item.code;
  const sections = cells.map((cell) => {
    const pieces = cell.pieces.map(([kind, text]) => (kind ? createElement("span", { class: kind }, text) : text));
    const title = createElement("h3", {}, cell.own ? `${cell.title}, of this task` : cell.title);
    const code = createElement("pre", {}, createElement("code", {}, ...pieces));
    return createElement("div", cell.own ? { class: "own" } : {}, title, code);
  });
  const code = find("code", HTMLElement);
  code.replaceChildren(...(problem ? [createElement("p", {}, problem)] : []), ...sections);
  code.scrollTop = 0;
  const own = code.querySelector(".own");
  if (own instanceof HTMLElement) code.scrollTop = own.offsetTop - code.offsetTop;
}

/**
 * Show the scene in a new frame: the scene of the previous student disappears immediately, and the browser's history gets
 * no entry for each item.
 * @param {Details} item
 */
function drawScene(item) {
  const old = find("scene", HTMLIFrameElement);
  const frame = /** @type {HTMLIFrameElement} */ (old.cloneNode());
  frame.src = item.scene;
  old.replaceWith(frame);
}

/** @param {Details} item */
function drawChecks(item) {
  const passed = item.checks.filter((check) => check.score >= 1).length;
  const checks = item.checks.map((check) => {
    const sign = check.score >= 1 ? "✓ passed" : `✗ ${Math.round(100 * check.score)} %`;
    const scenario = check.is_hidden ? `${check.scenario}, hidden` : check.scenario;
    const message = [check.message, check.broken].filter(Boolean).join("; ");
    return createElement("li", {}, `${sign}: ${check.title} (${scenario}): ${message}`);
  });
  const errors = item.errors.map((error) => createElement("li", {}, createElement("code", {}, error)));
  drawDetails("checks", `Checks: ${passed} of ${item.checks.length} passed`, [...errors, ...checks]);
}

/** @param {Details} item */
function drawHistory(item) {
  const rows = item.marks.map((mark) => {
    const points = mark.points === null ? "" : `${formatPoints(mark.points)} points`;
    const content = [points, mark.row && `for ${mark.row}`, mark.comment].filter(Boolean).join(", ");
    return createElement("li", {}, `${mark.by}, ${new Date(mark.at).toLocaleString()}: ${content || "seen"}`);
  });
  const whole = item.rubric.length && item.whole ? "; points for the whole task count, until you save a row" : "";
  const total = `${formatPoints(item.score)} of ${formatPoints(item.points)}`;
  drawDetails("history", `Marks: ${rows.length}; now ${total}${whole}`, rows);
}

/**
 * @param {string} id of a details element
 * @param {string} title
 * @param {HTMLElement[]} lines
 */
function drawDetails(id, title, lines) {
  const [summary, body] = find(id, HTMLElement).children;
  summary.textContent = title;
  body.replaceChildren(...lines);
}

/** @param {boolean} opensNext whether the next item is opened afterwards */
function save(opensNext) {
  try {
    const [item, entries] = [form.item, form.entries()];
    if (item) void runAlone(() => saveEntries(item, entries, opensNext));
  } catch (error) {
    void onSaveError(error);
  }
}

/**
 * @param {Details} item
 * @param {MarkEntry[]} entries
 * @param {boolean} opensNext
 */
async function saveEntries(item, entries, opensNext) {
  if (!(await store(item, entries))) return;
  await update();
  // The list shows one draft less.
  list.draw();
  if (opensNext) await move(1);
}

/**
 * Store marks on the server.
 * @param {Details} item
 * @param {MarkEntry[]} entries
 * @returns {Promise<boolean>} whether the server has written all input to its disk
 */
async function store(item, entries) {
  try {
    // Saving without a change marks a submission as reviewed.
    const isReview = item.state === "waiting" && item.note && !item.rubric.length;
    if (!entries.length && isReview) entries.push({ row: "", points: null, comment: form.saved["whole-comment"] });
    if (!entries.length) return true;
    const revision = form.draft()?.revision ?? item.revision;
    const answer = await request(`api/item/${item.key}`, { by: person.value, revision, marks: entries });
    form.removeDraft();
    setText("trouble", "");
    show({ ...item, ...answer });
    announce(`Saved: ${formatPoints(answer.score)} of ${formatPoints(answer.points)}`);
    return true;
  } catch (error) {
    return (await onSaveError(error).catch(reportError)) === true;
  }
}

/** Withdraw all marks of the open task, and its unsaved input. */
function withdraw() {
  const item = form.item;
  if (item?.marks.length) void runAlone(() => saveEntries(item, [{ row: "", withdraw: true }], false));
  else announce("This task has no saved mark");
}

/**
 * Compare unsaved input with the marks that another grader has saved, and let the person choose where they differ.
 * @param {Details} theirs the item as it is saved now
 * @returns {boolean} whether both are equal
 */
function resolveConflict(theirs) {
  const [mine, last] = [form.changes, theirs.marks.at(-1)];
  form.storeDraft(); // with the revision that the person has seen
  show(theirs);
  const differences = Object.keys(mine).filter((id) => mine[id] !== form.saved[id]);
  if (!differences.length) {
    form.removeDraft();
    announce(`${last?.by ?? "Somebody"} has saved the same`);
    return true;
  }
  const rows = differences.map((id) =>
    createElement(
      "tr",
      {},
      createElement("th", { scope: "row" }, form.label(id)),
      createElement("td", {}, form.saved[id] || "nothing"),
      createElement("td", {}, mine[id] || "nothing"),
    ),
  );
  const change = last ? `${last.by} saved this task at ${new Date(last.at).toLocaleTimeString()}` : "This task was changed";
  setText("conflict-title", `${change}, while you had it open. Nothing is lost: which counts?`);
  find("differences", HTMLElement).replaceChildren(...rows);
  find("conflict", HTMLElement).hidden = false;
  return false;
}

/** @param {number} step 1 opens the next free item, -1 the previous one */
async function move(step) {
  let key = list.next(step);
  while (key && (await open(key, true))) key = list.next(step);
  if (key) return;
  if (list.current) announce("There is no other task under these filters that nobody has open");
  else setText("empty", "Nothing waits under these filters. State: any shows all tasks.");
}

function toggleNames() {
  list.isAnonymous = !list.isAnonymous;
  find("anonymous", HTMLElement).setAttribute("aria-pressed", String(list.isAnonymous));
  localStorage.setItem("marking anonymous", list.isAnonymous ? "yes" : "");
  list.draw();
  drawTitle();
}

function focusComment() {
  (form.field("row1-comment") ?? form.field("whole-comment"))?.focus();
}

/** @type {Record<string, () => void>} */
const KEYS = {
  j: () => void runAlone(() => move(1)),
  k: () => void runAlone(() => move(-1)),
  s: () => save(true),
  c: focusComment,
  r: () => find("used", HTMLSelectElement).focus(),
  a: toggleNames,
  "/": () => find("student", HTMLInputElement).focus(),
  "?": () => find("keys", HTMLDialogElement).showModal(),
};

/** @param {KeyboardEvent} event */
function onKey(event) {
  const target = event.target instanceof HTMLElement ? event.target : document.body;
  if (isBusy || find("keys", HTMLDialogElement).open) return;
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
    event.preventDefault();
    save(true);
  } else if (event.key === "Escape") target.blur();
  else if (event.ctrlKey || event.metaKey || event.altKey || !find("shortcuts", HTMLInputElement).checked) return;
  else if (target.matches("input:not([type=checkbox]), select, textarea")) return;
  else if (/^Digit[1-9]$/.test(event.code)) form.onDigit(Number(event.code.at(-1)), event.shiftKey);
  else if (event.key in KEYS) {
    event.preventDefault();
    KEYS[event.key]();
  }
}

document.addEventListener("keydown", onKey);
find("form", HTMLFormElement).addEventListener("submit", (event) => {
  event.preventDefault();
  save(true);
});
find("anonymous", HTMLElement).addEventListener("click", toggleNames);
find("help", HTMLElement).addEventListener("click", KEYS["?"]);
find("previous", HTMLElement).addEventListener("click", KEYS.k);
find("next", HTMLElement).addEventListener("click", KEYS.j);
find("withdraw", HTMLElement).addEventListener("click", withdraw);
find("theirs", HTMLElement).addEventListener("click", () => {
  form.removeDraft();
  if (form.item) show(form.item);
});
find("mine", HTMLElement).addEventListener("click", () => {
  form.storeDraftFor(form.item?.revision ?? "");
  save(false);
});
person.addEventListener("change", () => {
  localStorage.setItem("marking person", person.value);
  list.person = person.value;
  if (form.item) show(form.item);
});
person.value = list.person = localStorage.getItem("marking person") ?? "";
if (localStorage.getItem("marking anonymous")) toggleNames();

for (;;) {
  await update();
  await new Promise((done) => setTimeout(done, POLL_INTERVAL));
}
