"""`course mark OUT --serve`: the server of the page on which graders mark.

The page shows data of students in a browser, so each request is decoded strictly before it has any
effect, scenes run in a frame without rights, and every URL contains a secret.
"""

import asyncio
import hmac
import json
import os
import re
import secrets
import sys
import webbrowser
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import Any, TypeVar

from markupsafe import Markup
from pygments.lexers.python import PythonLexer
from pygments.token import Token
from tornado.httpserver import HTTPServer
from tornado.web import Application, HTTPError, RequestHandler

from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading import store
from course_lib.grading.marking import by_hand
from course_lib.grading.marking.marking_queue import MarkingQueue
from course_lib.grading.marks import MarkEntry, MarksConflictError, require_results, stored_result
from course_lib.grading.records import Submission
from course_lib.grading.reports.rendering import fill, replace_controls, strip_control_characters
from course_lib.grading.reports.report import section_of
from course_lib.grading.reports.scenes import shared_script
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.submission import content_hash, graded_file, unpack
from course_lib.grading.task import Task
from course_lib.host import hub_prefix, user_name
from course_lib.third_party import read_json
from course_lib.viewer.page_server import GuardedHandler, open_sockets

PAUSE = 3.0  # [s] to wait for further marks before reports are written


class ReportUpdater:
    """Starts a process that calls `by_hand.update_reports` soon after marks were saved.

    A separate process is needed because drawing scenes takes seconds, and because time limits work
    in a main thread only.
    """

    def __init__(self, out: Path, course: store.Course) -> None:
        self._arguments = tuple(map(str, (out, course.exercises, course.solutions)))
        self._due = asyncio.Event()
        self.state = ""

    def schedule_update(self) -> None:
        """Schedule an update of the reports and the gradebook."""
        self.state = "Reports and gradebook will be updated soon."
        self._due.set()

    async def run(self) -> None:
        """Run forever; an update is repeated later if the folder is in use."""
        while True:
            await self._due.wait()
            await asyncio.sleep(PAUSE)
            self._due.clear()
            if problem := await self._update():
                self.state = f"Reports and gradebook are not updated yet: {problem}"
                self._due.set()
            elif not self._due.is_set():
                self.state = "Reports and gradebook are up to date."

    async def _update(self) -> str:
        """Run one update, and return its error message, or ""."""
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-P", "-m", by_hand.__name__, *self._arguments),
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,  # Ctrl+C must reach the server only, which waits for this process
        )
        try:
            _, output = await process.communicate()
        except asyncio.CancelledError:
            await process.wait()
            raise
        lines = output.decode("utf-8", "replace").strip().splitlines()
        if process.returncode == 0:
            return ""
        return replace_controls(lines[-1] if lines else "it was ended")


MAX_NAME = 80  # limit on the characters of a grader's name
MAX_COMMENT = 10_000  # limit on the characters of a comment
MAX_MARKS = 50  # limit on the marks in a request


@dataclass(frozen=True)
class SaveRequest:
    """A grader's marks for one task, and the revision that the grader has seen."""

    by: str
    revision: str
    given: tuple[MarkEntry, ...]


def decode_save(body: bytes) -> SaveRequest:
    """Decode a request to save marks.

    Raises:
        CourseError: It is invalid; the message states the expected value.
    """
    try:
        content = read_json(body)
    except ValueError as error:
        raise CourseError("the page sent invalid JSON: reload it") from error
    match content:
        case {"by": str(by), "revision": str(revision), "marks": [_, *_] as marks} if len(marks) <= MAX_MARKS:
            return SaveRequest(clean_name(by), revision, tuple(map(_decode_mark, marks)))
    raise CourseError('the page sent no marks: expected {"by": …, "revision": …, "marks": [one or more]}')


def _decode_mark(content: Any) -> MarkEntry:
    match content:
        case {"row": str(row), "withdraw": True}:
            return MarkEntry(None, row, None, withdraw=True)
        case {"row": str(row), "points": None | int() | float() as points, "comment": str(comment)}:
            if len(comment) > MAX_COMMENT:
                raise CourseError(
                    f"the comment has {len(comment)} characters, expected {MAX_COMMENT} at most"
                )
            if not isinstance(points, bool):
                return MarkEntry(points, row, _clean(comment).strip())
    raise CourseError(f"the page sent {content!r:.80}: expected row, points and comment")


def clean_name(text: str) -> str:
    """Return a grader's name on one line, or the name of the machine's user if it is empty."""
    return " ".join(_clean(text).split())[:MAX_NAME] or user_name()


def _clean(text: str) -> str:
    return str(strip_control_characters(text.encode("utf-8", "replace").decode()))


# A fixed port keeps the page's origin, so that unsaved marks in its storage survive a restart.
PORT = 8420
ADDRESS = ".marking.html"  # file in OUT, readable by its owner only
PRIVATE = 0o600
MAX_BODY = 1 << 20  # [B]
FILES = {"": "text/html", "marking.css": "text/css"} | dict.fromkeys(
    ("marking.js", "form.js", "list.js", "elements.js"), "text/javascript"
)
FOLDER = Path(__file__).with_name("page")
PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; frame-src "
    "'self'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
# The frame has no origin and no network; the viewer needs eval to unpack itself.
SCENE_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-eval' {viewer}; style-src "
    "'unsafe-inline'; img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors {page}"
)
T = TypeVar("T")


@dataclass(frozen=True)
class MarkingState:
    """The state that the request handlers share.

    Args:
        queue: The tasks to be marked.
        report_updater: Updates the reports.
        course: The course with the tasks.
        port: The port of the server.
        token: The secret part of the URL.
    """

    queue: MarkingQueue
    report_updater: ReportUpdater
    course: store.Course
    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))

    @property
    def address(self) -> str:
        """The URL to open."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    def url_secret(self, purpose: str) -> str:
        """Return the secret part of one scene's URL, from which no other secret can be derived."""
        return hmac.new(self.token.encode(), purpose.encode(), "sha256").hexdigest()[:32]

    def details(self, key: str) -> dict[str, Any]:
        """Return an item with its code and the URL of its scene."""
        details = self.queue.details(key)
        result = stored_result(self.queue.out, details["student"], details["exercise"])
        task = store.catalog_of(self.course).tasks.get(details["task"])
        scene = f"/{self.url_secret(key)}/scene/{key}"
        return details | {
            "code": submitted_code(result.result.submission, self.queue.out, task),
            "scene": scene,
        }


class _MarkingHandler(GuardedHandler):
    def initialize(self, desk: MarkingState) -> None:
        self.desk, self.port, self.token = desk, desk.port, desk.token

    def set_default_headers(self) -> None:
        """Restrict the permissions of each response in a browser."""
        self.set_header("Content-Security-Policy", PAGE_POLICY)
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.clear_header("Server")

    def write_error(self, status_code: int, **details: Any) -> None:
        """Respond with one line that does not echo any part of the request."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code}: {self._reason}\n")


class PageFileHandler(_MarkingHandler):
    """Serves the page and its parts."""

    def get(self, _: str, name: str) -> None:
        """Respond to GET."""
        if name not in FILES:
            raise HTTPError(404)
        self.set_header("Content-Type", f"{FILES[name]}; charset=utf-8")
        self.finish((FOLDER / (name or "marking.html")).read_bytes())


class _JsonHandler(_MarkingHandler):
    async def respond(self, call: Callable[[], Any]) -> None:
        """Call a function in a thread, and respond with its plain data or its error message."""
        try:
            content, code = await asyncio.get_running_loop().run_in_executor(None, call), 200
        except MarksConflictError as error:
            content, code = {"error": str(error)}, 409
        except store.RecordsWriteError as error:
            content, code = {"error": str(error)}, 503
        except CourseError as error:
            content, code = {"error": str(error)}, 400
        self.set_status(code)
        self.set_header("Content-Type", "application/json")
        self.finish(json.dumps(content))

    def open_items(self, key: str | None = None) -> dict[str, str]:
        """Return the items that other pages have open, and record the item that this page opens."""
        page, person = self.get_query_argument("page", "")[:40], self.get_query_argument("by", "")
        return self.desk.queue.set_open_item(page, clean_name(person), key) if page else {}


class QueueHandler(_JsonHandler):
    """Serves the list of items."""

    async def get(self, _: str) -> None:
        """Respond with the changed items, and the items that graders have open."""

        def changes() -> dict[str, Any]:
            text = self.get_query_argument("since", "0")
            if not text.isdecimal() or len(text) > 12:
                raise CourseError(f"{text!r:.40} is not the number of a change")
            others, state = self.open_items(), self.desk.report_updater.state
            return self.desk.queue.changes_since(int(text)) | {"others": others, "state": state}

        await self.respond(changes)


class ItemHandler(_JsonHandler):
    """Serves one item."""

    async def get(self, _: str, key: str) -> None:
        """Respond with the item's code, rubric and marks, and record it as open in this page."""
        await self.respond(lambda: self.desk.details(key) | {"others": self.open_items(key)})

    async def post(self, _: str, key: str) -> None:
        """Save marks, and respond when they are on the disk."""
        if self.request.headers.get("Origin") != f"http://{self.request.host}":
            raise HTTPError(403, reason="Only the page itself saves marks")
        if self.request.headers.get("Content-Type", "").split(";")[0] != "application/json":
            raise HTTPError(415)

        def save() -> dict[str, Any]:
            request = decode_save(self.request.body)
            self.desk.queue.save(key, request.given, request.by, request.revision)
            return self.desk.queue.details(key)

        await self.respond(save)
        if self.get_status() == 200:
            self.desk.report_updater.schedule_update()


class _SceneFileHandler(_MarkingHandler):
    """Base of the handlers for the content of the frame, in which each URL has its own secret."""

    def prepare(self) -> None:
        """Check the secret of the requested content."""
        self.token = self.desk.url_secret(self.path_args[1])
        super().prepare()


class SceneHandler(_SceneFileHandler):
    """Serves the report on one task, for a frame without rights."""

    async def get(self, _: str, key: str) -> None:
        """Respond to GET."""
        try:
            item = self.desk.queue.item(key)
            page = store.report_path(self.desk.queue.out, item.student, item.exercise).read_text(
                "utf-8", "replace"
            )
        except (CourseError, OSError):
            raise HTTPError(404) from None
        section = section_of(page, item.task)
        name = shared_script(self.desk.queue.out / "reports")
        origin, script = f"http://{self.request.host}", f"/{self.desk.url_secret(name)}/viewer/{name}"
        self.set_header("Content-Security-Policy", SCENE_POLICY.format(viewer=origin + script, page=origin))
        embedded_script = script if "course-scene" in section else ""
        self.finish(fill("scene.html", title=item.title, section=Markup(section), script=embedded_script))


class ViewerHandler(_SceneFileHandler):
    """Serves the script that draws scenes."""

    def get(self, _: str, name: str) -> None:
        """Respond to GET."""
        self.set_header("Content-Type", "text/javascript; charset=utf-8")
        self.set_header("Cross-Origin-Resource-Policy", "cross-origin")  # the frame has no origin
        self.set_header("Cache-Control", "private, max-age=31536000, immutable")
        self.finish((self.desk.queue.out / "reports" / name).read_bytes())


ROUTES: tuple[tuple[str, type[RequestHandler]], ...] = (
    (r"/([^/]*)/([a-z.]*)", PageFileHandler),
    (r"/([^/]*)/api/queue", QueueHandler),
    (r"/([^/]*)/api/item/([0-9a-f]{20})", ItemHandler),
    (r"/([^/]*)/scene/([0-9a-f]{20})", SceneHandler),
    (r"/([^/]*)/viewer/(viewer-[0-9a-zA-Z]+\.js)", ViewerHandler),
)


def serve(
    out: Path,
    *,
    port: int | None = None,
    browser: bool = True,
    course: store.Course | None = None,
) -> None:
    """Serve the page for marking until Ctrl+C, then update reports and gradebook.

    Args:
        out: The folder that `course grade` wrote.
        port: The port on this machine; None prefers `PORT`, 0 selects any.
        browser: Whether to open the page.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: There are no results, the port is in use, or this is a JupyterHub.
    """
    # On a JupyterHub the page would share its origin with student code.
    if hub_prefix():
        raise CourseError(
            "the page for marking is not served on a JupyterHub. Copy OUT to your own computer and "
            "run: course mark OUT --serve; or mark here: course mark OUT STUDENT EXERCISE TASK "
            "POINTS"
        )
    course = course or store.this_course()
    require_results(out)
    # Errors in the course's files are reported before the page opens.
    store.catalog_of(course)
    try:
        with suppress(KeyboardInterrupt):
            asyncio.run(_serve(out, port, browser, course))
    finally:
        (out / ADDRESS).unlink(missing_ok=True)
    _print_line("\nThe server has stopped. Updating reports …")
    _print_line(by_hand.update_reports(out, course, _print_line))


async def _serve(out: Path, port: int | None, browser: bool, course: store.Course) -> None:
    try:
        sockets = open_sockets(PORT if port is None else port)
    except CourseError:
        if port is not None:
            raise
        sockets = open_sockets(0)
    report_updater = ReportUpdater(out, course)
    desk = MarkingState(MarkingQueue(out), report_updater, course, sockets[0].getsockname()[1])
    routes = [(pattern, handler, {"desk": desk}) for pattern, handler in ROUTES]
    application = Application(routes, None, None, log_function=lambda _: None)
    server = HTTPServer(application, max_body_size=MAX_BODY, max_buffer_size=2 * MAX_BODY)
    server.add_sockets(sockets)
    _announce(desk, browser)
    if by_hand.find_stale(out):
        report_updater.schedule_update()
    await report_updater.run()


def _announce(desk: MarkingState, browser: bool) -> None:
    """Print the URL.

    A browser gets it in a private file, because command lines are visible to all users.
    """
    path, text = desk.queue.out / ADDRESS, f'<meta http-equiv="refresh" content="0; url={desk.address}">'
    with store.writing(desk.queue.out):
        write_atomically(path, text.encode(), PRIVATE)
    _print_line(f"Mark {os.fspath(desk.queue.out)} at {desk.address}\nCtrl+C stops the server.")
    if browser:
        webbrowser.open(path.resolve().as_uri())


def _print_line(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


MAX_SHOWN = 60_000  # limit on the characters shown of a cell or file
MAX_COLOURED = 20_000  # limit on the characters of a cell that is highlighted
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
Pieces = list[tuple[str, str]]  # (class of the token, text)


def submitted_code(submission: Submission, out: Path, task: Task | None) -> dict[str, Any]:
    """Return the code cells and files of a submission as plain data, or an error message.

    Args:
        submission: The submission as stored in its result.
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
            "problem": f"The code can't be shown: {error} Has the folder of submissions been "
            "moved? `course grade` with --resume finds it again.",
        }
    is_unchanged = submission.sha256 in (content_hash(data, files), content_hash(data, {}))
    own_pattern = None
    if task is not None:
        # A line that defines the task's object or checks it. The code need not be valid.
        name = re.escape(task.name)
        binds = rf"^(?:class|def|async def)\s+{name}\b|^{name}\s*[:=]"
        own_pattern = re.compile(rf"{binds}|[\"']{re.escape(task.id)}[\"']", re.MULTILINE)
    cells = [
        {
            "title": f"Cell {number}",
            "own": bool(own_pattern and own_pattern.search(code)),
            "pieces": _highlight(code) if len(code) <= MAX_COLOURED else _plain(code),
        }
        for number, code in enumerate(notebook.cells[:MAX_CELLS], 1)
    ]
    more = [
        {"title": strip_control_characters(file), "own": False, "pieces": _plain(text)}
        for file, text in files.items()
    ]
    return {
        "cells": [*cells, *more],
        "problem": "" if is_unchanged else "This file has changed since it was graded.",
    }


def _plain(text: str) -> Pieces:
    hidden_length = len(text) - MAX_SHOWN
    note = [("remark", f"\n… {hidden_length} more characters")] if hidden_length > 0 else []
    return [("", strip_control_characters(text[:MAX_SHOWN])), *note]


def _highlight(code: str) -> Pieces:
    """Split a cell into pieces with one highlighting class each."""
    tokens = PythonLexer(ensurenl=False, stripnl=False).get_tokens(strip_control_characters(code))
    kinds = (
        (next((kind for token_group, kind in KINDS if token in token_group), ""), text)
        for token, text in tokens
        if text
    )
    return [
        (kind, "".join(text for _, text in group)) for kind, group in groupby(kinds, key=lambda pair: pair[0])
    ]
