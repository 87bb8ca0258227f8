"""Rehearsals: an author's notebooks, run in the sandbox and judged like submissions."""

import math
import re
from array import array
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from course_lib.course.exercise import code_cells, read_notebook, source
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import judge_in_child, judge_task
from course_lib.grading.records import Run, TaskResult
from course_lib.grading.run.run import Job, plan_scenarios, run, unpack
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.task import Catalog, Task
from course_lib.ros.graph.graph import Sample
from course_lib.ros.messages import serialize, type_name

HEADER = "std_msgs/msg/Header"
# Not set to zero, because its default is the identity rotation.
ORIENTATION = "geometry_msgs/msg/Quaternion"
NAMED = ("type", "ns", "id", "name", "joint_names", "child_frame_id", "action", "lifetime")
Change = Callable[[Any], None]


@dataclass(frozen=True)
class Hollowing:
    """A way to remove the content of messages while they are still published at the right times.

    Args:
        name: A description for messages.
        filter_samples: Returns the hollowed samples.
        remedy: Advice for the author if the hollowed samples still earn points.
    """

    name: str
    filter_samples: Callable[[Sequence[Sample]], list[Sample]]
    remedy: str = "let these checks require the check of the content: check.requiring(content)"

    def apply(self, evidence: Evidence) -> Evidence:
        """Return the evidence with hollowed samples."""
        return replace(evidence, samples=tuple(self.filter_samples(evidence.samples)))


def _nested_messages(message: Any) -> list[Any]:
    """Return the messages nested in the fields of a message."""
    values = [getattr(message, name) for name in message._KINDS]
    nested = [item for value in values for item in (value if isinstance(value, list) else [value])]
    return [item for item in nested if hasattr(item, "_KINDS")]


def _reset_fields(message: Any, *, names: Sequence[str]) -> None:
    """Set all fields to their defaults, except headers and the fields in `names`.

    Lists of messages keep their length.
    """
    if type_name(message) == HEADER:
        return
    default = type(message)()
    for name in message._KINDS:
        value = getattr(message, name)
        nested = isinstance(value, list) and any(hasattr(item, "_KINDS") for item in value)
        if not nested and not hasattr(value, "_KINDS") and name not in names:
            blank = getattr(default, name)
            if isinstance(value, np.ndarray):
                blank = np.zeros_like(value)
            elif isinstance(value, array):
                blank = array(value.typecode, [0] * len(value))
            setattr(message, name, blank)
    for part in _nested_messages(message):
        _reset_fields(part, names=names)


def _zero_floats(message: Any) -> None:
    """Set all floating-point numbers to 0."""
    if type_name(message) in (HEADER, ORIENTATION):
        return
    for name in message._KINDS:
        value = getattr(message, name)
        if isinstance(value, float):
            setattr(message, name, 0.0)
        elif isinstance(value, array) and value.typecode in "fd":
            setattr(message, name, array(value.typecode, [0.0] * len(value)))
    for part in _nested_messages(message):
        _zero_floats(part)


def _zero_components(message: Any, *, field: str, parts: str) -> None:
    """Set components of a field to 0 in a message and all nested messages."""
    for part in parts:
        if field in message._KINDS and part in getattr(message, field)._KINDS:
            setattr(getattr(message, field), part, 0.0)
    for item in _nested_messages(message):
        _zero_components(item, field=field, parts=parts)


def _change_samples(samples: Sequence[Sample], change: Change) -> list[Sample]:
    changed_samples = []
    for sample in samples:
        message = sample.message()
        change(message)
        changed_samples.append(replace(sample, cdr=serialize(message)))
    return changed_samples


def _last_samples(samples: Sequence[Sample]) -> list[Sample]:
    return [sample for sample in samples if sample.stamp_ns == samples[-1].stamp_ns]


ALL_THE_TIME = (
    "let these checks require messages all the time: "
    "check.requiring(expect_throughout(topic).worth(0)), or expect_topic(topic, type, at_least=5)"
)
CHANGES: dict[str, Change] = {
    "headers only": partial(_reset_fields, names=()),
    "types, names and headers only": partial(_reset_fields, names=NAMED),
    "zeros for numbers": _zero_floats,
    "invisible: alpha 0": partial(_zero_components, field="color", parts="a"),
    "invisible: scale 0": partial(_zero_components, field="scale", parts="xyz"),
}
HOLLOWINGS = (
    *(Hollowing(name, partial(_change_samples, change=change)) for name, change in CHANGES.items()),
    Hollowing("one message at the end", _last_samples, ALL_THE_TIME),
)


STUDENT = "author"
# Maximum number of combinations of a task's personal options that are tried.
MOST = 100
DEFINES = re.compile(r'(class|def|import|from|[A-Z_]+ =|"""|#|@|%load_ext)')
CHECKS = re.compile(r"^check\(", re.MULTILINE)
TRACEBACK = "Traceback (most recent call last)"
# Kinds of tasks that only need cells with definitions.
ONLY_DEFINED = ("node", "function", "launch")


@dataclass(frozen=True)
class Rehearsal:
    """A notebook to run and judge.

    Args:
        week: The week.
        name: A description, like "the solution" or "the stub".
        cells: The source of the code cells.
        tasks: The ids of the tasks to run.
        with_hidden: Whether the hidden scenarios are run as well.
        option: Index of the personal options, modulo each task's number of options.
        hollow: Whether the hollowed samples are judged as well.
    """

    week: str
    name: str
    cells: tuple[str, ...]
    tasks: tuple[str, ...]
    with_hidden: bool = True
    option: int = 0
    hollow: bool = False


@dataclass(frozen=True)
class RehearsalResult:
    """The results of a rehearsal.

    Args:
        results: The results of the tasks, in order.
        cell_errors: The exceptions raised by cells.
        hollow: (hollowing, remedy, result) for each task whose samples a hollowing changes.
        types: (task, topic, message type) of the published topics.
        tracebacks: The tasks whose code printed a traceback, for example from a thread.
        limit: The resource whose limit a cell or a scenario exceeded, or "".
    """

    results: tuple[TaskResult, ...]
    cell_errors: tuple[str, ...]
    hollow: tuple[tuple[str, str, TaskResult], ...]
    types: tuple[tuple[str, str, str], ...]
    tracebacks: frozenset[str] = frozenset()
    limit: str = ""


def cells_of(path: Path) -> tuple[str, ...]:
    """Return the source of a notebook's code cells, or of a Python file as a single cell."""
    if path.suffix == ".py":
        return (path.read_text(encoding="utf-8"),)
    return tuple(source(cell) for _, cell in code_cells(read_notebook(path)))


def rehearse(rehearsal: Rehearsal, course: Course) -> RehearsalResult:
    """Run a rehearsal in the sandbox, and judge it."""
    catalog = catalog_of(course)
    tasks = [with_option(catalog.task(name), rehearsal.option) for name in rehearsal.tasks]
    steps = plan_scenarios(tasks, catalog, with_hidden=rehearsal.with_hidden)
    # Cells that show views or run live are left out if the tasks only need definitions, to save
    # time.
    cells = (
        tuple(rehearsal.cells)
        if any(task.kind not in ONLY_DEFINED for task in tasks)
        else tuple(cell for cell in rehearsal.cells if DEFINES.match(cell) or CHECKS.search(cell))
    )
    solution = course.solutions / f"{rehearsal.week}_solution.ipynb"
    files = catalog.with_assets(rehearsal.week, working_files(solution, cells))
    without_checks = tuple(step.without_checks() for step in steps)
    limits, forbidden_paths = catalog.course.limits, course.forbidden_paths
    job = Job(cells, STUDENT, without_checks, limits, files, course.sandbox, forbidden_paths)
    outcome = unpack(run(job).evidence, steps)
    judgement = judge_in_child(outcome, tasks, catalog)
    types = {
        (run.evidence.task, topic, type_name)
        for run in outcome.runs
        for topic, type_name in run.evidence.topics.items()
    }
    is_broken = any(check.broken for result in judgement.tasks for check in result.checks)
    # A check that raises an exception or exceeds its time limit does not show whether messages
    # matter.
    hollow_results = (
        _hollow_results(tasks, outcome.runs, catalog) if rehearsal.hollow and not is_broken else ()
    )
    hollow = tuple((way.name, way.remedy, result) for way, result in hollow_results)
    printed = frozenset(run.evidence.task for run in outcome.runs if TRACEBACK in run.evidence.output)
    return RehearsalResult(
        judgement.tasks, judgement.cell_errors, hollow, tuple(sorted(types)), printed, judgement.limit
    )


def count_options(tasks: Iterable[Task]) -> int:
    """Return the number of combinations of personal values of the task with most, at most MOST."""
    return max((min(_count_combinations(task), MOST) for task in tasks), default=1)


def with_option(task: Task, row: int) -> Task:
    """Return the task with one option for each personal value, the same for all students."""
    rows, personal_values = count_options([task]), {}
    # With more than MOST combinations, the rows are spread evenly over them.
    number = row % rows * _count_combinations(task) // rows
    for name, choices in task.personal.items():
        number, index = divmod(number, len(choices))
        personal_values[name] = (choices[index],)
    return replace(task, personal=personal_values)


def _count_combinations(task: Task) -> int:
    return math.prod(len(choices) for choices in task.personal.values())


def _hollow_results(
    tasks: Sequence[Task], runs: Sequence[Run], catalog: Catalog
) -> Iterable[tuple[Hollowing, TaskResult]]:
    for task in (task for task in tasks if task.kind == "node"):
        before = [run for run in runs if run.evidence.task == task.id]
        for hollowing in HOLLOWINGS:
            after = [replace(run, evidence=hollowing.apply(run.evidence)) for run in before]
            if after != before:
                yield hollowing, judge_task(task, *catalog.points(task), after)
