"""Hollow answers earn next to nothing; near misses fail a public check."""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from course_lib.grading.advice import Advice
from course_lib.grading.judge import TaskResult, judge_task
from course_lib.grading.run.job import Run
from tests.notebooks.graded import (
    IN_PROCESS,
    WEEKS,
    catalog,
    cells_of,
    defined,
    evidence_here,
    marked,
    run_of,
    said,
    solution,
)
from tests.notebooks.hollow import HOLLOWINGS, Hollowing

MOST = 0.1  # of a task's points, for rate, stamps and frame alone


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in an empty folder: answers may write files."""
    monkeypatch.chdir(tmp_path)


def hollowed(week: str, hollowing: Hollowing) -> Iterator[TaskResult]:
    """The results of the node tasks whose evidence the hollowing changes."""
    run = run_of(solution(week))
    for task in catalog().of_week(week):
        before = [one for one in run.runs if one.evidence.task == task.id]
        runs = [replace(one, evidence=hollowing.of(one.evidence)) for one in before]
        if task.kind == "node" and runs != before:
            yield judge_task(task, *catalog().points(task), runs)


@pytest.mark.parametrize("week", WEEKS)
@pytest.mark.parametrize("hollowing", HOLLOWINGS, ids=lambda hollowing: hollowing.name)
def test_a_publisher_without_content_earns_at_most_a_tenth(week: str, hollowing: Hollowing) -> None:
    earned = {
        result.task: [(check.title, check.hidden, check.weight) for check in result.checks if check.passed]
        for result in hollowed(week, hollowing)
        if result.score > MOST * result.points
    }
    assert earned == {}


@dataclass(frozen=True)
class Variant:
    """The solution of a task with changes, as a table in near_misses/ or other_ways/ has it.

    Args:
        task: The task's id.
        change: Pairs of what is replaced in the cell of the solution, and by what.
        miss: The requirement that is missed, in words.
        says: What a message of a public check says of it, a regular expression.
        raises: What the code raises then.
        way: In what a right solution differs.
        hint: The kind of mistake whose hint, one of the task's own, is shown first.
    """

    task: str
    change: tuple[tuple[str, str], ...]
    miss: str = ""
    says: str = ""
    raises: str = ""
    way: str = ""
    hint: str = ""


def variants(folder: str) -> Iterator[Any]:
    """All rows of a folder's tables, as parameters."""
    for path in sorted(Path(__file__).with_name(folder).glob("week*.toml")):
        for name, rows in tomllib.loads(path.read_text()).items():
            for row in rows:
                made = Variant(f"{path.stem}.{name}", **row)
                ident = f"{made.task}: {made.miss or made.way}"
                yield pytest.param(made, id=ident)


def changed_cells(variant: Variant) -> list[str]:
    """The cells of the solution with the changes in them."""
    name = catalog().task(variant.task).name
    cells = cells_of(solution(variant.task[:6]))
    for old, new in variant.change:
        (place,) = (i for i, cell in enumerate(cells) if old in cell and re.search(rf"\b{name}\b", cell))
        cells[place] = cells[place].replace(old, new)
    return cells


def result_of(variant: Variant, *, hidden: bool) -> TaskResult:
    """Run and judge the variant, in this process where its kind allows."""
    task, cells = catalog().task(variant.task), changed_cells(variant)
    if task.kind not in IN_PROCESS:
        (result,) = marked(cells, [task], hidden=hidden).judgement.tasks
        return result
    names = defined(cells, task.week)
    scenarios = [(one, False) for one in task.scenarios]
    scenarios += [(one, True) for one in catalog().hidden.get(task.id, ()) if hidden]
    runs = [Run(one, evidence_here(task, one, names), is_hidden) for one, is_hidden in scenarios]
    return judge_task(task, *catalog().points(task), runs)


FAULTY = {  # task: the class or function that its exercise hands out with faults
    "week04.mended_arm": "BrokenArm",
    "week05.battery_bar": "broken_bar",
    "week06.camera_monitor": "BrokenMonitor",
}


@pytest.mark.parametrize(("name", "faulty"), FAULTY.items())
def test_a_faulty_start_earns_nothing_as_it_is(name: str, faulty: str) -> None:
    task = catalog().task(name)
    subject = {task.name: defined(cells_of(solution(task.week)), task.week)[faulty]}
    scenarios = [(one, False) for one in task.scenarios]
    scenarios += [(one, True) for one in catalog().hidden.get(task.id, ())]
    runs = [Run(one, evidence_here(task, one, subject), hidden) for one, hidden in scenarios]
    result = judge_task(task, *catalog().points(task), runs)
    assert result.score == 0, [check.title for check in result.checks if check.passed]


@pytest.mark.parametrize("miss", list(variants("near_misses")))
def test_a_public_check_names_the_requirement_that_is_missed(miss: Variant) -> None:
    result = result_of(miss, hidden=False)
    assert [error.split(":")[0] for error in result.errors] == [miss.raises] * bool(miss.raises)
    assert re.search(miss.says, said(result)), said(result) or "all public checks pass"
    if miss.hint:
        task = catalog().task(miss.task)
        assert Advice().hint(task, result) == f"Hint: {task.mistakes[miss.hint]}"


def test_every_own_hint_of_a_task_is_shown_for_a_near_miss() -> None:
    shown = {(row.values[0].task, row.values[0].hint) for row in variants("near_misses")}
    own = {(task.id, kind) for task in catalog().tasks.values() for kind in task.mistakes}
    assert own - shown == set()
    assert len({task for task, _ in own}) >= 20


@pytest.mark.parametrize("way", list(variants("other_ways")))
def test_another_way_to_meet_the_requirements_gets_full_marks(way: Variant) -> None:
    result = result_of(way, hidden=True)
    assert (result.score, said(result)) == (result.points, "")
