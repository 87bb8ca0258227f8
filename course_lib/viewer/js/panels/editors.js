import { createElement, setChanged } from "./elements.js";

/** @typedef {import("../protocol.js").PanelRow} Row */
/** @typedef {{element: any, update: (value: any) => void}} Control */

/** @param {number} value formatted with at most six digits */
const formatNumber = (value) => String(Number(Number(value).toPrecision(6)));

/** @param {number[]} rgb */
const hex = (rgb) => `#${rgb.map((part) => part.toString(16).padStart(2, "0")).join("")}`;
/** @param {string} text */
const rgb = (text) => [1, 3, 5].map((start) => parseInt(text.slice(start, start + 2), 16));

const ANSWER_TIME = 500; // [ms] that Python may take to accept, clip or reject a value

/** @param {any} input @returns {number | string} an invalid number as the text that Python rejects, not as NaN */
const numberOf = ({ valueAsNumber }) => (Number.isNaN(valueAsNumber) ? "" : valueAsNumber);

/**
 * A text field that accepts a new value only while the user is not typing in it.
 * @param {any} fields @param {(field: any) => void} onchange @param {(value: any) => string} show
 */
function inputField(fields, onchange, show = String) {
  let isTyping = false;
  /** @type {any} */
  let value;
  const update = (now = value) => {
    value = now;
    if (!isTyping) input.value = show(value);
  };
  const input = createElement("input", {
    ...fields,
    oninput: () => (isTyping = true),
    onkeydown: (/** @type {KeyboardEvent} */ { key }) => {
      if (key !== "Escape") return;
      isTyping = false; // the value is restored, as in RViz
      update();
    },
    onchange: () => {
      isTyping = false;
      onchange(input);
      setTimeout(update, ANSWER_TIME); // Python sends nothing if the value remains what it was
    },
  });
  return { element: input, update };
}

/** @typedef {(row: Row, set: (value: any) => void, list: string) => Control} EditorFactory creates a control */
/** @type {EditorFactory} */
const numberField = ({ editor }, set) => {
  const limits = { min: editor?.low ?? "", max: editor?.high ?? "" };
  const [step, show] = editor?.kind === "integer" ? [1, String] : ["any", formatNumber];
  return inputField({ type: "number", step, ...limits }, (input) => set(numberOf(input)), show);
};
/** @type {EditorFactory} */
const textField = (_, set, list) => {
  const control = inputField({ type: "text", spellcheck: false }, (input) => set(input.value));
  if (list) control.element.setAttribute("list", list);
  return control;
};
/** @type {Record<import("../protocol.js").Editor["kind"], EditorFactory>} */
const EDITORS = {
  number: numberField,
  integer: numberField,
  text: textField,
  frame: textField,
  topic: textField,
  bool: (_, set) => {
    const box = createElement("input", { type: "checkbox", onchange: () => set(box.checked) });
    return { element: box, update: (value) => (box.checked = value) };
  },
  enum: ({ editor }, set) => {
    const options = (editor?.options ?? []).map((word) => new Option(word, word));
    const field = createElement("select", { onchange: () => set(field.value) }, ...options);
    return { element: field, update: (value) => (field.value = value) };
  },
  color: (_, set) => {
    const control = inputField({ type: "color" }, (input) => set(rgb(input.value)), hex);
    const update = (/** @type {number[]} */ value) => {
      setChanged(control.element, { title: value.join("; ") }); // as RViz writes it
      control.update(value);
    };
    return { ...control, update };
  },
  vector: ({ label }, set) => {
    const change = () => set(axes.map(({ element }) => numberOf(element)));
    const axes = ["x", "y", "z"].map((axis) =>
      inputField({ type: "number", step: "any", ariaLabel: `${label} ${axis}` }, change, formatNumber),
    );
    const element = createElement("span", { className: "course-vector" }, ...axes.map((axis) => axis.element));
    return { element, update: (value) => axes.forEach((axis, i) => axis.update(value[i])) };
  },
  none: () => {
    const text = createElement("span");
    return { element: text, update: (value) => setChanged(text, { textContent: value ?? "" }) };
  },
};

/**
 * @param {Row} row @param {(value: any) => void} set @param {string} list id of the suggestions, if any
 * @returns {Control} named after the row
 */
export function editorFor(row, set, list) {
  const control = EDITORS[row.editor?.kind ?? "none"](row, set, list);
  if (row.editor) control.element.ariaLabel = row.label;
  return control;
}
