"""`course mark OUT --serve`: the server of the page on which persons mark."""

import asyncio
import hmac
import json
import os
import secrets
import sys
import webbrowser
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from markupsafe import Markup
from tornado.httpserver import HTTPServer
from tornado.web import Application, HTTPError, RequestHandler

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.marking.follow import Follower, follow_marks, stale
from course_lib.grading.marking.handed_in import handed_in
from course_lib.grading.marking.marking_queue import MarkingQueue
from course_lib.grading.marking.requests import read_name, read_number, read_save
from course_lib.grading.marks.mark import need_results, read_result
from course_lib.grading.marks.marks import MarksConflictError
from course_lib.grading.records import (
    Course,
    OutError,
    catalog_of,
    report_path,
    result_path,
    this_course,
    writing,
)
from course_lib.grading.reports.report import section_of
from course_lib.grading.reports.scenes import shared_script
from course_lib.grading.reports.table import fill
from course_lib.surroundings import hub_prefix
from course_lib.viewer.page_server import Guarded, bound

PORT = 8420  # if it is free: then what a page kept of unsaved marks is found again after a restart
ADDRESS = ".marking.html"  # in OUT, for its owner only
PRIVATE = 0o600
MAX_BODY = 1 << 20  # [B]
FILES = {"": "text/html", "marking.css": "text/css"} | dict.fromkeys(
    ("marking.js", "form.js", "list.js", "elements.js"), "text/javascript"
)
FOLDER = Path(__file__).with_name("page")
PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; frame-src 'self'; "
    "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
SCENE_POLICY = (  # without the page's origin and any network; eval is how the viewer unpacks itself
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-eval' {viewer}; "
    "style-src 'unsafe-inline'; "
    "img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors {page}"
)
T = TypeVar("T")


@dataclass(frozen=True)
class MarkingDesk:
    """The parts of the server that its handlers share.

    Args:
        queue: The tasks to be marked.
        follower: Of the reports.
        course: The tasks with their names.
        port: Where it listens.
        token: The secret part of the address.
    """

    queue: MarkingQueue
    follower: Follower
    course: Course
    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))

    @property
    def address(self) -> str:
        """The address to open."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    def pass_for(self, what: str) -> str:
        """Return the secret part of one scene's address, from which no other follows."""
        return hmac.new(self.token.encode(), what.encode(), "sha256").hexdigest()[:32]

    def details(self, key: str) -> dict[str, Any]:
        """Return an item with its code and the address of its scene."""
        details = self.queue.details(key)
        result = read_result(result_path(self.queue.out, details["student"], details["exercise"]))
        task = catalog_of(self.course).tasks.get(details["task"])
        scene = f"/{self.pass_for(key)}/scene/{key}"
        return details | {"code": handed_in(result, task), "scene": scene}


class _MarkingHandler(Guarded):
    def initialize(self, desk: MarkingDesk) -> None:
        self.desk, self.port, self.token = desk, desk.port, desk.token

    def set_default_headers(self) -> None:
        """Bound what each answer may do in a browser."""
        self.set_header("Content-Security-Policy", PAGE_POLICY)
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.clear_header("Server")

    def write_error(self, status_code: int, **details: Any) -> None:
        """Answer with a line, and nothing of the request in it."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code}: {self._reason}\n")


class PageFileHandler(_MarkingHandler):
    """The handler of the page and its parts."""

    def get(self, _: str, name: str) -> None:
        """Answer GET."""
        if name not in FILES:
            raise HTTPError(404)
        self.set_header("Content-Type", f"{FILES[name]}; charset=utf-8")
        self.finish((FOLDER / (name or "marking.html")).read_bytes())


class _Answer(_MarkingHandler):
    async def answer(self, call: Callable[..., Any], *args: Any) -> None:
        """Answer with the plain data that a call returns in a thread, or with its error in words."""
        try:
            content, code = await asyncio.get_running_loop().run_in_executor(None, call, *args), 200
        except MarksConflictError as error:
            content, code = {"error": str(error)}, 409
        except OutError as error:
            content, code = {"error": str(error)}, 503
        except CourseError as error:
            content, code = {"error": str(error)}, 400
        self.set_status(code)
        self.set_header("Content-Type", "application/json")
        self.finish(json.dumps(content))

    def others(self, key: str | None = None) -> dict[str, str]:
        """Return the items that other pages have open, and remember what this one opens, if it does."""
        page, person = self.get_query_argument("page", "")[:40], self.get_query_argument("by", "")
        return self.desk.queue.at_work(page, read_name(person), key) if page else {}


class QueueHandler(_Answer):
    """The handler of the list of items."""

    async def get(self, _: str) -> None:
        """Answer with what has changed, and who is at work on what."""
        await self.answer(self._changes)

    def _changes(self) -> dict[str, Any]:
        changes = self.desk.queue.since(read_number(self.get_query_argument("since", "0")))
        return changes | {"others": self.others(), "state": self.desk.follower.state}


class ItemHandler(_Answer):
    """The handler of one item."""

    async def get(self, _: str, key: str) -> None:
        """Answer with its code, rubric and marks, and who is at work on what: whoever asks first has it."""
        await self.answer(self._details, key)

    def _details(self, key: str) -> dict[str, Any]:
        return self.desk.details(key) | {"others": self.others(key)}

    async def post(self, _: str, key: str) -> None:
        """Save marks; the answer comes when they are on the disk."""
        if self.request.headers.get("Origin") != f"http://{self.request.host}":
            raise HTTPError(403, reason="Only the page itself saves marks")
        if self.request.headers.get("Content-Type", "").split(";")[0] != "application/json":
            raise HTTPError(415)
        await self.answer(self._save, key)
        if self.get_status() == 200:
            self.desk.follower.marked()

    def _save(self, key: str) -> dict[str, Any]:
        save = read_save(self.request.body)
        self.desk.queue.save(key, save.given, save.by, save.revision)
        return self.desk.queue.details(key)


class _SceneFileHandler(_MarkingHandler):
    """Base of the handlers of what runs in the frame: each address has a secret of its own."""

    def prepare(self) -> None:
        """Compare with the secret of what is asked for."""
        self.token = self.desk.pass_for(self.path_args[1])
        super().prepare()


class SceneHandler(_SceneFileHandler):
    """The handler of the report on one task, in a frame without rights."""

    async def get(self, _: str, key: str) -> None:
        """Answer GET."""
        try:
            item = self.desk.queue.item(key)
            page = report_path(self.desk.queue.out, item.student, item.exercise).read_text("utf-8", "replace")
        except (CourseError, OSError):
            raise HTTPError(404) from None
        section = section_of(page, item.task)
        name = shared_script(self.desk.queue.out / "reports")
        here, script = f"http://{self.request.host}", f"/{self.desk.pass_for(name)}/viewer/{name}"
        self.set_header("Content-Security-Policy", SCENE_POLICY.format(viewer=here + script, page=here))
        needed = script if "course-scene" in section else ""
        self.finish(fill("scene.html", title=item.title, section=Markup(section), script=needed))


class ViewerHandler(_SceneFileHandler):
    """The handler of the script that draws scenes."""

    def get(self, _: str, name: str) -> None:
        """Answer GET."""
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


def serve(out: Path, *, port: int | None = None, browser: bool = True, course: Course | None = None) -> None:
    """Serve the page for marking until Ctrl+C; then reports and gradebook follow.

    Args:
        out: The folder that `course grade` wrote.
        port: Where to listen, on this machine only; None prefers `PORT`, 0 is any.
        browser: Whether to open the page.
        course: Where the tasks are; default: this checkout.

    Raises:
        CourseError: There are no results, the port cannot be had, or this is a JupyterHub.
    """
    if hub_prefix():  # its page would share an origin with students' code
        raise CourseError(
            "the page for marking is not served on a JupyterHub. Copy OUT to your own computer, and then: "
            "course mark OUT --serve; or mark here: course mark OUT STUDENT EXERCISE TASK POINTS"
        )
    course = course or this_course()
    need_results(out)
    catalog_of(course)  # what is wrong in it is said now
    try:
        with suppress(KeyboardInterrupt):
            asyncio.run(_serve(out, port, browser, course))
    finally:
        (out / ADDRESS).unlink(missing_ok=True)
    _say("\nThe page has ended. Reports follow …")
    _say(follow_marks(out, course))


async def _serve(out: Path, port: int | None, browser: bool, course: Course) -> None:
    sockets = _sockets(port)
    follower = Follower(out, course)
    desk = MarkingDesk(MarkingQueue(out), follower, course, sockets[0].getsockname()[1])
    routes = [(pattern, handler, {"desk": desk}) for pattern, handler in ROUTES]
    application = Application(routes, None, None, log_function=lambda _: None)
    server = HTTPServer(application, max_body_size=MAX_BODY, max_buffer_size=2 * MAX_BODY)
    server.add_sockets(sockets)
    _announce(desk, browser)
    if stale(out):
        follower.marked()
    await follower.run()


def _sockets(port: int | None) -> Sequence[Any]:
    if port is not None:
        return bound(port)
    try:
        return bound(PORT)
    except CourseError:
        return bound(0)


def _announce(desk: MarkingDesk, browser: bool) -> None:
    """Print the address; a browser gets it in a private file, as all users see each other's command lines."""
    path, text = desk.queue.out / ADDRESS, f'<meta http-equiv="refresh" content="0; url={desk.address}">'
    with writing(desk.queue.out):
        write_whole(path, text.encode(), PRIVATE)
    _say(f"Marks of {os.fspath(desk.queue.out)} are given at {desk.address}\nCtrl+C ends it.")
    if browser:
        webbrowser.open(path.resolve().as_uri())


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()
