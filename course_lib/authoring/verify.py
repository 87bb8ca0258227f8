"""`course verify`: everything of a week that a command can see before students do."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from course_lib.authoring.fields import unbuildable
from course_lib.authoring.flaw import ASPECTS, Flaw
from course_lib.authoring.lesson_rules import (
    FOR_EXTRAS,
    FOR_LESSONS,
    FOR_REVIEWS,
    WITH_EXERCISE,
    unknown_questions,
    untaught,
)
from course_lib.authoring.mutants import idle_operators
from course_lib.authoring.new_week import template_picture, unchanged_files
from course_lib.authoring.page import NotebookPage
from course_lib.authoring.rehearsal import cells_of
from course_lib.authoring.rules import FOR_ALL, Rule
from course_lib.authoring.week import WeekRehearsals, missing_files
from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import exercise_from, notebook_text, read_notebook
from course_lib.course.questions import read_questions
from course_lib.errors import CourseError, counted, did_you_mean, place_of
from course_lib.grading.executors import executors
from course_lib.grading.records import Course, catalog_of

if TYPE_CHECKING:
    from rich.table import Table

LEFT = "REPLACE"  # in the texts of templates
EXTRAS = "extras"  # the row of what belongs to no week
OF_EXTRAS = {"lesson", "quiz", "wrong"}  # aspects
UNKNOWN = frozenset({"fields", "solution", "stub", "empty", "second", "wrong", "can fail"})


@dataclass(frozen=True)
class WeekReport:
    """One row of the table.

    Args:
        week: "week01", or the extras.
        flaws: What is wrong.
        unknown: Aspects that could not be looked at.
        left: Files with places of a template, and how many each has.
        kept: By wrong answer, its share of the task's points.
    """

    week: str
    flaws: tuple[Flaw, ...]
    unknown: frozenset[str] = frozenset()
    left: Mapping[str, int] = field(default_factory=dict)
    kept: Mapping[str, float] = field(default_factory=dict)

    @property
    def replace(self) -> int:
        """Count the places of a template."""
        return sum(self.left.values())

    def cell(self, aspect: str) -> str:
        """Return the mark of one aspect."""
        if any(flaw.aspect == aspect for flaw in self.flaws):
            return "✘"
        return "." if aspect in self.unknown else "✔"


def verify(course: Course, weeks: Sequence[str] = (), jobs: int | None = None) -> Iterator[WeekReport]:
    """Verify weeks, one after the other; a broken one does not keep the others from it.

    Args:
        course: Where the files are.
        weeks: "week01", …; default: all weeks of course.toml, then the extras.
        jobs: Notebooks that run at a time; default: the number of processors.

    Raises:
        CourseError: course.toml can't be read, or there is no such week.
    """
    known = weeks_of(course)
    for week in weeks:
        if week not in known:
            meant = did_you_mean(week, known) or f", known: {', '.join(known)}"
            raise CourseError(f"there is no {week} in {course.exercises / 'course.toml'}{meant}")
    with executors(jobs or os.cpu_count() or 1, None) as (_, pool, _):
        for week in weeks or known:
            yield replace(_report(week, course, pool), left=_left_of_template(week, course))
    if not weeks and (found := [*page_flaws(EXTRAS, course), *_idle_mutants(course)]):
        yield WeekReport(EXTRAS, tuple(found), frozenset(ASPECTS) - OF_EXTRAS)


def weeks_of(course: Course) -> list[str]:
    """Return the weeks of course.toml, and those that have a check file only."""
    named = read_course_file(course.exercises / "course.toml")
    written = (path.stem for path in (course.exercises / "checks").glob("week*.py"))
    return sorted({*named.weeks, *named.faults, *written})


def _report(week: str, course: Course, pool: Executor) -> WeekReport:
    found = [*page_flaws(week, course), *_quizzes(week, course), *_fresh(week, course)]
    try:
        tasks = catalog_of(course).of_week(week)
        if not tasks:
            return WeekReport(week, tuple(found), UNKNOWN)
        broken = list(missing_files(week, course))
        broken += _inputs(week, course)
        if not broken:
            rehearsals = WeekRehearsals(week, course, pool)
            found += rehearsals.flaws()
            return WeekReport(week, tuple(found), kept=rehearsals.kept)
    except CourseError as error:
        broken = [Flaw("files", str(error))]
    return WeekReport(week, (*broken, *found), UNKNOWN)


def _inputs(week: str, course: Course) -> Iterator[Flaw]:
    catalog = catalog_of(course)
    for task in catalog.of_week(week):
        yield from unbuildable(task, task.scenarios, course.exercises / "checks" / f"{week}.py")
        hidden = catalog.hidden.get(task.id, ())
        yield from unbuildable(replace(task, ghost=()), hidden, course.solutions / "checks" / f"{week}.py")


def page_flaws(week: str, course: Course) -> Iterator[Flaw]:
    """Yield what the rules say of a week's notebooks, or of the extras."""
    if week == EXTRAS:
        for path in sorted(course.lessons.glob("extra_*.ipynb")):
            yield from _obeys(path, course, [*FOR_ALL, *FOR_EXTRAS])
        return
    reviews = sorted(course.lessons.glob(f"{week}_your_review.ipynb"))
    pages = sorted(set(course.lessons.glob(f"{week}_*.ipynb")) - set(reviews))
    solution = course.solutions / f"{week}_solution.ipynb"
    if len(pages) != 1:
        text = f"{counted(len(pages), 'lesson')}, expected one"
        yield Flaw("lesson", text, str(course.lessons / f"{week}_*.ipynb"))
    for path in pages:
        rules = [*FOR_ALL, *FOR_LESSONS, *(WITH_EXERCISE if solution.is_file() else ())]
        yield from _obeys(path, course, rules)
    for path in reviews:
        yield from _obeys(path, course, [*FOR_ALL, *FOR_REVIEWS])
    for path in (solution, course.exercises / f"{week}_exercise.ipynb"):
        if path.is_file():
            yield from _obeys(path, course, FOR_ALL)
    if solution.is_file():
        known = [path for path in sorted(course.lessons.glob("week*.ipynb")) if path.name[:6] <= week]
        with suppress(CourseError, SyntaxError):  # the rules name that
            yield from (Flaw("lesson", text, str(solution)) for text in untaught(solution, known))


def _obeys(path: Path, course: Course, rules: Iterable[Rule]) -> Iterator[Flaw]:
    page = NotebookPage(path, course.exercises)
    with suppress(CourseError):  # what cannot be read is named elsewhere
        yield from (Flaw("quiz", text, str(path)) for text in unknown_questions(page))
    try:
        for rule in rules:
            yield from (Flaw("lesson", text, str(path)) for text in rule(page))
    except (CourseError, KeyError) as error:  # no notebook; a cell without its parts
        yield Flaw("lesson", f"it can't be read as a notebook: {error}", str(path))


def _quizzes(week: str, course: Course) -> Iterator[Flaw]:
    for path in sorted((course.exercises / "quizzes").glob(f"{week}*.toml")):
        for kind in ("question", "prediction"):
            try:
                read_questions(path, kind)
            except CourseError as error:
                yield Flaw("quiz", str(error))


def _idle_mutants(course: Course) -> Iterator[Flaw]:
    """Yield mutants of the course's own that change no solution."""
    path = course.solutions / "answers" / "mutants.toml"
    with suppress(CourseError):  # each week names what cannot be read
        cells = [cell for one in course.solutions.glob("*_solution.ipynb") for cell in cells_of(one)]
        for name in idle_operators(course.solutions, cells):
            yield Flaw("wrong", f"the pattern of the mutant {name!r} is in no solution", place_of(path, name))


def _fresh(week: str, course: Course) -> Iterator[Flaw]:
    """Yield an exercise that differs from what is made of its solution."""
    solution = course.solutions / f"{week}_solution.ipynb"
    exercise = course.exercises / f"{week}_exercise.ipynb"
    if not (solution.is_file() and exercise.is_file()):
        return
    try:
        made = notebook_text(exercise_from(read_notebook(solution)))
    except CourseError as error:
        yield Flaw("fresh", str(error), str(solution))
        return
    if exercise.read_text(encoding="utf-8") != made:
        how = "python -m course_lib.course.exercise writes it again"
        yield Flaw("fresh", f"it is not what the solution gives: {how}", str(exercise))


def table(reports: Sequence[WeekReport]) -> "Table":
    """Return one table: a row per week, a column per aspect."""
    from rich.table import Table

    made = Table("week", *ASPECTS, box=None, padding=(0, 1, 0, 0), pad_edge=False)  # fits 80 columns
    for report in reports:
        made.add_row(report.week, *(report.cell(aspect) for aspect in ASPECTS))
    return made


def _left_of_template(week: str, course: Course) -> dict[str, int]:
    """Return how often each file says REPLACE, or is the template's; JupyterLab does not show metadata."""
    tops = [course.lessons, course.exercises / "quizzes", course.exercises / "mistakes", course.solutions]
    tops += [course.exercises / "checks", course.solutions / "checks", course.solutions / "answers"]
    files = [path for top in tops for path in top.glob(f"{week}*") if path.is_file()]
    found = dict[str, int]()
    for path in files:
        text = path.read_text(encoding="utf-8", errors="replace")
        cells, _, metadata = text.rpartition('\n "metadata": {')
        found[f"{path}, in its metadata"] = metadata.count(LEFT) if cells else 0
        found[str(path)] = (cells or metadata).count(LEFT)
        found[f"{path}, its picture, which is the template's"] = text.count(template_picture())
    whole = (path for path in unchanged_files(week, course) if not found[str(path)])
    found |= {f"{path}, which is the template's": 1 for path in whole}
    return {place: count for place, count in found.items() if count}


def lines(reports: Sequence[WeekReport], course: Course) -> list[str]:
    """Return every flaw as one line, with paths from the top of the course, and a summary."""
    top = f"{course.exercises.parent}{os.sep}"
    flaws = [f"{report.week}, {flaw.aspect}: {flaw}" for report in reports for flaw in report.flaws]
    found = [flaw.replace(top, "") for flaw in flaws]
    found += _left_lines(reports)
    found += [f"{place}: {count} {LEFT}".replace(top, "") for r in reports for place, count in r.left.items()]
    found += [_kept_line(report) for report in reports if report.kept]
    meant: Mapping[str, str] = {f.aspect: ASPECTS[f.aspect] for r in reports for f in r.flaws}
    said = [f"{aspect}: {text}" for aspect, text in meant.items()]
    bad = sum(bool(report.flaws) for report in reports)
    end = f"{counted(bad, 'week')} of {len(reports)} not ready." if bad else "All of it is right."
    return [*found, *["What must hold:"] * bool(said), *said, end]


def _left_lines(reports: Iterable[WeekReport]) -> list[str]:
    return [
        f"{r.week}: {counted(r.replace, 'place')} of the template left, look for {LEFT}"
        for r in reports
        if r.replace
    ]


def left_in(course: Course) -> list[str]:
    """Return a line for each week in which places of the template are left."""
    return _left_lines(
        [WeekReport(week, (), left=_left_of_template(week, course)) for week in weeks_of(course)]
    )


def _kept_line(report: WeekReport) -> str:
    """Return what wrong answers of a week still earn, and the one that earns most."""
    most = max(report.kept, key=lambda name: report.kept[name])
    count, middle = counted(len(report.kept), "wrong answer"), median(report.kept.values())
    top = f"{report.kept[most]:.2f} ({most})"
    return f"{report.week}: {count} keep {middle:.2f} of their task's points in the median, at most {top}"
