"""`course ros2 --run program.py …`: as in a second terminal."""

from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.tools.run import ros2_over

LATE = """
import rclpy, time
from rclpy.node import Node
from std_msgs.msg import String

rclpy.init()
time.sleep(0.3)  # it takes a while to come up
node = Node("late")
node.declare_parameter("speed", 2)
publisher = node.create_publisher(String, "chatter", 10)
node.create_subscription(String, "ear", lambda said: print("heard", said.data), 10)
node.create_timer(0.1, lambda: publisher.publish(String(data="hi")))
rclpy.spin(node)
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    file = tmp_path / "late.py"
    file.write_text(LATE)
    return file


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("node list", "/late\n"),
        ("topic type /chatter", "std_msgs/msg/String\n"),
        ("topic info /ear", "Type: std_msgs/msg/String\nPublisher count: 0\nSubscription count: 1\n"),
        ("param get /late speed", "Integer value is: 2\n"),
        ("topic echo /chatter --once", "data: hi\n---\n"),
        ("topic echo /chatter --csv --timeout 0.25", "hi\nhi\n"),
        ("interface proto std_msgs/msg/String --no-quotes", "data: ''\n\n"),
    ],
)
def test_tool_sees_running_nodes(
    program: Path, capsys: pytest.CaptureFixture[str], line: str, text: str
) -> None:
    assert ros2_over(line.split(" "), files=[program], bag=None, seconds=3.0) == 0
    assert capsys.readouterr() == (text, "")


def test_output_of_a_program_beside_a_tool_is_written_to_stderr(
    program: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["topic", "pub", "--once", "/ear", "std_msgs/msg/String", "data: hi"]
    assert ros2_over(words, files=[program], bag=None, seconds=3.0) == 0
    captured = capsys.readouterr()
    assert captured.out.endswith("String(data='hi')\n\n")
    assert captured.err == "heard hi\n"


def test_endless_tool_ends_with_the_run(program: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ros2_over(["topic", "hz", "/chatter"], files=[program], bag=None, seconds=2.0)
    rate = "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 11\n"
    assert capsys.readouterr().out == rate


def test_error_of_the_tool_is_raised_after_the_run(program: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(CourseError, match=r"^Could not determine the type .*Did you mean /chatter\?"):
        ros2_over(["topic", "echo", "/chater"], files=[program], bag=None, seconds=3.0)
    assert "does not appear to be published yet" in capsys.readouterr().out
    with pytest.raises(CourseError, match="invalid choice: 'lst'"):
        ros2_over(["topic", "lst"], files=[program], bag=None, seconds=3.0)


def test_run_starts_a_program_that_calls_init_itself(capfd: pytest.CaptureFixture[str]) -> None:
    words = ["run", "demo_nodes_py", "talker"]
    assert ros2_over(words, files=[], bag=None, seconds=2.5) == 0
    printed = capfd.readouterr()
    assert 'Publishing: "Hello World: 1"' in printed.err
    assert "Process exited" not in printed.out
