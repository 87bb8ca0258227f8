"""The record that the stage `run` starts from: plain data, which may go to another process or machine."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import msgpack

from course_lib.course.course_file import Limits
from course_lib.grading.catalog import Catalog
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.isolation import Need
from course_lib.grading.personal import personal_values
from course_lib.grading.task import Scenario, Task

VERSION = 3  # of stored evidence
ANSWER = (Scenario("answer"),)  # of a written task without scenarios: its text is evidence nevertheless


@dataclass(frozen=True)
class Step:
    """One scenario of a task, and whether it is hidden."""

    task: Task
    scenario: Scenario
    hidden: bool = False

    def unjudged(self) -> "Step":
        """Return the step without checks and expected messages, which only the judge needs."""
        task = replace(self.task, scenarios=(), ghost=())
        return Step(task, replace(self.scenario, checks=()), self.hidden)


@dataclass(frozen=True)
class Run:
    """A scenario that has been run, and its evidence."""

    scenario: Scenario
    evidence: Evidence
    hidden: bool = False


@dataclass(frozen=True)
class Job:
    """A submission to run.

    Args:
        cells: Its code.
        student: The ID that personal values derive from; None is a guest.
        steps: The scenarios in order.
        limits: The resources that it may use.
        files: Texts that were handed in with it, by path.
        need: The least isolation in which it is run.
        refused: Paths of the course that it must not read on the machine where it runs.
    """

    cells: tuple[str, ...]
    student: str | None
    steps: tuple[Step, ...]
    limits: Limits
    files: Mapping[str, str] = field(default_factory=dict)
    need: Need = "any"
    refused: tuple[str, ...] = ()

    @property
    def personal(self) -> dict[str, dict[str, Any]]:
        """The student's own values, by task."""
        return {step.task.id: personal_values(step.task, self.student) for step in self.steps}

    @property
    def key(self) -> str:
        """The digest of all that the evidence depends on; submissions with equal keys are run once.

        The kit is no part of it, so that a corrected check can judge the evidence that is there.
        """
        steps = [step.unjudged() for step in self.steps]
        content = [VERSION, self.cells, self.personal, sorted(self.files.items()), steps, self.limits]
        return hashlib.sha256(msgpack.packb(content, default=_by_field)).hexdigest()[:32]


def plan(tasks: Sequence[Task], catalog: Catalog, *, hidden: bool) -> tuple[Step, ...]:
    """Return every scenario of every task, public scenarios first."""
    public = [(task, task.scenarios or ANSWER * (task.kind == "written")) for task in tasks]
    steps = [Step(task, scenario) for task, scenarios in public for scenario in scenarios]
    if hidden:
        steps += [Step(task, one, hidden=True) for task in tasks for one in catalog.hidden.get(task.id, ())]
    return tuple(steps)


def _by_field(data: Any) -> Any:
    return vars(data) if hasattr(data, "__dict__") else repr(data)
