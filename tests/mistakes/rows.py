"""The tables of typical mistakes: each with the lines that a student sees.

A row of an exercise changes the solution of one task and runs its public checks in this process; a row of
week 0 runs a cell. Equal code gets equal lines, so a table is written once and compared afterwards. The
mistakes in `strangers/` have tables of their own. A row of `lessons/` changes a cell of a review or of the
extra lesson, and shows what the lesson then prints.
"""

import io
import re
import tomllib
import warnings
from collections.abc import Iterable, Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cache, partial
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

from course_lib.authoring.edits import apply_changes, read_answers
from course_lib.course.material import solutions_dir
from course_lib.errors import CourseError
from course_lib.grading.advice import Advice
from course_lib.grading.caught_errors import CaughtErrors
from course_lib.grading.check import table_of
from course_lib.grading.judge import judge_task
from course_lib.grading.own_source import source_of
from course_lib.grading.records import Run
from course_lib.grading.reports.rendering import ALL_PASSED, FOR_A_PERSON
from course_lib.grading.run.outcome import describe
from course_lib.grading.run.scenario import ScenarioGraph
from course_lib.grading.task import Task
from tests.mistakes.cells import CELLS, LESSONS, lesson_mistakes, seen_in_cell
from tests.notebooks.graded import STUDENT, WEEKS, catalog, cells_of, defined, evidence_here, solution

HERE = Path(__file__).parent
LEAST = 30  # rows of a week
MOST = 34  # rows of a week, without the mistakes of strangers
LONGEST = 400  # characters of a line
# [s] as in grading. An endless loop takes that long; each other mistake takes a tenth of a second.
WALL_LIMIT = 10.0
# [B] of evidence. A mistake that multiplies its messages takes 20 s to exceed the limit of a
# submission.
EVIDENCE_LIMIT = 2**20
# Kinds of tasks whose object is made by the definition of a class or a function.
KINDS = ("node", "function", "launch")


@dataclass(frozen=True)
class Mistake:
    """A mistake: location, description and code."""

    where: str
    what: str
    code: str


def mistakes_of(week: str) -> list[Mistake]:
    """Return the mistakes of an exercise: the edits that fit any task, then the wrong answers of the week."""
    tasks = [task for task in catalog().tasks_of_week(week) if task.kind in KINDS and _cell_of(task)]
    return [*_edits(tasks), *_wrong_answers(week, tasks)]


def _edits(tasks: list[Task]) -> Iterator[Mistake]:
    table = tomllib.loads((HERE / "edits.toml").read_text(encoding="utf-8"))["edit"]
    used = dict.fromkeys((task.id for task in tasks), 0)
    for edit in table:
        # The task with the fewest rows comes first, so that all tasks of the week occur.
        for task in sorted(tasks, key=lambda one: used[one.id]):
            code = _cell_of(task)
            new = re.sub(edit["find"], edit["put"], code, count=1)
            if new != code:
                used[task.id] += 1
                yield Mistake(task.id, edit["mistake"], new)
                break


def _wrong_answers(week: str, tasks: list[Task]) -> Iterator[Mistake]:
    """Yield wrong answers of the week, one of each task in turn."""
    cells, by_task = cells_of(solution(week)), {task.id: task for task in tasks}
    waiting: dict[str, list[Mistake]] = {task.id: [] for task in tasks}
    for variant in read_answers(solutions_dir(), week).variants:
        if variant.miss and variant.task in by_task:
            try:
                new = apply_changes(variant, by_task[variant.task].name, cells)
            except CourseError:
                continue
            code = _cell_of(by_task[variant.task])
            if len(new) == 1 and cells[next(iter(new))] == code:
                waiting[variant.task].append(Mistake(variant.task, variant.miss, next(iter(new.values()))))
    while any(waiting.values()):
        for rows in waiting.values():
            if rows:
                yield rows.pop(0)


def _cell_of(task: Task) -> str:
    """Return the cell of the solution that defines a task's object, or ""."""
    return _definition(task.week, task.name)


@cache
def _definition(week: str, name: str) -> str:
    start = re.compile(rf"^(class|def) {name}\b", re.MULTILINE)
    return next((cell for cell in cells_of(solution(week)) if start.search(cell)), "")


def mistakes_of_strangers(week: str) -> list[Mistake]:
    """Return the mistakes that readers of the lesson made, from `strangers/`."""
    table = tomllib.loads((HERE / "strangers" / f"{week}.toml").read_text(encoding="utf-8"))
    found = []
    for name, part in table.items():
        task = catalog().task(f"{week}.{name}")
        for what, *changes in part["rows"]:
            code = _cell_of(task)
            for old, new in changes:
                if old not in code:
                    raise ValueError(f"{task.id}, {what}: the cell of the solution does not contain {old!r}")
                code = code.replace(old, new, 1)
            found.append(Mistake(task.id, what, code))
    return found


def seen(mistake: Mistake) -> list[str]:
    """Return the lines that `check` shows for a mistake, without the checks that pass."""
    task = catalog().task(mistake.where)
    cells = [
        mistake.code if cell == _cell_of(task) else cell
        for cell in cells_of(solution(task.week))
        if not re.search(r"^(check\(|%)", cell, re.MULTILINE) or cell.startswith("%load_ext")
    ]
    # Python prints a warning once per process, and pytest keeps it to itself.
    quiet = warnings.catch_warnings(action="ignore")
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()), quiet:
        try:
            namespace = defined(cells, task.week)
        except (Exception, SystemExit) as error:
            return [describe(error)]
        small = partial(ScenarioGraph, room=EVIDENCE_LIMIT)
        source = source_of(namespace[task.name], task.week)
        graph = patch("course_lib.grading.run.scenario.ScenarioGraph", small)
        with graph, CaughtErrors(source) as caught:
            runs = [Run(one, evidence_here(task, one, namespace, WALL_LIMIT)) for one in task.scenarios]
    result = judge_task(task, *catalog().points(task), runs)
    evidence = [run.evidence for run in runs]
    shown = str(table_of(task, result, evidence, STUDENT, Advice(), source, caught))
    return [line for line in shown.splitlines()[1:] if " ✓ " not in f" {line} "]


def table(week: str) -> str:
    """Return the table of a week as text."""
    # Answers write layouts and launch files where they run.
    with TemporaryDirectory() as folder, chdir(folder):
        if week == "week00":
            return cells_table()
        return _lesson_table(week) if week in LESSONS else _exercise_table(week)


def _exercise_table(week: str) -> str:
    if week in STRANGERS:
        found = _rows(mistakes_of_strangers(week.removesuffix("_strangers")))
    else:
        found = islice(_rows(mistakes_of(week)), MOST)
    by_task: dict[str, list[str]] = {}
    for task, row in found:
        by_task.setdefault(task, []).append(row)
    rows = [row for task in by_task.values() for row in task]
    return "\n".join([f"{len(rows)} typical mistakes of {week}, and what the student sees.\n", *rows])


def _rows(mistakes: Iterable[Mistake]) -> Iterator[tuple[str, str]]:
    """Yield the task and the row of each mistake that fails a check."""
    for mistake in mistakes:
        # Memory addresses and the temporary folder differ between runs.
        stable = (
            re.sub(r"0x[0-9a-f]{6,}", "0x…", line.replace(str(Path.cwd()), ".")) for line in seen(mistake)
        )
        lines = [line.strip()[:LONGEST] for line in stable]
        # An edit may leave correct code, such as a new name of a topic that no check requires.
        if {ALL_PASSED, FOR_A_PERSON}.isdisjoint(lines):
            row = "\n".join([f"{mistake.where}: {mistake.what}", *(f"    {line}" for line in lines)])
            yield mistake.where, f"{row}\n"


def path_of(week: str) -> Path:
    """Return the file of a week's table."""
    return HERE / "tables" / f"{week}.txt"


def cells_table() -> str:
    """Return the table of week 0 as text."""
    parts = [
        f"{len(CELLS)} typical mistakes of week00 and of cells in any lesson, and what the student sees.\n"
    ]
    for what, code in CELLS:
        lines = "\n".join(f"    {line.strip()[:LONGEST]}" for line in seen_in_cell(code))
        parts.append(f"{what}: {code}\n{lines}\n")
    return "\n".join(parts)


def _lesson_table(lesson: str) -> str:
    """Return the table of a lesson's cells as text."""
    found = lesson_mistakes(lesson)
    parts = [f"{len(found)} typical mistakes in {lesson}, and what the student sees.\n"]
    for what, code, shown in found:
        lines = "\n".join(f"    {line.strip()[:LONGEST]}" for line in shown)
        parts.append(f"{what}: {code.replace(chr(10), ' ⏎ ')}\n{lines}\n")
    return "\n".join(parts)


STRANGERS = [f"{path.stem}_strangers" for path in sorted((HERE / "strangers").glob("*.toml"))]
ALL = ["week00", *LESSONS, *WEEKS, *STRANGERS]
