from collections.abc import Callable

import pytest
from geometry_msgs.msg import PointStamped
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.ros.graph import DELAY_NS

Run = Callable[[str], str]


def test_a_message_is_as_old_as_its_way_is_long(run: Run, talker: Node) -> None:
    delay = f"{DELAY_NS * 1e-9:.3f}"
    assert run("topic delay /place").startswith(
        f"average delay: {delay}\n\tmin: {delay}s max: {delay}s std dev: 0.00000s window: 8\n"
    )


def test_a_silent_second_says_no_new_messages(run: Run, talker: Node) -> None:
    sent = talker.create_publisher(PointStamped, "rare", 1)
    left = [PointStamped(), PointStamped()]
    talker.create_timer(0.4, lambda: sent.publish(left.pop()) if left else None)
    assert run("topic delay /rare").splitlines()[2:4] == ["no new messages"] * 2


def test_without_a_header_ros_s_words_and_what_to_type_instead(run: Run, talker: Node) -> None:
    with pytest.raises(CourseError, match=r"^msg does not have header: .* `ros2 topic hz /chatter`"):
        run("topic delay /chatter")
