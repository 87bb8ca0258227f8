"""The plain page of a gateway: who is connected, who drives, what was held back."""

import asyncio
import secrets
import threading
from collections.abc import Callable
from html import escape

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, RequestHandler

from course_lib.errors import counted
from course_lib.gateway.gateway import Gateway
from course_lib.ros.zenoh.login import ROBOT, STUDENTS

REFRESH = 2  # [s]
PATIENCE = 5.0  # [s] for the last answer
HOST = "127.0.0.1"
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="{refresh}">
<title>{title}</title>
<style>td, th {{ padding: .2rem 1rem; text-align: left }}</style>
</head><body><h1>{title}</h1>
<p>Robot: {robot}. Links of students: {links}.</p>
<table><caption>Students</caption>
<thead><tr><th scope="col">Student</th><th scope="col">Namespace</th><th scope="col">Connected</th>
<th scope="col">Drives</th><th scope="col">Commands passed on</th>
<th scope="col">Commands held back</th></tr></thead>
<tbody>
{rows}
</tbody></table></body></html>
"""


def page_text(gateway: Gateway) -> str:
    """Return the page as it is now."""
    students, robots = gateway.links()
    present, driver = gateway.present(), gateway.driver
    rows = []
    for user in gateway.users:
        if user.name != ROBOT:
            connected = f"yes, {counted(len(present[user.name]), 'kit')}" if user.name in present else "no"
            cells = (f"/{STUDENTS}/{user.name}", connected, "drives" if user == driver else "")
            counts = (gateway.passed[user.name], gateway.held[user.name])
            tail = "".join(f"<td>{escape(str(cell))}</td>" for cell in (*cells, *counts))
            rows.append(f'<tr><th scope="row">{escape(user.student)}</th>{tail}</tr>')
    return PAGE.format(
        refresh=REFRESH,
        title=f"Gateway: {escape(driver.student) if driver else 'nobody'} drives",
        robot=f"linked to {escape(', '.join(robots))}" if robots else "no link",
        links=len(students),
        rows="\n".join(rows),
    )


class _StatusHandler(RequestHandler):
    def initialize(self, text: Callable[[], str]) -> None:
        self.text = text

    def get(self) -> None:
        """Answer GET; the address has a secret part."""
        self.set_header("Cache-Control", "no-store")
        self.finish(self.text())


class StatusPage:
    """A server of one text on a free port of 127.0.0.1, in a thread of its own: it never delays the gateway.

    Args:
        text: Called in that thread for each request.
    """

    def __init__(self, text: Callable[[], str]) -> None:
        (self._socket,) = bind_sockets(0, HOST)
        self._secret = secrets.token_urlsafe(12)
        self._loop = asyncio.new_event_loop()
        self._text = text
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """The address to open."""
        return f"http://{HOST}:{self._socket.getsockname()[1]}/{self._secret}/"

    def close(self) -> None:
        """End it: an interpreter that exits while the thread is in Zenoh is aborted."""
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(PATIENCE)

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        pages = Application([(f"/{self._secret}/", _StatusHandler, {"text": self._text})])
        HTTPServer(pages).add_socket(self._socket)
        self._loop.run_forever()
