"""The most frequent mistakes of students: each with the error class and text of ROS 2, and a hint.

Texts: ROS 2 Jazzy's rclpy, rosidl, tf2 and Python's own; where ROS hangs, the kit's DeadlockError.
"""

import linecache
from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.tracebacks import print_error
from tests.python_messages import without_python_version
from tests.ros.rclpy.mistakes.frames import FRAMES
from tests.ros.rclpy.mistakes.imports import IMPORTS
from tests.ros.rclpy.mistakes.messages import MESSAGES
from tests.ros.rclpy.mistakes.names import NAMES
from tests.ros.rclpy.mistakes.nodes import NODES
from tests.ros.rclpy.mistakes.parameters import PARAMETERS
from tests.ros.rclpy.mistakes.plain_python import PLAIN_PYTHON
from tests.ros.rclpy.mistakes.sequences import SEQUENCES
from tests.ros.rclpy.mistakes.services import SERVICES
from tests.ros.rclpy.mistakes.times import TIMES
from tests.ros.rclpy.mistakes.topics import TOPICS

PROGRAM = """
from diagnostic_msgs.msg import DiagnosticStatus
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Point, PoseStamped, Twist
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.action import ActionClient, ActionServer
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from std_msgs.msg import ColorRGBA, Float64MultiArray, Int32, String, UInt8
from tf2_ros import Buffer, TransformBroadcaster
from visualization_msgs.msg import Marker
"""
CODE = compile(PROGRAM, "program", "exec")
# (program, last line of the error, hint below it)
OF_ROS = [*NODES, *TOPICS, *MESSAGES, *PARAMETERS, *SERVICES, *TIMES, *FRAMES]
MISTAKES = [*OF_ROS, *IMPORTS, *NAMES, *PLAIN_PYTHON, *SEQUENCES]


def transform(parent: str, child: str, second: int) -> TransformStamped:
    """Create a transform for the programs."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp.sec = parent, second
    return message


@pytest.fixture
def robot(graph: Graph) -> Iterator[Node]:
    """A run with a node, which a program may end itself."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    yield Node("robot")
    rclpy.try_shutdown()


def test_table_has_sixty_mistakes_mostly_with_a_hint() -> None:
    assert len(MISTAKES) >= 60
    assert sum(bool(hint) for _, _, hint in MISTAKES) >= 60


@pytest.mark.parametrize(("program", "message", "hint"), MISTAKES)
def test_mistake_raises_the_error_of_ros_with_a_hint(
    robot: Node,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    program: str,
    message: str,
    hint: str,
) -> None:
    # Some hints read the failing line, as they do in a file or in a cell.
    lines = [f"{line}\n" for line in program.splitlines()]
    monkeypatch.setitem(linecache.cache, "program.py", (len(program), None, lines, "program.py"))
    names = {"__name__": "__main__", "rclpy": rclpy, "node": robot, "transform": transform}
    exec(CODE, names)
    with time_lock.hold():
        try:
            exec(compile(program, "program.py", "exec"), names)
        except Exception as error:
            print_error(error)
    errors = without_python_version(capfd.readouterr().err)
    assert without_python_version(message) in errors.replace(
        f"[{robot.get_clock().now().nanoseconds / 1e9:.9f}] ", ""
    )
    assert (f"\nhint: {hint}\n" in errors) if hint else "hint:" not in errors
