from collections.abc import Callable

import pytest
from geometry_msgs.msg import PointStamped
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import DELAY_NS

Run = Callable[[str], str]


def test_message_delay_equals_the_transport_delay(run: Run, talker: Node) -> None:
    delay = f"{DELAY_NS * 1e-9:.3f}"
    assert run("topic delay /place").startswith(
        f"average delay: {delay}\n\tmin: {delay}s max: {delay}s std dev: 0.00000s window: 8\n"
    )


def test_second_without_messages_is_reported(run: Run, talker: Node) -> None:
    sent = talker.create_publisher(PointStamped, "rare", 1)
    left = [PointStamped(), PointStamped()]
    talker.create_timer(0.4, lambda: sent.publish(left.pop()) if left else None)
    assert run("topic delay /rare").splitlines()[2:4] == ["no new messages"] * 2


def test_message_without_a_header_has_the_ros_error_and_an_alternative(run: Run, talker: Node) -> None:
    with pytest.raises(CourseError, match=r"^msg does not have header: .* `ros2 topic hz /chatter`"):
        run("topic delay /chatter")
