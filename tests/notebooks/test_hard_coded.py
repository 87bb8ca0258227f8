"""An answer that hard-codes the values of the public scenarios gets almost no points."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import pytest

from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.task import Scenario, Task, resolve
from course_lib.ros.graph.graph import START_NS
from tests.notebooks.graded import catalog, judged, run_of, solution

MOST = 0.1  # of a task's points
WEEKS = ("week05", "week06", "week07", "week08")


def questions(scenario: Scenario, personal: Mapping[str, Any]) -> list[str]:
    return [repr(resolve((call.args, call.kwargs), personal)) for call in scenario.calls]


def has_inputs(task: Task) -> bool:
    """Return whether a public scenario has inputs beyond the task description."""
    return any(s.inputs or any(c.args or c.kwargs for c in s.calls) for s in task.scenarios)


def replays(runs: list[Run]) -> Iterator[list[Run]]:
    """Return the hidden runs as they were, if the code had repeated a public run's answers or messages."""
    public, hidden = [run for run in runs if not run.is_hidden], [run for run in runs if run.is_hidden]
    public_answers = {
        question: answer
        for run in public
        for question, answer in zip(
            questions(run.scenario, run.evidence.personal), run.evidence.returns, strict=False
        )
    }
    for public_run in public:
        replayed_runs = []
        for run in hidden:
            end_ns = START_NS + round(run.scenario.seconds * 1e9)
            samples = tuple(s for s in public_run.evidence.samples if s.stamp_ns <= end_ns)
            returns = tuple(public_answers.get(q) for q in questions(run.scenario, run.evidence.personal))
            replayed_runs.append(
                replace(run, evidence=replace(run.evidence, samples=samples, returns=returns))
            )
        yield [*public, *replayed_runs]


@pytest.mark.sample(1)
@pytest.mark.parametrize("week", WEEKS)
def test_hard_coded_public_output_earns_at_most_a_tenth(week: str) -> None:
    runs, earned = run_of(solution(week)).runs, {}
    for task in judged(week):
        if has_inputs(task):
            for replayed_runs in replays([run for run in runs if run.evidence.task == task.id]):
                result = judge_task(task, *catalog().points(task), replayed_runs)
                if result.fraction > MOST:
                    earned[task.id] = [(c.title, c.is_hidden, c.weight) for c in result.checks if c.passed]
    assert earned == {}


@pytest.mark.sample(1)
@pytest.mark.parametrize("week", WEEKS)
@pytest.mark.parametrize("answer", [None, [], 0.0, 1.0, "", {}, [0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
def test_constant_return_value_earns_at_most_a_tenth(week: str, answer: Any) -> None:
    runs, earned = run_of(solution(week)).runs, {}
    for task in judged(week):
        if task.kind == "function":
            constant_runs = [
                replace(run, evidence=replace(run.evidence, returns=(answer,) * len(run.evidence.returns)))
                for run in runs
                if run.evidence.task == task.id
            ]
            result = judge_task(task, *catalog().points(task), constant_runs)
            if result.fraction > MOST:
                earned[task.id] = [(c.title, c.is_hidden, c.weight) for c in result.checks if c.passed]
    assert earned == {}
