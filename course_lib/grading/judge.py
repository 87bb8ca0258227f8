"""The stage `judge`: from evidence to scores, in pure functions: equal evidence gets equal scores."""

import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.grading.catalog import Catalog
from course_lib.grading.evidence import Check, Evidence, Verdict
from course_lib.grading.run.job import Run
from course_lib.grading.task import Row, Task
from course_lib.grading.time_limit import time_limit

if TYPE_CHECKING:  # students' kernels judge without a jail
    from course_lib.grading.run.run import ExerciseRun

CHECK_SECONDS = 5.0  # [s] of processor time for a check
TASK_SECONDS = 10.0  # [s] of processor time for all checks of a task
LEAST_SECONDS = 0.1  # [s] for a check where the others have used up the task's time
LONGEST = 500  # characters of an exception's text
NEEDS_ANOTHER = "another check must pass first"
TOO_LARGE = "the messages are too large to be checked in time"
CANNOT_JUDGE = "this check could not judge what came: a fault of the course, which your instructor looks at"

# Its text is the student's own and may tell a hidden input, so students don't get it; the evidence has it.
HIDDEN_ERROR = "in a hidden scenario the code raises an exception, or ends too early"


@dataclass(frozen=True)
class CheckResult:
    """The result of one check.

    Args:
        title: Of the check.
        scenario: The scenario's name.
        hidden: Whether students may not see the message.
        weight: Share of the task's points.
        score: From 0 to 1.
        message: The reason, with values.
        mistake: The kind of mistake, without values.
        broken: The exception of a check that raised one; for staff only.
        seconds: Of processor time [s]; it differs from time to time, so no result file has it.
    """

    title: str
    scenario: str
    hidden: bool
    weight: float
    score: float
    message: str
    mistake: str
    broken: str = ""
    seconds: float = field(default=0.0, compare=False)

    @property
    def passed(self) -> bool:
        """True with the full score."""
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
        rubric: The rows by which a person marks the task.
        is_current: False if those points were given for another hand-in.
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
    rubric: tuple[Row, ...] = ()
    is_current: bool = True

    @property
    def fraction(self) -> float:
        """The weighted mean of the checks' scores."""
        whole = sum(check.weight for check in self.checks)
        return sum(check.weight * check.score for check in self.checks) / whole if whole else 0.0

    @property
    def score(self) -> float:
        """Points: those of a person, else those of the checks."""
        return round(self.points * self.fraction, 2) if self.manual is None else self.manual

    @property
    def untouched(self) -> bool:
        """True if every error is the stub's NotImplementedError."""
        return bool(self.errors) and all(error.startswith("NotImplementedError") for error in self.errors)

    @property
    def passed(self) -> bool:
        """True if all checks pass."""
        return all(check.passed for check in self.checks)

    @property
    def waits(self) -> bool:
        """True if a person must mark it: by its rubric, as a weighty check raised, or once more."""
        is_broken = any(check.broken and check.weight for check in self.checks)
        return not self.is_current or (self.manual is None and (bool(self.rubric) or is_broken))

    def as_plain(self) -> dict[str, Any]:
        """Return the entry of a result file."""
        plain = asdict(self)
        for check in plain["checks"]:
            del check["seconds"]
        return {**plain, "score": self.score}

    @classmethod
    def from_plain(cls, content: Mapping[str, Any]) -> "TaskResult":
        """Return the task of an entry of a result file."""
        known = {field.name: content[field.name] for field in fields(cls) if field.name in content}
        checks = tuple(CheckResult(**check) for check in content["checks"])
        return cls(**{**known, "checks": checks, "rubric": tuple(Row(**row) for row in content["rubric"])})


@dataclass(frozen=True)
class Judgement:
    """The results of all tasks of one submission, with the log of its cells.

    Args:
        tasks: In the order of the exercise.
        isolation: The layers between the submission and the machine that it ran on.
        cell_errors: Exceptions of the cells, which are run once, before the scenarios.
        output: The text that the cells printed.
        digests: Of the recordings, by task and scenario.
        limit: The resource that a scenario or a cell used up, or "".
    """

    tasks: tuple[TaskResult, ...]
    isolation: str
    cell_errors: tuple[str, ...]
    output: str
    digests: Mapping[str, str]
    limit: str = ""

    @property
    def broken(self) -> list[str]:
        """Each check that raised an exception, with task and scenario; for staff."""
        rows = [(task.task, check) for task in self.tasks for check in task.checks if check.broken]
        return [f"{task}, {check.scenario}, {check.title!r}: {check.broken}" for task, check in rows]

    def as_plain(self) -> dict[str, Any]:
        """Return the part of a result file that is judged."""
        return {**vars(self), "tasks": [task.as_plain() for task in self.tasks]}

    @classmethod
    def from_plain(cls, content: Mapping[str, Any]) -> "Judgement":
        """Return the judgement of a result file."""
        known = {field.name: content[field.name] for field in fields(cls) if field.name in content}
        return cls(**{**known, "tasks": tuple(map(TaskResult.from_plain, content["tasks"]))})


def judge(run: "ExerciseRun", tasks: Sequence[Task], catalog: Catalog) -> Judgement:
    """Judge the evidence of a submission by the checks of its tasks."""
    results = tuple(
        judge_task(task, *catalog.points(task), [one for one in run.runs if one.evidence.task == task.id])
        for task in tasks
    )
    return Judgement(
        tasks=results,
        isolation=str(run.isolation),
        limit=next((result.stopped for result in results if result.stopped), run.log.limit),
        cell_errors=(*run.log.stopped.values(), *run.log.errors),
        output=run.log.output,
        digests={f"{r.evidence.task}/{r.scenario.name}": r.evidence.recording.digest() for r in run.runs},
    )


def judge_task(task: Task, points: float, bonus: bool, runs: Sequence[Run]) -> TaskResult:
    """Judge all runs of a task; a check that raises costs that check only."""
    judge = _Judge()
    checks = tuple(result for run in runs for result in judge.results(run))
    if task.rubric:  # a person marks it: the checks only tell
        checks = tuple(replace(check, weight=0.0) for check in checks)
    errors = dict.fromkeys(error for run in runs if not run.hidden for error in run.evidence.errors)
    if any(
        set(run.evidence.errors) - errors.keys() for run in runs if run.hidden and not run.evidence.stopped
    ):
        errors[HIDDEN_ERROR] = None
    stopped = next((run.evidence.stopped for run in runs if run.evidence.stopped), "")
    return TaskResult(task.id, task.title, points, bonus, checks, tuple(errors), stopped, rubric=task.rubric)


class _Judge:
    """The judge of one task, with a limit of processor time for all of its checks."""

    def __init__(self) -> None:
        self._left = TASK_SECONDS
        self._verdicts: dict[Callable[[Evidence], Verdict], Verdict] = {}  # of one run
        self._seconds: dict[Callable[[Evidence], Verdict], float] = {}

    def results(self, run: Run) -> list[CheckResult]:
        """Return a row for each check; what was decoded for them is released."""
        self._verdicts = {}
        rows = [_row(check, run, self._verdict(check, run.evidence)) for check in run.scenario.checks]
        run.evidence.release()
        took = [self._seconds[check.judge] for check in run.scenario.checks]
        return [replace(row, seconds=seconds) for row, seconds in zip(rows, took, strict=True)]

    def _verdict(self, check: Check, evidence: Evidence) -> Verdict:
        """Return what a check finds; where it passes, but one that it requires does not, that is named."""
        if check.judge not in self._verdicts:
            self._verdicts[check.judge] = self._look(check, evidence)
        verdict = self._verdicts[check.judge]
        for required in check.requires:
            failing = self._verdict(required, evidence)
            if failing.score >= 1 and not failing.broken:
                continue
            if verdict.score >= 1 or failing.broken:
                message = f"counts when this passes: {required.title}"
                return Verdict(0.0, message, NEEDS_ANOTHER, failing.broken)
            return replace(verdict, score=0.0)
        return verdict

    def _look(self, check: Check, evidence: Evidence) -> Verdict:
        begin = time.process_time()
        try:
            with time_limit(max(min(CHECK_SECONDS, self._left), LEAST_SECONDS)):
                verdict = check.judge(evidence)
                return replace(verdict, score=float(verdict.score), message=str(verdict.message))
        except Exception as error:  # of the kit or of a check file, over what a student published
            slow = evidence.large_message if isinstance(error, TimeoutError) else ""
            message = f"{TOO_LARGE}: {slow}; publish fewer points" if slow else CANNOT_JUDGE
            kind = TOO_LARGE if slow else CANNOT_JUDGE
            return Verdict(
                0.0, message, kind, f"{_place(check, error)}{type(error).__name__}: {error}"[:LONGEST]
            )
        finally:
            self._seconds[check.judge] = time.process_time() - begin
            self._left -= self._seconds[check.judge]


def _place(check: Check, error: Exception) -> str:
    """Return "week01.py line 12: " for an exception in a check: where its own code or its word stands."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).parent.name == "checks"]
    if own:
        return f"{own[-1].filename} line {own[-1].lineno}: "
    return f"{check.origin.place}: " if check.origin else ""


def _row(check: Check, run: Run, verdict: Verdict) -> CheckResult:
    score = verdict.score if 0 <= verdict.score <= 1 else 0.0  # NaN is not a score
    mistake = verdict.mistake or ("as expected" if score == 1 else "not as expected")
    return CheckResult(
        title=check.title,
        scenario=run.scenario.name,
        hidden=run.hidden,
        weight=check.weight,
        score=score,
        message=verdict.message,
        mistake=mistake,
        broken=verdict.broken,
    )
