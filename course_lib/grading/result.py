"""What is known of one graded submission: the file in OUT/results."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError
from course_lib.grading.exercise_run import ExerciseRun
from course_lib.grading.marks import Mark
from course_lib.grading.submission import Submission

Status = Literal["graded", "needs_marking", "limit", "rejected", "grader_error"]
MARK_COLUMNS = ("score", "max_score", "days_late", "penalty", "final")
COLUMNS = ("student", "exercise", *MARK_COLUMNS, "status", "reason", "message")


@dataclass(frozen=True)
class Result:
    """One submission's marks and reasons.

    Args:
        submission: What was handed in.
        status: `rejected` and `grader_error` have no mark.
        reason: A word: which limit, which kind of rejection.
        message: A sentence.
        mark: The arithmetic, if there is a mark.
        run: What each task got, and why.
        notes: For staff.
    """

    submission: Submission
    status: Status
    reason: str = ""
    message: str = ""
    mark: Mark | None = None
    run: ExerciseRun | None = None
    notes: tuple[str, ...] = ()

    @property
    def isolation(self) -> str:
        """How well it was kept apart from the machine that it ran on."""
        return str(self.run.isolation) if self.run else "not run"

    def row(self) -> dict[str, Any]:
        """Its line of the gradebook."""
        known = vars(self.submission) | vars(self) | (asdict(self.mark) if self.mark else {})
        return {name: known.get(name, "") for name in COLUMNS}

    def write(self, out: Path) -> None:
        """Write it to OUT/results/STUDENT/EXERCISE.json, whole or not at all."""
        submission = self.submission
        content = {
            "row": self.row(),
            "file": str(submission.path),
            "sha256": submission.sha256,
            "received": submission.received.time.isoformat(),
            "received_from": submission.received.source,
            "isolation": self.isolation,
            "notes": [*submission.notes, *self.notes],
            **(self.run.as_plain() if self.run else {}),
        }
        text = json.dumps(content, indent=1, ensure_ascii=False)
        write_whole(result_path(out, submission), text.encode("utf-8", "replace"))


def result_path(out: Path, submission: Submission) -> Path:
    """Where the result of a submission is kept."""
    return out / "results" / submission.student / f"{submission.exercise}.json"


def read_result(path: Path) -> dict[str, Any]:
    """The content of a result file.

    Raises:
        CourseError: It can't be read; names it.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        return {**content, "row": {name: content["row"][name] for name in COLUMNS}}
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Remove it and grade again.") from error
