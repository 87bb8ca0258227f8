"""The tasks of all submissions, for persons who mark them at the same time."""

import hashlib
import threading
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from course_lib.errors import CourseError
from course_lib.grading.judge import TaskResult
from course_lib.grading.marks.mark import read_result
from course_lib.grading.marks.marks import (
    Given,
    HandMark,
    add_marks,
    apply_marks,
    marked_tasks,
    read_marks,
    revision_of,
    whole_task_counts,
)
from course_lib.grading.records import digest_of, marks_path, result_path

PRESENT = 10.0  # [s] after its last question, a page counts as closed
MOST_COMMENTS = 30  # that are offered again
State = Literal["waiting", "marked", "checks"]
Stamp = tuple[int, ...] | None


@dataclass(frozen=True)
class QueueItem:
    """One task of one submission, in a line.

    Args:
        key: Of letters and digits, in addresses instead of names.
        student: As the results have it.
        exercise: "week05_exercise".
        task: Its id.
        title: Of the task.
        alias: Of the student, for those who mark without names.
        score: Points as they are now.
        points: The most that it can give.
        state: Waits for a person, was marked by one, or has points by checks alone.
        failed: The titles of the checks without full score.
        note: Why the submission is to be looked at, or "".
        revision: Of the marks.
    """

    key: str
    student: str
    exercise: str
    task: str
    title: str
    alias: str
    score: float
    points: float
    state: State
    failed: tuple[str, ...]
    note: str
    revision: str


class MarkingQueue:
    """A folder of records as the pages see it; it may change under them, and every mark goes to the disk.

    Args:
        out: The folder that `course grade` wrote.
    """

    def __init__(self, out: Path) -> None:
        self.out = out
        self._lock = threading.Lock()
        self._stamps: dict[Path, tuple[Stamp, Stamp]] = {}
        self._items: dict[str, tuple[int, QueueItem]] = {}  # with the number of the last change
        self._comments: dict[Path, list[HandMark]] = {}
        self._problems: dict[Path, str] = {}
        self._pages: dict[str, tuple[str, str, float]] = {}  # item and person of each page, and when
        self._number = 0

    def since(self, number: int) -> dict[str, Any]:
        """Return what has changed after a change, as plain data; 0 is before the first one."""
        with self._lock:
            self._look()
            items = [asdict(item) for changed, item in self._items.values() if changed > number]
            return {"number": self._number, "items": items, "problems": sorted(self._problems.values())}

    def at_work(self, page: str, person: str, key: str | None) -> dict[str, str]:
        """Return the items that other pages show, with their persons.

        Args:
            page: The page that asks.
            person: Who is at work on it.
            key: The item that it opens; None is still the last one.
        """
        with self._lock:
            now = time.monotonic()
            key = self._pages[page][0] if key is None and page in self._pages else key or ""
            self._pages[page] = (key, person, now)
            self._pages = {one: at for one, at in self._pages.items() if now - at[2] < PRESENT}
            return {at[0]: at[1] for one, at in self._pages.items() if one != page and at[0]}

    def item(self, key: str) -> QueueItem:
        """Return an item as the disk has it.

        Raises:
            CourseError: There is none.
        """
        with self._lock:
            self._look()
            if key not in self._items:
                raise CourseError("this task is not in the results any more: choose another one")
            return self._items[key][1]

    def details(self, key: str) -> dict[str, Any]:
        """Return an item as plain data with its rubric, marks and checks, and comments to be used again.

        Raises:
            CourseError: There is none, or a file can't be read.
        """
        item = self.item(key)
        task, marks, sha256 = self._read(item)
        shown = apply_marks(task, marks, sha256)
        mine = [mark for mark in marks if mark.task == item.task]
        return {
            **asdict(item),
            "revision": revision_of(marks, item.task, sha256),
            "score": shown.score,
            "rubric": [asdict(row) for row in task.rubric],
            "whole": whole_task_counts(mine),
            "marks": [asdict(mark) for mark in mine],
            "checks": [asdict(check) for check in sorted(task.checks, key=lambda check: check.score)],
            "errors": list(task.errors),
            "used": self._used(item.task),
        }

    def save(self, key: str, given: Sequence[Given], by: str, revision: str) -> None:
        """Store the marks of a person, all or none; they are on the disk afterwards.

        Raises:
            MarksConflictError: Somebody else has marked the task since that revision.
            OutError: The folder can't be written.
            CourseError: There is no such task or row, or it has fewer points.
        """
        item = self.item(key)
        task, _, sha256 = self._read(item)
        file = marks_path(self.out, item.student, item.exercise)
        add_marks(file, task, given, sha256=sha256, by=by, revision=revision)

    def _read(self, item: QueueItem) -> tuple[TaskResult, list[HandMark], str]:
        content = read_result(result_path(self.out, item.student, item.exercise))
        marks = read_marks(marks_path(self.out, item.student, item.exercise))
        found = (task for task in content.get("tasks", ()) if task["task"] == item.task)
        task = next(found, None)
        if task is None:
            raise CourseError(f"{item.exercise} of {item.student} has no task {item.task} any more")
        return TaskResult.from_plain(task), marks, content["sha256"]

    def _used(self, task: str) -> list[list[str]]:
        """Return the comments on a task, with their rows, the most frequent first."""
        with self._lock:
            all_marks = [mark for marks in self._comments.values() for mark in marks]
        said = Counter((mark.row, mark.comment) for mark in all_marks if mark.task == task and mark.comment)
        return [list(pair) for pair, _ in said.most_common(MOST_COMMENTS)]

    def _look(self) -> None:
        """Read each result that is new or has changed, with its marks."""
        for path in sorted((self.out / "results").glob("[!.]*/[!.]*.json")):
            marks = marks_path(self.out, path.parent.name, path.stem)
            stamps = (_stamp(path), _stamp(marks))
            if self._stamps.get(path) != stamps:
                self._stamps[path] = stamps
                self._number += 1
                self._read_result(path, marks)

    def _read_result(self, path: Path, marks_file: Path) -> None:
        self._problems.pop(path, None)
        try:
            content, marks = read_result(path), read_marks(marks_file)
        except CourseError as error:
            self._problems[path] = str(error)
            return
        self._comments[path] = marks
        items = _items(content, marks)
        self._items.update({item.key: (self._number, item) for item in items})


def _stamp(path: Path) -> Stamp:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size


def _items(content: Mapping[str, Any], marks: Sequence[HandMark]) -> list[QueueItem]:
    tasks = marked_tasks(content, marks)
    is_waiting = content["row"]["status"] == "needs_marking"
    first = tasks[:1] if is_waiting and not any(task.waits for task in tasks) else []
    return [_item(task, content, marks, waits=task.waits or task in first) for task in tasks]


def _item(
    task: TaskResult, content: Mapping[str, Any], marks: Sequence[HandMark], *, waits: bool
) -> QueueItem:
    student, exercise = content["student"], content["exercise"]
    by_person = any(mark.task == task.task for mark in marks)
    return QueueItem(
        key=digest_of([student, exercise, task.task])[:20],
        student=student,
        exercise=exercise,
        task=task.task,
        title=task.title,
        alias=hashlib.sha256(student.encode("utf-8", "surrogatepass")).hexdigest()[:6],
        score=task.score,
        points=task.points,
        state="waiting" if waits else "marked" if by_person else "checks",
        failed=tuple(dict.fromkeys(check.title for check in task.checks if not check.passed)),
        note=content.get("id_note") or "",
        revision=revision_of(marks, task.task, content["sha256"]),
    )
