"""Parsers of students' files and strings: each accepts any input, or raises a CourseError."""

import json
import random
import time
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from course_lib.displays.layout import layout_of
from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.filters import Isolation
from course_lib.grading.records import Run
from course_lib.grading.run.run import ExerciseRun, Step, pack, unpack
from course_lib.grading.run.submission_run import CellLog
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.task import Scenario, Task, time_limit
from course_lib.ros.programs.parameter_yaml import read_text
from tests.hostile.made_up import random_text, spoilt
from tests.hostile.staff_files import STAFF

SECONDS = 5.0  # [s] of processor time for one input
TASK = Task("week01.any", "Any", "value", "any", ("a", "b", "c"), (Scenario("public"),))
STEPS = [Step(TASK, TASK.scenarios[0])]


@cache
def notebook() -> bytes:
    """Return an exercise as students get it."""
    return (Path(__file__).parents[2] / "exercises" / "week01_exercise.ipynb").read_bytes()


@cache
def stored() -> bytes:
    """Return stored evidence."""
    run = Run(TASK.scenarios[0], Evidence(TASK.id, "public", 1.0, returns=(1, "a", [1.0])))
    return pack(ExerciseRun((run,), CellLog(), Isolation()))


def _notebook(chance: random.Random) -> None:
    data = spoilt(chance, notebook())
    if chance.random() < 0.5:  # JSON still, of another form
        content = json.loads(notebook())
        key = chance.choice(("cells", "metadata", "nbformat", "worksheets"))
        content[key] = chance.choice(
            (None, [], {}, 4, "x", [None], [{}], [{"cell_type": "code", "source": 3}])
        )
        data = json.dumps(content).encode()
    parse_notebook(data, "week01_exercise.ipynb")


def _layout(chance: random.Random) -> None:
    layout_of(random_text(chance), "the layout")


def _parameters(chance: random.Random) -> None:
    read_text(random_text(chance))


def _stored(chance: random.Random) -> None:
    unpack(spoilt(chance, stored()), STEPS)


Parsers = Sequence[tuple[Callable[[random.Random], None], type[Exception]]]  # with the permitted exceptions
STUDENTS: Parsers = (
    (_notebook, CourseError),
    (_layout, CourseError),
    (_parameters, ValueError),
    (_stored, CourseError),
)
STAFFS: Parsers = tuple((parse, CourseError) for parse in STAFF)


def parse_any(chance: random.Random, parsers: Parsers = STUDENTS) -> float:
    """Parse one generated input. Return the CPU time [s].

    Raises:
        Exception: The parser raised what it does not announce, or took too long.
    """
    parse, announced = chance.choice(parsers)
    start = time.process_time()
    try:
        with time_limit(SECONDS):
            parse(chance)
    except announced:
        pass  # the error is reported, and grading continues
    return time.process_time() - start
