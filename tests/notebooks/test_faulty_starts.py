"""The faulty starting code of a debugging task gets almost no points."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.task import Task
from tests.notebooks.graded import (
    IN_PROCESS,
    WEEKS,
    catalog,
    cells_of,
    defined,
    evidence_here,
    judged,
    solution,
)

MOST = 0.1  # of a task's points, for rate, stamps and frame
FAULTY = r"^class (Broken\w+)\b"


def faulty_starts() -> Iterator[Any]:
    """Each task whose start has faults, with the name of the faulty class."""
    for week in WEEKS:
        tasks, faulty = {task.name: task for task in judged(week)}, ""
        for cell in cells_of(solution(week)):
            match = re.search(FAULTY, cell, re.MULTILINE)
            faulty = match[1] if match else faulty
            for name in re.findall(r"^class (\w+)\b", cell, re.MULTILINE):
                if faulty and name in tasks and tasks[name].kind in IN_PROCESS:
                    yield pytest.param(tasks[name], faulty, id=tasks[name].id)
                    faulty = ""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in an empty folder, because released code may write files."""
    monkeypatch.chdir(tmp_path)


STARTS = list(faulty_starts())


@pytest.mark.parametrize(("task", "faulty"), STARTS)
def test_faulty_start_code_of_a_task_earns_at_most_a_tenth(task: Task, faulty: str) -> None:
    names = defined(cells_of(solution(task.week)), task.week)
    names[task.name] = names[faulty]
    scenarios = [(one, False) for one in task.scenarios]
    scenarios += [(one, True) for one in catalog().hidden[task.id]]
    runs = [Run(one, evidence_here(task, one, names), hidden) for one, hidden in scenarios]
    result = judge_task(task, *catalog().points(task), runs)
    earned = [(check.title, check.is_hidden, check.weight) for check in result.checks if check.passed]
    assert result.fraction <= MOST, earned


@pytest.mark.parametrize("week", ["week01", "week02", "week03", "week07", "week08"])
def test_every_week_has_tasks_with_faulty_start_code(week: str) -> None:
    assert [start.values[0].id for start in STARTS if start.values[0].week == week]


HANDED_OUT = {  # task: the class or function that its exercise hands out with faults
    "week04.mended_arm": "BrokenArm",
    "week05.battery_bar": "broken_bar",
    "week06.camera_monitor": "BrokenMonitor",
}


@pytest.mark.parametrize(("name", "faulty"), HANDED_OUT.items())
def test_unchanged_faulty_start_code_earns_nothing(name: str, faulty: str) -> None:
    task = catalog().task(name)
    subject = {task.name: defined(cells_of(solution(task.week)), task.week)[faulty]}
    scenarios = [(one, False) for one in task.scenarios]
    scenarios += [(one, True) for one in catalog().hidden.get(task.id, ())]
    runs = [Run(one, evidence_here(task, one, subject), hidden) for one, hidden in scenarios]
    result = judge_task(task, *catalog().points(task), runs)
    assert result.score == 0, [check.title for check in result.checks if check.passed]
