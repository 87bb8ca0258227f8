"""The records of a submission: its files, its results, and its points.

The stages of `grade` pass these objects on, and store them as they are, so the program has no
second form of them. They are frozen dataclasses. msgspec builds them from JSON and checks each
field, so the error about a damaged file names the field.

| record | written by | file |
|---|---|---|
| `Submission` | `submissions/` | part of the result |
| evidence of its run | `run/` | OUT/evidence/DIGEST.msgpack.gz (`evidence.py`) |
| `Result` | `judge.py`, `marks.py` | OUT/results/STUDENT/EXERCISE.json |
| `HandMark` | a grader | OUT/marks/STUDENT/EXERCISE.json |

`marks.MarkedResult` combines a result with graders' points, as gradebook, reports and exports
show it.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from course_lib.course.course_file import Counts, LatePolicy
from course_lib.errors import format_count
from course_lib.files import write_atomically
from course_lib.grading.evidence import Evidence
from course_lib.grading.store import result_path
from course_lib.grading.submissions.notebook import Notebook
from course_lib.grading.task import Row, Scenario
from course_lib.third_party import read_json

# The structure of a result's file. Files of the kit up to 0.3 have no version, and all fields in
# one object. Before version 4, some fields have other names.
VERSION = 4
DAY = 86_400  # [s]
RECEIPT_TIME, UNKNOWN = "receipt", "unknown"  # sources of a time of receipt
# How the ID in a file compares with its student: `Submission.id_flag`.
MISMATCH, NO_ID, UNVERIFIED = "ID mismatch", "no ID", "ID not verified"
NOT_RUN = "not run"
Status = Literal["graded", "needs_marking", "limit", "rejected", "grader_error"]
T = TypeVar("T")
OLD_SUBMISSION = (
    "student", "exercise", "claimed_id", "sha256", "problem", "key", "twins", "values_of", "id_flag",
    "id_note",
)  # fmt: skip
OLD_RECEIVED = {"time": "received", "source": "received_from", "late": "late", "receipt": "receipt_time"}
OLD_LATE = ("percent_per_day", "max_percent", "accepted_days")
OLD_JUDGEMENT = ("tasks", "isolation", "cell_errors", "output", "digests", "limit")
RENAMED_FIELDS = {
    "claimed": "claimed_id", "named": "relative_path", "refused": "rejected_files",
    "hidden": "is_hidden", "bonus": "is_bonus", "handed_in_as": "download_path",
}  # fmt: skip
NO_PENALTY = LatePolicy(0.0)


@dataclass(frozen=True)
class ReceiptTime:
    """The best known time of receipt.

    Args:
        time: The time in UTC; None if unknown.
        source: Where it was recorded: received.csv, timestamp.txt, receipt, or unknown.
        late: Whether the platform marks it as late; None if unknown.
        receipt: The time in the file of `course submit`, written by the student's machine.
        notes: Notes on times that could not be used.
        download_path: The path in the platform's download, or "".
    """

    time: datetime | None
    source: str
    late: bool | None = None
    receipt: datetime | None = None
    notes: tuple[str, ...] = ()
    download_path: str = ""

    @property
    def is_trusted(self) -> bool:
        """True if the platform or the instructor recorded the time."""
        return self.time is not None and self.source != RECEIPT_TIME

    def days_late(self, deadline: datetime | None, policy: LatePolicy) -> int:
        """Return the started days after the deadline; 1 if the platform only marks it as late."""
        if deadline is None:
            return 0
        if self.time is None:
            return int(self.late is True)
        return count_days_late(self.time, deadline, policy)

    def remark(self, deadline: datetime | None, policy: LatePolicy) -> str:
        """Return the gradebook's remark about an uncertain time, or ""."""
        if deadline is None or self.is_trusted:
            return ""
        if self.time is not None:
            lateness = "late" if self.days_late(deadline, policy) else "on time"
            return f"{lateness} according to the receipt only, which the student's machine wrote"
        if self.late is None:
            return "time of receipt unknown: not counted as late"
        return "late according to the platform, time unknown: counted as 1 day" if self.late else (
            "time of receipt unknown: not late according to the platform"
        )  # fmt: skip

    def contradictions(self, deadline: datetime | None, policy: LatePolicy) -> list[str]:
        """Return notes for staff if two sources disagree about lateness."""
        if deadline is None:
            return ["the platform marks it as late, but course.toml has no deadline"] if self.late else []
        days = self.days_late(deadline, policy)
        notes = []
        if self.is_trusted and self.late is not None and self.late != (days > 0):
            lateness = "late" if self.late else "not late"
            notes.append(
                f"the platform marks it as {lateness}, "
                f"but according to {self.source} it is {format_count(days, 'day')} late"
            )
        if self.source != RECEIPT_TIME and self.receipt is not None:
            by_receipt = count_days_late(self.receipt, deadline, policy)
            if (by_receipt > 0) != (days > 0):
                days_text = format_count(by_receipt, "day")
                notes.append(f"according to its receipt, which is not trusted, it is {days_text} late")
        return notes


def count_days_late(received: datetime, deadline: datetime | None, late: LatePolicy) -> int:
    """Return the number of started days after the deadline plus the minutes of grace.

    A day lasts until the same local time of the next day, even if the clocks change in between.
    """
    if deadline is None:
        return 0
    # Subtracting times of the same zone would ignore clock changes.
    received = received.astimezone(UTC)
    days = max(math.floor((received - deadline).total_seconds() / DAY) - 1, 0)
    while received - (deadline + timedelta(days=days)) > timedelta(minutes=late.grace_minutes):
        days += 1
    return days


@dataclass(frozen=True)
class Submission:
    """A submission of one exercise.

    Args:
        student: The name of the folder that contains it, else the ID in the file.
        exercise: "week01_exercise"; the file's name if the exercise is unknown.
        path: The file's path; in a result, relative to the folder of submissions, so that both can
            be moved.
        received: The time of receipt and its source.
        notebook: Its cells and metadata; None if it can't be read.
        files: Contents of files submitted with it, by relative path.
        claimed_id: The ID in the file.
        sha256: Digest of the notebook and its files.
        problem: The reason why it can't be graded, or "".
        key: The key of its evidence, if it can be graded.
        twins: Other students who submitted the same file.
        rivals: Files and folders with this student's ID; somebody may have used a wrong ID.
        values_of: The student whose personal values count; None is a guest.
        id_flag: A short description of a problem with the ID in the file, or "".
        id_note: The same as a sentence.
        uncounted_files: The student's other files of the exercise, which do not count.
        reason: A keyword for the problem, if it is not the file's.
        relative_path: The file's path in the folder of submissions.
        counts: Which of several files counts.
        rejected_files: The student's files that `course collect` rejected, with the reasons.
        is_untouched: True if the notebook is the unchanged exercise.
    """

    student: str
    exercise: str
    path: Path
    received: ReceiptTime
    notebook: Notebook | None = None
    files: Mapping[str, str] = field(default_factory=dict)
    claimed_id: str | None = None
    sha256: str = ""
    problem: str = ""
    key: str = ""
    twins: tuple[str, ...] = ()
    rivals: tuple[str, ...] = ()
    values_of: str | None = None
    id_flag: str = ""
    id_note: str = ""
    uncounted_files: tuple[str, ...] = ()
    reason: str = ""
    relative_path: str = ""
    counts: Counts = "last"
    rejected_files: tuple[str, ...] = ()
    is_untouched: bool = False

    @property
    def is_exercise(self) -> bool:
        """True if it is a readable exercise with a non-empty cell."""
        return not self.problem and self.notebook is not None and any(map(str.strip, self.notebook.cells))

    @property
    def notes(self) -> list[str]:
        """Notes for staff."""
        notes = [f"the same file as that of {', '.join(self.twins)}"] if self.twins else []
        if self.is_untouched:
            notes.append("the unchanged exercise: nothing was written into it")
        if self.rivals:
            notes.append(
                f"several files have the ID {self.student}, in {', '.join(self.rivals)}: this one counts"
            )
        if self.uncounted_files and self.counts == "best":
            notes.append(
                f"the best of these counts: {', '.join((*self.uncounted_files, self.relative_path))}"
            )
        elif self.uncounted_files:
            notes.append(f"{self.relative_path} counts, not {', '.join(self.uncounted_files)}")
        if self.rejected_files:
            notes.append(f"not collected: {', '.join(self.rejected_files)}")
        notes += self.received.notes
        return [*notes, self.id_note] if self.id_note else notes


@dataclass(frozen=True)
class Run:
    """A scenario and the evidence of its run."""

    scenario: Scenario
    evidence: Evidence
    is_hidden: bool = False


@dataclass(frozen=True)
class CheckResult:
    """The result of one check.

    Args:
        title: The check's title.
        scenario: The scenario's name.
        is_hidden: Whether the message is withheld from students.
        weight: Share of the task's points.
        score: From 0 to 1.
        message: The reason, with values.
        mistake: The kind of mistake, without values.
        broken: The exception that the check raised, or ""; for staff only.
        seconds: Processor time [s]. It differs from run to run, so it is not stored in result
            files.
    """

    title: str
    scenario: str
    is_hidden: bool
    weight: float
    score: float
    message: str
    mistake: str
    broken: str = ""
    seconds: float = field(default=0.0, compare=False)

    @property
    def passed(self) -> bool:
        """True if the score is full."""
        return self.score >= 1


@dataclass(frozen=True)
class TaskResult:
    """The mark of one task and its reasons.

    Args:
        task: The task's id.
        title: The title in tables.
        points: The maximum number of points.
        is_bonus: Whether the points are added on top of the 100.
        checks: The results of its checks.
        errors: The exceptions that the student's code raised.
        stopped: The limit that ended the code, or "".
        manual: Points given by a person, which replace the checks' points.
        comments: Comments by that person.
        rubric: The rows by which a person marks the task.
        is_current: False if those points were given for another submission.
    """

    task: str
    title: str
    points: float
    is_bonus: bool
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
        total_weight = sum(check.weight for check in self.checks)
        return (
            sum(check.weight * check.score for check in self.checks) / total_weight if total_weight else 0.0
        )

    @property
    def score(self) -> float:
        """The points given by a person, else by the checks."""
        return round(self.points * self.fraction, 2) if self.manual is None else self.manual

    @property
    def is_untouched(self) -> bool:
        """True if every error is the stub's NotImplementedError."""
        return bool(self.errors) and all(error.startswith("NotImplementedError") for error in self.errors)

    @property
    def passed(self) -> bool:
        """True if all checks pass."""
        return all(check.passed for check in self.checks)

    @property
    def needs_hand_mark(self) -> bool:
        """True if a person must mark the task.

        This holds if it has a rubric, if a check with a weight raised an exception, or if the
        points were given for another submission.
        """
        is_broken = any(check.broken and check.weight for check in self.checks)
        return not self.is_current or (self.manual is None and (bool(self.rubric) or is_broken))


@dataclass(frozen=True)
class Judgement:
    """The results of all tasks of one submission, and the log of its cells.

    Args:
        tasks: In the order of the exercise.
        isolation: The isolation layers that were active during the run.
        cell_errors: Exceptions of the cells, which run once before the scenarios.
        output: The text that the cells printed.
        digests: Digests of the recordings, by task and scenario.
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
        """Each check that raised an exception, with task and scenario; for staff only."""
        rows = [(task.task, check) for task in self.tasks for check in task.checks if check.broken]
        return [f"{task}, {check.scenario}, {check.title!r}: {check.broken}" for task, check in rows]


@dataclass(frozen=True)
class Fault:
    """An error of the kit or the machine that prevented the judgement of a submission."""

    kind: str
    text: str

    @classmethod
    def from_error(cls, error: Exception) -> "Fault":
        """Return the fault for an exception."""
        return cls(type(error).__name__, str(error))


@dataclass(frozen=True)
class Attempt:
    """One of several submissions of an exercise.

    Args:
        key: The key of its evidence, or "".
        received: The time of receipt and its source.
        id_flag: What is wrong with the ID that the file names, or "".
        final: Points after the late policy; None without a mark.
    """

    key: str
    received: ReceiptTime
    id_flag: str = ""
    final: float | None = None


@dataclass(frozen=True)
class Mark:
    """The computed mark of one submission, in points; `penalty` is the deduction for lateness."""

    score: float
    max_score: float
    days_late: int
    penalty: float
    final: float

    @classmethod
    def compute(cls, tasks: Sequence[TaskResult], days_late: int, late: LatePolicy) -> "Mark":
        """Add up the points of tasks, bonus on top, and deduct the late penalty."""
        score = round(sum(task.score for task in tasks), 2)
        max_score = sum(task.points for task in tasks if not task.is_bonus)
        penalty = round(score * late.penalty_percent(days_late) / 100, 2)
        return cls(score, max_score, days_late, penalty, round(score - penalty, 2))


@dataclass(frozen=True)
class Result:
    """The record of one student's exercise.

    Args:
        submission: The attempt that counts.
        status: The status; `rejected` and `grader_error` have no mark.
        reason: The limit that was reached, or the kind of rejection or fault.
        message: An explanation if there is no mark.
        judgement: Each task's checks, without points by graders; None if there is no mark.
        days_late: Number of started days after the deadline.
        late: The late policy when it was marked.
        notes: Notes for staff.
        remark: The gradebook's remark about an uncertain time of receipt.
        attempts: All attempts, oldest first.
        rules: Digest of the rules by which the submission was judged.
        digest: Digest of everything that the result depends on; "" if it must be computed again.
        version: The version of the file's structure.
    """

    submission: Submission
    status: Status
    reason: str = ""
    message: str = ""
    judgement: Judgement | None = None
    days_late: int = 0
    late: LatePolicy = NO_PENALTY
    notes: tuple[str, ...] = ()
    remark: str = ""
    attempts: tuple[Attempt, ...] = ()
    rules: str = ""
    digest: str = ""
    version: int = VERSION

    @property
    def mark(self) -> Mark | None:
        """The mark without graders' points; None if there is no judgement."""
        return Mark.compute(self.judgement.tasks, self.days_late, self.late) if self.judgement else None

    @property
    def tasks(self) -> tuple[TaskResult, ...]:
        """The tasks; none if there is no judgement."""
        return self.judgement.tasks if self.judgement else ()

    @property
    def isolation(self) -> str:
        """The layers between the submission and the machine that it ran on."""
        return self.judgement.isolation if self.judgement else NOT_RUN

    @property
    def rejection_reason(self) -> str:
        """The reason why the submission is too late for points, or ""."""
        if self.late.is_accepted(self.days_late):
            return ""
        days = format_count(self.days_late, "started day")
        return f"not accepted: {days} late, at most {self.late.accepted_days:g} are accepted"

    def write(self, out: Path) -> None:
        """Write OUT/results/STUDENT/EXERCISE.json, completely or not at all."""
        content = to_plain(self)
        for name in ("notebook", "files"):
            del content["submission"][name]
        task_contents = content["judgement"]["tasks"] if self.judgement else ()
        for task, plain in zip(self.tasks, task_contents, strict=True):
            # The file contains the score for other programs; the kit computes it.
            plain["score"] = task.score
            # Measured times vary, but equal submissions must get equal files.
            for check in plain["checks"]:
                del check["seconds"]
        text = json.dumps(content, indent=1, ensure_ascii=False)
        # msgspec's own encoder rejects lone surrogates, which a student's output may contain.
        path = result_path(out, self.submission.student, self.submission.exercise)
        write_atomically(path, text.encode("utf-8", "replace"))


@dataclass(frozen=True)
class HandMark:
    """A grader's points for a task or a row of its rubric. The last one is used.

    Args:
        task: The task's id; "" for a whole exercise without a gradable file.
        points: The points; None for a comment alone.
        row: The text of the rubric's row; "" for the whole task.
        comment: A comment for the student; the last one of each row counts.
        by: The grader.
        at: The time in ISO format.
        sha256: Digest of the submission that the grader has seen; "" if unknown.
        withdrawn: Whether this entry withdraws all earlier marks for the row, or for the task and
            all its rows.
    """

    task: str
    points: float | None
    row: str
    comment: str
    by: str
    at: str
    sha256: str = ""
    withdrawn: bool = False

    def is_of(self, sha256: str) -> bool:
        """Return whether the mark is for a submission with this SHA-256, or has no digest."""
        return self.sha256 in ("", sha256)


def to_plain(record: Any) -> Any:
    """Convert a record to dictionaries, lists, strings and numbers."""
    # asdict first, because msgspec omits fields that were missing in the file that it has read.
    return msgspec.to_builtins(asdict(record), enc_hook=_path_to_text)


def from_plain(content: Any, kind: type[T]) -> T:
    """Build a record from JSON values.

    Raises:
        ValueError: A field is missing or has the wrong type. The message names it.
    """
    return msgspec.convert(content, kind, dec_hook=_path_from_text)


def read_stored_result(path: Path) -> Result:
    """Read the file of a result.

    Raises:
        ValueError: The file is not a result. The message names the field.
        OSError: The file can't be read.
    """
    content = read_json(path.read_text(encoding="utf-8"))
    if isinstance(content, dict) and content.get("version") != VERSION:
        content = _rename_fields(content)
    if isinstance(content, dict) and "submission" not in content:
        content = _from_version_1(content)
    return from_plain(content, Result)


def _rename_fields(content: Any) -> Any:
    if isinstance(content, dict):
        return {RENAMED_FIELDS.get(key, key): _rename_fields(value) for key, value in content.items()}
    return [_rename_fields(value) for value in content] if isinstance(content, list) else content


def _from_version_1(content: Mapping[str, Any]) -> dict[str, Any]:
    """Convert the content of a result's file of version 0.3 to the current structure."""
    when = {new: content.get(old_name) for new, old_name in OLD_RECEIVED.items()}
    when["download_path"] = content.get("download_path", "")
    submission = {name: content[name] for name in OLD_SUBMISSION if name in content}
    submission |= {"path": content.get("file"), "received": when}
    late_policy = {name: content[name] for name in OLD_LATE if name in content}
    attempts = [
        {"key": old["key"], "received": when, "id_flag": old.get("id_flag", ""), "final": old["final"]}
        for old in content.get("attempts", ())
    ]
    new = {**content, "submission": submission, "late": late_policy, "attempts": attempts, "version": 1}
    if "tasks" in content:
        new["judgement"] = {name: content[name] for name in OLD_JUDGEMENT if name in content}
    return new


def _path_to_text(value: Any) -> str:
    if isinstance(value, Path):
        return value.as_posix()
    raise NotImplementedError(f"{type(value).__name__} is not stored in a record")


def _path_from_text(kind: type, value: Any) -> Any:
    if kind is Path and isinstance(value, str):
        return Path(value)
    raise NotImplementedError(f"{kind.__name__} is not read from a record")
