"""The tasks of all submissions, for several graders who mark at the same time; `course mark` for one task.

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
from course_lib.grading.records import HandMark, Received, Result, Submission, TaskResult
from course_lib.grading.reports.report import report
from course_lib.grading.reports.table import say, strip_control_characters
from course_lib.grading.reports.tables import write_tables
from course_lib.grading.store import (
    Course,
    catalog_of,
    digest_of,
    lock_folder,
    marks_path,
    result_path,
    this_course,
    writing,
)
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.received import UNKNOWN
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
    known = submission.sha256 in (content_hash(data, files), content_hash(data, {}))
    own = _own_line_pattern(task) if task else None
    cells = [
        {"title": f"Cell {number}", "own": bool(own and own.search(code)), "pieces": _pieces(code)}
        for number, code in enumerate(notebook.cells[:MAX_CELLS], 1)
    ]
    more = [
        {"title": strip_control_characters(name), "own": False, "pieces": _plain(text)}
        for name, text in files.items()
    ]
    return {
        "cells": [*cells, *more],
        "problem": "" if known else "This file has changed since it was graded.",
    }


def _own_line_pattern(task: Task) -> re.Pattern[str]:
    """Return a pattern for lines that define a task's object or check it; the code need not be valid."""
    name = re.escape(task.name)
    binds = rf"^(?:class|def|async def)\s+{name}\b|^{name}\s*[:=]"
    return re.compile(rf"{binds}|[\"']{re.escape(task.id)}[\"']", re.MULTILINE)


def _pieces(code: str) -> Pieces:
    """Split a cell into pieces with one highlighting class each."""
    return list(_highlight(strip_control_characters(code))) if len(code) <= MAX_COLOURED else _plain(code)


def _plain(text: str) -> Pieces:
    left = len(text) - MAX_SHOWN
    note = [("remark", f"\n… {left} more characters")] if left > 0 else []
    return [("", strip_control_characters(text[:MAX_SHOWN])), *note]


def _highlight(code: str) -> Iterator[tuple[str, str]]:
    last, text = "", ""
    for token, piece in PythonLexer(ensurenl=False, stripnl=False).get_tokens(code):
        kind = next((kind for known, kind in KINDS if token in known), "")
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
        self._items: dict[str, tuple[int, QueueItem]] = {}  # with the number of their last change
        self._comments: dict[Path, list[HandMark]] = {}
        self._problems: dict[Path, str] = {}
        # item, grader and time of the last request, by page
        self._pages: dict[str, tuple[str, str, float]] = {}
        self._number = 0

    def since(self, number: int) -> dict[str, Any]:
        """Return the items changed since a change number, as plain data; 0 returns all."""
        with self._lock:
            self._refresh()
            items = [asdict(item) for changed, item in self._items.values() if changed > number]
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
            self._pages = {one: at for one, at in self._pages.items() if now - at[2] < PRESENT}
            return {at[0]: at[1] for one, at in self._pages.items() if one != page and at[0]}

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
        shown = apply_marks(task, marks, sha256)
        mine = [mark for mark in standing_marks(marks) if mark.task == item.task]
        with self._lock:
            all_marks = [mark for marks in self._comments.values() for mark in standing_marks(marks)]
        comments = Counter(
            (mark.row, mark.comment) for mark in all_marks if mark.task == item.task and mark.comment
        )
        return {
            **asdict(item),
            "revision": revision_of(marks, item.task, sha256),
            "score": shown.score,
            "rubric": [asdict(row) for row in task.rubric],
            "whole": has_task_mark(mine),
            "marks": [asdict(mark) for mark in mine],
            "checks": [asdict(check) for check in sorted(task.checks, key=lambda check: check.score)],
            "errors": list(task.errors),
            "used": [list(pair) for pair, _ in comments.most_common(MOST_COMMENTS)],
        }

    def save(self, key: str, given: Sequence[MarkEntry], by: str, revision: str) -> None:
        """Store a grader's marks, all or none; they are flushed to the disk.

        Raises:
            MarksConflictError: Someone else has marked the task since that revision.
            OutError: The folder can't be written.
            CourseError: The task or row does not exist, or has fewer points.
        """
        item = self.item(key)
        task, _, sha256 = self._read(item)
        file = marks_path(self.out, item.student, item.exercise)
        add_marks(file, task, given, sha256=sha256, by=by, revision=revision)

    def _read(self, item: QueueItem) -> tuple[TaskResult, list[HandMark], str]:
        marked = stored_result(self.out, item.student, item.exercise)
        task = next((task for task in marked.result.tasks if task.task == item.task), None)
        if task is None:
            raise CourseError(f"{item.exercise} of {item.student} no longer has the task {item.task}")
        return task, list(marked.marks), marked.result.submission.sha256

    def _refresh(self) -> None:
        """Read each result that is new or has changed, with its marks."""
        for path in sorted((self.out / "results").glob("[!.]*/[!.]*.json")):
            marks = marks_path(self.out, path.parent.name, path.stem)
            stamps = (_stamp(path), _stamp(marks))
            if self._stamps.get(path) != stamps:
                self._stamps[path] = stamps
                self._number += 1
                self._read_result(path)

    def _read_result(self, path: Path) -> None:
        self._problems.pop(path, None)
        try:
            marked = read_result(path)
        except CourseError as error:
            self._problems[path] = str(error)
            return
        self._comments[path] = list(marked.marks)
        items = _items(marked)
        self._items.update({item.key: (self._number, item) for item in items})


def _stamp(path: Path) -> Stamp:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size


def _items(marked: MarkedResult) -> list[QueueItem]:
    tasks, is_waiting = marked.tasks, marked.row.status == "needs_marking"
    first = tasks[:1] if is_waiting and not any(task.needs_hand_mark for task in tasks) else ()
    return [_item(task, marked, waits=task.needs_hand_mark or task in first) for task in tasks]


def _item(task: TaskResult, marked: MarkedResult, *, waits: bool) -> QueueItem:
    student, exercise, submission = marked.student, marked.exercise, marked.result.submission
    by_person = any(mark.task == task.task for mark in standing_marks(marked.marks))
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
        note=submission.id_note,
        revision=revision_of(marked.marks, task.task, submission.sha256),
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
    course: Course | None = None,
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
    given = (
        MarkEntry(None, row, withdraw=True) if withdraw else MarkEntry(_number(points), row, comment or None)
    )
    catalog = catalog_of(course or this_course())
    student = known_name(student, out / "results", "student")
    exercise = known_name(exercise, out / "results" / student, "exercise")
    path = result_path(out, student, exercise)
    with lock_folder(out, say), writing(out):
        result, file = read_result(path).result, marks_path(out, student, exercise)
        tasks = {known.task: known for known in result.tasks}
        task = _find_task(task, tasks, f"{exercise} of {student}")
        (stored,) = add_marks(file, tasks[task], [given], sha256=result.submission.sha256)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    now, what = read_result(path).row, f"{task} ({stored.row})" if stored.row else task
    done = f"mark for {what} withdrawn" if withdraw else f"{stored.points:g} for {what}"
    points_now = f"{now.mark.final:g}, " if now.mark else ""
    return f"{student} {exercise}: {done}; now {points_now}{now.status}"


def mark_without_file(
    out: Path,
    student: str,
    exercise: str,
    points: str = "",
    *,
    comment: str = "",
    withdraw: bool = False,
    course: Course | None = None,
) -> str:
    """Store a grader's points for work without a gradable file, such as an oral exam; return a line.

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
    given = MarkEntry(None, withdraw=True) if withdraw else MarkEntry(_number(points), "", comment or None)
    catalog = catalog_of(course or this_course())
    weeks = {week: one for week, one in catalog.course.weeks.items() if one.points}
    week = normalise(exercise).removesuffix("_exercise")
    if week not in weeks:
        known = ", ".join(f"{one}_exercise" for one in weeks)
        raise CourseError(f"there is no exercise {exercise!r}; exercises with points: {known}")
    student, exercise = normalise(student), f"{week}_exercise"
    path = result_path(out, student, exercise)
    with lock_folder(out, say), writing(out):
        is_new = not path.is_file()
        result = _no_file(student, exercise) if is_new else read_result(path).result
        if result.judgement is not None and not withdraw:
            raise CourseError(
                f"{exercise} of {student} has a file that was graded: enter points for its tasks, "
                f"course mark {out} {student} {exercise} TASK POINTS"
            )
        most = POINTS_PER_WEEK + sum(weeks[week].bonus.values())
        whole = TaskResult("", f"{exercise} of {student}", most, False, ())
        (stored,) = add_marks(marks_path(out, student, exercise), whole, [given], sha256="")
        if is_new:
            result.write(out)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    if stored.withdrawn:
        return f"{student} {exercise}: mark without a file withdrawn; now {read_result(path).row.status}"
    new = ", who is new in the gradebook" if is_new else ""
    return f"{student} {exercise}{new}: {stored.points:g} without a file; now graded"


def _no_file(student: str, exercise: str) -> Result:
    """Return the result of a student who has not submitted a file."""
    nothing = Submission(
        student,
        exercise,
        Path(f"{student}/{exercise}.ipynb"),
        Received(None, UNKNOWN),
        problem="no file was submitted",
        reason="no file",
    )
    return mark([nothing], [None], CourseFile("", {}), "")


def _number(points: str) -> float:
    try:
        return float(points)
    except ValueError as error:
        raise CourseError(f"{points!r} is not a number of points") from error


def known_name(name: str, folder: Path, what: str) -> str:
    """Return the name of a student or an exercise as it is spelled in the results.

    Raises:
        CourseError: It does not exist; the message suggests similar names.
    """
    known = sorted(path.stem if path.is_file() else path.name for path in folder.glob("[!.]*"))
    spelled = {_normalize(one): one for one in known}
    for spelling in (_normalize(name), _normalize(f"{name}_{what}")):
        if spelling in spelled:
            return spelled[spelling]
    suggestion = did_you_mean(_normalize(name), spelled, 3) or f"; it has {', '.join(known[:10]) or 'none'}."
    raise CourseError(f"{folder} has no {what} {name!r}{suggestion}")


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
            f"{of} has no tasks that were graded; gradebook.csv says why. Points for the whole exercise, for "
            "paper or an oral exam: course mark OUT STUDENT EXERCISE POINTS --without-file"
        )
    short = {task.split(".", 1)[-1]: task for task in tasks}
    found = name if name in tasks else short.get(name)
    if found is None:
        suggestion = did_you_mean(name, [*short, *tasks], 3) or f"; it has {', '.join(short) or 'none'}."
        raise CourseError(f"{of} has no task {name!r}{suggestion}")
    return found
