import json
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh
from zenoh.handlers import Callback

from course_lib.gateway.gateway import PASSWORDS, Gateway, GatewayUser, Settings, load_users
from course_lib.ros.robot.sending import STALE_SECONDS, STOP_PERIOD
from tests.patience import PATIENCE, join
from tests.ports import free_port

Opened = Callable[..., zenoh.Session]
ROSTER = "Full name,ID number\nAnn Lee,1234\nBob Ray,b.1\n"


def wait_for(state: Callable[[], object], what: str, patience: float = PATIENCE) -> None:
    end = time.monotonic() + patience
    while not state():
        assert time.monotonic() < end, what
        time.sleep(0.02)


@pytest.fixture
def opened() -> Iterator[Opened]:
    """Open sessions of raw Zenoh, closed after the test."""
    sessions: list[zenoh.Session] = []

    def open_one(
        place: str = "", user: GatewayUser | None = None, mode: str = "client", **more: Any
    ) -> zenoh.Session:
        settings = {
            "mode": mode,
            "connect/endpoints": [place] if place else [],
            "connect/timeout_ms": 3000,
            "listen/endpoints": [],
            "scouting/multicast/enabled": False,
            "timestamping/enabled": True,
        }
        if user is not None:
            settings["transport/auth/usrpwd"] = {"user": user.name, "password": user.token}
        config = zenoh.Config()
        for key, value in (settings | more).items():
            config.insert_json5(key, json.dumps(value))
        sessions.append(zenoh.open(config))
        return sessions[-1]

    yield open_one
    for session in sessions:
        session.close()


class Classroom:
    """A robot with its router, a gateway that is looked after, and its users."""

    def __init__(self, folder: Path, opened: Opened, **settings: Any) -> None:
        self._opened = opened
        robot, own = f"tcp/127.0.0.1:{free_port()}", f"tcp/127.0.0.1:{free_port()}"
        self.robot_place, self.place = robot, own
        self.robots_router = opened(mode="router", **{"listen/endpoints": [robot]})
        self.robot = opened(robot, mode="peer", **{"listen/endpoints": ["tcp/127.0.0.1:0"]})
        (folder / "roster.csv").write_text(ROSTER)
        self.users = load_users(folder, folder / "roster.csv", "", own)
        _, self.ann, self.bob = self.users
        sends, calls = settings.pop("sends", ["cmd_vel"]), settings.pop("calls", ["reset"])
        self.lines: list[str] = []
        chosen = Settings(own, robot, sends, calls, **settings)
        self.gateway = Gateway(chosen, self.users, folder / PASSWORDS, self.lines.append)
        wait_for(self.gateway.is_robot_connected, "the gateway reaches the robot's router")
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._look_after, daemon=True)
        self._thread.start()

    def _look_after(self) -> None:
        while not self._ended.wait(STOP_PERIOD):
            self.gateway.stop(older_than=STALE_SECONDS)

    def student(self, user: GatewayUser, mode: str = "client") -> zenoh.Session:
        session = self._opened(self.place, user, mode)
        wait_for(lambda: [*session.info.routers_zid()], f"{user.name} reaches the gateway")
        return session

    def close(self) -> None:
        self._ended.set()
        join(self._thread)
        self.gateway.close()


@pytest.fixture
def classroom(tmp_path: Path, opened: Opened) -> Iterator[Classroom]:
    room = Classroom(tmp_path, opened)
    yield room
    room.close()


def _nothing() -> None:
    """Do nothing. Zenoh 1.5 requires a function that it calls when the callback is dropped."""


def hears(session: zenoh.Session, *keys: str) -> list[tuple[str, bytes]]:
    """Return a list to which samples on these keys are appended."""
    received: list[tuple[str, bytes]] = []

    def put(sample: zenoh.Sample) -> None:
        received.append((str(sample.key_expr), bytes(sample.payload)))

    for key in keys:
        session.declare_subscriber(key, Callback(put, _nothing, indirect=False))
    return received


def sees_tokens(session: zenoh.Session) -> list[str]:
    """Return a list that fills with the keys of all tokens."""
    observed: list[str] = []

    def add(sample: zenoh.Sample) -> None:
        observed.append(str(sample.key_expr))

    for key in ("**", "@ros2_lv/**", "**/@adv/**", "@course/**"):
        session.liveliness().declare_subscriber(key, Callback(add, _nothing, indirect=False), history=True)
    return observed
