"""A graph without a page, a talker in it, and a bag of five seconds."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.recording import Recording, write_bag
from course_lib.ros.graph.graph import START_NS, Graph, Sample, use_graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.ros.time.driving import running_nodes
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource

BAG_START = START_NS - 10**12  # [ns]


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    monkeypatch.chdir(tmp_path)
    with use_graph(Graph(notebook=True)) as graph:
        rclpy.init()
        yield graph


@pytest.fixture
def talker(graph: Graph) -> Node:
    """Publishes on /chatter, /camera/image and the hidden /_x twice a second."""
    node = Node("talker")
    publishers = [node.create_publisher(String, topic, 10) for topic in ("chatter", "camera/image", "_x")]

    def speak() -> None:
        for publisher in publishers:
            publisher.publish(String(data="hi"))

    node.create_timer(0.5, speak)
    running_nodes().append(node)
    return node


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """Six messages a second apart, in turn on /a and on the latched /b."""
    latched = Qos(depth=1, durability="transient_local")
    samples = [
        Sample(
            BAG_START + i * 10**9,
            ("/a", "/b")[i % 2],
            "std_msgs/msg/String",
            serialize(String(data=str(i))),
            (Qos(), latched)[i % 2],
            node=0,
        )
        for i in range(6)
    ]
    write_bag(Recording(tuple(samples)), tmp_path / "five")
    return tmp_path / "five"


@pytest.fixture
def run(graph: Graph) -> Callable[[str], str]:
    """Return the output of `ros2 bag …`."""

    def run(line: str) -> str:
        output: list[str] = []
        ros2(["bag", *line.split()], GraphSource(graph), output.append)
        return "".join(output)

    return run
