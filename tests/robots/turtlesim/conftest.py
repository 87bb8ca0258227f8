from collections.abc import Iterator

import pytest
import rclpy

from course_lib.robots.turtlesim.simulator import TurtlesimNode
from course_lib.ros import virtual_time
from course_lib.ros.graph import Graph, use_graph
from tests.robots.turtlesim.student import Student


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[TurtlesimNode, Student]]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    virtual_time.install()
    with use_graph(Graph(notebook=True)):
        rclpy.init()
        simulator = TurtlesimNode()
        yield simulator, Student(simulator)
