"""What earns next to nothing, and what is caught before the hidden checks."""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from course_lib.grading.exercise_run import run_exercise
from course_lib.grading.judge import Run, TaskResult, judge_task
from tests.notebooks.graded import (
    IN_PROCESS,
    OPEN,
    STUDENT,
    WEEKS,
    catalog,
    cells_of,
    defined,
    evidence_here,
    run_of,
    said,
    solution,
)
from tests.notebooks.hollow import HOLLOWINGS, Hollowing

NEAR_MISSES = Path(__file__).parent / "near_misses"
MOST = 0.1  # of a task's points, for rate, stamps and frame alone


def still_open(week: str) -> Any:
    """The mark of weeks whose checks are still to be tightened: they may fail."""
    return pytest.mark.xfail(strict=False) if week in OPEN else ()


def weeks() -> list[Any]:
    """Every week, as a parameter."""
    return [pytest.param(week, marks=still_open(week)) for week in WEEKS]


def hollowed(week: str, hollowing: Hollowing) -> Iterator[TaskResult]:
    """The results of the node tasks whose evidence the hollowing changes."""
    run = run_of(solution(week))
    for task in run.tasks:
        before = [one for one in run.runs if one.evidence.task == task.id]
        runs = [replace(one, evidence=hollowing.of(one.evidence)) for one in before]
        if task.kind == "node" and runs != before:
            yield judge_task(task, *catalog().points(task), runs)


@pytest.mark.parametrize("week", weeks())
@pytest.mark.parametrize("hollowing", HOLLOWINGS, ids=lambda hollowing: hollowing.name)
def test_a_publisher_without_content_earns_at_most_a_tenth(week: str, hollowing: Hollowing) -> None:
    earned = {
        result.task: [(check.title, check.hidden, check.weight) for check in result.checks if check.passed]
        for result in hollowed(week, hollowing)
        if result.score > MOST * result.points
    }
    assert earned == {}


@dataclass(frozen=True)
class NearMiss:
    """A right solution with one requirement of its task missed, as a table in near_misses/ has it.

    Args:
        task: The task's id.
        miss: The requirement that is missed, in words.
        change: Pairs of what is replaced in the cell of the solution, and by what.
        says: What a message of a public check says of it, a regular expression.
        raises: What the code raises then.
    """

    task: str
    miss: str
    change: tuple[tuple[str, str], ...]
    says: str
    raises: str = ""


def near_misses() -> Iterator[Any]:
    for path in sorted(NEAR_MISSES.glob("week*.toml")):
        for name, rows in tomllib.loads(path.read_text()).items():
            for row in rows:
                made = NearMiss(f"{path.stem}.{name}", **row)
                yield pytest.param(made, id=f"{made.task}: {made.miss}", marks=still_open(path.stem))


def with_changes(miss: NearMiss) -> list[str]:
    """The cells of the solution with the miss in them."""
    name = catalog().task(miss.task).name
    cells = cells_of(solution(miss.task[:6]))
    for old, new in miss.change:
        (place,) = (i for i, cell in enumerate(cells) if old in cell and re.search(rf"\b{name}\b", cell))
        cells[place] = cells[place].replace(old, new)
    return cells


@pytest.mark.parametrize("miss", near_misses())
def test_a_public_check_names_the_requirement_that_is_missed(miss: NearMiss) -> None:
    task, cells = catalog().task(miss.task), with_changes(miss)
    if task.kind in IN_PROCESS:
        names = defined(cells, task.week)
        runs = [Run(scenario, evidence_here(task, scenario, names)) for scenario in task.scenarios]
        result = judge_task(task, *catalog().points(task), runs)
    else:
        (result,) = run_exercise(cells, [task], catalog(), STUDENT, hidden=False).results
    assert [error.split(":")[0] for error in result.errors] == [miss.raises] * bool(miss.raises)
    assert re.search(miss.says, said(result)), said(result) or "all public checks pass"
