"""A student's view recovers after the routers between robot and kit are killed and restarted."""

import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from visualization_msgs.msg import Marker

from course_lib import Viewer
from course_lib.gateway.gateway import load_users
from course_lib.ros.graph.graph import use_graph
from course_lib.ros.messages import serialize
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import Permissions
from course_lib.ros.time import wall
from course_lib.ros.zenoh.link import ZenohLink
from tests.gateway.conftest import ROSTER
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import LIMIT_OF_A_SERVER, Program
from tests.ros.zenoh.conftest import Routers
from tests.ros.zenoh.test_two_kits import LATCHED, listener, say, talker, texts

RESTARTS = 3  # tests/benchmarks/bench_restarts.py does 20 of each
MARKER = "visualization_msgs/msg/Marker"


class Gateways:
    """`course router` in a process that can be killed and started again."""

    def __init__(self, folder: Path, robot: str) -> None:
        (folder / "roster.csv").write_text(ROSTER)
        self.place = f"tcp/127.0.0.1:{free_port()}"
        words = ("router", "--listen", self.place, "--students", "roster.csv", "--robot", robot)
        self._command = [sys.executable, "-m", "course_lib", *words]
        self._folder = folder
        self.start()

    def start(self) -> None:
        pipe = subprocess.PIPE
        self._process = Program(self._command, limit=LIMIT_OF_A_SERVER, cwd=self._folder, stdout=pipe)
        self._process.find("Status:")

    def kill(self) -> None:
        self._process.send_signal(signal.SIGKILL)
        self._process.communicate()

    @property
    def address(self) -> str:
        """The first student's."""
        return load_users(self._folder / "course_router", None, "", self.place)[1].address(self.place)


class View:
    """A robot's kit that publishes, and a student's kit with a viewer; times are how often it came back."""

    def __init__(self, robot: str, student: str) -> None:
        self.lines: list[str] = []
        allowed = Permissions.from_names(["/marker", "/map"], ())
        self._robot = RobotGraph(ZenohLink(robot), allowed, lambda _: None)
        self._student = RobotGraph(ZenohLink(student), Permissions(), self.lines.append)
        self._marker, self._map = (
            talker(self._robot, "/marker", MARKER),
            talker(self._robot, "/map", qos=LATCHED),
        )
        with use_graph(self._student):
            self._viewer = Viewer("map")
        self._viewer.add("Marker", "/marker")
        say(self._robot, self._map, "the map")
        self._number = 0

    def until(self, ready: Callable[[], object], what: str) -> None:
        """Drive both kits until `ready()`."""
        end = wall.monotonic() + PATIENCE
        while not ready():
            assert wall.monotonic() < end, f"not seen: {what}; told: {self.lines}"
            for graph in (self._robot, self._student):
                graph.advance()

    def comes_back(self) -> None:
        """Wait until the viewer draws a new marker and a new subscription receives the latched map."""
        self._number += 1
        marker = Marker(type=Marker.CUBE, ns="new", id=self._number)
        marker.header.frame_id, marker.color.a = "map", 1.0
        marker.scale.x = marker.scale.y = marker.scale.z = 1.0

        def drawn() -> bool:
            self._robot.publish(self._marker, serialize(marker))
            self._viewer.refresh()
            return any(f"new/{self._number}" in name for name in self._viewer.scene.objects())

        self.until(drawn, f"marker {self._number}")
        late = listener(self._student, "/map", qos=LATCHED)
        self.until(lambda: "the map" in texts(late), "the map")

    def is_alone(self) -> bool:
        """Return whether the student's kit lists no node of the robot."""
        return "/talker" not in {node.full_name for node in self._student.nodes()}

    def close(self) -> None:
        """End both kits."""
        self._viewer.close()
        self._robot.close()
        self._student.close()


def restarted(view: View, routers: "Routers | Gateways", times: int) -> Iterator[float]:
    """Kill and restart a router `times` times. Yield the time until the view recovers [s]."""
    for _ in range(times):
        routers.kill()
        view.until(view.is_alone, "the end of the robot's nodes")
        routers.start()
        begun = wall.monotonic()
        view.comes_back()
        yield wall.monotonic() - begun


@pytest.mark.slow
@pytest.mark.parametrize("which", ["robot's router", "gateway"])
def test_view_recovers_after_a_router_is_killed(tmp_path: Path, which: str) -> None:
    routers = Routers()
    gateways = Gateways(tmp_path, f"tcp/127.0.0.1:{routers.port}")
    view = View(f"tcp/127.0.0.1:{routers.port}", gateways.address)
    try:
        view.comes_back()
        killed = routers if which == "robot's router" else gateways
        assert len(list(restarted(view, killed, RESTARTS))) == RESTARTS
    finally:
        view.close()
        gateways.kill()
        routers.kill()
