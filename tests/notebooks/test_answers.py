"""The checks of every week against right, wrong, empty and mutated answers."""

import re
import tomllib
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.exercise import exercise_path
from tests.notebooks.graded import (
    IN_PROCESS,
    WEEKS,
    catalog,
    cells_of,
    defined,
    evidence_here,
    judged,
    judged_results,
    marked,
    run_of,
    said,
    solution,
)
from tests.notebooks.mutations import Operator, mutants

ANSWERS = Path(__file__).parent / "answers"


def wrong_answers() -> dict[tuple[str, str], str]:
    """Per file of wrong answers and task: what a message or kind of mistake says of it."""
    tables = {path.stem: tomllib.loads(path.read_text()) for path in sorted(ANSWERS.glob("week*.toml"))}
    return {
        (f"{week}_{name}", task): says
        for week, files in tables.items()
        for name, tasks in files.items()
        for task, says in tasks.items()
    }


WRONG = wrong_answers()


@pytest.mark.parametrize("week", WEEKS)
def test_the_solution_gets_full_marks_and_says_nothing_of_errors(week: str) -> None:
    run = run_of(solution(week))
    assert run.judgement.cell_errors == ()
    assert [task.task for task in judged_results(run) if task.score != task.points] == []
    assert [said(task) for task in run.judgement.tasks if not task.passed] == []


@pytest.mark.parametrize("week", WEEKS)
def test_another_right_solution_gets_full_marks(week: str) -> None:
    run = run_of(ANSWERS / f"{week}_other_right.py")
    assert {task.task: said(task) for task in judged_results(run) if task.score != task.points} == {}


@pytest.mark.parametrize("week", WEEKS)
def test_the_stub_gets_0_and_says_what_is_missing(week: str) -> None:
    run = run_of(exercise_path(solution(week)))
    assert [task.score for task in run.judgement.tasks] == [0.0] * len(run.judgement.tasks)
    assert all("NotImplementedError" in "".join(task.errors) for task in judged_results(run))


@pytest.mark.parametrize(("name", "task"), WRONG)
def test_a_wrong_answer_loses_points_and_its_mistake_is_named(name: str, task: str) -> None:
    results = run_of(ANSWERS / f"{name}.py").judgement.tasks
    (result,) = (result for result in results if result.task == f"{name[:6]}.{task}")
    assert result.errors == ()
    assert result.score < result.points
    assert WRONG[name, task] in said(result)
    assert said(result, hidden=True), "the hidden checks must not pass it"


@pytest.mark.parametrize("week", WEEKS)
def test_every_task_has_two_wrong_answers(week: str) -> None:
    for task in judged(week):
        assert len([1 for name, wrong in WRONG if f"{name[:6]}.{wrong}" == task.id]) >= 2


@pytest.mark.parametrize("week", WEEKS)
def test_the_public_checks_of_a_task_have_different_titles(week: str) -> None:
    for task in catalog().of_week(week):
        titles = [check.title for scenario in task.scenarios for check in scenario.checks]
        assert sorted(titles) == sorted(set(titles)), task.id


def rounds(week: str) -> list[Any]:
    """Notebooks in which every task is mutated in one place, until each task has had all its mutants."""
    cells, tasks = cells_of(solution(week)), judged(week)
    places = [
        next(
            i for i, cell in enumerate(cells) if re.search(rf"^(class|def) {task.name}\b", cell, re.MULTILINE)
        )
        for task in tasks
    ]
    made = []
    for row in zip_longest(*(mutants(cells[place]) for place in places)):
        changed, operators = list(cells), dict[str, Operator]()
        for task, place, mutant in zip(tasks, places, row, strict=True):
            if mutant:
                operators[task.id], changed[place] = mutant
        names = " ".join(f"{task.split('.')[1]}={operator.name}" for task, operator in operators.items())
        made.append(pytest.param(week, operators, changed, id=f"{week}: {names}"))
    return made


@pytest.mark.parametrize(
    ("week", "operators", "cells"), [one_round for week in WEEKS for one_round in rounds(week)]
)
def test_mutants_of_the_solution_lose_points_and_none_passes_the_hidden_checks(
    week: str, operators: dict[str, Operator], cells: list[str]
) -> None:
    for result in judged_results(marked(cells, catalog().of_week(week))):
        if result.task in operators:
            assert result.errors == ()
            assert result.score < result.points
            assert said(result, hidden=True)
            assert re.search(operators[result.task].names, said(result)), said(result)
            if not operators[result.task].only_other_inputs:
                assert said(result, hidden=False), "a public check must not pass it"
        else:
            assert result.score == result.points


def kinds_of_files() -> list[tuple[str, str]]:
    return [(week, kind) for week in WEEKS for kind in ("solution", "stub", "first_try", "second_try")]


@pytest.mark.parametrize(("week", "kind"), kinds_of_files())
def test_kernel_and_worker_record_the_same(
    week: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # answers may write files
    paths = {"solution": solution(week), "stub": exercise_path(solution(week))}
    path = paths.get(kind, ANSWERS / f"{week}_{kind}.py")
    namespace = defined(cells_of(path), week)
    for run in run_of(path).runs:
        task = catalog().task(run.evidence.task)
        if task.kind not in IN_PROCESS:
            continue
        here = evidence_here(task, run.scenario, namespace)
        assert here.recording.digest() == run.evidence.recording.digest(), (task.id, run.scenario.name)
        assert here.returns == run.evidence.returns, (task.id, run.scenario.name)
