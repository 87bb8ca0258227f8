import inspect
import os
import sys
import time
from collections.abc import Sequence
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading import (
    Call,
    Check,
    Evidence,
    Scenario,
    Task,
    expect_launch_argument,
    expect_launch_node,
    expect_transform,
)
from course_lib.grading.run.run import Job, plan_scenarios, run_scenarios
from course_lib.grading.run.scenario import run_in_this_process
from course_lib.grading.task import shipped_catalog

HINTS = ("one", "two", "three")
STATIC = ("tf2_ros", "static_transform_publisher")
LAYOUT = expect_launch_argument("layout", default="a.rviz")
RVIZ = expect_launch_node("rviz2", "rviz2", options={"-d": "$(layout)"})
LAMP = expect_launch_node(*STATIC, name="lamp", options={"--z": 2.0, "--frame-id": "map"})
CHECKS = (LAYOUT, LAMP, RVIZ)
RIGHT = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

def generate_launch_description():
    layout = LaunchConfiguration("layout")
    return LaunchDescription([
        DeclareLaunchArgument("layout", default_value="a.rviz"),
        Node(package="tf2_ros", executable="static_transform_publisher", name="lamp",
             arguments=["--z", "2", "--frame-id", "map", "--child-frame-id", "lamp"]),
        Node(package="rviz2", executable="rviz2", arguments=["-d", layout]),
    ])
"""
OTHER = """
import launch
import launch_ros.actions as ros
from launch.actions import *

FILE = "a.rviz"

def rviz(context):
    layout = context.launch_configurations["layout"]
    return [ros.Node(package="rviz2", executable="rviz2", arguments=["-d", layout])]

def generate_launch_description():
    described = launch.LaunchDescription()
    described.add_action(DeclareLaunchArgument(name="layout", default_value=FILE))
    words = ["--frame-id", "map", "--z", str(2.0), "--child-frame-id", "lamp"]
    lamp = ros.Node(executable="static_transform_publisher", package="tf2_ros", name="lamp", arguments=words)
    for action in (TimerAction(period=1.0, actions=[lamp]), OpaqueFunction(function=rviz)):
        described.add_action(action)
    return described
"""
XML = """
<launch>
  <arg name="layout" default="a.rviz"/>
  <node pkg="tf2_ros" exec="static_transform_publisher" name="lamp"
        args="--z 2 --frame-id map --child-frame-id lamp"/>
  <node pkg="rviz2" exec="rviz2" args="-d $(var layout)"/>
</launch>
"""


def task(checks: Sequence[Check] = CHECKS) -> Task:
    scenario = Scenario("public", calls=(Call(),), checks=tuple(checks))
    return Task("week05.launch_file", "A launch", "launch", "launch_file", HINTS, (scenario,))


def launched(text: Any) -> Evidence:
    made = task()
    return run_in_this_process(made, made.scenarios[0], lambda: text, {})


def verdicts(text: Any) -> list[Any]:
    evidence = launched(text)
    return [check.judge(evidence) for check in CHECKS]


@pytest.mark.parametrize("text", [RIGHT, OTHER, XML], ids=["list", "functions", "XML"])
def test_equivalent_launch_files_pass(text: str) -> None:
    assert [verdict.message for verdict in verdicts(text)] == ["as expected"] * 3


def test_messages_of_launched_nodes_are_recorded_as_evidence() -> None:
    evidence = launched(RIGHT)
    assert expect_transform("map", "lamp", translation=(0.0, 0.0, 2.0)).judge(evidence).score == 1
    assert not evidence.errors


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('default_value="a.rviz"', 'default_value="b.rviz"', "the default of layout is 'b.rviz', expected"),
        (', default_value="a.rviz"', "", "the default of layout is None, expected 'a.rviz'"),
        ('("layout", default', '("file", default', "launch configuration 'layout' does not exist"),
        ('name="lamp"', 'name="light"', "the name of static_transform_publisher is 'light', expected 'lamp'"),
        ('"2"', '"3"', "the argument after '--z' of static_transform_publisher is '3', expected '2.0'"),
        (
            '"-d", layout',
            '"-d", "a.rviz"',
            "is 'a.rviz', expected the value of the argument layout, LaunchConfiguration('layout')",
        ),
        ('"-d", layout', '"-d"', "rviz2 has no '-d' with a value after it, it has ['-d'], expected"),
        ('"-d", layout', "", "rviz2 has no '-d' with a value after it, it has no arguments, expected"),
        ('"--z", "2"', '"--z 2"', "has no '--z' with a value after it, it has ['--z 2', '--frame-id', 'map'"),
        ('package="rviz2"', 'package="rviz"', "package 'rviz' not found, searching"),
        ('"--z", "2"', '"--z", "2", "--yaw", "a"', "argument --yaw: invalid float value: 'a'; [static_"),
        ('package="rviz2"', 'package="tf2_ros"', "executable 'rviz2' not found in package 'tf2_ros'"),
        ('Node(package="rv', 'Node(package="b", executable="a"), Node(package="rv', "package 'b' not found"),
        ("return LaunchDescription", "LaunchDescription", "returned None; end it with: return"),
        ("def generate_launch_description", "def describe", "does not contain the required function"),
        (
            "def generate_launch_description",
            "def generate_launch_discription",
            "Rename generate_launch_discription: launch calls generate_launch_description",
        ),
        ("layout = ", "layout = = ", "SyntaxError: invalid syntax (your.launch.py, line 8: layout = = "),
        ('"--z", "2"', '"--z", 2', "'int' object is not iterable"),
        ('Node(package="rviz2"', 'lambda: Node(package="rviz2"', "object has no attribute 'visit'"),
        ('"--frame-id", "map"', '"--frame-id", "lamp"', "the argument after '--frame-id' of static"),
        ('"lamp"]', '"map"]', "process has died [pid 1, exit code 1, cmd 'static_transform_publisher-1"),
    ],
)  # fmt: skip
def test_fault_of_a_launch_file_is_reported(old: str, new: str, message: str) -> None:
    assert old in RIGHT
    assert message in "; ".join(verdict.message for verdict in verdicts(RIGHT.replace(old, new)))


def test_second_node_of_an_executable_fails_its_checks_unless_the_task_requires_it() -> None:
    other = (
        'Node(package="tf2_ros", executable="static_transform_publisher", name="other", arguments=["--z", "2"'
    )
    other += ', "--frame-id", "map", "--child-frame-id", "other"]), Node(package="rviz2"'
    evidence = launched(RIGHT.replace('Node(package="rviz2"', other))
    verdict = expect_launch_node(*STATIC, options={"--z": 2.0}).judge(evidence)
    assert "starts 2 nodes of static_transform_publisher, expected at most 1" in verdict.message
    for name in ("lamp", "other"):
        options = {"--child-frame-id": name}
        assert expect_launch_node(*STATIC, name=name, options=options, of=2).judge(evidence).score == 1
    assert expect_launch_node(*STATIC, options={"--child-frame-id": "other"}, of=2).judge(evidence).score == 0


IMPORTS = [line for line in RIGHT.splitlines() if line.startswith("from")]


@pytest.mark.parametrize("line", IMPORTS)
@pytest.mark.parametrize("misspelt", [False, True])
def test_launch_file_without_an_import_fails_every_check(line: str, misspelt: bool) -> None:
    text = RIGHT.replace(line, line.replace("launch", "lunch") if misspelt else "")
    error = "ModuleNotFoundError: No module named 'lunch" if misspelt else "NameError: name '"
    assert all(f"ros2 launch reports: {error}" in verdict.message for verdict in verdicts(text))


def test_launch_does_not_change_the_process_state() -> None:
    before = list(sys.argv), list(sys.path), dict(os.environ)
    launched(
        RIGHT.replace("layout = ", 'import os; os.environ["LAMP"] = "on"; layout = ').replace(
            "def generate", 'import sys; sys.path.append("/nowhere")\n\ndef generate'
        )
    )
    assert (sys.argv, sys.path, dict(os.environ)) == before


def test_failed_launch_restores_sys_argv() -> None:
    before = list(sys.argv)
    launched(RIGHT.replace('Node(package="rviz2"', 'lambda: Node(package="rviz2"'))
    assert sys.argv == before


def test_terminated_node_fails_only_its_own_checks() -> None:
    scores = [verdict.score for verdict in verdicts(RIGHT.replace('"lamp"]', '"map"]'))]
    assert scores == [1, 0, 1]


@pytest.mark.parametrize("text", [None, "", 5, "raise SystemExit"])
def test_invalid_launch_file_scores_zero(text: Any) -> None:
    assert all(verdict.score == 0 for verdict in verdicts(text))


def test_launch_file_of_one_endless_word_is_judged_quickly() -> None:
    begin = time.process_time()
    assert all(verdict.score == 0 for verdict in verdicts("x" * 20_000))
    assert time.process_time() - begin < 3  # [s]; a pattern that starts inside of words takes 9 s


@pytest.mark.parametrize(
    "returned",
    [None, 5, "launch", {"launched": 5}, {"launched": {"defaults": [], "started": 1, "others": {}}},
     {"launched": {"defaults": {}, "started": [["a"]], "others": [], "error": ""}}],
)  # fmt: skip
def test_forged_launch_record_is_judged_by_the_checks(returned: Any) -> None:
    evidence = Evidence("week05.launch_file", "public", 5.0, returns=(returned,))
    assert all(check.judge(evidence).score == 0 for check in CHECKS)


def test_launch_file_gives_equal_evidence_in_the_kernel_and_in_the_sandbox() -> None:
    made, text = task(), OTHER
    here = run_in_this_process(made, made.scenarios[0], lambda: text, {})
    cells = (f"def launch_file():\n    return {text!r}",)
    course = shipped_catalog()
    (run,) = run_scenarios(
        Job(cells, None, plan_scenarios([made], course, with_hidden=False), course.course.limits)
    ).runs
    assert run.evidence.returns == here.returns
    assert run.evidence.samples
    assert run.evidence.recording.digest() == here.recording.digest()


def test_launch_check_in_another_task_type_is_rejected() -> None:
    with pytest.raises(
        CourseError, match=r"expect_launch_argument at .*test_launch_checks\.py line \d+ needs kind"
    ):
        Task(
            "week05.launch_file", "A launch", "function", "launch_file", HINTS,
            (Scenario("public", calls=(Call(),), checks=(LAYOUT,)),),
        )  # fmt: skip


def test_documentation_of_a_check_function_lacks_the_whole_entry_of_the_evidence() -> None:
    assert "Args:\n    package: The package of the executable." in (inspect.getdoc(expect_launch_node) or "")
