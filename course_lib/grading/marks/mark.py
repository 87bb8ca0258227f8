"""What is known of one graded submission: the file in OUT/results."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal

from course_lib.course.course_file import Late
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.handin.ids import MISMATCH
from course_lib.grading.handin.submission import Submission
from course_lib.grading.judge import CheckResult, TaskResult
from course_lib.grading.marks.marks import HandMark, Mark, apply_marks, mark, marks_path, read_marks
from course_lib.grading.run.run import ExerciseRun

Status = Literal["graded", "needs_marking", "limit", "rejected", "grader_error"]
MARK_COLUMNS = ("score", "max_score", "days_late", "penalty", "final")
TEXT_COLUMNS = ("student", "exercise", "status", "reason", "message")
COLUMNS = (*TEXT_COLUMNS[:2], *MARK_COLUMNS, *TEXT_COLUMNS[2:])


@dataclass(frozen=True)
class Result:
    """One submission's marks and reasons.

    Args:
        submission: What was handed in.
        status: `rejected` and `grader_error` have no mark.
        reason: A word: which limit, which kind of rejection.
        message: A sentence, if there is no mark.
        run: What each task got, and why.
        days_late: Started days.
        percent_per_day: What each of them costs.
        notes: For staff.
        rules: A hash of the course file and the checks of that time.
        remark: What the gradebook says of a time of receipt that is not certain.
        attempts: What was handed in, all of it if the best counts, with the mark of each.
    """

    submission: Submission
    status: Status
    reason: str = ""
    message: str = ""
    run: ExerciseRun | None = None
    days_late: int = 0
    percent_per_day: float = 0.0
    notes: tuple[str, ...] = ()
    attempts: tuple[dict[str, Any], ...] = ()
    rules: str = ""
    remark: str = ""

    @property
    def isolation(self) -> str:
        """How well it was kept apart from the machine that it ran on."""
        return str(self.run.isolation) if self.run else "not run"

    @property
    def mark(self) -> Mark | None:
        """The arithmetic, if there is a mark."""
        return mark(self.run.results, self.days_late, Late(self.percent_per_day)) if self.run else None

    def with_marks(self, marks: Sequence[HandMark]) -> "Result":
        """The same with what persons gave, for the report."""
        if self.run is None:
            return self
        pairs = zip(self.run.tasks, self.run.results, strict=True)
        results = [apply_marks(one, [asdict(row) for row in task.rubric], marks) for task, one in pairs]
        row, run = row_of(self.content(), marks), replace(self.run, results=tuple(results))
        return replace(self, run=run, status=row["status"], message=row["message"])

    def content(self) -> dict[str, Any]:
        """What its file holds: nothing that a person gave is in it."""
        return {
            **self.submission.as_plain(),
            **{name: value for name, value in vars(self).items() if name not in ("submission", "run")},
            "isolation": self.isolation,
            "notes": [*self.submission.notes, *self.notes, *self._broken_notes()],
            **(self.run.as_plain() if self.run else {}),
        }

    def _broken_notes(self) -> list[str]:
        return [f"a check could not judge it: {check}" for check in self.run.broken] if self.run else []

    def write(self, out: Path) -> None:
        """Write it to OUT/results/STUDENT/EXERCISE.json, whole or not at all."""
        text = json.dumps(self.content(), indent=1, ensure_ascii=False)
        path = result_path(out, self.submission.student, self.submission.exercise)
        write_whole(path, text.encode("utf-8", "replace"))


def result_path(out: Path, student: str, exercise: str) -> Path:
    """Where the result of a submission is kept."""
    return out / "results" / student / f"{exercise}.json"


def read_result(path: Path) -> dict[str, Any]:
    """The content of a result file, and its `row` of the gradebook with what persons gave.

    Raises:
        CourseError: It, or the file of marks, can't be read; names it.
    """
    marks = read_marks(marks_path(path.parents[2], path.parent.name, path.stem))
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        return {**content, "row": row_of(content, marks)}
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Remove it and grade again.") from error


def results_in(out: Path) -> Iterator[dict[str, Any]]:
    """All results, by student and exercise, one at a time: together they may be large."""
    return map(read_result, sorted((out / "results").glob("*/*.json")))


def row_of(content: Mapping[str, Any], marks: Sequence[HandMark] = ()) -> dict[str, Any]:
    """The line of the gradebook that a result and what persons gave come to."""
    row = dict.fromkeys(MARK_COLUMNS, "") | {name: content[name] for name in TEXT_COLUMNS}
    tasks = content.get("tasks", ())
    results = [apply_marks(_task(task), task["rubric"], marks) for task in tasks]
    if results:
        full = sum(one.score >= one.points for one in results)
        said = f"{full} of {len(results)} tasks have full marks"
        row["message"] = "; ".join(filter(None, (said, content.get("remark"))))
        row |= asdict(mark(results, content["days_late"], Late(content["percent_per_day"])))
    pairs = zip(tasks, results, strict=True)
    if any(one.waits or (task["rubric"] and one.manual is None) for task, one in pairs):
        row["status"] = "needs_marking"
    if results and content.get("id_flag") == MISMATCH:
        row["reason"] = ", ".join(filter(None, (row["reason"], MISMATCH)))
        row["message"] = f"{content['id_note']}; {row['message']}"
        if not marks:  # a person who gave marks has seen it
            row["status"] = "needs_marking"
    return {name: row[name] for name in COLUMNS}


def _task(task: Mapping[str, Any]) -> TaskResult:
    known = {field.name: task[field.name] for field in fields(TaskResult)}
    return TaskResult(**{**known, "checks": tuple(CheckResult(**check) for check in task["checks"])})
