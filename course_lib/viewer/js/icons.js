// Icons as lines in a square of 20 by 20, because fonts draw such characters differently or lack them.
/** @type {Record<string, string>} */
const LINES = {
  full: "M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4",
  beside: "M2 3h16v14H2zM11 3v14M13.5 7h2M13.5 10h2",
  apart: "M2 4h9v4H2zM9 12h9v4H9z",
  play: "M5 3l12 7-12 7z",
  pause: "M6 4v12M14 4v12",
  loop: "M4 6a7.5 7.5 0 1 1-1 6M4 2v4h4",
  Interact: "M5 2l11 9-5 .5 3 5.5-2 1-3-5.5L5 16z",
  "Move Camera": "M10 2v16M2 10h16M8 4l2-2 2 2M8 16l2 2 2-2M4 8l-2 2 2 2M16 8l2 2-2 2",
  Select: "M2 5V3h3M9 3h3M15 3h3v2M18 9v3M18 15v2h-3M12 17H9M5 17H2v-2M2 12V9",
  "Focus Camera": "M10 1v5M10 14v5M1 10h5M14 10h5M10 4a6 6 0 1 0 .01 0z",
  Measure: "M1 13V7h18v6zM5 7v3M10 7v4M15 7v3",
  "2D Pose Estimate": "M3 17L16 4M9 4h7v7",
  "2D Goal Pose": "M5 19V2l11 4-11 4",
  "Publish Point": "M10 18c-4-6-5-8-5-10a5 5 0 0 1 10 0c0 2-1 4-5 10zM10 6.5a1.5 1.5 0 1 0 .01 0z",
};

/** @param {string} name @returns {Element} an icon with the size and color of the text; its button must have a name */
export function icon(name) {
  const box = document.createElement("span");
  box.innerHTML =
    '<svg viewBox="0 0 20 20" width="1.15em" height="1.15em" fill="none" stroke="currentColor" stroke-width="1.7" ' +
    `stroke-linejoin="round" style="vertical-align:-0.2em" aria-hidden="true"><path d="${LINES[name]}"/></svg>`;
  return /** @type {Element} */ (box.firstChild);
}
