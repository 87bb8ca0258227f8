"""`check(task, obj)` in a notebook: runs the student's object, judges it, shows why."""

import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

from course_lib.course.identity import current_identity
from course_lib.course.installation import first_lesson
from course_lib.course.questions import show
from course_lib.course.state import keep_check, student_state
from course_lib.errors import CourseError
from course_lib.grading.advice import Advice, large_messages, not_numbers, returned_none
from course_lib.grading.catalog import Catalog, shipped_catalog
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import TaskResult, judge_task
from course_lib.grading.personal import personal_values
from course_lib.grading.reports.table import Table
from course_lib.grading.run.job import Run
from course_lib.grading.run.outcome import printed
from course_lib.grading.run.student_side import run_here
from course_lib.grading.task import Task
from course_lib.surroundings import in_notebook

STRICT = "COURSE_STRICT"
FILL_IN = "Nothing is filled in yet: replace the line with raise NotImplementedError, then check again."
NO_ID = "No student ID is known, so your own values are a guest's. Type it into the form in {}."
MISSING = object()  # stands for an object that was not given

_ADVICE = Advice()  # of this kernel
_bind: Callable[[str, Any], None] | None = None  # set in the grader's worker


class CheckFailedError(CourseError):
    """A check that did not pass, raised with COURSE_STRICT=1."""


def check(task_id: str, subject: Any = MISSING) -> None:
    """Run your object through a task's public checks and show what passed, what did not, and why.

    Args:
        task_id: The task, "week01.post".
        subject: What the task asks for: the node class itself, a function, a value or a text.

    Raises:
        CourseError: There is no such task, or no object; or with COURSE_STRICT=1, a check failed.
    """
    if _bind is not None:
        _bind(task_id, subject)
        return
    catalog, student = shipped_catalog(), current_identity()
    if not isinstance(task_id, str):
        raise CourseError(
            f"{task_id!r} is not a task: write its name first, like {_example(catalog, task_id)}"
        )
    task = catalog.task(task_id)
    if subject is MISSING:
        raise CourseError(f"check needs your object as its second argument. Write: {_call(task)}")
    personal = personal_values(task, student)
    strict = os.environ.get(STRICT) == "1"
    runs = [Run(scenario, run_here(task, scenario, subject, personal)) for scenario in task.scenarios]
    result = judge_task(task, *catalog.points(task), runs)
    evidence = [run.evidence for run in runs]
    remember(task, result, _cells_of_this_kernel())
    shown = _ADVICE.reasons(result) if in_notebook() and not strict else result
    table = table_of(task, shown, evidence, student, _ADVICE)
    show(lambda: table, str(table))
    if in_notebook() and task.ghost and not result.passed:
        from course_lib.grading.reports.ghost_view import show_ghost  # here: widgets are slow to load

        show_ghost(task, runs[0].evidence)
    if strict and not result.passed:
        raise CheckFailedError(str(table))


def bind_only(bind: Callable[[str, Any], None]) -> None:
    """Hand objects to `bind` instead of checking them, in the grader's worker."""
    global _bind
    _bind = bind


def _cells_of_this_kernel() -> list[str]:
    """Return the sources of the cells that were run in this kernel; none outside of one."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    history = getattr(shell, "history_manager", None)
    return [] if history is None else list(history.input_hist_raw)


def remember(task: Task, result: TaskResult, cells: Sequence[str]) -> None:
    """Keep a task's points in the student's folder, and which cells had been run by then."""
    state = student_state()
    state.put("progress", task.id, {"score": result.score, "of": result.points})
    keep_check(state, task.id, passed=result.passed and not result.untouched, cells=cells)


def table_of(
    task: Task, result: TaskResult, evidence: Sequence[Evidence], student: str | None, advice: Advice
) -> Table:
    """Return the result as a table, with a hint if a check failed.

    Args:
        task: The task.
        result: What the checks say.
        evidence: What came out of the public scenarios.
        student: Who asks.
        advice: The hints that the student has seen.
    """
    notes = []
    if result.untouched:
        notes.append(FILL_IN)
    elif task.scenarios and not result.passed:
        notes += [*returned_none(task, evidence), *not_numbers(evidence), advice.hint(task, result)]
    if task.personal and student is None:
        notes.append(NO_ID.format(first_lesson()))
    notes += large_messages(evidence)
    return Table(result, tuple(notes), printed(one.output for one in evidence))


def _call(task: Task) -> str:
    return f'check("{task.id}", {task.name})'


def _example(catalog: Catalog, subject: Any) -> str:
    """Return the call for the task of which the object alone was given, else for the first task."""
    name = getattr(subject, "__name__", "")
    tasks = list(catalog.tasks.values())
    found = [task for task in tasks if task.name == name] or tasks
    return _call(found[0]) if found else 'check("week01.task", MyNode)'
