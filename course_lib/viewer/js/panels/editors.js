import { part } from "./parts.js";

/** @typedef {import("../protocol.js").PanelRow} Row */
/** @typedef {{element: any, update: (value: any) => void}} Control */

/** @param {number} value formatted with at most six digits */
const short = (value) => String(Number(Number(value).toPrecision(6)));

/** @param {number[]} rgb */
const hex = (rgb) => `#${rgb.map((part) => part.toString(16).padStart(2, "0")).join("")}`;
/** @param {string} text */
const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));

/**
 * A text field that accepts a new value only while the user is not typing in it.
 * @param {any} fields @param {(field: any) => void} onchange @param {(value: any) => string} show
 */
function typed(fields, onchange, show = String) {
  const input = part("input", { ...fields, onchange: () => onchange(input) });
  return {
    element: input,
    update: (/** @type {any} */ value) => {
      if (document.activeElement !== input) input.value = show(value);
    },
  };
}

/** @typedef {(row: Row, set: (value: any) => void, list: string) => Control} Maker of a control */
/** @type {Maker} */
const numberField = ({ editor }, set) => {
  const limits = { min: editor?.low ?? "", max: editor?.high ?? "" };
  const step = editor?.kind === "integer" ? 1 : "any";
  return typed({ type: "number", step, ...limits }, (input) => set(input.valueAsNumber), short);
};
/** @type {Maker} */
const textField = (_, set, list) => {
  const made = typed({ type: "text", spellcheck: false }, (input) => set(input.value));
  if (list) made.element.setAttribute("list", list);
  return made;
};
/** @type {Record<import("../protocol.js").Editor["kind"], Maker>} */
const EDITORS = {
  number: numberField,
  integer: numberField,
  text: textField,
  frame: textField,
  topic: textField,
  bool: (_, set) => {
    const box = part("input", { type: "checkbox", onchange: () => set(box.checked) });
    return { element: box, update: (value) => (box.checked = value) };
  },
  enum: ({ editor }, set) => {
    const options = (editor?.options ?? []).map((word) => new Option(word, word));
    const field = part("select", { onchange: () => set(field.value) }, ...options);
    return { element: field, update: (value) => (field.value = value) };
  },
  color: (_, set) => typed({ type: "color" }, (input) => set(rgb(input.value)), hex),
  vector: ({ label }, set) => {
    const change = () => set(axes.map(({ element }) => element.valueAsNumber));
    const axes = ["x", "y", "z"].map((axis) =>
      typed({ type: "number", step: "any", ariaLabel: `${label} ${axis}` }, change, short),
    );
    const element = part("span", { className: "course-vector" }, ...axes.map((axis) => axis.element));
    return { element, update: (value) => axes.forEach((axis, i) => axis.update(value[i])) };
  },
  none: () => {
    const words = part("span");
    return { element: words, update: (value) => (words.textContent = value ?? "") };
  },
};

/**
 * @param {Row} row @param {(value: any) => void} set @param {string} list id of the suggestions, if any
 * @returns {Control} named after the row
 */
export function editorFor(row, set, list) {
  const made = EDITORS[row.editor?.kind ?? "none"](row, set, list);
  if (row.editor) made.element.ariaLabel = row.label;
  return made;
}
