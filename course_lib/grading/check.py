"""`check(task, obj)` in a notebook: runs the student's object, judges it, shows why."""

import os
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from course_lib.course.exercise import current_identity
from course_lib.course.questions import show
from course_lib.course.state import last_check, save_check, student_state
from course_lib.errors import CourseError, join_words
from course_lib.grading.advice import Advice
from course_lib.grading.caught_errors import CaughtErrors
from course_lib.grading.evidence import Evidence
from course_lib.grading.inputs import personal_values
from course_lib.grading.judge import judge_task
from course_lib.grading.own_source import is_from_cell, source_of
from course_lib.grading.records import Run, TaskResult
from course_lib.grading.reports.rendering import Table
from course_lib.grading.run.outcome import printed_lines
from course_lib.grading.run.scenario import WALL_LIMIT, run_in_this_process
from course_lib.grading.submissions.notebook import NOT_SUBMITTED, CodeCell
from course_lib.grading.task import Catalog, Task, shipped_catalog
from course_lib.host import in_notebook
from course_lib.tools.resume import resumed_sources

STRICT = "COURSE_STRICT"
STUB = "raise NotImplementedError"
# [s] of the wall clock, for scenarios after one that has taken all of its time.
SHORT_LIMIT = 3.0
# Default of `subject`: None is a valid object to check.
MISSING = object()

# Hints advance step by step, so their state lasts as long as the kernel.
_ADVICE = Advice()
# In the grader's worker, `check` only records which object belongs to which task.
_bind: Callable[[str, Any], None] | None = None


class CheckFailedError(CourseError):
    """Raised by `check` with COURSE_STRICT=1 if a check does not pass."""


def check(task_id: str, subject: Any = MISSING) -> None:
    """Run your object through a task's public checks and show what passed, what failed, and why.

    Args:
        task_id: The task, "week01.post".
        subject: What the task requires: the node class itself, a function, a value or a string.

    Raises:
        CourseError: The task does not exist or no object was passed; or, with COURSE_STRICT=1, a
            check failed.
    """
    if _bind is not None:
        _bind(task_id, subject)
        return
    catalog, student = shipped_catalog(), current_identity()
    if not isinstance(task_id, str):
        # The example is for the task whose object was passed in place of the id, if there is one.
        name = getattr(task_id, "__name__", "")
        tasks = list(catalog.tasks.values())
        matching = [task for task in tasks if task.name == name] or tasks
        example = _call_text(matching[0]) if matching else 'check("week01.task", MyNode)'
        raise CourseError(f"{task_id!r} is not a task: pass its name first, like {example}")
    task = catalog.task(task_id)
    if subject is MISSING:
        raise CourseError(f"check needs your object as its second argument. Write: {_call_text(task)}")
    personal = personal_values(task, student)
    strict = os.environ.get(STRICT) == "1"
    source = source_of(subject, task.week)
    runs: list[Run] = []
    limit = WALL_LIMIT
    with CaughtErrors(source) as caught:
        for scenario in task.scenarios:
            record = run_in_this_process(task, scenario, subject, personal, wall_limit=limit)
            runs.append(Run(scenario, record))
            # An endless loop in one scenario also occurs in the others.
            limit = SHORT_LIMIT if record.stopped else limit
    result = judge_task(task, *catalog.points(task), runs)
    evidence = [run.evidence for run in runs]
    # Outside IPython there is no history of cells.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    history = getattr(shell, "history_manager", None)
    cells = [] if history is None else [*resumed_sources, *history.input_hist_raw]
    save_progress(task, result, cells, student)
    table = table_of(task, result, evidence, student, _ADVICE, source, caught)
    # Python files of the notebook's folder that were imported are not submitted with it.
    here = Path.cwd()
    paths = [
        getattr(module, "__file__", None) for name, module in sys.modules.copy().items() if name != "__main__"
    ]
    imported_files = sorted({Path(path).name for path in paths if path and Path(path).parent == here})
    own_files = map(NOT_SUBMITTED.format, imported_files)
    stale = stale_note(subject, cells)
    mix_up = [] if stale else _mix_up_note(catalog, task, result, subject, cells)
    # Hints about an older definition do not fit the student's newest code.
    notes = (*stale, *mix_up, *([] if stale else table.notes), *own_files)
    table = replace(table, next_step=next_step(catalog, task), notes=notes)
    show(lambda: table, str(table))
    if in_notebook() and task.ghost and not result.passed:
        # Imported late, because widgets are slow to load.
        from course_lib.grading.reports.scenes import show_ghost

        show_ghost(task, runs[0].evidence)
    if strict and not result.passed:
        raise CheckFailedError(str(table))


def bind_only(bind: Callable[[str, Any], None]) -> None:
    """Make `check` pass objects to `bind` instead of checking them; used in the grader's worker."""
    global _bind
    _bind = bind


def save_progress(task: Task, result: TaskResult, cells: Sequence[str], student: str | None) -> None:
    """Store a task's points, the cells run so far and the ID, in the student's folder."""
    state = student_state()
    state.put("progress", task.id, {"score": result.score, "of": result.points})
    passed = result.passed and not result.is_untouched
    defined, current, replaced = set[str](), set[str](), set[str]()
    for cell in reversed(cells):
        names = CodeCell(0, cell, True).bindings
        (replaced if names and names <= defined else current).add(cell)
        defined |= names
    replaced -= current
    save_check(state, task.id, passed=passed, cells=cells, student=student, replaced=replaced)


def next_step(catalog: Catalog, task: Task) -> str:
    """Return the sentence after a task that has passed: the next task, or how to hand in.

    Tasks that have passed are left out. After the last task, the sentence names the tasks before
    it that have not passed.
    """
    tasks, state = catalog.tasks_of_week(task.week), student_state()
    place = tasks.index(task)
    checks = [last_check(state, other.id) for other in tasks]
    open_places = [i for i, last in enumerate(checks) if i != place and not (last and last.passed)]
    following = next((i for i in open_places if i > place), None)
    if following is not None:
        _, is_bonus = catalog.points(tasks[following])
        title = tasks[following].title
        end = "" if title.endswith("?") else "."
        return f"Next is task {following + 1}{' for a bonus' if is_bonus else ''}: {title}{end}"
    still_open = join_words([f"task {i + 1}" for i in open_places])
    begin = f"Still open: {still_open}." if still_open else "All tasks have passed."
    return f"{begin} To hand in, type in a terminal: course submit {task.week}_exercise.ipynb"


def _mix_up_note(
    catalog: Catalog, task: Task, result: TaskResult, subject: Any, cells: Sequence[str]
) -> list[str]:
    """Return a line about an object of another task, or about an answer that a later cell replaced."""
    name = getattr(subject, "__name__", "")
    if result.passed or not isinstance(name, str):
        return []
    if name != task.name and name in [other.name for other in catalog.tasks.values()]:
        return [f"Hint: {name} belongs to another task. Write: {_call_text(task)}"]
    definition = re.compile(rf"^(class|def) {re.escape(name)}\b", re.MULTILINE)
    own = [cell for cell in cells if definition.search(cell)] if name else []
    if own and len(definition.findall(own[-1])) > 1:
        return [
            f"Hint: The cell defines {name} {len(definition.findall(own[-1]))} times, and only the "
            "last one counts: delete the others, and run the cell again."
        ]
    if result.is_untouched and any(STUB not in cell for cell in own):
        return [
            f"Hint: An earlier cell defines {name} without this line, and a later one has replaced "
            "it: delete the later cell, and run your own again."
        ]
    return []


def stale_note(subject: Any, cells: Sequence[str]) -> list[str]:
    """Return a hint if the newest cell that defines the object failed, so an older object is checked.

    Args:
        subject: The student's object.
        cells: The cells run so far, in the order of their runs.
    """
    name = getattr(subject, "__name__", "")
    if not isinstance(name, str) or not name.isidentifier():
        return []
    definition = re.compile(rf"^(async def|def|class)\s+{name}\b", re.MULTILINE)
    newest = next((cell for cell in reversed(cells) if definition.search(cell)), "")
    if not newest or is_from_cell(subject, newest):
        return []
    return [
        f"Hint: The newest cell with {name} ended with an error, so an older {name} was checked. "
        "Fix that error, run the cell again, then check."
    ]


def table_of(
    task: Task,
    result: TaskResult,
    evidence: Sequence[Evidence],
    student: str | None,
    advice: Advice,
    source: str = "",
    caught: CaughtErrors | None = None,
) -> Table:
    """Return the result as a table, with hints if a check failed.

    Args:
        task: The task.
        result: The verdicts of the checks.
        evidence: The evidence of the public scenarios.
        student: The student's ID, if it is known.
        advice: The state of the hints shown so far.
        source: The student's code.
        caught: The errors that the student's code caught.
    """
    notes = advice.notes(task, result, evidence, student, source, caught)
    return Table(result, tuple(notes), printed_lines(record.output for record in evidence))


def _call_text(task: Task) -> str:
    return f'check("{task.id}", {task.name})'
