"""`course router`: a gateway until Ctrl+C, and the change of its driver."""

import signal
import socket
import time
from collections.abc import Callable
from pathlib import Path

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.gateway.gateway import TURN, Gateway, Settings
from course_lib.gateway.page import StatusPage, page_text
from course_lib.gateway.students import (
    DRIVER,
    GUEST,
    PASSWORDS,
    PRIVATE,
    THE_ROBOT,
    TOKENS,
    Access,
    class_of,
    named,
)
from course_lib.ros.zenoh.login import ROBOT, STUDENTS

NOBODY = "nobody"
PAGE_ADDRESS = "page.txt"  # in the folder, while a gateway runs

Write = Callable[[str], None]


def router(
    settings: Settings, folder: Path, roster: Path | None, id_column: str, driver: str, write: Write
) -> None:
    """Run a gateway until it is interrupted; with one running in this folder, only change its driver.

    Raises:
        CourseError: A name, file, address or option can't be used.
    """
    if driver and _runs(folder):
        write_whole(folder / DRIVER, driver.encode(), PRIVATE)
        write(f"The gateway in {folder} was told: {driver} drives.")
        return
    if (settings.certificate is None) != (settings.key is None):
        raise CourseError("TLS needs two files: --certificate cert.pem --key key.pem")
    protocol, port = settings.listen.partition("/")[0], settings.listen.rpartition(":")[2]
    if (protocol == "tls") != (settings.certificate is not None):
        raise CourseError(f"--listen {settings.listen}: a certificate goes with tls/…, tcp/… has none")
    place = f"{protocol}/{socket.getfqdn()}:{port}"
    users = class_of(folder, roster, id_column, place)
    if not driver and users[-1].student == GUEST:
        driver = GUEST
    first = named(users, driver).student if driver and driver != NOBODY else NOBODY
    gateway = Gateway(settings, users, folder / PASSWORDS)
    page = StatusPage(lambda: page_text(gateway))
    try:
        write_whole(folder / PAGE_ADDRESS, page.address.encode(), PRIVATE)
        write_whole(folder / DRIVER, first.encode(), PRIVATE)
        _introduce(settings, users, folder, page, place, write)
        _serve(gateway, folder / DRIVER, write)
    finally:
        page.close()
        gateway.close()
        (folder / PAGE_ADDRESS).unlink(missing_ok=True)


def _introduce(
    settings: Settings, users: list[Access], folder: Path, page: StatusPage, place: str, write: Write
) -> None:
    one = users[-1]
    write(f"Students connect to {one.address(place) if one.student == GUEST else place}")
    write(f"Tokens to hand out: {folder / TOKENS}")
    for line in [f"Robot: {settings.robot}"] if settings.robot else _about_robot(settings, folder, place):
        write(line)
    for topic in settings.sends:
        write(f"/{STUDENTS}/NAME/{topic} goes to /{topic} while NAME drives")
    for service in settings.calls:
        write(f"Everybody may call /{service}")
    write(f"Status: {page.address}")
    write("Change the driver in another terminal: course router --driver NAME (or: nobody)")


def _about_robot(settings: Settings, folder: Path, place: str) -> list[str]:
    """Return what to set on a robot that connects to the gateway."""
    login = f'transport/auth/usrpwd/user="{ROBOT}";transport/auth/usrpwd/password="TOKEN"'
    return [
        "Robot: none is named by --robot, so it connects to this gateway. Set one of these for it:",
        f"  on this computer, for its nodes:  {_override(settings.robot_listen)}",
        f"  on another one, for rmw_zenohd:   {_override(place, login)}",
        f"  (TOKEN is in the row {THE_ROBOT} of {folder / TOKENS}; programs of the course: --robot "
        f"{settings.robot_listen})",
    ]


def _override(place: str, *more: str) -> str:
    """Return the line for the shell by which rmw_zenoh connects to a place."""
    return "export ZENOH_CONFIG_OVERRIDE='" + ";".join([f'connect/endpoints=["{place}"]', *more]) + "'"


def _serve(gateway: Gateway, wanted: Path, write: Write) -> None:
    """Look after the driver until an interrupt; `wanted` holds who shall drive."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    asked, linked = "", False
    try:
        while True:
            gateway.turn()
            text = wanted.read_text(encoding="utf-8").strip() if wanted.exists() else asked
            if text != asked:
                asked = text
                _change(gateway, text, write)
            if linked != gateway.linked():
                linked = not linked
                write(
                    "The robot's router is linked." if linked else "The link to the robot's router is lost."
                )
            time.sleep(TURN)
    except KeyboardInterrupt:
        write("Stopped.")


def _change(gateway: Gateway, who: str, write: Write) -> None:
    try:
        gateway.drive(None if who == NOBODY else named(gateway.users, who))
    except CourseError as error:
        write(f"{error} The driver stays.")
    else:
        write(f"{who} drives.")


def _runs(folder: Path) -> bool:
    """Return whether a gateway's page answers at the address that is in the folder."""
    try:
        host, _, port = (folder / PAGE_ADDRESS).read_text("utf-8").split("/")[2].partition(":")
        socket.create_connection((host, int(port)), timeout=1.0).close()
    except (OSError, ValueError, IndexError):
        return False
    return True
