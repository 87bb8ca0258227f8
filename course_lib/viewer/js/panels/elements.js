/**
 * Create an element.
 * @param {string} tag @param {any} fields properties of the element, or attributes if it has no such property
 * @param {(Node | string)[]} children @returns {any}
 */
export function createElement(tag, fields = {}, ...children) {
  const element = /** @type {any} */ (document.createElement(tag));
  for (const [name, value] of Object.entries(fields)) {
    if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/**
 * Set properties of an element that have other values now. A page lays out its text anew after each write, and a live
 * view updates its panels ten times a second.
 * @param {any} element @param {any} fields
 */
export function setChanged(element, fields) {
  for (const [name, value] of Object.entries(fields)) if (element[name] !== value) element[name] = value;
}

/**
 * Create a button with a name for screen readers.
 * @param {string | Node} content @param {string} name @param {() => void} onclick
 */
export const button = (content, name, onclick) =>
  createElement("button", { type: "button", title: name, ariaLabel: name, onclick }, content);

/**
 * Show a small dialog with one field; Escape closes it.
 * @param {HTMLElement} host @param {string} title @param {any} field an input or a select element
 * @param {(value: string) => void} onConfirm called with the chosen value
 * @param {HTMLElement[]} notes shown below the field
 */
export function openDialog(host, title, field, onConfirm, ...notes) {
  field.ariaLabel = title;
  const confirm = createElement("button", { type: "submit", textContent: title });
  const cancel = createElement("button", { type: "button", textContent: "Cancel", onclick: () => dialog.close() });
  const buttons = createElement("div", {}, confirm, cancel);
  const form = createElement("form", { method: "dialog" }, createElement("strong", {}, title), field, ...notes, buttons);
  const dialog = createElement("dialog", { ariaLabel: title }, form);
  dialog.onclose = () => dialog.remove();
  form.onsubmit = (/** @type {Event} */ event) => {
    event.preventDefault();
    if (field.value) onConfirm(field.value);
    dialog.close();
  };
  if (field.size) field.ondblclick = () => form.requestSubmit();
  field.onkeydown = (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== "Enter") return;
    event.preventDefault(); // otherwise the button that receives the focus would be pressed, too
    form.requestSubmit();
  };
  host.append(dialog);
  dialog.showModal();
  field.focus();
}
