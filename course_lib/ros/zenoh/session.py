"""Sessions of Zenoh as clients of a router, and handlers that need no thread of Python's."""

import _thread
import json
from collections.abc import Callable
from typing import Any

import zenoh
from zenoh.handlers import Callback

from course_lib.errors import CourseError
from course_lib.ros import wall
from course_lib.ros.zenoh.login import NO_LOGIN, Login

OPEN_SECONDS = 3.0  # [s] until a router must have answered
CALL_SECONDS = 600.0  # [s] until a service must have answered, as rmw_zenoh has it
END_SECONDS, MOMENT = 2.0, 0.005  # [s] until handlers must have ended, and between two looks at them


def _nothing() -> None:
    """Do nothing."""


class Handlers:
    """Handlers that Zenoh's own threads call, counted until the last call of each is over.

    With a Python thread for each, an interpreter does not exit while a session is open; and the thread would
    belong to the program, where robot time has replaced `Thread.start`. But an interpreter that exits while a
    thread of Zenoh is in a handler is aborted: `wait` for them behind the end of a session.
    """

    def __init__(self) -> None:
        self.alive, self._mutex = 0, _thread.allocate_lock()

    def direct(self, function: Callable[[Any], None], end: Callable[[], None] = _nothing) -> "Callback[Any]":
        """Return a handler; `end` is called behind its last call."""
        with self._mutex:
            self.alive += 1

        def over() -> None:
            end()
            with self._mutex:
                self.alive -= 1

        return Callback(function, over, indirect=False)

    def wait(self, seconds: float = END_SECONDS) -> None:
        """Wait until no handler will be called any more, at most so long, [s]."""
        end = wall.monotonic() + seconds
        while self.alive and wall.monotonic() < end:
            wall.sleep(MOMENT)


def open_session(address: str, login: Login = NO_LOGIN) -> zenoh.Session:
    """Open a session as a client: a robot's router does not pass on messages between peers.

    Raises:
        CourseError: No router answers, or the address is not one.
    """
    settings = {
        "mode": "client",
        "connect/endpoints": [address],
        "connect/timeout_ms": round(OPEN_SECONDS * 1000),
        "connect/retry": {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2},
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "listen/endpoints": [],
        "timestamping/enabled": True,  # the caches of latched topics need it
        "queries_default_timeout": round(CALL_SECONDS * 1000),
        "transport/shared_memory/enabled": False,
        **login.settings(address),
    }
    config = zenoh.Config()
    try:
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        raise CourseError(f"{address!r} is not an address: write it like tcp/192.168.1.5:7447.") from error
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise CourseError(_no_router(address, login)) from error


def _no_router(address: str, login: Login) -> str:
    """Return what to look at where nothing answers."""
    if login.name:
        return (
            f"No gateway lets {login.name} in at {address}. Does `course router` run there, is the token the "
            "one that you were given, is this the right network?"
        )
    return (
        f"No Zenoh router answers at {address}. Does `ros2 run rmw_zenoh_cpp rmw_zenohd` run on the robot, "
        "is its port open, is this the right network?"
    )
