/** The order of search results: titles of sections first, and pages for teachers and developers last. */
var Scorer = {
  score: ([page, , anchor, , score, , kind]) =>
    score + (kind === "title" && anchor ? 60 : 0) - (Scorer.last.has(page) ? 80 : 0),
  last: new Set(["author", "benchmarks", "capacity", "contributor", "hub", "instructor", "reference/grading"]),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
