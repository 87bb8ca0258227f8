"""`course verify`: check everything about a week that can be checked before students use it."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from course_lib.authoring.deletions import Code, find_false_passes
from course_lib.authoring.edits import (
    RIGHT,
    Edit,
    failure_text,
    group_edits,
    idle_operators,
    make_edits,
    make_rehearsal,
    operators,
    read_answers,
)
from course_lib.authoring.new import template_picture, unchanged_files
from course_lib.authoring.rehearsal import (
    Rehearsal,
    RehearsalResult,
    cells_of,
    count_options,
    rehearse,
    with_option,
)
from course_lib.authoring.rules import ASPECTS, EXTRAS, Flaw, input_flaws, misspelled_names, page_flaws
from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import code_cells, exercise_from, notebook_text, read_notebook, source
from course_lib.course.material import CHOICE, course_package, lessons_dir
from course_lib.course.questions import read_questions
from course_lib.errors import CourseError, did_you_mean, format_count, location_of
from course_lib.files import write_atomically
from course_lib.grading.executors import executors
from course_lib.grading.judge import NEEDS_ANOTHER
from course_lib.grading.records import CheckResult, TaskResult
from course_lib.grading.store import Course, catalog_of, kit_digest
from course_lib.grading.task import Scenario, Task
from course_lib.third_party import read_json

if TYPE_CHECKING:
    from rich.table import Table

# Maximum fraction of a task's points that a publisher without content may earn.
MOST = 0.1
# Minimum number of wrong answers per task.
MIN_WRONG_ANSWERS = 2
Look = Callable[[RehearsalResult], Iterable[Flaw]]
# Identifies a check: task, scenario, number.
Key = tuple[str, str, int]


class WeekRehearsals:
    """The rehearsals of one week.

    Args:
        week: The week, like "week01".
        course: The course.
        pool: Executor that runs and judges the rehearsals.
    """

    def __init__(self, week: str, course: Course, pool: Executor) -> None:
        self._week, self._course, self._pool = week, course, pool
        self._tasks = [task for task in catalog_of(course).tasks_of_week(week) if not task.rubric]
        self._solution = course.solutions / f"{week}_solution.ipynb"
        self._exercise = course.exercises / f"{week}_exercise.ipynb"
        self._checks_file = str(course.exercises / "checks" / f"{week}.py")
        self._cells = cells_of(self._solution)
        self._answers = read_answers(course.solutions, week)
        # Fraction of the task's points that each wrong answer earns.
        self.earned_fractions: dict[str, float] = {}
        self._failed: set[Key] = set()
        self._checks: dict[Key, CheckResult] = {}
        # How a check raised an exception or ended its process, and on which answer, at first.
        self._broken: dict[Key, tuple[str, str]] = {}
        self._locations = {
            (task.id, scenario.name, number): check.origin.location
            for task in self._tasks
            for scenario in self._scenarios(task)
            for number, check in enumerate(scenario.checks)
            if check.origin
        }

    def flaws(self) -> Iterator[Flaw]:
        """Run all rehearsals and yield the flaws."""
        checks = r"^check\(\s*[\"'](\w+\.\w+)[\"']"
        checked_tasks = set(re.findall(checks, "\n".join(self._cells), re.MULTILINE))
        known_tasks = {task.id for task in catalog_of(self._course).tasks_of_week(self._week)}
        for name in sorted(checked_tasks - known_tasks):
            text = f"check({name!r}, …): there is no such task{did_you_mean(name, known_tasks, 3)}"
            yield Flaw("solution", text, str(self._solution))
        for name in sorted(known_tasks - checked_tasks):
            yield Flaw("solution", f"no cell calls check({name!r}, …)", str(self._solution))
        ids = tuple(task.id for task in self._tasks)
        solution = Rehearsal(self._week, "the solution", self._cells, ids, hollow=True)
        (rehearsal_result,) = self._run_rehearsals([solution])
        self._record_checks(rehearsal_result.results, solution.name)
        yield from self._check_solution(rehearsal_result)
        is_broken = any(check.broken for result in rehearsal_result.results for check in result.checks)
        if rehearsal_result.limit == "time" or is_broken:
            # All other answers would also take too long, or fail because of the same check.
            return
        edits = list(make_edits(self._tasks, self._answers, self._cells, operators(self._course.solutions)))
        yield from (edit for edit in edits if isinstance(edit, Flaw))
        groups = group_edits([edit for edit in edits if isinstance(edit, Edit)], self._cells, self._week)
        rehearsals = list(self._whole_rehearsals())
        rehearsals += [(rehearsal, partial(self._check_edits, group)) for group, rehearsal in groups]
        results = self._run_rehearsals([rehearsal for rehearsal, _ in rehearsals])
        for (rehearsal, look), rehearsal_result in zip(rehearsals, results, strict=True):
            self._record_checks(rehearsal_result.results, rehearsal.name)
            yield from look(rehearsal_result)
        for key, (answer, broken) in self._broken.items():
            text = f"{key[0]}: a check fails with an error on an answer ({answer}): {broken}"
            yield Flaw("wrong", text, self._location(key))
        for key, check in self._checks.items():
            if check.weight and key not in self._failed:
                text = f"{key[0]}, {_visibility(check)} {check.scenario!r}, {check.title!r}"
                yield Flaw("can fail", f"{text}: no answer fails it. Add one that does", self._location(key))
        yield from self._find_missing_answers()
        # Deletions with which the solution crashes, but passes all public checks.
        code = Code.from_notebook(self._solution)
        for name, task, why in find_false_passes(code, self._tasks, self._week, self._run_rehearsals):
            text = f"{task}: {name} the solution crashes ({why}), and all public checks pass"
            yield Flaw("wrong", f"{text}. Add a call or an input that needs it", str(self._solution))

    def _run_rehearsals(self, rehearsals: Sequence[Rehearsal]) -> Iterator[RehearsalResult]:
        return self._pool.map(rehearse, rehearsals, [self._course] * len(rehearsals))

    def _whole_rehearsals(self) -> Iterator[tuple[Rehearsal, Look]]:
        """Yield the rehearsals of whole notebooks: each option of the solution, the stub, answer files."""
        ids = tuple(task.id for task in self._tasks)
        plain = Rehearsal(self._week, "the solution", self._cells, ids, hollow=True)
        for row in range(1, count_options(self._tasks)):
            tasks = [task for task in self._tasks if count_options([task]) > row]
            rehearsal = replace(plain, tasks=tuple(task.id for task in tasks), option=row, hollow=False)
            yield rehearsal, partial(self._check_option, tasks, row)
        yield Rehearsal(self._week, "the stub", cells_of(self._exercise), ids), self._check_stub
        for name in [*[RIGHT] * bool(self._answers.other_right), *self._answers.files]:
            path = self._answers.file(name)
            look = self._check_right_answer if name == RIGHT else partial(self._check_wrong_answer, name)
            yield Rehearsal(self._week, path.name, cells_of(path), ids), look

    def _record_checks(self, results: Iterable[TaskResult], answer: str) -> None:
        for key, check in (row for result in results for row in _checks_by_key(result)):
            self._checks.setdefault(key, check)
            if check.broken:
                self._broken.setdefault(key, (answer, check.broken))
            if not check.passed and check.mistake != NEEDS_ANOTHER:
                self._failed.add(key)

    def _check_solution(self, rehearsal_result: RehearsalResult) -> Iterator[Flaw]:
        for error in rehearsal_result.cell_errors:
            yield Flaw("solution", f"a cell raises {error}", str(self._solution))
        for result in rehearsal_result.results:
            yield from self._check_full_marks("solution", "the solution", result, str(self._solution))
        types = {(task, topic): type_name for task, topic, type_name in rehearsal_result.types}
        for task in self._tasks:
            yield from misspelled_names(task, self._scenarios(task), types)
        for way, _, result in rehearsal_result.hollow:
            self._record_checks([result], f"the solution with {way}")
        for way, remedy, result in rehearsal_result.hollow:
            if result.fraction > MOST:
                earned = ", ".join(check.title for check in result.checks if check.passed and check.weight)
                text = f"{result.task}: {way}: {result.score:g} of {result.points:g} points, for: {earned}"
                yield Flaw("empty", f"{text}. Remedy: {remedy}", self._checks_file)

    def _check_option(
        self, tasks: Sequence[Task], row: int, rehearsal_result: RehearsalResult
    ) -> Iterator[Flaw]:
        for task, result in zip(tasks, rehearsal_result.results, strict=True):
            values = {name: choice for name, (choice,) in with_option(task, row).personal.items()}
            yield from self._check_full_marks(
                "solution", f"the solution with {values}", result, str(self._solution)
            )

    def _check_full_marks(
        self,
        aspect: str,
        subject: str,
        result: TaskResult,
        place: str,
    ) -> Iterator[Flaw]:
        """Yield a flaw for a task without full marks, located at the first failing check."""
        if result.score < result.points or not result.passed:
            failing = [(key, check) for key, check in _checks_by_key(result) if not check.passed]
            why = [
                f"{_visibility(c)} {c.scenario!r}, {c.title!r}: {c.broken or c.message}"
                for _, c in failing[:2]
            ]
            text = "; ".join([*result.errors[:1], *why])
            at = place if result.errors or not failing else self._location(failing[0][0])
            score = f"{result.score:g} of {result.points:g} points"
            yield Flaw(aspect, f"{result.task}: {subject} has {score}: {text}", at)

    def _location(self, key: Key) -> str:
        return self._locations.get(key, self._checks_file)

    def _check_stub(self, rehearsal_result: RehearsalResult) -> Iterator[Flaw]:
        for result in rehearsal_result.results:
            earned = [check.title for check in result.checks if check.score and check.weight]
            if result.score:
                text = (
                    f"{result.task}: the empty exercise has {result.score:g} points, for: {', '.join(earned)}"
                )
                yield Flaw("stub", text, str(self._exercise))
            elif "NotImplementedError" not in "".join(result.errors):
                text = f"{result.task}: the stub does not raise NotImplementedError: is # solution: missing?"
                yield Flaw("stub", text, str(self._solution))

    def _check_right_answer(self, rehearsal_result: RehearsalResult) -> Iterator[Flaw]:
        path = self._answers.file(RIGHT)
        for result in rehearsal_result.results:
            yield from self._check_full_marks("second", path.name, result, str(path))

    def _check_wrong_answer(self, name: str, rehearsal_result: RehearsalResult) -> Iterator[Flaw]:
        for result in rehearsal_result.results:
            says = self._answers.files[name].get(result.task)
            place = location_of(self._answers.path, says or "")
            if says is None:
                continue
            self.earned_fractions[f"{result.task}: {name}"] = result.fraction
            is_full = result.score >= result.points
            if result.errors or is_full or not failure_text(result, is_hidden=True):
                outcome = [*result.errors, f"{result.score:g} of {result.points:g} points"][0]
                text = f"{result.task}: {name}: {outcome}, expected failing public and hidden checks"
                yield Flaw("wrong", text, place)
            elif says not in failure_text(result):
                text = f"{result.task}: {name}: expected a message with {says!r}, the checks report: "
                yield Flaw("wrong", text + failure_text(result).splitlines()[0], place)

    def _check_edits(
        self,
        group: Sequence[Edit],
        rehearsal_result: RehearsalResult,
    ) -> Iterator[Flaw]:
        """Yield the flaws of each edit in a notebook.

        An edit with flaws is run again on its own first, because the other edits may have affected
        it.
        """
        for edit, result in zip(group, rehearsal_result.results, strict=True):
            flaws, last = list(edit.look(result)), result
            if flaws and len(group) > 1:
                single = make_rehearsal([edit], self._cells, self._week)
                (single_result,) = self._run_rehearsals([single])
                self._record_checks(single_result.results, single.name)
                (last,) = single_result.results
                flaws = list(edit.look(last))
            if not edit.is_right:
                self.earned_fractions[edit.name] = last.fraction
            yield from flaws

    def _find_missing_answers(self) -> Iterator[Flaw]:
        ways = {variant.task for variant in self._answers.variants if variant.way}
        hints = {(variant.task, variant.hint) for variant in self._answers.variants}
        for task in self._tasks:
            count, path = self._answers.count_wrong_answers(task.id), str(self._answers.path)
            if count < MIN_WRONG_ANSWERS:
                text = f"{task.id}: {count} wrong answers, expected at least {MIN_WRONG_ANSWERS}"
                yield Flaw("wrong", text, path)
            if self._answers.other_right is None and task.id not in ways:
                yield Flaw("second", f"{task.id}: no alternative correct answer: add one with way = …", path)
            for kind in task.mistakes:
                if (task.id, kind) not in hints:
                    text = f"{task.id}: no wrong answer with hint = {kind!r}: is this hint ever shown?"
                    yield Flaw("wrong", text, path)
            titles = Counter(check.title for scenario in task.scenarios for check in scenario.checks)
            for title in (title for title, number in titles.items() if number > 1):
                yield Flaw("files", f"{task.id}: two public checks are titled {title!r}", self._checks_file)

    def _scenarios(self, task: Task) -> tuple[Scenario, ...]:
        return task.scenarios + catalog_of(self._course).hidden.get(task.id, ())


def _checks_by_key(result: TaskResult) -> Iterator[tuple[Key, CheckResult]]:
    """Yield the checks of a task with their keys. The number is the index in the scenario."""
    numbers = Counter[str]()
    for check in result.checks:
        yield (result.task, check.scenario, numbers[check.scenario]), check
        numbers[check.scenario] += 1


def _visibility(check: CheckResult) -> str:
    return "hidden" if check.is_hidden else "public"


# Wall-clock limit of one lesson [s]. The kit's longest lesson takes 20 s.
SECONDS = 300
COLOR = re.compile(r"\x1b\[[0-9;]*m")
ERROR = re.compile(r"^(?:[\w.]*(?:Error|Exception|Interrupt|Exit|Warning)\b.*|error: .*)$", re.MULTILINE)
# IPython's marker of the line that raised an exception.
FAILED_LINE = re.compile(r"^-+> (\d+) (.*)$", re.MULTILINE)


def run_lesson(path: Path, seconds: float = SECONDS) -> list[Flaw]:
    """Run a lesson in a separate process and return its error, if any.

    Args:
        path: The notebook. Modules in its folder are copied with it.
        seconds: Time limit, [s].
    """
    with tempfile.TemporaryDirectory(prefix="lesson_") as folder:
        for file in (path, *path.parent.glob("week*.py")):
            shutil.copy(file, folder)
        command = [sys.executable, "-P", "-m", "course_lib", "run", path.name]
        environment = {**os.environ, "COURSE_STRICT": "0", CHOICE: course_package().name}
        try:
            process = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=seconds
            )
        except subprocess.TimeoutExpired:
            text = f"it does not end within {seconds:g} s: is there an infinite loop?"
            return [Flaw("lesson", text, str(path))]
    output = COLOR.sub("", f"{process.stdout}\n{process.stderr}")
    if process.returncode == 0 and "Traceback (most recent call last)" not in output:
        return []
    return [Flaw("lesson", _last_error(path, output, process.returncode), str(path))]


def _last_error(path: Path, output: str, code: int) -> str:
    """Return the last error in a lesson's output, with its line and cell as in JupyterLab."""
    errors = ERROR.findall(output)
    error = errors[-1] if errors else f"exit code {code}"
    for line, text in reversed(FAILED_LINE.findall(output)):
        for number, cell in code_cells(read_notebook(path)):
            lines = source(cell).splitlines()
            if int(line) <= len(lines) and lines[int(line) - 1].strip() == text.strip():
                return f"cell {number}, line {line} ({text.strip()}) ends with {error}"
    return f"a cell ends with {error}"


# Placeholder in the templates.
PLACEHOLDER = "REPLACE"
# The aspects that are checked for the extras.
OF_EXTRAS = {"lesson", "quiz", "wrong"}
# Aspects that cannot be checked if files of the week are missing or invalid.
UNKNOWN = frozenset({"fields", "solution", "stub", "empty", "second", "wrong", "can fail"})


@dataclass(frozen=True)
class WeekReport:
    """One row of the table.

    Args:
        week: "week01", or EXTRAS.
        flaws: The flaws that were found.
        unchecked: The aspects that could not be checked.
        placeholders: Number of remaining template placeholders by file.
        earned_fractions: Fraction of the task's points that each wrong answer earns.
    """

    week: str
    flaws: tuple[Flaw, ...]
    unchecked: frozenset[str] = frozenset()
    placeholders: Mapping[str, int] = field(default_factory=dict)
    earned_fractions: Mapping[str, float] = field(default_factory=dict)

    @property
    def placeholder_count(self) -> int:
        """The number of remaining template placeholders."""
        return sum(self.placeholders.values())

    def cell(self, aspect: str) -> str:
        """Return the symbol for an aspect: passed, failed or skipped."""
        if any(flaw.aspect == aspect for flaw in self.flaws):
            return "✘"
        return "." if aspect in self.unchecked else "✔"


def verify(
    course: Course,
    weeks: Sequence[str] = (),
    jobs: int | None = None,
) -> Iterator[WeekReport]:
    """Verify weeks one after the other. A broken week does not affect the others.

    Args:
        course: The course.
        weeks: "week01", …; default: all weeks of course.toml, then the extras.
        jobs: Number of notebooks run in parallel; default: the number of processors.

    Raises:
        CourseError: course.toml cannot be read, or a week does not exist.
    """
    known_weeks = weeks_of(course)
    for week in weeks:
        if week not in known_weeks:
            suggestion = did_you_mean(week, known_weeks) or f", known: {', '.join(known_weeks)}"
            raise CourseError(f"there is no {week} in {course.exercises / 'course.toml'}{suggestion}")
    with executors(jobs or os.cpu_count() or 1, None) as (pool, _, _):
        for week in weeks or known_weeks:
            runs = _start_lessons(f"{week}_*.ipynb", course, pool)
            report = _verify_week(week, course, pool)
            flaws = (*report.flaws, *(flaw for run in runs for flaw in run.result()))
            yield replace(report, flaws=flaws, placeholders=_count_placeholders(week, course))
        runs = [] if weeks else _start_lessons("extra_*.ipynb", course, pool)
        ran = [flaw for run in runs for flaw in run.result()]
    if not weeks and (flaws_of_extras := [*page_flaws(EXTRAS, course), *_idle_mutants(course), *ran]):
        yield WeekReport(EXTRAS, tuple(flaws_of_extras), frozenset(ASPECTS) - OF_EXTRAS)


def _start_lessons(pattern: str, course: Course, pool: Executor) -> list["Future[list[Flaw]]"]:
    """Start the lessons that match a pattern, if the course is the installed one.

    Lessons of another course would use the quizzes of the installed one.
    """
    if not course.lessons.is_dir() or course.lessons.resolve() != lessons_dir().resolve():
        return []
    return [pool.submit(run_lesson, path) for path in sorted(course.lessons.glob(pattern))]


def weeks_of(course: Course) -> list[str]:
    """Return the weeks in course.toml, and the weeks that only have a check file."""
    course_file = read_course_file(course.exercises / "course.toml")
    check_files = (path.stem for path in (course.exercises / "checks").glob("week*.py"))
    return sorted({*course_file.weeks, *course_file.faults, *check_files})


def _verify_week(week: str, course: Course, pool: Executor) -> WeekReport:
    flaws = [*page_flaws(week, course)]
    for path in sorted((course.exercises / "quizzes").glob(f"{week}*.toml")):
        for kind in ("question", "prediction"):
            try:
                read_questions(path, kind)
            except CourseError as error:
                flaws.append(Flaw("quiz", str(error)))
    flaws += _check_exercise(week, course)
    try:
        tasks = catalog_of(course).tasks_of_week(week)
        if not tasks:
            return WeekReport(week, tuple(flaws), UNKNOWN)
        notebooks = {
            course.solutions / f"{week}_solution.ipynb": f"write it, or begin with: course new {week}",
            course.exercises / f"{week}_exercise.ipynb": "python -m course_lib.course.exercise generates it",
        }
        flaws_of_files = [
            Flaw("files", f"missing: {how}", str(path))
            for path, how in notebooks.items()
            if not path.is_file()
        ]
        flaws_of_files += input_flaws(week, course)
        if not flaws_of_files:
            rehearsals = WeekRehearsals(week, course, pool)
            flaws += rehearsals.flaws()
            return WeekReport(week, tuple(flaws), earned_fractions=rehearsals.earned_fractions)
    except CourseError as error:
        flaws_of_files = [Flaw("files", str(error))]
    return WeekReport(week, (*flaws_of_files, *flaws), UNKNOWN)


def _idle_mutants(course: Course) -> Iterator[Flaw]:
    """Yield a flaw for each of the course's own mutation operators that matches no solution."""
    path = course.solutions / "answers" / "mutants.toml"
    # Each week reports its unreadable files.
    with suppress(CourseError):
        cells = [cell for path in course.solutions.glob("*_solution.ipynb") for cell in cells_of(path)]
        for name in idle_operators(course.solutions, cells):
            yield Flaw(
                "wrong",
                f"the pattern of the mutant {name!r} does not match any solution",
                location_of(path, name),
            )


def _check_exercise(week: str, course: Course) -> Iterator[Flaw]:
    """Yield a flaw if the exercise differs from the generated one."""
    solution = course.solutions / f"{week}_solution.ipynb"
    exercise = course.exercises / f"{week}_exercise.ipynb"
    if not (solution.is_file() and exercise.is_file()):
        return
    try:
        expected_text = notebook_text(exercise_from(read_notebook(solution)))
    except CourseError as error:
        yield Flaw("fresh", str(error), str(solution))
        return
    if exercise.read_text(encoding="utf-8") != expected_text:
        how = "python -m course_lib.course.exercise writes it again"
        yield Flaw("fresh", f"it differs from the exercise that the solution generates: {how}", str(exercise))


def table(reports: Sequence[WeekReport]) -> "Table":
    """Return the results as a table: a row per week, a column per aspect."""
    from rich.table import Table

    # The padding is chosen so that the table fits into 80 columns.
    rows = Table("week", *ASPECTS, box=None, padding=(0, 1, 0, 0), pad_edge=False)
    for report in reports:
        rows.add_row(report.week, *(report.cell(aspect) for aspect in ASPECTS))
    return rows


def _count_placeholders(week: str, course: Course) -> dict[str, int]:
    """Count the remaining template placeholders by file.

    Placeholders in metadata are counted separately, because JupyterLab does not show metadata.
    """
    tops = [course.lessons, course.exercises / "quizzes", course.exercises / "mistakes", course.solutions]
    tops += [course.exercises / "checks", course.solutions / "checks", course.solutions / "answers"]
    files = [path for top in tops for path in top.glob(f"{week}*") if path.is_file()]
    counts = dict[str, int]()
    for path in files:
        text = path.read_text(encoding="utf-8", errors="replace")
        cells, _, metadata = text.rpartition('\n "metadata": {')
        counts[f"{path}, in its metadata"] = metadata.count(PLACEHOLDER) if cells else 0
        counts[str(path)] = (cells or metadata).count(PLACEHOLDER)
        counts[f"{path}, its picture, which is the template's"] = text.count(template_picture())
    unchanged = (path for path in unchanged_files(week, course) if not counts[str(path)])
    counts |= {f"{path}, which is the template's": 1 for path in unchanged}
    return {place: count for place, count in counts.items() if count}


def lines(reports: Sequence[WeekReport], course: Course) -> list[str]:
    """Return a line for each flaw, with paths relative to the course's folder, and a summary."""
    top = f"{course.exercises.parent}{os.sep}"
    flaws = [f"{report.week}, {flaw.aspect}: {flaw}" for report in reports for flaw in report.flaws]
    output = [flaw.replace(top, "") for flaw in flaws]
    output += _open_question_lines(reports)
    output += [
        f"{place}: {count} {PLACEHOLDER}".replace(top, "")
        for r in reports
        for place, count in r.placeholders.items()
    ]
    for report in (report for report in reports if report.earned_fractions):
        # The median and the maximum of the points that wrong answers earn.
        name, kept = max(report.earned_fractions.items(), key=lambda item: item[1])
        count = format_count(len(report.earned_fractions), "wrong answer")
        middle = median(report.earned_fractions.values())
        output.append(
            f"{report.week}: {count} keep {middle:.2f} of their task's points in the median, "
            f"at most {kept:.2f} ({name})"
        )
    aspects: Mapping[str, str] = {f.aspect: ASPECTS[f.aspect] for r in reports for f in r.flaws}
    requirements = [f"{aspect}: {text}" for aspect, text in aspects.items()]
    week_count = sum(bool(report.flaws) for report in reports)
    end = (
        f"{format_count(week_count, 'week')} of {len(reports)} not ready."
        if week_count
        else "Everything is correct."
    )
    return [*output, *["What must hold:"] * bool(requirements), *requirements, end]


def _open_question_lines(reports: Iterable[WeekReport]) -> list[str]:
    return [
        f"{r.week}: {format_count(r.placeholder_count, 'place')} of the template left, look for {PLACEHOLDER}"
        for r in reports
        if r.placeholder_count
    ]


def report_placeholders(course: Course) -> list[str]:
    """Return a line for each week that still contains template placeholders."""
    return _open_question_lines(
        [WeekReport(week, (), placeholders=_count_placeholders(week, course)) for week in weeks_of(course)]
    )


# The file next to exercises/ that stores the digests of weeks without flaws.
DIGESTS_FILE = ".verified.json"
# Maximum number of lines in the error of `reject_broken`.
MOST_SHOWN = 10


def save_digests(course: Course, reports: Iterable[WeekReport]) -> None:
    """Save the digests of the weeks without flaws."""
    sound = [digest_of_week(course, report.week) for report in reports if not report.flaws]
    known_digests = [digest for digest in _read_digests(course) if digest not in sound]
    text = json.dumps([*known_digests, *sound][-200:], indent=0)
    write_atomically(course.exercises.parent / DIGESTS_FILE, text.encode())


def reject_broken(course: Course, tell: Callable[[str], object] = lambda _: None) -> None:
    """Verify the weeks that have changed since their last verification.

    Args:
        course: The course.
        tell: Called with a line before each week, because a week can take minutes.

    Raises:
        CourseError: A week has flaws.
    """
    known_digests = _read_digests(course)
    changed_weeks = [week for week in weeks_of(course) if digest_of_week(course, week) not in known_digests]
    reports = list[WeekReport]()
    for number, week in enumerate(changed_weeks, 1):
        tell(f"verifying {week} ({number} of {len(changed_weeks)}), which can take minutes …")
        for report in verify(course, [week]):
            reports.append(report)
            for flaw in report.flaws[:1]:
                tell(f"{week}: {format_count(len(report.flaws), 'flaw')}. {flaw.aspect}: {flaw}")
    save_digests(course, reports)
    reports.append(WeekReport(EXTRAS, tuple(page_flaws(EXTRAS, course))))
    broken_reports = [report for report in reports if report.flaws]
    if broken_reports:
        problems = lines(broken_reports, course)
        summary = " | ".join(problems[:MOST_SHOWN])
        raise CourseError(f"nothing was released. {summary} … To see all flaws, run: course verify")


def digest_of_week(course: Course, week: str) -> str:
    """Return the digest of all files that verify a week, including earlier lessons."""
    lessons = [path for path in course.lessons.glob("week*") if path.name[:6] <= week]
    files_of_week = [path for top in (course.exercises, course.solutions) for path in top.rglob(f"{week}*")]
    shared = [course.exercises / "course.toml", course.solutions / "answers" / "mutants.toml"]
    total = hashlib.sha256(f"{kit_digest()} {week}".encode())
    for path in sorted({*lessons, *files_of_week, *shared}):
        if path.is_file() and path.suffix != ".pyc":
            total.update(path.name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def _read_digests(course: Course) -> list[str]:
    with suppress(OSError, ValueError):
        digests = read_json((course.exercises.parent / DIGESTS_FILE).read_text(encoding="utf-8"))
        return [d for d in digests if isinstance(d, str)] if isinstance(digests, list) else []
    return []
