// The page on which persons mark: it loads items, saves marks, and follows what other persons save.

import { find, make, round, say } from "./elements.js";
import { Form } from "./form.js";
import { List } from "./list.js";

/** @typedef {import("./types").Details} Details */
/** @typedef {import("./types").Changes} Changes */
/** @typedef {import("./types").Given} Given */

const PAUSE = 2000; // [ms] between two questions
const PAGE = crypto.randomUUID();
const GONE = "The server does not answer. What you typed is kept in this browser. Start `course mark … --serve` again, and open its address.";
const OLD = "The server was started again with another address: open that one. What you typed is kept in this browser.";

const form = new Form();
/** @type {List} */
const list = new List((key) => void alone(() => open(key)));
const [person, beside] = [find("person", HTMLInputElement), find("work", HTMLElement)];
let number = 0;
let busy = false;

/** An answer of the server that is no success. */
class Refused extends Error {
  /**
   * @param {number} code
   * @param {string} text
   */
  constructor(code, text) {
    super(text);
    this.code = code;
  }
}

/**
 * @param {string} path
 * @param {object} [body] to be saved
 * @returns {Promise<any>}
 * @throws {Refused}
 */
async function ask(path, body) {
  const post = { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  /** @type {Response} */
  let response;
  try {
    response = await fetch(path, body ? post : {});
  } catch {
    throw new Refused(0, GONE);
  }
  if (response.status === 403) throw new Refused(403, OLD);
  const content = await response.json().catch(() => ({ error: `The server answers ${response.status}.` }));
  if (!response.ok) throw new Refused(response.status, content.error);
  return content;
}

/** @param {unknown} error that stops the page */
function trouble(error) {
  if (!(error instanceof Refused)) throw error;
  find("trouble", HTMLElement).textContent = error.message;
}

/**
 * @param {unknown} error for which marks are not saved
 * @returns {Promise<boolean>} whether somebody else has saved the same
 */
async function refuse(error) {
  const isOurs = error instanceof Refused || error instanceof RangeError;
  if (!isOurs || (error instanceof Refused && [0, 403].includes(error.code))) trouble(error);
  if (isOurs) find("unsaved", HTMLElement).textContent = `Not saved: ${error.message}`;
  if (isOurs) say(`Not saved: ${error.message}`);
  if (!form.item || !(error instanceof Refused && error.code === 409)) return false;
  return conflict(await load(form.item.key));
}

const me = () => new URLSearchParams({ page: PAGE, by: person.value });

/**
 * @param {string} key
 * @returns {Promise<Details>} an item; from now on others see that it is open here
 */
const load = (key) => ask(`api/item/${key}?${me()}`);

/**
 * Do one thing at a time: keys pressed meanwhile are for no task, least of all for the next one.
 *
 * @param {() => Promise<unknown>} work
 */
async function alone(work) {
  if (busy) return;
  const [fields, panel, focused] = [find("form", HTMLElement), find("conflict", HTMLElement), document.activeElement];
  busy = fields.inert = true;
  try {
    await work();
  } finally {
    busy = fields.inert = false;
    if (!panel.hidden) panel.focus();
    else if (focused instanceof HTMLElement && fields.contains(focused)) focused.focus();
  }
}

/** @type {Promise<void>} one question after the other: an old answer must not come after a new one */
let following = Promise.resolve();
const follow = () => (following = following.then(look));

async function look() {
  try {
    const about = `since=${number}&${me()}`;
    const changes = /** @type {Changes} */ (await ask(`api/queue?${about}`));
    const differ = JSON.stringify(changes.others) !== JSON.stringify(list.others);
    number = changes.number;
    for (const item of changes.items) list.items.set(item.key, item);
    list.others = changes.others;
    find("state", HTMLElement).textContent = changes.state;
    find("trouble", HTMLElement).textContent = changes.problems.join(" ");
    if (changes.items.length || differ) list.draw();
    await meet();
    if (!list.current) await alone(() => move(1));
  } catch (error) {
    trouble(error);
  }
}

/** Show what another person has saved for the open item. */
async function meet() {
  const [now, shown] = [list.items.get(list.current), form.item];
  if (busy || !now || !shown || now.revision === shown.revision || shown.key !== now.key) return;
  await alone(async () => (form.changed ? conflict(await load(now.key)) : open(now.key)));
}

/**
 * @param {string} key
 * @param {boolean} [unless] not if somebody else has it open
 * @returns {Promise<boolean>} whether to look for another one
 */
async function open(key, unless = false) {
  try {
    const details = await load(key);
    list.others = details.others;
    if (unless && key in details.others) return true;
    list.current = key;
    show(details);
    list.draw();
    find("list", HTMLElement).querySelector("[aria-current]")?.scrollIntoView({ block: "nearest" });
  } catch (error) {
    trouble(error);
  }
  return false;
}

/** @param {Details} item */
function show(item) {
  const isNew = form.item?.key !== item.key;
  find("conflict", HTMLElement).hidden = true;
  form.show(item, person.value);
  beside.hidden = false;
  find("empty", HTMLElement).hidden = true;
  name();
  drawChecks(item);
  drawHistory(item);
  if (isNew) {
    drawCode(item);
    drawScene(item);
    say(find("title", HTMLElement).textContent ?? "");
  }
}

/** Write the open item's student, or not. */
function name() {
  const item = form.item;
  if (!item) return;
  const title = `${list.named(item)}: ${item.title}`;
  find("title", HTMLElement).replaceChildren(make("bdi", {}, list.named(item)), `: ${item.title} (${item.task})`);
  find("note", HTMLElement).textContent = list.anonymous && item.note ? "Look at its ID, with names shown." : item.note;
  document.title = `${title} - Marking`;
}

/** @param {Details} item */
function drawCode(item) {
  const { cells, problem } = item.code;
  const parts = cells.map((cell) => {
    const pieces = cell.pieces.map(([kind, text]) => (kind ? make("span", { class: kind }, text) : text));
    const title = make("h3", {}, cell.own ? `${cell.title}, of this task` : cell.title);
    return make("div", cell.own ? { class: "own" } : {}, title, make("pre", {}, make("code", {}, ...pieces)));
  });
  const code = find("code", HTMLElement);
  code.replaceChildren(...(problem ? [make("p", {}, problem)] : []), ...parts);
  code.scrollTop = 0;
  const own = code.querySelector(".own");
  if (own instanceof HTMLElement) code.scrollTop = own.offsetTop - code.offsetTop;
}

/** @param {Details} item; a new frame each time: the last student's scene goes at once, and Back leaves the page */
function drawScene(item) {
  const old = find("scene", HTMLIFrameElement);
  const frame = /** @type {HTMLIFrameElement} */ (old.cloneNode());
  frame.src = item.scene;
  old.replaceWith(frame);
}

/** @param {Details} item */
function drawChecks(item) {
  const passed = item.checks.filter((check) => check.score >= 1).length;
  const lines = item.checks.map((check) => {
    const sign = check.score >= 1 ? "✓ passed" : `✗ ${Math.round(100 * check.score)} %`;
    const where = check.hidden ? `${check.scenario}, hidden` : check.scenario;
    return make("li", {}, `${sign}: ${check.title} (${where}): ${[check.message, check.broken].filter(Boolean).join("; ")}`);
  });
  const errors = item.errors.map((error) => make("li", {}, make("code", {}, error)));
  fold("checks", `Checks: ${passed} of ${item.checks.length} passed`, [...errors, ...lines]);
}

/** @param {Details} item */
function drawHistory(item) {
  const rows = item.marks.map((mark) => {
    const points = mark.points === null ? "" : `${round(mark.points)} points`;
    const what = [points, mark.row && `for ${mark.row}`, mark.comment].filter(Boolean).join(", ");
    return make("li", {}, `${mark.by}, ${new Date(mark.at).toLocaleString()}: ${what || "seen"}`);
  });
  const whole = item.rubric.length && item.whole ? "; points for the whole task count, until you save a row" : "";
  fold("history", `Marks: ${rows.length}; now ${round(item.score)} of ${round(item.points)}${whole}`, rows);
}

/**
 * @param {string} id
 * @param {string} title
 * @param {HTMLElement[]} lines
 */
function fold(id, title, lines) {
  const [head, body] = find(id, HTMLElement).children;
  head.textContent = title;
  body.replaceChildren(...lines);
}

/** @param {boolean} goOn */
function save(goOn) {
  try {
    const [item, given] = [form.item, form.given()];
    if (item) void alone(() => saved(item, given, goOn));
  } catch (error) {
    void refuse(error);
  }
}

/**
 * @param {Details} item
 * @param {Given[]} given
 * @param {boolean} goOn
 */
async function saved(item, given, goOn) {
  if (!(await store(item, given))) return;
  await follow();
  list.draw(); // a draft less
  if (goOn) await move(1);
}

/**
 * @param {Details} item
 * @param {Given[]} given
 * @returns {Promise<boolean>} whether all that was typed is on the server's disk
 */
async function store(item, given) {
  try {
    const isSeen = item.state === "waiting" && item.note && !item.rubric.length;
    if (!given.length && isSeen) given.push({ row: "", points: null, comment: form.saved["whole-comment"] });
    if (!given.length) return true;
    const revision = form.draft()?.revision ?? item.revision;
    const now = await ask(`api/item/${item.key}`, { by: person.value, revision, marks: given });
    form.forget();
    find("trouble", HTMLElement).textContent = "";
    show({ ...item, ...now });
    say(`Saved: ${round(now.score)} of ${round(now.points)}`);
    return true;
  } catch (error) {
    return (await refuse(error).catch(trouble)) === true;
  }
}

/** Take back all marks of the open task, and what is typed for it. */
function withdraw() {
  const item = form.item;
  if (item?.marks.length) void alone(() => saved(item, [{ row: "", withdraw: true }], false));
  else say("This task has no saved mark");
}

/**
 * @param {Details} theirs the item as it is saved by now, while other marks were typed here
 * @returns {boolean} whether both say the same
 */
function conflict(theirs) {
  const [mine, last] = [form.changes, theirs.marks.at(-1)];
  form.keep(); // with the revision that was seen
  show(theirs);
  const differ = Object.keys(mine).filter((id) => mine[id] !== form.saved[id]);
  if (!differ.length) return agree(last?.by);
  const rows = differ.map((id) => {
    const [head, saved] = [make("th", { scope: "row" }, form.label(id)), make("td", {}, form.saved[id] || "nothing")];
    return make("tr", {}, head, saved, make("td", {}, mine[id] || "nothing"));
  });
  const when = last ? `${last.by} saved this task at ${new Date(last.at).toLocaleTimeString()}` : "This task was changed";
  find("conflict-title", HTMLElement).textContent = `${when}, while you had it open. Nothing is lost: which counts?`;
  find("differences", HTMLElement).replaceChildren(...rows);
  find("conflict", HTMLElement).hidden = false;
  return false;
}

/** @param {string} [other] who has saved what was typed here */
function agree(other) {
  form.forget();
  say(`${other ?? "Somebody"} has saved the same`);
  return true;
}

/** @param {number} step */
async function move(step) {
  let key = list.next(step);
  while (key && (await open(key, true))) key = list.next(step);
  if (key) return;
  if (list.current) say("There is no other task under these filters that nobody has open");
  else find("empty", HTMLElement).textContent = "Nothing waits under these filters. State: any shows all tasks.";
}

function hide() {
  list.anonymous = !list.anonymous;
  find("anonymous", HTMLElement).setAttribute("aria-pressed", String(list.anonymous));
  localStorage.setItem("marking anonymous", list.anonymous ? "yes" : "");
  list.draw();
  name();
}

function comment() {
  (form.field("row1-comment") ?? form.field("whole-comment"))?.focus();
}

/** @type {Record<string, () => void>} */
const KEYS = {
  j: () => void alone(() => move(1)),
  k: () => void alone(() => move(-1)),
  s: () => save(true),
  c: comment,
  r: () => find("used", HTMLSelectElement).focus(),
  a: hide,
  "/": () => find("student", HTMLInputElement).focus(),
  "?": () => find("keys", HTMLDialogElement).showModal(),
};

/** @param {KeyboardEvent} event */
function press(event) {
  const target = event.target instanceof HTMLElement ? event.target : document.body;
  if (busy || find("keys", HTMLDialogElement).open) return;
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
    event.preventDefault();
    save(true);
  } else if (event.key === "Escape") target.blur();
  else if (event.ctrlKey || event.metaKey || event.altKey || !find("shortcuts", HTMLInputElement).checked) return;
  else if (target.matches("input:not([type=checkbox]), select, textarea")) return;
  else if (/^Digit[1-9]$/.test(event.code)) form.press(Number(event.code.at(-1)), event.shiftKey);
  else if (event.key in KEYS) {
    event.preventDefault();
    KEYS[event.key]();
  }
}

document.addEventListener("keydown", press);
find("form", HTMLFormElement).addEventListener("submit", (event) => {
  event.preventDefault();
  save(true);
});
find("anonymous", HTMLElement).addEventListener("click", hide);
find("help", HTMLElement).addEventListener("click", KEYS["?"]);
find("previous", HTMLElement).addEventListener("click", KEYS.k);
find("next", HTMLElement).addEventListener("click", KEYS.j);
find("withdraw", HTMLElement).addEventListener("click", withdraw);
find("theirs", HTMLElement).addEventListener("click", () => {
  form.forget();
  if (form.item) show(form.item);
});
find("mine", HTMLElement).addEventListener("click", () => {
  form.seen(form.item?.revision ?? "");
  save(false);
});
person.addEventListener("change", () => {
  localStorage.setItem("marking person", person.value);
  list.person = person.value;
  if (form.item) show(form.item);
});
person.value = list.person = localStorage.getItem("marking person") ?? "";
if (localStorage.getItem("marking anonymous")) hide();

for (;;) {
  await follow();
  await new Promise((done) => setTimeout(done, PAUSE));
}
