// Elements are made of text, never of markup: what students write is shown and does nothing.

/**
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, string | boolean | (() => void)>} [about] attributes; functions are called on click
 * @param {...(Node | string)} content
 * @returns {HTMLElementTagNameMap[T]}
 */
export function make(tag, about = {}, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(about)) {
    if (typeof value === "function") element.addEventListener("click", value);
    else if (typeof value === "string") element.setAttribute(name, value);
    else element.toggleAttribute(name, value);
  }
  element.append(...content);
  return element;
}

/**
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function find(id, kind) {
  const element = document.getElementById(id);
  if (!(element instanceof kind)) throw new Error(`the page has no ${id}`);
  return element;
}

/** @param {string} text */
export function say(text) {
  const place = find("said", HTMLElement);
  place.textContent = "";
  requestAnimationFrame(() => (place.textContent = text)); // the same text again is read again
}

/** @param {number} points */
export const round = (points) => String(Math.round(points * 100) / 100);
