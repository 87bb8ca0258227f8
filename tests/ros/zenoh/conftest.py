"""A router on a free port, and graphs that are linked to it."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import zenoh

from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import Permissions
from course_lib.ros.time import wall
from course_lib.ros.zenoh.link import ZenohLink
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import LIMIT_OF_A_SERVER, Program

ROOT = Path(__file__).parents[3]
ROUTER = """
import sys
from tests.ros.zenoh.conftest import open_router

session = open_router(int(sys.argv[1]))
print("up", flush=True)
sys.stdin.read()
"""


def open_router(port: int) -> zenoh.Session:
    """Open a router as rmw_zenohd is configured, on loopback."""
    settings = {
        "mode": "router",
        "listen/endpoints": [f"tcp/127.0.0.1:{port}"],
        "scouting/multicast/enabled": False,
        "routing/router/peers_failover_brokering": False,
        "timestamping/enabled": True,
    }
    config = zenoh.Config()
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


def zenoh_link(graph: RobotGraph) -> ZenohLink:
    """Return the link of a graph."""
    assert isinstance(graph.link, ZenohLink)
    return graph.link


class Routers:
    """Routers in separate processes, which can be killed and restarted."""

    def __init__(self) -> None:
        self.port = free_port()
        self.start()

    def start(self) -> None:
        command = [sys.executable, "-c", ROUTER, str(self.port)]
        pipe = subprocess.PIPE
        self._process = Program(command, limit=LIMIT_OF_A_SERVER, stdin=pipe, stdout=pipe, cwd=ROOT)
        assert self._process.read_line() == "up\n"

    @property
    def pid(self) -> int:
        return self._process.pid

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()


@dataclass
class Kits:
    """Linked graphs, driven together until something is the case."""

    address: str
    graphs: list[RobotGraph] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)  # that they reported

    def join(self, *, domain: int = 0, send: str = "", call: str = "") -> RobotGraph:
        """Link one more graph."""
        allowed = Permissions.from_names(send.split(), call.split())
        self.graphs.append(RobotGraph(ZenohLink(self.address, domain), allowed, self.lines.append))
        return self.graphs[-1]

    def until(self, ready: Callable[[], object], what: str) -> None:
        """Drive all graphs until `ready()`."""
        deadline = wall.monotonic() + PATIENCE
        while not ready():
            assert wall.monotonic() < deadline, f"not seen: {what}; told: {self.lines}"
            for graph in self.graphs:
                graph.advance()

    def leave(self, graph: RobotGraph) -> None:
        """End the link of one."""
        self.graphs.remove(graph)
        graph.close()


@pytest.fixture
def router() -> Iterator[str]:
    """Run a router; the value is its address."""
    port = free_port()
    with open_router(port):
        yield f"tcp/127.0.0.1:{port}"


@pytest.fixture
def kits(router: str) -> Iterator[Kits]:
    joined = Kits(router)
    yield joined
    for graph in tuple(joined.graphs):
        joined.leave(graph)
