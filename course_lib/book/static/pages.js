/** What the theme leaves out: names for screen readers, and the words of a search in a page that it found. */
addEventListener("load", () => {
  nameArrows();
  if (!document.getElementById("search-results")) markWords();
});

/** Names the arrows of the contents, which open and close a chapter, by the chapter. */
function nameArrows() {
  for (const arrow of document.querySelectorAll("nav .has-children > details > summary")) {
    const chapter = arrow.closest("li").querySelector("a")?.textContent.trim();
    arrow.setAttribute("aria-label", `Pages of ${chapter}`);
  }
}

/** Marks the words of a search in a page that was opened from its results, and scrolls to the first of them. */
function markWords() {
  SphinxHighlight.highlightSearchWords(); // Sphinx leaves it out where a theme has the search in all pages
  setTimeout(() => {
    if (!location.hash) document.querySelector("article .highlighted")?.scrollIntoView({ block: "center" });
  }, 50);
}
