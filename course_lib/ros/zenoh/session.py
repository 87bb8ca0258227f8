"""Sessions of Zenoh as clients of a router, and handlers that need no thread of Python's."""

import json
from collections.abc import Callable
from typing import Any

import zenoh
from zenoh.handlers import Callback

from course_lib.errors import CourseError
from course_lib.ros.zenoh.login import NO_LOGIN, Login

OPEN_SECONDS = 3.0  # [s] until a router must have answered
CALL_SECONDS = 600.0  # [s] until a service must have answered, as rmw_zenoh has it


def direct(function: Callable[[Any], None], end: Callable[[], None] = lambda: None) -> "Callback[Any]":
    """Return a handler that Zenoh's own threads call.

    With a Python thread for each, an interpreter does not exit while a session is open; and the thread would
    belong to the program, where robot time has replaced `Thread.start`.
    """
    return Callback(function, end, indirect=False)


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
        raise CourseError(
            f"No Zenoh router answers at {address}. Does `ros2 run rmw_zenoh_cpp rmw_zenohd` run on the "
            "robot, is its port open, is this the right network"
            f"{', is the token right' if login.name else ''}?"
        ) from error
