/**
 * Make an element.
 * @param {string} tag @param {any} fields by their names in JavaScript; `role` and `data...` too
 * @param {(Node | string)[]} children @returns {any}
 */
export function part(tag, fields = {}, ...children) {
  const element = /** @type {any} */ (document.createElement(tag));
  for (const [name, value] of Object.entries(fields)) {
    if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/**
 * Make a button with a name for screen readers.
 * @param {string | Node} sign @param {string} name @param {() => void} onclick
 */
export const button = (sign, name, onclick) =>
  part("button", { type: "button", title: name, ariaLabel: name, onclick }, sign);

/**
 * Show a small dialog with one field; Escape closes it.
 * @param {HTMLElement} host @param {string} title @param {any} field an input or a list
 * @param {(value: string) => void} act called with the chosen value
 */
export function ask(host, title, field, act) {
  field.ariaLabel = title;
  const yes = part("button", { type: "submit", textContent: title });
  const no = part("button", { type: "button", textContent: "Cancel", onclick: () => box.close() });
  const form = part("form", { method: "dialog" }, part("strong", {}, title), field, part("div", {}, yes, no));
  const box = part("dialog", { ariaLabel: title }, form);
  box.onclose = () => box.remove();
  form.onsubmit = (/** @type {Event} */ event) => {
    event.preventDefault();
    if (field.value) act(field.value);
    box.close();
  };
  if (field.size) field.ondblclick = () => form.requestSubmit();
  field.onkeydown = (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== "Enter") return;
    event.preventDefault(); // otherwise the button that receives the focus would be pressed, too
    form.requestSubmit();
  };
  host.append(box);
  box.showModal();
  field.focus();
}
