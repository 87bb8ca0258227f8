from collections.abc import Iterator

import pytest
import rclpy

from course_lib.robots.turtlesim import TurtlesimNode
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time import virtual_time
from tests.robots.turtlesim.student import Student


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[TurtlesimNode, Student]]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    virtual_time.install()
    with use_graph(Graph(notebook=True)):
        rclpy.init()
        simulator = TurtlesimNode()
        yield simulator, Student(simulator)
