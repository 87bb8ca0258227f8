from collections.abc import Callable

import pytest
from rclpy.node import Node
from std_msgs.msg import Bool, String

from course_lib.errors import CourseError

Run = Callable[[str], str]


def test_type_prints_the_type_of_a_topic_and_find_its_topics(run: Run, talker: Node, other: Node) -> None:
    other.create_publisher(Bool, "/chatter", 1)
    talker.create_publisher(String, "/_hidden", 1)
    assert run("topic type /chatter") == "std_msgs/msg/Bool\nstd_msgs/msg/String\n"
    with pytest.raises(CourseError, match="Unknown topic '/nope'"):
        run("topic type /nope")
    assert run("topic find std_msgs/msg/String") == "/chatter\n"
    assert run("topic find std_msgs/msg/String --include-hidden-topics -c") == "2\n"
    assert run("topic find std_msgs/msg/Int8") == ""
