"""The tasks of all submissions, for several graders who mark at the same time.

It also holds `course mark` for a single task.

Marks appear in gradebook, index and report.
"""

import hashlib
import re
import threading
import time
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from pygments.lexers.python import PythonLexer
from pygments.token import Token

from course_lib.course.course_file import POINTS_PER_WEEK, CourseFile
from course_lib.course.exercise import normalise
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading import store
from course_lib.grading.marks import (
    MarkedResult,
    MarkEntry,
    add_marks,
    apply_marks,
    has_task_mark,
    mark,
    read_result,
    revision_of,
    standing_marks,
    stored_result,
)
from course_lib.grading.records import HandMark, ReceiptTime, Result, Submission, TaskResult
from course_lib.grading.reports.report import report
from course_lib.grading.reports.table import say, strip_control_characters
from course_lib.grading.reports.tables import write_tables
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.roster import UNKNOWN
from course_lib.grading.submissions.submission import content_hash, graded_file, unpack
from course_lib.grading.task import Task

MAX_SHOWN = 60_000  # characters of a cell or file
MAX_COLOURED = 20_000  # characters of a cell
MAX_CELLS = 300
# Syntax highlighting classes of the page, by pygments' tokens.
KINDS = (
    (Token.Comment, "remark"),
    (Token.Literal.String, "string"),
    (Token.Literal.Number, "number"),
    (Token.Keyword, "keyword"),
    (Token.Operator.Word, "keyword"),
    (Token.Name.Function, "name"),
    (Token.Name.Class, "name"),
)
Pieces = list[tuple[str, str]]  # kind and text


def submitted_code(submission: Submission, out: Path, task: Task | None) -> dict[str, Any]:
    """Return the code cells and files of a submission as plain data, or an error message.

    Args:
        submission: As its result has it.
        out: The folder of records.
        task: The task whose cells are marked.
    """
    path = graded_file(submission, out)
    try:
        data, _ = unpack(path)
        notebook = parse_notebook(data, path.name)
        files = working_files(path, notebook.cells)
    except CourseError as error:
        return {
            "cells": [],
            "problem": f"The code can't be shown: {error} Has the folder of submissions been moved? "
            "`course grade` with --resume finds it again.",
        }
    is_unchanged = submission.sha256 in (content_hash(data, files), content_hash(data, {}))
    own_pattern = _own_line_pattern(task) if task else None
    cells = [
        {
            "title": f"Cell {number}",
            "own": bool(own_pattern and own_pattern.search(code)),
            "pieces": _pieces(code),
        }
        for number, code in enumerate(notebook.cells[:MAX_CELLS], 1)
    ]
    more = [
        {"title": strip_control_characters(name), "own": False, "pieces": _plain(text)}
        for name, text in files.items()
    ]
    return {
        "cells": [*cells, *more],
        "problem": "" if is_unchanged else "This file has changed since it was graded.",
    }


def _own_line_pattern(task: Task) -> re.Pattern[str]:
    """Return a pattern for lines that define a task's object or check it.

    The code need not be valid.
    """
    name = re.escape(task.name)
    binds = rf"^(?:class|def|async def)\s+{name}\b|^{name}\s*[:=]"
    return re.compile(rf"{binds}|[\"']{re.escape(task.id)}[\"']", re.MULTILINE)


def _pieces(code: str) -> Pieces:
    """Split a cell into pieces with one highlighting class each."""
    return list(_highlight(strip_control_characters(code))) if len(code) <= MAX_COLOURED else _plain(code)


def _plain(text: str) -> Pieces:
    hidden_length = len(text) - MAX_SHOWN
    note = [("remark", f"\n… {hidden_length} more characters")] if hidden_length > 0 else []
    return [("", strip_control_characters(text[:MAX_SHOWN])), *note]


def _highlight(code: str) -> Iterator[tuple[str, str]]:
    last, text = "", ""
    for token, piece in PythonLexer(ensurenl=False, stripnl=False).get_tokens(code):
        kind = next((kind for token_group, kind in KINDS if token in token_group), "")
        if kind != last and text:
            yield last, text
            text = ""
        last, text = kind, text + piece
    if text:
        yield last, text


PRESENT = 10.0  # [s] time without requests after which a page is considered closed
MOST_COMMENTS = 30  # comments offered for reuse
State = Literal["waiting", "marked", "checks"]
Stamp = tuple[int, ...] | None


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
        # item, grader and time of the last request, by page
        self._pages: dict[str, tuple[str, str, float]] = {}
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
            key = self._pages[page][0] if key is None and page in self._pages else key or ""
            self._pages[page] = (key, person, now)
            self._pages = {other: at for other, at in self._pages.items() if now - at[2] < PRESENT}
            return {at[0]: at[1] for other, at in self._pages.items() if other != page and at[0]}

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
            raise CourseError(f"{item.exercise} of {item.student} no longer has the task {item.task}")
        return task, list(stored.marks), stored.result.submission.sha256

    def _refresh(self) -> None:
        """Read each result that is new or has changed, with its marks."""
        for path in sorted((self.out / "results").glob("[!.]*/[!.]*.json")):
            marks = store.marks_path(self.out, path.parent.name, path.stem)
            stamps = (_stamp(path), _stamp(marks))
            if self._stamps.get(path) != stamps:
                self._stamps[path] = stamps
                self._number += 1
                self._read_result(path)

    def _read_result(self, path: Path) -> None:
        self._problems.pop(path, None)
        try:
            stored = read_result(path)
        except CourseError as error:
            self._problems[path] = str(error)
            return
        self._comments[path] = list(stored.marks)
        items = _items(stored)
        self._items.update({item.key: (self._number, item) for item in items})


def _stamp(path: Path) -> Stamp:
    try:
        stat = path.stat()
    except OSError:
        return None
    return stat.st_ino, stat.st_mtime_ns, stat.st_size


def _items(result: MarkedResult) -> list[QueueItem]:
    tasks, is_waiting = result.tasks, result.row.status == "needs_marking"
    first = tasks[:1] if is_waiting and not any(task.needs_hand_mark for task in tasks) else ()
    return [_item(task, result, waits=task.needs_hand_mark or task in first) for task in tasks]


def _item(task: TaskResult, result: MarkedResult, *, waits: bool) -> QueueItem:
    student, exercise, submission = result.student, result.exercise, result.result.submission
    by_person = any(mark.task == task.task for mark in standing_marks(result.marks))
    return QueueItem(
        key=store.digest_of([student, exercise, task.task])[:20],
        student=student,
        exercise=exercise,
        task=task.task,
        title=task.title,
        alias=hashlib.sha256(student.encode("utf-8", "surrogatepass")).hexdigest()[:6],
        score=task.score,
        points=task.points,
        state="waiting" if waits else "marked" if by_person else "checks",
        failed=tuple(dict.fromkeys(check.title for check in task.checks if not check.passed)),
        note=submission.id_note,
        revision=revision_of(result.marks, task.task, submission.sha256),
    )


def mark_by_hand(
    out: Path,
    student: str,
    exercise: str,
    task: str,
    points: str = "",
    *,
    row: str = "",
    comment: str = "",
    withdraw: bool = False,
    course: store.Course | None = None,
) -> str:
    """Store the points of a grader, and return a line with the new mark.

    Args:
        out: The folder that `course grade` wrote.
        student: The student as in the gradebook.
        exercise: "week01_exercise".
        task: "week01.essay", or "essay".
        points: A number, for the row if one is given, else for the whole task instead of the
            checks' points.
        row: A row of the rubric: its number from 1, or the beginning of its text.
        comment: A comment for the student; "" keeps the existing one.
        withdraw: Withdraw earlier marks instead of giving points; the checks' points count again.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: The student, exercise, task or row does not exist; too many points; or no mark
            to withdraw.
    """
    entry = (
        MarkEntry(None, row, withdraw=True) if withdraw else MarkEntry(_number(points), row, comment or None)
    )
    catalog = store.catalog_of(course or store.this_course())
    student = known_name(student, out / "results", "student")
    exercise = known_name(exercise, out / "results" / student, "exercise")
    path = store.result_path(out, student, exercise)
    with store.lock_folder(out, say), store.writing(out):
        result, file = read_result(path).result, store.marks_path(out, student, exercise)
        tasks = {task_result.task: task_result for task_result in result.tasks}
        task = _find_task(task, tasks, f"{exercise} of {student}")
        (stored_mark,) = add_marks(file, tasks[task], [entry], sha256=result.submission.sha256)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    now, target = read_result(path).row, f"{task} ({stored_mark.row})" if stored_mark.row else task
    change = f"mark for {target} withdrawn" if withdraw else f"{stored_mark.points:g} for {target}"
    points_now = f"{now.mark.final:g}, " if now.mark else ""
    return f"{student} {exercise}: {change}; now {points_now}{now.status}"


def mark_without_file(
    out: Path,
    student: str,
    exercise: str,
    points: str = "",
    *,
    comment: str = "",
    withdraw: bool = False,
    course: store.Course | None = None,
) -> str:
    """Store a grader's points for work without a gradable file, such as an oral exam.

    Return a line for the terminal.

    Args:
        out: The folder of records, in which the student may be new.
        student: The student's ID.
        exercise: "week01_exercise", or "week01".
        points: Points for the whole exercise, without the late policy.
        comment: A comment for the student; "" keeps the existing one.
        withdraw: Withdraw such a mark.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: The exercise does not exist, a file of it has been graded, or the points are
            invalid.
    """
    entry = MarkEntry(None, withdraw=True) if withdraw else MarkEntry(_number(points), "", comment or None)
    catalog = store.catalog_of(course or store.this_course())
    weeks = {week: settings for week, settings in catalog.course.weeks.items() if settings.points}
    week = normalise(exercise).removesuffix("_exercise")
    if week not in weeks:
        known_exercises = ", ".join(f"{week}_exercise" for week in weeks)
        raise CourseError(f"there is no exercise {exercise!r}; exercises with points: {known_exercises}")
    student, exercise = normalise(student), f"{week}_exercise"
    path = store.result_path(out, student, exercise)
    with store.lock_folder(out, say), store.writing(out):
        is_new = not path.is_file()
        result = _result_without_file(student, exercise) if is_new else read_result(path).result
        if result.judgement is not None and not withdraw:
            raise CourseError(
                f"{exercise} of {student} has a file that was graded: enter points for its tasks, "
                f"course mark {out} {student} {exercise} TASK POINTS"
            )
        max_points = POINTS_PER_WEEK + sum(weeks[week].bonus.values())
        exercise_result = TaskResult("", f"{exercise} of {student}", max_points, False, ())
        (stored_mark,) = add_marks(
            store.marks_path(out, student, exercise), exercise_result, [entry], sha256=""
        )
        if is_new:
            result.write(out)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    if stored_mark.withdrawn:
        return f"{student} {exercise}: mark without a file withdrawn; now {read_result(path).row.status}"
    new = ", who is new in the gradebook" if is_new else ""
    return f"{student} {exercise}{new}: {stored_mark.points:g} without a file; now graded"


def _result_without_file(student: str, exercise: str) -> Result:
    """Return the result of a student who has not submitted a file."""
    nothing = Submission(
        student,
        exercise,
        Path(f"{student}/{exercise}.ipynb"),
        ReceiptTime(None, UNKNOWN),
        problem="no file was submitted",
        reason="no file",
    )
    return mark([nothing], [None], CourseFile("", {}), "")


def _number(points: str) -> float:
    try:
        return float(points)
    except ValueError as error:
        raise CourseError(f"{points!r} is not a number of points") from error


def known_name(name: str, folder: Path, kind: str) -> str:
    """Return the name of a student or an exercise as it is spelled in the results.

    Raises:
        CourseError: It does not exist; the message suggests similar names.
    """
    names = sorted(path.stem if path.is_file() else path.name for path in folder.glob("[!.]*"))
    by_spelling = {_normalize(spelling): spelling for spelling in names}
    for spelling in (_normalize(name), _normalize(f"{name}_{kind}")):
        if spelling in by_spelling:
            return by_spelling[spelling]
    suggestion = (
        did_you_mean(_normalize(name), by_spelling, 3) or f"; it has {', '.join(names[:10]) or 'none'}."
    )
    raise CourseError(f"{folder} has no {kind} {name!r}{suggestion}")


def _normalize(name: str) -> str:
    try:
        return normalise(name)
    except CourseError:
        return name


def _find_task(name: str, tasks: Collection[str], of: str) -> str:
    """Return a task's id, given the id or its part after the dot.

    Raises:
        CourseError: It does not exist; the message suggests similar names.
    """
    if not tasks:
        raise CourseError(
            f"{of} has no tasks that were graded; gradebook.csv has the reason. Points for the "
            "whole exercise, for paper or an oral exam: course mark OUT STUDENT EXERCISE POINTS "
            "--without-file"
        )
    short = {task.split(".", 1)[-1]: task for task in tasks}
    task_id = name if name in tasks else short.get(name)
    if task_id is None:
        suggestion = did_you_mean(name, [*short, *tasks], 3) or f"; it has {', '.join(short) or 'none'}."
        raise CourseError(f"{of} has no task {name!r}{suggestion}")
    return task_id
