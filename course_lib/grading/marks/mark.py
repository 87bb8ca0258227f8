"""The stage `mark`: from judgements to a result, kept in OUT/results."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal

from course_lib.course.course_file import CourseFile, Late
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.handin.ids import MISMATCH
from course_lib.grading.handin.submission import Submission
from course_lib.grading.judge import Judgement
from course_lib.grading.marks.marks import HandMark, Mark, add_up, apply_marks, marked_tasks, read_marks
from course_lib.grading.records import marks_path, result_path

Status = Literal["graded", "needs_marking", "limit", "rejected", "grader_error"]
MARK_COLUMNS = tuple(field.name for field in fields(Mark))
TEXT_COLUMNS = ("student", "exercise", "status", "reason", "message")
COLUMNS = (*TEXT_COLUMNS[:2], *MARK_COLUMNS, *TEXT_COLUMNS[2:])


@dataclass(frozen=True)
class Fault:
    """The failure of the kit or the machine because of which a submission has no judgement."""

    kind: str
    text: str

    @classmethod
    def of(cls, error: Exception) -> "Fault":
        """Return the fault of an exception."""
        return cls(type(error).__name__, str(error))


@dataclass(frozen=True)
class Result:
    """The record of one student's exercise.

    Args:
        submission: The attempt that counts.
        status: `rejected` and `grader_error` have no mark.
        reason: A word: the limit, or the kind of rejection or fault.
        message: A sentence, if there is no mark.
        judgement: Each task's checks, without the points of persons; None if there is no mark.
        days_late: Started days.
        percent_per_day: The penalty for each of them.
        notes: For staff.
        remark: The gradebook's words on a time of receipt that is not certain.
        attempts: Identity and mark of each attempt.
        digest: Of all that the result depends on; "" if it must be made again.
    """

    submission: Submission
    status: Status
    reason: str = ""
    message: str = ""
    judgement: Judgement | None = None
    days_late: int = 0
    percent_per_day: float = 0.0
    notes: tuple[str, ...] = ()
    remark: str = ""
    attempts: tuple[Mapping[str, Any], ...] = ()
    digest: str = ""

    @property
    def mark(self) -> Mark | None:
        """The arithmetic, if there is a mark."""
        if self.judgement is None:
            return None
        return add_up(self.judgement.tasks, self.days_late, Late(self.percent_per_day))

    def with_marks(self, marks: Sequence[HandMark]) -> "Result":
        """Return the result with the points of persons, for the report."""
        if self.judgement is None:
            return self
        tasks = tuple(apply_marks(task, marks, self.submission.sha256) for task in self.judgement.tasks)
        row, judgement = row_of(self.as_plain(), marks), replace(self.judgement, tasks=tasks)
        return replace(self, judgement=judgement, status=row["status"], message=row["message"])

    def as_plain(self) -> dict[str, Any]:
        """Return the content of the result's file."""
        own = {name: value for name, value in vars(self).items() if name not in ("submission", "judgement")}
        judged = self.judgement.as_plain() if self.judgement else {"isolation": "not run"}
        return {**self.submission.as_plain(), **own, **judged}

    @classmethod
    def from_plain(cls, content: Mapping[str, Any]) -> "Result":
        """Return the result of a file's content."""
        known = {field.name: content[field.name] for field in fields(cls) if field.name in content}
        judgement = Judgement.from_plain(content) if "tasks" in content else None
        return cls(**known, submission=Submission.from_plain(content), judgement=judgement)

    def write(self, out: Path) -> None:
        """Write OUT/results/STUDENT/EXERCISE.json, whole or not at all."""
        text = json.dumps(self.as_plain(), indent=1, ensure_ascii=False)
        path = result_path(out, self.submission.student, self.submission.exercise)
        write_whole(path, text.encode("utf-8", "replace"))


def mark(
    attempts: Sequence[Submission],
    judged: Sequence[Judgement | Fault | None],
    course: CourseFile,
    digest: str,
) -> Result:
    """Mark one student's attempts at an exercise; the best one counts.

    Args:
        attempts: The submissions, the oldest first.
        judged: The judgement of each, or the fault because of which it has none; None if it is rejected.
        course: Deadlines and late policy.
        digest: Of all that the result depends on.
    """
    results = [_result(one, judgement, course) for one, judgement in zip(attempts, judged, strict=True)]
    best = max(results, key=_rank)
    finals = [result.mark.final if result.mark else None for result in results]
    tried = [{**identity(one), "final": final} for one, final in zip(attempts, finals, strict=True)]
    return replace(best, attempts=tuple(tried), digest=digest if best.judgement else "")


def identity(submission: Submission) -> dict[str, str]:
    """Return the identity of an attempt: its content, its time of receipt, and whether its ID is right."""
    received = json.dumps(submission.received.as_plain())
    return {"key": submission.key, "received": received, "id_flag": submission.id_flag}


def _rank(result: Result) -> float:
    """Return the mark; a fault counts more, as that attempt may be the best, and a rejection less."""
    if result.status == "grader_error":
        return math.inf
    return result.mark.final if result.mark else -1.0


def _result(submission: Submission, judged: Judgement | Fault | None, course: CourseFile) -> Result:
    notes = tuple(submission.notes)
    if judged is None:
        reason = submission.reason or ("wrong exercise" if submission.sha256 else "unreadable")
        return Result(submission, "rejected", reason, submission.problem, notes=notes)
    if isinstance(judged, Fault):
        return Result(submission, "grader_error", judged.kind, judged.text, notes=notes)
    late, received = course.late, submission.received
    deadline = course.deadline(submission.exercise.split("_")[0], submission.student)
    broken = [f"a check could not judge it: {check}" for check in judged.broken]
    return Result(
        submission,
        "limit" if judged.limit else "graded",
        judged.limit,
        judgement=judged,
        days_late=received.days_late(deadline, late),
        percent_per_day=late.percent_per_day,
        notes=(*notes, *received.contradictions(deadline, late), *broken),
        remark=received.remark(deadline, late),
    )


def read_result(path: Path) -> dict[str, Any]:
    """Return the content of a result file, with its `row` of the gradebook.

    Raises:
        CourseError: The file, or the file of marks, can't be read; names it.
    """
    marks = read_marks(marks_path(path.parents[2], path.parent.name, path.stem))
    try:
        content = read_json(path.read_text(encoding="utf-8"))
        content |= {
            "student": path.parent.name,
            "exercise": path.stem,
        }  # a name on the disk may hold any bytes
        return {**content, "row": row_of(content, marks)}
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Remove it and grade again.") from error


def results_in(out: Path) -> Iterator[dict[str, Any]]:
    """Yield all results, by student and exercise, one at a time: together they may be large."""
    return map(read_result, sorted((out / "results").glob("*/*.json")))


def need_results(out: Path) -> None:
    """Refuse a folder that `course grade` has not written.

    Raises:
        CourseError: It holds no result.
    """
    if not any((out / "results").glob("*/*.json")):
        raise CourseError(f"{out} has no results. Type: course grade SUBMISSIONS --out {out}")


def row_of(content: Mapping[str, Any], marks: Sequence[HandMark] = ()) -> dict[str, Any]:
    """Return the line of the gradebook for a result and the points of persons."""
    row = dict.fromkeys(MARK_COLUMNS, "") | {name: content[name] for name in TEXT_COLUMNS}
    tasks = marked_tasks(content, marks)
    if tasks:
        full = sum(task.score >= task.points for task in tasks)
        said = f"{full} of {len(tasks)} tasks have full marks"
        if again := ", ".join(task.task for task in tasks if not task.is_current):
            said += f"; {again}: marked in another hand-in: mark it again"
        row["message"] = "; ".join(filter(None, (said, content.get("remark"))))
        row |= asdict(add_up(tasks, content["days_late"], Late(content["percent_per_day"])))
    if any(task.waits for task in tasks):
        row["status"] = "needs_marking"
    if tasks and content.get("id_flag") == MISMATCH:
        row["reason"] = ", ".join(filter(None, (row["reason"], MISMATCH)))
        row["message"] = f"{content['id_note']}; {row['message']}"
        if not any(mark.is_of(content["sha256"]) for mark in marks):  # who gave marks has seen it
            row["status"] = "needs_marking"
    return {name: row[name] for name in COLUMNS}
