"""From evidence to marks: pure functions, so that the same evidence always gets the same mark."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check, Evidence, Verdict, failed
from course_lib.grading.task import Scenario, Task
from course_lib.grading.time_limit import time_limit

CHECK_SECONDS = 60.0  # [s] of a check's processor time

# Its text is the student's own and may tell a hidden input, so students don't get it; the evidence has it.
HIDDEN_ERROR = "in a hidden scenario the code raises an exception, or ends too early"


class BrokenCheckError(CourseError):
    """A check raised something: the kit's fault, never the student's."""


@dataclass(frozen=True)
class Run:
    """A scenario that has been run: what it was, and what came out."""

    scenario: Scenario
    evidence: Evidence
    hidden: bool = False


@dataclass(frozen=True)
class CheckResult:
    """One row of a table: with the public wording and the kind of mistake, for whoever may read which."""

    title: str
    scenario: str
    hidden: bool
    weight: float
    score: float
    message: str
    mistake: str

    @property
    def passed(self) -> bool:
        """Whether it has the full score."""
        return self.score >= 1


@dataclass(frozen=True)
class TaskResult:
    """The mark of one task and its reasons.

    Args:
        task: Its id.
        title: In tables.
        points: The most that it can give.
        bonus: Whether they come on top.
        checks: What was looked at.
        errors: What the code raised.
        stopped: Which limit ended it, or "".
        manual: Points that a person gave; they count instead of the checks'.
        comments: What that person says.
    """

    task: str
    title: str
    points: float
    bonus: bool
    checks: tuple[CheckResult, ...]
    errors: tuple[str, ...] = ()
    stopped: str = ""
    manual: float | None = None
    comments: tuple[str, ...] = ()

    @property
    def fraction(self) -> float:
        """The weighted mean of the checks' scores."""
        whole = sum(check.weight for check in self.checks)
        return sum(check.weight * check.score for check in self.checks) / whole if whole else 0.0

    @property
    def score(self) -> float:
        """In points."""
        return round(self.points * self.fraction, 2) if self.manual is None else self.manual

    @property
    def untouched(self) -> bool:
        """Whether what was run is still the stub."""
        return bool(self.errors) and all(error.startswith("NotImplementedError") for error in self.errors)

    @property
    def passed(self) -> bool:
        """Whether no check says otherwise."""
        return all(check.passed for check in self.checks)


def judge_task(task: Task, points: float, bonus: bool, runs: Sequence[Run]) -> TaskResult:
    """Judge all runs of a task.

    Raises:
        BrokenCheckError: A check raised an exception.
    """
    checks = tuple(_judge(check, run) for run in runs for check in run.scenario.checks)
    if task.rubric:  # a person marks it: the checks only tell
        checks = tuple(replace(check, weight=0.0) for check in checks)
    errors = dict.fromkeys(error for run in runs if not run.hidden for error in run.evidence.errors)
    if any(
        set(run.evidence.errors) - errors.keys() for run in runs if run.hidden and not run.evidence.stopped
    ):
        errors[HIDDEN_ERROR] = None
    stopped = next((run.evidence.stopped for run in runs if run.evidence.stopped), "")
    return TaskResult(task.id, task.title, points, bonus, checks, tuple(errors), stopped)


def _judge(check: Check, run: Run) -> CheckResult:
    verdict = _verdict(check, run)
    score = verdict.score if 0 <= verdict.score <= 1 else 0.0  # NaN is no score
    mistake = verdict.mistake or ("as expected" if score == 1 else "not as expected")
    return CheckResult(
        check.title, run.scenario.name, run.hidden, check.weight, score, verdict.message, mistake
    )


def _verdict(check: Check, run: Run) -> Verdict:
    """Return what a check says; where it passes, but one that it requires does not, that is named."""
    verdict = _looked(check, run)
    failing = next((required for required in check.requires if _verdict(required, run).score < 1), None)
    if failing is None:
        return verdict
    if verdict.score >= 1:
        return failed(f"counts when this passes: {failing.title}", "another check must pass first")
    return replace(verdict, score=0.0)


def _looked(check: Check, run: Run) -> Verdict:
    try:
        with time_limit(CHECK_SECONDS):
            return check.judge(run.evidence)
    except Exception as error:  # whatever a check raises is a fault of ours and must be named as such
        where = f"{run.evidence.task}, {run.scenario.name}, {check.title!r}"
        raise BrokenCheckError(f"{where} is broken: {type(error).__name__}: {error}") from error
