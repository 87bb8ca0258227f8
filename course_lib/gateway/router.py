"""`course router`: runs a gateway until Ctrl+C, or changes the driver of a running one."""

import asyncio
import re
import secrets
import signal
import socket
import threading
from collections.abc import Callable
from dataclasses import replace
from html import escape
from pathlib import Path

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, RequestHandler

from course_lib.course.state import write_atomically
from course_lib.errors import CourseError, format_count
from course_lib.gateway.access import (
    DRIVER,
    GUEST,
    PASSWORDS,
    PRIVATE,
    THE_ROBOT,
    TOKENS,
    find_student,
    load_users,
)
from course_lib.gateway.gateway import TURN, Gateway, Settings
from course_lib.ros.robot.connect import full_address, is_over_dds
from course_lib.ros.zenoh.session import ROBOT, STUDENTS

# Interval between updates of the page [s].
REFRESH = 2
# Time limit for the last response [s].
PATIENCE = 5.0
HOST = "127.0.0.1"
# The notation of Zenoh: protocol, host and port.
LISTEN = re.compile(r"\w+/[^/]+:\d+", re.ASCII)
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
    """Return the HTML of the current status."""
    students, robots = gateway.links()
    present, driver = gateway.connected_students(), gateway.driver
    rows = []
    for user in gateway.users:
        if user.name != ROBOT:
            connected = (
                f"yes, {format_count(len(present[user.name]), 'kit')}" if user.name in present else "no"
            )
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
        """Respond to GET. The address contains a secret."""
        self.set_header("Cache-Control", "no-store")
        self.finish(self.text())


class StatusPage:
    """Serves a string on a free port of 127.0.0.1.

    It runs in a separate thread, so it never delays the gateway.

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
        """Stop the server.

        An interpreter that exits while its thread uses Zenoh would be aborted.
        """
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(PATIENCE)

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        pages = Application([(f"/{self._secret}/", _StatusHandler, {"text": self._text})])
        HTTPServer(pages).add_socket(self._socket)
        self._loop.run_forever()


NOBODY = "nobody"
# In the folder while a gateway runs.
PAGE_ADDRESS = "page.txt"

Write = Callable[[str], None]


def router(
    settings: Settings, folder: Path, roster: Path | None, id_column: str, driver: str, write: Write
) -> None:
    """Run a gateway until it is interrupted, or change the driver of the one that runs in this folder.

    Raises:
        CourseError: A name, file, address or option cannot be used.
    """
    if driver and _is_running(folder):
        write_atomically(folder / DRIVER, driver.encode(), PRIVATE)
        write(f"The gateway in {folder} now has the driver {driver}.")
        return
    if (settings.certificate is None) != (settings.key is None):
        raise CourseError("TLS needs two files: --certificate cert.pem --key key.pem")
    # Before the first file is written.
    if settings.robot:
        settings = replace(settings, robot=full_address(settings.robot))
    if not LISTEN.fullmatch(settings.listen):
        raise CourseError(f"--listen {settings.listen}: write it like tcp/0.0.0.0:7448")
    protocol, port = settings.listen.partition("/")[0], settings.listen.rpartition(":")[2]
    if (protocol == "tls") != (settings.certificate is not None):
        raise CourseError(f"--listen {settings.listen}: use a certificate with tls/…, and none with tcp/…")
    place = f"{protocol}/{socket.getfqdn()}:{port}"
    users = load_users(folder, roster, id_column, place)
    if not driver and users[-1].student == GUEST:
        driver = GUEST
    first = find_student(users, driver).student if driver and driver != NOBODY else NOBODY
    gateway = Gateway(settings, users, folder / PASSWORDS, write)
    page = StatusPage(lambda: page_text(gateway))
    try:
        write_atomically(folder / PAGE_ADDRESS, page.address.encode(), PRIVATE)
        write_atomically(folder / DRIVER, first.encode(), PRIVATE)
        one = users[-1]
        domain = f" with --domain {settings.domain}" if settings.domain else ""
        write(f"Students connect to {one.address(place) if one.student == GUEST else place}{domain}")
        write(f"Tokens to hand out: {folder / TOKENS}")
        for line in (
            [f"Robot: {settings.robot}"] if settings.robot else _robot_settings(settings, folder, place)
        ):
            write(line)
        for topic in settings.sends:
            write(f"/{STUDENTS}/NAME/{topic} goes to /{topic} while NAME drives")
        for service in settings.calls:
            write(f"Everybody may call /{service}")
        write(f"Status: {page.address}")
        write("Change the driver in another terminal: course router --driver NAME (or: nobody)")
        _serve(gateway, folder / DRIVER, write)
    finally:
        page.close()
        gateway.close()
        (folder / PAGE_ADDRESS).unlink(missing_ok=True)


def _robot_settings(settings: Settings, folder: Path, place: str) -> list[str]:
    """Return the settings for a robot that connects to the gateway."""
    login = f'transport/auth/usrpwd/user="{ROBOT}";transport/auth/usrpwd/password="TOKEN"'
    return [
        "Robot: --robot names no address, so the robot connects to this gateway. Set one of these for it:",
        f"  on this computer, for its nodes:  {_override(settings.robot_listen)}",
        f"  on another one, for rmw_zenohd:   {_override(place, login)}",
        f"  (TOKEN is in the row {THE_ROBOT} of {folder / TOKENS}; programs of the course: --robot "
        f"{settings.robot_listen})",
    ]


def _override(place: str, *more: str) -> str:
    """Return the shell command with which rmw_zenoh connects to an address."""
    return "export ZENOH_CONFIG_OVERRIDE='" + ";".join([f'connect/endpoints=["{place}"]', *more]) + "'"


def _serve(gateway: Gateway, wanted: Path, write: Write) -> None:
    """Run the gateway until an interrupt. The file `wanted` contains the driver's name."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    asked, linked = "", False
    robot = "robot" if is_over_dds(gateway.settings.robot) else "robot's router"
    try:
        while True:
            gateway.stop_if_silent()
            text = wanted.read_text(encoding="utf-8").strip() if wanted.exists() else asked
            if text != asked:
                asked = text
                try:
                    gateway.set_driver(None if text == NOBODY else find_student(gateway.users, text))
                except CourseError as error:
                    write(f"{error} The driver stays.")
                else:
                    write(f"{text} drives.")
            if linked != gateway.is_robot_connected():
                linked = not linked
                write(f"The {robot} is linked." if linked else f"The link to the {robot} is lost.")
            gateway.wait(TURN)
    except KeyboardInterrupt:
        write("Stopped.")


def _is_running(folder: Path) -> bool:
    """Return whether a gateway responds at the address stored in the folder."""
    try:
        host, _, port = (folder / PAGE_ADDRESS).read_text("utf-8").split("/")[2].partition(":")
        socket.create_connection((host, int(port)), timeout=1.0).close()
    except (OSError, ValueError, IndexError):
        return False
    return True
