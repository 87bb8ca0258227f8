from typing import Any

import pytest

from course_lib.grading import Evidence, expect_launch_argument, expect_launch_node
from tests.grading.test_path_checks import returned

LAYOUT = expect_launch_argument("layout", default="a.rviz")
RVIZ = expect_launch_node("rviz2", "rviz2", options={"-d": "$(layout)"})
LAMP = expect_launch_node("tf2_ros", "static", name="lamp", options={"--z": 2.0, "--frame-id": "map"})
RIGHT = """
def generate_launch_description():
    layout = LaunchConfiguration("layout")
    return LaunchDescription([
        DeclareLaunchArgument("layout", default_value="a.rviz"),
        Node(package="tf2_ros", executable="static", name="lamp",
             arguments=["--z", "2", "--frame-id", "map"]),
        Node(package="rviz2", executable="rviz2", arguments=["-d", layout]),
    ])
"""
OTHER = """
FILE = "a.rviz"

def generate_launch_description():
    described = launch.LaunchDescription()
    words = ["--frame-id", "map", "--z", str(2.0)]
    lamp = launch_ros.actions.Node(executable="static", package="tf2_ros", name="lamp", arguments=words)
    rviz = Node(package="rviz2", executable="rviz2", arguments=["-d", LaunchConfiguration("layout")])
    nodes = [lamp] + [rviz]
    described.add_action(DeclareLaunchArgument(name="layout", default_value=FILE))
    described.add_action(GroupAction)
    return LaunchDescription([*nodes])
"""


def verdicts(text: Any) -> list[Any]:
    evidence: Evidence = returned(text)
    return [check.judge(evidence) for check in (LAYOUT, LAMP, RVIZ)]


@pytest.mark.parametrize("text", [RIGHT, OTHER])
def test_a_launch_file_may_be_written_in_several_ways(text: str) -> None:
    assert [verdict.message for verdict in verdicts(text)] == ["as expected"] * 3


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('default_value="a.rviz"', "", "the default of layout is None, expected 'a.rviz'"),
        ('("layout", default', '("file", default', "declares no argument 'layout'"),
        ('name="lamp"', 'name="light"', "the name of static is 'light', expected 'lamp'"),
        ('"2"', '"3"', "the word behind '--z' of static is '3', expected '2.0'"),
        ('"2"', '"high"', "the word behind '--z' of static is 'high', expected '2.0'"),
        ('"-d", layout', '"-d", "a.rviz"', "the word behind '-d' of rviz2 is 'a.rviz', expected '$(layout)'"),
        ('["-d", layout]', '"-d"', "the word behind '-d' of rviz2 is None"),
        ('package="rviz2"', 'package="rviz"', "starts static of tf2_ros, rviz2 of rviz, expected rviz2"),
        ("return LaunchDescription", "LaunchDescription", "has no function generate_launch_description"),
        ("layout = ", "layout = = ", "Python says of the launch file: invalid syntax"),
    ],
)
def test_what_is_wrong_with_a_launch_file_is_named(old: str, new: str, message: str) -> None:
    assert old in RIGHT
    assert message in "; ".join(verdict.message for verdict in verdicts(RIGHT.replace(old, new)))


@pytest.mark.parametrize(
    "text",
    [
        None,
        "",
        "x" * 20_000,
        RIGHT.replace("[\n", "+".join(["a"] * 3000) + " + [\n", 1),
        "\n".join(f"a{n} = [a{n + 1}, a{n + 1}]" for n in range(200)) + "\nLaunchDescription(a0)\n" + RIGHT,
    ],
)
def test_bombs_and_nothing_end_in_a_verdict(text: Any) -> None:
    assert all(isinstance(verdict.message, str) for verdict in verdicts(text))
