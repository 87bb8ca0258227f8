"""The checks of every week against right, wrong, empty and mutated answers."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.exercise import exercise_path
from course_lib.course.exercise_file import read_notebook, source
from course_lib.course.files import exercises_dir, solutions_dir
from course_lib.grading.catalog import Catalog, load_catalog
from course_lib.grading.exercise_run import ExerciseRun, run_exercise
from course_lib.grading.judge import TaskResult
from course_lib.grading.personal import give_values, personal_values
from course_lib.grading.scenario import run_here
from course_lib.grading.task import Task
from tests.notebooks.mutations import Operator, mutants

ANSWERS = Path(__file__).parent / "answers"
WEEKS = sorted(path.name[:6] for path in solutions_dir().glob("week*_solution.ipynb"))
STUDENT = "s1"
A_WHILE = 100.0  # [s]


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


@cache
def catalog() -> Catalog:
    """The course's, with limits for a machine that has much else to do."""
    made = load_catalog(exercises_dir(), solutions_dir())
    limits = replace(made.course.limits, cell_seconds=A_WHILE, scenario_seconds=A_WHILE, total_seconds=600.0)
    return replace(made, course=replace(made.course, limits=limits))


def cells_of(path: Path) -> list[str]:
    if path.suffix == ".py":
        return [path.read_text()]
    return [source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code"]


def solution(week: str) -> Path:
    return solutions_dir() / f"{week}_solution.ipynb"


def marked(cells: Sequence[str], week: str) -> ExerciseRun:
    return run_exercise(cells, catalog().of_week(week), catalog(), STUDENT, hidden=True)


@cache
def run_of(path: Path) -> ExerciseRun:
    """What came of a file: a solution, an exercise as it is handed out, or an answer."""
    return marked(cells_of(path), path.name[:6])


def judged(week: str) -> list[Task]:
    """The tasks that checks decide; a person reads the others."""
    return [task for task in catalog().of_week(week) if not task.rubric]


def judged_results(run: ExerciseRun) -> list[TaskResult]:
    return [result for task, result in zip(run.tasks, run.results, strict=True) if not task.rubric]


def said(result: TaskResult, *, hidden: bool | None = None) -> str:
    """All messages and kinds of mistake of the checks that failed."""
    failed = [c for c in result.checks if not c.passed and hidden in (None, c.hidden)]
    return "\n".join(f"{check.message}\n{check.mistake}" for check in failed)


@pytest.mark.parametrize("week", WEEKS)
def test_the_solution_gets_full_marks_and_says_nothing_of_errors(week: str) -> None:
    run = run_of(solution(week))
    assert run.cell_errors == []
    assert [task.task for task in judged_results(run) if task.score != task.points] == []
    assert [said(task) for task in run.results if not task.passed] == []


@pytest.mark.parametrize("week", WEEKS)
def test_another_right_solution_gets_full_marks(week: str) -> None:
    run = run_of(ANSWERS / f"{week}_other_right.py")
    assert {task.task: said(task) for task in judged_results(run) if task.score != task.points} == {}


@pytest.mark.parametrize("week", WEEKS)
def test_the_stub_gets_0_and_says_what_is_missing(week: str) -> None:
    run = run_of(exercise_path(solution(week)))
    assert [task.score for task in run.results] == [0.0] * len(run.results)
    assert all("NotImplementedError" in "".join(task.errors) for task in judged_results(run))


@pytest.mark.parametrize(("name", "task"), WRONG)
def test_a_wrong_answer_loses_points_and_its_mistake_is_named(name: str, task: str) -> None:
    results = run_of(ANSWERS / f"{name}.py").results
    (result,) = (result for result in results if result.task == f"{name[:6]}.{task}")
    assert result.errors == ()
    assert result.score < result.points
    assert WRONG[name, task] in said(result)
    assert said(result, hidden=True), "the hidden checks must not pass it"


@pytest.mark.parametrize("week", WEEKS)
def test_every_task_has_two_wrong_answers(week: str) -> None:
    for task in judged(week):
        assert len([1 for name, wrong in WRONG if f"{name[:6]}.{wrong}" == task.id]) >= 2


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
    for result in judged_results(marked(cells, week)):
        if result.task in operators:
            assert result.errors == ()
            assert result.score < result.points
            assert said(result, hidden=True)
            assert re.search(operators[result.task].names, said(result)), said(result)
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
    cells = [re.sub(r"^%.*\n", "", cell) for cell in cells_of(path)]
    definitions = [c for c in cells if re.match(r"(class|def|import|from|[A-Z_]+ =|\"\"\"|#)", c)]
    tasks = [task for task in catalog().of_week(week) if task.kind in ("node", "function")]
    give_values({task.id: personal_values(task, STUDENT) for task in tasks})
    namespace: dict[str, Any] = {}
    for cell in definitions:
        exec(cell, namespace)
    for run in run_of(path).runs:
        task = catalog().task(run.evidence.task)
        if task not in tasks:
            continue
        personal = personal_values(task, STUDENT)
        here = run_here(task, run.scenario, namespace[task.name], personal, wall_limit=A_WHILE)
        assert here.recording.digest() == run.evidence.recording.digest(), (task.id, run.scenario.name)
        assert here.returns == run.evidence.returns, (task.id, run.scenario.name)
