"""A solution without one of a task's requirements fails a public check that names it."""

import tomllib
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

from course_lib.grading.exercise_run import run_exercise
from tests.notebooks.graded import STUDENT, catalog, cells_of, judged_results, solution

TABLES = sorted((Path(__file__).parent / "near_misses").glob("week0[5-8].toml"))
Miss = Mapping[str, str]


def put_in(cells: list[str], miss: Miss) -> list[str]:
    """Return the cells with a requirement left out; the text to find is there exactly once."""
    assert sum(cell.count(miss["find"]) for cell in cells) == 1, miss
    return [cell.replace(miss["find"], miss["put"]) for cell in cells]


def rounds() -> list[Any]:
    """Return notebooks in which every task misses one requirement, until each has missed all of its own."""
    made = []
    for path in TABLES:
        week, table = path.stem, tomllib.loads(path.read_text())
        for row in zip_longest(*table.values()):
            misses = {f"{week}.{task}": miss for task, miss in zip(table, row, strict=True) if miss}
            names = ", ".join(
                f"{task.split('.')[1]} without {miss['without']}" for task, miss in misses.items()
            )
            made.append(pytest.param(week, misses, id=f"{week}: {names}"))
    return made


@pytest.mark.parametrize(("week", "misses"), rounds())
def test_a_requirement_that_is_left_out_is_named_by_a_public_check(
    week: str, misses: Mapping[str, Miss]
) -> None:
    cells = cells_of(solution(week))
    for miss in misses.values():
        cells = put_in(cells, miss)
    run = run_exercise(cells, catalog().of_week(week), catalog(), STUDENT, hidden=False)
    for result in judged_results(run):
        public = "\n".join(check.message for check in result.checks if not check.passed)
        if result.task in misses:
            assert misses[result.task]["says"] in public, result.errors
            assert result.score < result.points
        else:
            assert public == ""
