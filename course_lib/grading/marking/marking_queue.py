"""The tasks of all submissions, for several graders who mark at the same time."""

import hashlib
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from course_lib.errors import CourseError
from course_lib.grading import store
from course_lib.grading.marks import (
    MarkedResult,
    MarkEntry,
    add_marks,
    apply_marks,
    has_task_mark,
    read_result,
    revision_of,
    standing_marks,
    stored_result,
)
from course_lib.grading.records import HandMark, TaskResult

PRESENT = 10.0  # [s] time without requests after which a page is considered closed
MOST_COMMENTS = 30  # limit on the comments offered for reuse
State = Literal["waiting", "marked", "checks"]
Stamp = tuple[int, ...] | None


class OpenItem(NamedTuple):
    """The item that a page shows."""

    key: str
    grader: str
    # Time of the page's last request, by the monotonic clock [s].
    requested_at: float


@dataclass(frozen=True)
class QueueItem:
    """One task of one submission in the queue.

    Args:
        key: Letters and digits that replace the names in URLs.
        student: The student as in the results.
        exercise: "week05_exercise".
        task: The task's id.
        title: The task's title.
        alias: A pseudonym of the student, for marking without names.
        score: The current points.
        points: The maximum number of points.
        state: Whether it waits for a grader, was marked by one, or has points of checks only.
        failed: Titles of the checks without full score.
        note: A reason to review the submission, or "".
        revision: Revision of the marks.
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
    """The tasks in a folder of records, as shown to the pages.

    The folder may change at any time, so it is read again for each request, and each mark is
    written to the disk before it is acknowledged.

    Args:
        out: The folder that `course grade` wrote.
    """

    def __init__(self, out: Path) -> None:
        self.out = out
        self._lock = threading.Lock()
        self._stamps: dict[Path, tuple[Stamp, Stamp]] = {}
        self._items: dict[str, tuple[int, QueueItem]] = {}  # (number of the last change, item) by key
        self._comments: dict[Path, list[HandMark]] = {}
        self._problems: dict[Path, str] = {}
        self._open_items: dict[str, OpenItem] = {}  # by page
        self._number = 0

    def changes_since(self, number: int) -> dict[str, Any]:
        """Return the items changed since a change number, as plain data; 0 returns all."""
        with self._lock:
            self._refresh()
            items = [asdict(item) for change_number, item in self._items.values() if change_number > number]
            return {"number": self._number, "items": items, "problems": sorted(self._problems.values())}

    def set_open_item(self, page: str, person: str, key: str | None) -> dict[str, str]:
        """Return the items open on other pages, with their graders.

        Args:
            page: The page that sends the request.
            person: The grader who uses it.
            key: The item that it opens; None keeps the previous item.
        """
        with self._lock:
            now = time.monotonic()
            if key is None:
                key = self._open_items[page].key if page in self._open_items else ""
            items = self._open_items | {page: OpenItem(key, person, now)}
            self._open_items = {p: item for p, item in items.items() if now - item.requested_at < PRESENT}
            others = (item for p, item in self._open_items.items() if p != page and item.key)
            return {item.key: item.grader for item in others}

    def item(self, key: str) -> QueueItem:
        """Return an item in its current state on the disk.

        Raises:
            CourseError: It does not exist.
        """
        with self._lock:
            self._refresh()
            if key not in self._items:
                raise CourseError("this task is no longer in the results: choose another one")
            return self._items[key][1]

    def details(self, key: str) -> dict[str, Any]:
        """Return an item as plain data with rubric, marks, checks, and comments for reuse.

        Raises:
            CourseError: It does not exist, or a file can't be read.
        """
        item = self.item(key)
        task, marks, sha256 = self._read(item)
        marked_task = apply_marks(task, marks, sha256)
        marks_of_task = [mark for mark in standing_marks(marks) if mark.task == item.task]
        with self._lock:
            all_marks = [mark for marks in self._comments.values() for mark in standing_marks(marks)]
        comments = Counter(
            (mark.row, mark.comment) for mark in all_marks if mark.task == item.task and mark.comment
        )
        return {
            **asdict(item),
            "revision": revision_of(marks, item.task, sha256),
            "score": marked_task.score,
            "rubric": [asdict(row) for row in task.rubric],
            "whole": has_task_mark(marks_of_task),
            "marks": [asdict(mark) for mark in marks_of_task],
            "checks": [asdict(check) for check in sorted(task.checks, key=lambda check: check.score)],
            "errors": list(task.errors),
            "used": [list(pair) for pair, _ in comments.most_common(MOST_COMMENTS)],
        }

    def save(self, key: str, given: Sequence[MarkEntry], by: str, revision: str) -> None:
        """Store a grader's marks, all or none, and flush them to the disk.

        Raises:
            MarksConflictError: Someone else has marked the task since that revision.
            RecordsWriteError: The folder can't be written.
            CourseError: The task or row does not exist, or has fewer points.
        """
        item = self.item(key)
        task, _, sha256 = self._read(item)
        file = store.marks_path(self.out, item.student, item.exercise)
        add_marks(file, task, given, sha256=sha256, by=by, revision=revision)

    def _read(self, item: QueueItem) -> tuple[TaskResult, list[HandMark], str]:
        stored = stored_result(self.out, item.student, item.exercise)
        task = next((task for task in stored.result.tasks if task.task == item.task), None)
        if task is None:
            raise CourseError(
                f"{item.exercise} of {item.student} no longer has the task {item.task}: reload the page"
            )
        return task, list(stored.marks), stored.result.submission.sha256

    def _refresh(self) -> None:
        """Read each result that is new or has changed, with its marks."""
        for path in sorted((self.out / "results").glob("[!.]*/[!.]*.json")):
            marks = store.marks_path(self.out, path.parent.name, path.stem)
            stamps = (_stamp(path), _stamp(marks))
            if self._stamps.get(path) == stamps:
                continue
            self._stamps[path] = stamps
            self._number += 1
            self._problems.pop(path, None)
            try:
                stored = read_result(path)
            except CourseError as error:
                self._problems[path] = str(error)
                continue
            self._comments[path] = list(stored.marks)
            self._items |= {item.key: (self._number, item) for item in _items(stored)}


def _stamp(path: Path) -> Stamp:
    try:
        stat = path.stat()
    except OSError:
        return None
    return stat.st_ino, stat.st_mtime_ns, stat.st_size


def _items(result: MarkedResult) -> Iterator[QueueItem]:
    tasks, is_waiting = result.tasks, result.row.status == "needs_marking"
    first = tasks[:1] if is_waiting and not any(task.needs_hand_mark for task in tasks) else ()
    student, exercise, submission = result.student, result.exercise, result.result.submission
    marked_tasks = {mark.task for mark in standing_marks(result.marks)}
    for task in tasks:
        waits = task.needs_hand_mark or task in first
        yield QueueItem(
            key=store.digest_of([student, exercise, task.task])[:20],
            student=student,
            exercise=exercise,
            task=task.task,
            title=task.title,
            alias=hashlib.sha256(student.encode("utf-8", "surrogatepass")).hexdigest()[:6],
            score=task.score,
            points=task.points,
            state="waiting" if waits else "marked" if task.task in marked_tasks else "checks",
            failed=tuple(dict.fromkeys(check.title for check in task.checks if not check.passed)),
            note=submission.id_note,
            revision=revision_of(result.marks, task.task, submission.sha256),
        )
