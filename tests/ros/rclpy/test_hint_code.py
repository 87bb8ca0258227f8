"""The code between backticks in hints, run in a program in which a student could write it."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.signals import SignalHandlerOptions

from course_lib.ros.graph.graph import Graph
from course_lib.ros.near_names import IMPORTS, LAUNCH_IMPORTS, ROS_1, call_with_fields
from course_lib.ros.programs import import_path
from course_lib.ros.time.time_lock import time_lock
from course_lib.tools.notebook import ros2_magic
from tests.ros.rclpy.test_mistakes import MISTAKES, PROGRAM

SNIPPET = re.compile(r"`([^`]+)`")
NAMES = """
import math
import os
import sys
import numpy as np
import tf2_geometry_msgs
from math import atan2, cos, sin
from course_lib import Viewer
from lifecycle_msgs.msg import Transition
from geometry_msgs.msg import PointStamped, Quaternion, TransformStamped, Vector3
from rcl_interfaces.msg import SetParametersResult
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool
from rclpy.clock import ClockType
from rclpy.qos import QoSPresetProfiles
from std_msgs.msg import MultiArrayDimension
from rclpy.lifecycle import TransitionCallbackReturn
class Robot(Node):
    def __init__(self):
        super().__init__("robot_of_hints")
        self.publisher, self.angle, self.count = None, 0.0, 0
        self.declare_parameter("known", 1.0)
        self.declare_parameter("gain", 1.0)
        self.create_publisher(Marker, "/a_topic", 10)
        self.create_service(AddTwoInts, "/a_service", self.answer)
    def tick(self): ...
    def on_message(self, msg): ...
    def heard(self, msg): ...
    def answer(self, request, response):
        return response
    def execute(self, goal_handle): ...
self = robot = Robot()
client = robot.create_client(AddTwoInts, "/a_service")
future, f = client.call_async(AddTwoInts.Request()), print
response, stat, stamp = AddTwoInts.Response(), 0, robot.get_clock().now().to_msg()
point, transform, text = PointStamped(), TransformStamped(), "1,5"
viewer = Viewer()
display = viewer.add("Marker")
marker, green, u, yaw, speed, count = Marker(), 1.0, 1.0, 1.5, 1.0, 0
import tf2_geometry_msgs
from geometry_msgs.msg import PointStamped, TransformStamped
from tf2_ros import TransformListener
self.buffer, broadcaster = Buffer(), TransformBroadcaster(self)
transform = TransformStamped(child_frame_id="base_link")
transform.header.frame_id, transform.transform.rotation.w = "map", 1.0
self.buffer.set_transform(transform, "test")
point = PointStamped()
point.header.frame_id = "map"
message, state, items, matrix, time = Marker(), JointState(), [1.0], np.eye(4), 1.0
item, v, q, numbers = 2.0, Vector3(), Quaternion(), [0.0, 0.0, 0.0, 1.0]
executor, node = rclpy.executors.SingleThreadedExecutor(), Robot()
parameter = rclpy.parameter.Parameter("gain", value=1.0)
self.publisher = robot.create_publisher(Marker, '/a_topic', 10)
publisher = angle = get_logger = spin = 0
subscription = node.create_subscription(Marker, '/a_topic', print, 10)
pose = PoseStamped()
self.message = message
"""
# Names that a hint suggests: an attribute or a field of an object that the hint does not repeat.
FIELDS = {
    "results[0].hypothesis.score",
    "header.frame_id",
    "data",
    "self.last.data",
    "size",
    "scale",
    "pose.position",
    "CUBE",
    "CYLINDER",
    "TEXT_VIEW_FACING",
    "color.a",
    "msg",
    "sec",
    "seconds",
    "sequence",
    "get_logger",
    "publisher",
    "spin",
    "value",
    "depth",
    "self.",
}


@pytest.fixture
def program(graph: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, object]]:
    # Some of the snippets write files.
    monkeypatch.chdir(tmp_path)
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    names: dict[str, object] = {"__name__": "__main__", "rclpy": rclpy}
    with time_lock.hold():
        exec(PROGRAM, names)
        exec(NAMES, names)
        yield names
    rclpy.try_shutdown()


def run(snippet: str, names: dict[str, object]) -> None:
    """Run a snippet: a magic, a statement, or the first line of a method."""
    if snippet.startswith("%ros2 "):
        ros2_magic(snippet.removeprefix("%ros2 "))
    elif snippet.startswith("def "):
        exec(f"class Other(Robot):\n    {snippet}: ...", names)
    elif snippet.startswith("for "):
        exec(f"{snippet}: ...", names)
    elif snippet == "rclpy.init()":
        rclpy.shutdown()
        exec(snippet, names)
    elif snippet.startswith("super()"):
        exec(f"class Other(Node):\n    def __init__(self): {snippet}\nOther()", names)
    elif snippet.startswith(("return ", "await ", "global ", "if ")):
        exec(f"async def other():\n    {snippet}\nother().close()", names)
    else:
        if "get_parameter(" in snippet:
            exec("self.declare_parameters('', [('a_name', 1.0), ('speed', 1.0)])", names)
        exec(snippet, names)


def snippets() -> list[str]:
    hints = [hint for _, _, hint in MISTAKES]
    lines = [*IMPORTS.values(), *LAUNCH_IMPORTS.values()]
    found = [one for hint in [*hints, *ROS_1.values()] for one in SNIPPET.findall(hint)]
    return sorted({*found, *lines} - FIELDS)


@pytest.mark.parametrize("snippet", snippets())
def test_code_in_a_hint_is_executable(program: dict[str, object], snippet: str) -> None:
    run(snippet, program)


@pytest.mark.parametrize("name", ["ColorRGBA", "Point", "Vector3", "Quaternion", "Pose", "Header", "String"])
def test_example_of_a_message_sets_existing_fields(program: dict[str, object], name: str) -> None:
    call = call_with_fields(name)
    package = "std_msgs" if name in ("ColorRGBA", "Header", "String") else "geometry_msgs"
    exec(f"from {package}.msg import {name}\n{call}", program)
    assert call.startswith(name)


def test_color_is_shown_with_its_channel_names() -> None:
    import_path.install()
    assert call_with_fields("ColorRGBA") == "ColorRGBA(r=1.0, g=1.0, b=1.0, a=1.0)"
    assert call_with_fields("Nothing") == ""
