"""The stage `judge`: pure functions from evidence to scores, equal for equal evidence."""

import mmap
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading.evidence import Check, Evidence, Verdict, all_checks
from course_lib.grading.executors import CAN_FORK, ChildDiedError, call_in_child
from course_lib.grading.records import CheckResult, Judgement, Run, TaskResult
from course_lib.grading.task import Catalog, Task, limit_course_code

if TYPE_CHECKING:
    from course_lib.grading.run.run import ExerciseRun

CHECK_SECONDS = 5.0  # [s] processor time of one check
TASK_SECONDS = 10.0  # [s] processor time for a task's checks together
LEAST_SECONDS = 0.1  # [s] minimum for a check if the others have used up the task's time
LONGEST = 500  # limit on the characters of an exception's text
NEEDS_ANOTHER = "another check must pass first"
TOO_LARGE = "the messages are too large to be checked in time"
CANNOT_JUDGE = (
    "this check raised an error on your messages: a fault in the course, which your instructor will look into"
)

# The exception's text may reveal a hidden input, so students don't see it. The evidence contains
# it.
HIDDEN_ERROR = "in a hidden scenario the code raises an exception, or ends too early"


@dataclass
class CrashLog:
    """The checks that ended a process in which they judged a submission.

    Checks have numbers in the order in which a submission is judged, which is the same in each
    process.

    Args:
        reasons: How a check ended the process, by its number.
    """

    reasons: dict[int, str] = field(default_factory=dict)
    _running: mmap.mmap = field(default_factory=lambda: mmap.mmap(-1, 8))  # shared with forks

    @property
    def running(self) -> int:
        """The number of the check that runs, or of the last one that ran; 0 before the first."""
        return int.from_bytes(self._running[:], "little")

    def begin(self) -> str:
        """Begin the next check, and return how it ended an earlier process, or ""."""
        number = self.running + 1
        self._running[:] = number.to_bytes(8, "little")
        return self.reasons.get(number, "")

    def restart(self, reason: str) -> bool:
        """Add the running check, and return whether that may help: it was not in the log before."""
        is_new = self.running not in self.reasons
        self.reasons[self.running] = reason
        self._running[:] = bytes(8)
        return is_new


def judge_in_child(run: "ExerciseRun", tasks: Sequence[Task], catalog: Catalog) -> Judgement:
    """Judge like `judge`, in a fork of this process that a check may crash.

    A check that ends the process is broken, like one that raises an exception. Each fork decodes
    all messages anew, so this is for submissions that have ended a process before.
    """
    log = CrashLog()
    while CAN_FORK:
        try:
            return call_in_child(partial(judge, run, tasks, catalog, log))
        except ChildDiedError as error:
            named = (("/".join(Path(file).parts[-3:]), line) for file, line in error.places)
            places = (f"{file} line {line}: " for file, line in named if "/checks/" in file)
            place = next(places, "")
            if not log.restart(f"{place}{error}"):
                raise
    return judge(run, tasks, catalog)


def judge(
    run: "ExerciseRun", tasks: Sequence[Task], catalog: Catalog, log: CrashLog | None = None
) -> Judgement:
    """Judge the evidence of a submission with the checks of its tasks.

    Args:
        run: The evidence.
        tasks: The tasks of the exercise.
        catalog: The course's catalog.
        log: The checks that crashed before; they are not run.
    """
    results = tuple(
        judge_task(task, *catalog.points(task), task_runs, log)
        for task in tasks
        for task_runs in [[r for r in run.runs if r.evidence.task == task.id]]
    )
    return Judgement(
        tasks=results,
        isolation=str(run.isolation),
        limit=next((result.stopped for result in results if result.stopped), run.log.limit),
        cell_errors=(*run.log.stopped.values(), *run.log.errors),
        output=run.log.output,
        digests={f"{r.evidence.task}/{r.scenario.name}": r.evidence.recording.digest() for r in run.runs},
    )


def judge_task(
    task: Task, points: float, is_bonus: bool, runs: Sequence[Run], log: CrashLog | None = None
) -> TaskResult:
    """Judge all runs of a task. A check that raises an exception loses only its own points."""
    judge = _Judge(log)
    checks = tuple(result for run in runs for result in judge.results(run))
    if task.rubric:
        # A person marks this task, so the checks only report.
        checks = tuple(replace(check, weight=0.0) for check in checks)
    public_evidence = [run.evidence for run in runs if not run.is_hidden]
    errors = dict.fromkeys(error for evidence in public_evidence for error in evidence.errors)
    if any(
        set(run.evidence.errors) - errors.keys() for run in runs if run.is_hidden and not run.evidence.stopped
    ):
        errors[HIDDEN_ERROR] = None
    stopped = next((run.evidence.stopped for run in runs if run.evidence.stopped), "")
    return TaskResult(
        task.id, task.title, points, is_bonus, checks, tuple(errors), stopped, rubric=task.rubric
    )


class _Judge:
    """The judge of one task, with a limit of processor time for all of its checks."""

    def __init__(self, log: CrashLog | None) -> None:
        self._log = log
        self._remaining = TASK_SECONDS
        self._verdicts: dict[Callable[[Evidence], Verdict], Verdict] = {}  # verdicts of the current run
        self._seconds: dict[Callable[[Evidence], Verdict], float] = {}
        self._titles: dict[Callable[[Evidence], Verdict], str] = {}  # rows of the current run

    def results(self, run: Run) -> list[CheckResult]:
        """Return a row for each check, then release the messages that were decoded for them."""
        self._verdicts = {}
        self._titles = {check.judge: check.title for check in run.scenario.checks}
        evidence = replace(run.evidence, checks=all_checks(run.scenario.checks))
        rows = []
        for check in run.scenario.checks:
            verdict = self._verdict(check, evidence)
            # The comparison is also false for NaN.
            score = verdict.score if 0 <= verdict.score <= 1 else 0.0
            row = CheckResult(
                title=check.title,
                scenario=run.scenario.name,
                is_hidden=run.is_hidden,
                weight=check.weight,
                score=score,
                message=verdict.message,
                mistake=verdict.mistake or ("as expected" if score == 1 else "not as expected"),
                broken=verdict.broken,
                seconds=self._seconds[check.judge],
            )
            rows.append(row)
        evidence.release()
        return rows

    def _verdict(self, check: Check, evidence: Evidence) -> Verdict:
        """Return a check's verdict, with score 0 if a check that it requires fails.

        If the check itself passes, the message names the row of the required check. A required
        check without a row shows its own message instead: students can't look it up.
        """
        if check.judge not in self._verdicts:
            self._verdicts[check.judge] = self._run_check(check, evidence)
        verdict = self._verdicts[check.judge]
        for required in check.requires:
            failing = self._verdict(required, evidence)
            if failing.score >= 1 and not failing.broken:
                continue
            if verdict.score >= 1 or failing.broken:
                title = self._titles.get(required.judge, required.title)
                has_row = required.judge in self._titles or failing.broken
                message = f'checked once "{title}" passes' if has_row else failing.message
                return Verdict(0.0, message, NEEDS_ANOTHER, failing.broken)
            return replace(verdict, score=0.0)
        return verdict

    def _run_check(self, check: Check, evidence: Evidence) -> Verdict:
        begin = time.process_time()
        try:
            if self._log and (crash := self._log.begin()):
                return Verdict(0.0, CANNOT_JUDGE, CANNOT_JUDGE, crash)
            with limit_course_code(max(min(CHECK_SECONDS, self._remaining), LEAST_SECONDS)):
                verdict = check.judge(evidence)
                if not isinstance(verdict, Verdict):
                    raise TypeError(f"the check returned {verdict!r}, expected passed(...) or failed(...)")
                return replace(verdict, score=float(verdict.score), message=str(verdict.message))
        except (Exception, SystemExit) as error:
            # Student data can trigger errors in a check or in the kit; the student is not at fault.
            # A check that calls sys.exit() must not end the grading of a class.
            slow = evidence.large_message if isinstance(error, TimeoutError) else ""
            message = f"{TOO_LARGE}: {slow}; publish fewer points" if slow else CANNOT_JUDGE
            kind = TOO_LARGE if slow else CANNOT_JUDGE
            return Verdict(
                0.0, message, kind, f"{_location(check, error)}{type(error).__name__}: {error}"[:LONGEST]
            )
        finally:
            self._seconds[check.judge] = time.process_time() - begin
            self._remaining -= self._seconds[check.judge]


def _location(check: Check, error: BaseException) -> str:
    """Return the location of an exception in a check, "week01.py line 12: ", or ""."""
    frames = traceback.extract_tb(error.__traceback__)
    check_frames = [frame for frame in frames if Path(frame.filename).parent.name == "checks"]
    if check_frames:
        # Three path components identify the check file; results contain no absolute paths of this
        # machine.
        return f"{'/'.join(Path(check_frames[-1].filename).parts[-3:])} line {check_frames[-1].lineno}: "
    code = getattr(check.judge, "__code__", None)
    if check.origin is None and code is not None:
        return f"{'/'.join(Path(code.co_filename).parts[-3:])} line {code.co_firstlineno}: "
    return f"{check.origin.location}: " if check.origin else ""
