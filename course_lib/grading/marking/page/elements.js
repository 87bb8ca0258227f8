// Elements are created from text, never from markup, so that a student's text is displayed and never runs.

/**
 * Create an element.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, string | boolean | (() => void)>} [attributes] a function is called on click
 * @param {...(Node | string)} content
 * @returns {HTMLElementTagNameMap[T]}
 */
export function createElement(tag, attributes = {}, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener("click", value);
    else if (typeof value === "string") element.setAttribute(name, value);
    else element.toggleAttribute(name, value);
  }
  element.append(...content);
  return element;
}

/**
 * Return an element of the page.
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind the expected class
 * @returns {T}
 */
export function find(id, kind) {
  const element = document.getElementById(id);
  if (!(element instanceof kind)) throw new Error(`the page has no ${id}`);
  return element;
}

/** @param {string} id @param {string} text its new content */
export function setText(id, text) {
  find(id, HTMLElement).textContent = text;
}

/** @param {string} text is read aloud by screen readers */
export function announce(text) {
  setText("said", "");
  // In a later frame, because an unchanged text would not be read again.
  requestAnimationFrame(() => setText("said", text));
}

/** @param {number} points rounded to two decimals */
export const formatPoints = (points) => String(Math.round(points * 100) / 100);
