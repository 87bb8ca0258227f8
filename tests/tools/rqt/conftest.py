"""A small robot: an arm that moves and logs, a planner that listens to it."""

from collections.abc import Iterator
from math import sin

import pytest
import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.driving import running_nodes


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    graph = Graph(notebook=True)
    with use_graph(graph):
        rclpy.init(args=[])
        yield graph


class Arm(Node):
    """Moves two joints at 20 Hz."""

    def __init__(self) -> None:
        super().__init__("controller", namespace="arm")
        gain = FloatingPointRange(from_value=0.0, to_value=5.0)
        self.declare_parameter(
            "gain", 1.5, ParameterDescriptor(description="How fast", floating_point_range=[gain])
        )
        self.declare_parameter("frame", "base")
        self.declare_parameter("limits", [0.5, 1.5])
        self.declare_parameter("serial", "A-17", ParameterDescriptor(read_only=True))
        self.add_on_set_parameters_callback(self.check)
        self.states = self.create_publisher(JointState, "joint_states", 10)
        self.create_timer(0.05, self.move)

    def move(self) -> None:
        now = self.get_clock().now()
        self.states.publish(JointState(name=["a", "b"], position=[sin(now.nanoseconds * 1e-9), 2.0]))

    def check(self, parameters: list[Parameter]) -> SetParametersResult:
        is_good = all(p.name != "frame" or p.value == "base" for p in parameters)
        return SetParametersResult(successful=is_good, reason="" if is_good else "there is only base")


@pytest.fixture
def arm(graph: Graph) -> Arm:
    node = Arm()
    running_nodes().append(node)
    return node


@pytest.fixture
def planner(graph: Graph) -> Node:
    node = Node("planner")
    node.create_subscription(JointState, "/arm/joint_states", lambda _: None, 10)
    node.create_publisher(String, "plan", 10)
    return node
