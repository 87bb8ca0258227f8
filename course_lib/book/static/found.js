/** Marks the words of a search in a page that was opened from its results, and scrolls to the first of them. */
addEventListener("load", () => {
  if (document.getElementById("search-results")) return;
  SphinxHighlight.highlightSearchWords(); // Sphinx leaves it out where a theme has the search in all pages
  setTimeout(() => {
    if (!location.hash) document.querySelector("article .highlighted")?.scrollIntoView({ block: "center" });
  }, 50);
});
