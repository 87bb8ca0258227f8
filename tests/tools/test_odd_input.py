"""Invalid input gets a one-line error, never a traceback."""

import pytest
from rclpy.node import Node

from course_lib.errors import CourseError
from tests.tools.conftest import Run

STRING = "topic pub /x std_msgs/msg/String"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("topic echo /chatter --once --timeout inf", "argument --timeout: Value must be in 1e-09 … 1e[+]09$"),
        ("topic list --spin-time nan", "argument --spin-time: 'nan' is not a time in seconds, -1e[+]09 … 1e"),
        ("topic list --spin-time inf", "argument --spin-time: 'inf' is not a time in seconds"),
        (f"{STRING} -r 1e-320 -w 0", "argument -r/--rate: Value must be in 1e-09 … 1e[+]09$"),
        (f"{STRING} -1 -w 0 --keep-alive inf", "argument --keep-alive: Value must be in"),
        (f"{STRING} -1 -t 2 -w 0", "argument -t/--times: not allowed with argument -1/--once$"),
        (f"{STRING} -1 -w 0 -n bad-name", "^Invalid node name: node name must not contain characters"),
        ("topic echo /chatter --once -l -5", "argument --truncate-length/-l: value must be non-negative"),
        ("param list --filter (", "argument --filter: '[(]' is not a regular expression: missing [)]"),
        ("run tf2_tools view_frames --wait-time nan", "argument -t/--wait-time: 'nan' is not a time"),
        ("run tf2_ros tf2_echo a b 0", "argument echo_rate: Value must be positive$"),
        ("run tf2_ros tf2_echo a b x", "argument echo_rate: Value must be positive$"),
    ],
)
def test_invalid_option_values_are_rejected_in_one_line(
    run: Run, talker: Node, line: str, message: str
) -> None:
    with pytest.raises(CourseError, match=message):
        run(line)


def test_count_of_0_repeats_endlessly(run: Run, talker: Node) -> None:
    output = run(f"{STRING} -w 0 -t 0")
    assert output.count("publishing #") == 6
    assert "ros2 topic pub stopped after 5 s of robot time" in output
