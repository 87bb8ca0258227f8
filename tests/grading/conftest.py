"""Constructed evidence, and a small course with submissions."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from course_lib.grading.evidence import Evidence
from course_lib.grading.store import Course
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name

MakeEvidence = Callable[..., Evidence]


@pytest.fixture
def evidence() -> MakeEvidence:
    """Evidence of (seconds, topic, message) rows."""

    def make(*published: tuple[float, str, Any], seconds: float = 3.0, **more: Any) -> Evidence:
        samples = tuple(
            Sample(START_NS + round(at * 1e9), topic, type_name(message), serialize(message), Qos(), 7)
            for at, topic, message in published
        )
        return Evidence("week01.demo", "public", seconds, samples, **more)

    return make


@pytest.fixture
def cube() -> Callable[..., Any]:
    """Return the red cube that lesson 1 requires, with some fields changed."""

    def make(**changes: Any) -> Any:
        from visualization_msgs.msg import Marker

        marker = Marker(type=Marker.CUBE, ns="basic_shapes")
        marker.header.frame_id = "map"
        marker.pose.position.z = 0.5
        marker.scale.x = marker.scale.y = marker.scale.z = 1.0
        marker.color.r, marker.color.a = 1.0, 0.8
        for dotted, value in changes.items():
            *path, last = dotted.split("__")
            owner = marker
            for name in path:
                owner = getattr(owner, name)
            setattr(owner, last, value)
        return marker

    return make


COURSE = """
title = "A course"
time_zone = "Europe/Paris"
[limits]
cell_seconds = 30
scenario_seconds = 30
[weeks.week01]
title = "First marker"
deadline = 2026-10-11T23:59:00
[weeks.week01.points]
red_cube = 60
half = 40
[weeks.week01.bonus]
answer = 10
"""
CHECKS = """
from course_lib.grading.task import Call, Message, Scenario, Task, my
from course_lib.grading import expect_marker, expect_rate, expect_text, expect_value

TOPIC = "/visualization_marker"
HINTS = ("Which fields has a marker?", "The centre is half an edge up.", "Set position.z to 0.5.")
TASKS = (
    Task("week01.red_cube", "A red cube", "node", "RedCubeNode", HINTS, scenarios=(
        Scenario("public", seconds=3.0, checks=(
            expect_marker(TOPIC, type="CUBE", frame="map", position=(0, 0, 0.5)),
            expect_marker(TOPIC, color=(1, 0, 0)),
        )),),
        ghost=(Message(TOPIC, "visualization_msgs/msg/Marker", {
            "type": 1, "header": {"frame_id": "map"}, "scale": {"x": 1, "y": 1, "z": 1},
            "color": {"r": 1, "a": 1},
        }),),
    ),
    Task("week01.half", "Half of it", "function", "half", HINTS, scenarios=(
        Scenario("public", calls=(Call(4.0),), checks=(expect_value(2.0, unit="m"),)),)),
    Task("week01.answer", "Your number", "value", "answer", HINTS, personal={"n": (10, 20, 30)}, scenarios=(
        Scenario("public", checks=(expect_value(my("n", times=2)),)),)),
)
"""
MISTAKES = """
[half]
"a value has the wrong sign" = "Half, not minus half."
"""
HIDDEN = """
from course_lib.grading.task import Call, Scenario
from course_lib.grading import Check, expect_rate, expect_value
HIDDEN = {
    "week01.red_cube": (Scenario("longer", seconds=9.0, checks=(
        expect_rate("/visualization_marker", 1.0).worth(2),)),),
    "week01.half": (Scenario("other", calls=(Call(-7.0),), checks=(expect_value(-3.5),)),),
}
"""
FAULTY_CHECK = 'Check("the value is right", lambda evidence: [][1])'  # raises an IndexError
RIGHT = """
%load_ext course_lib
import rclpy
from rclpy.node import Node
from visualization_msgs.msg import Marker
from course_lib import check
from course_lib.grading import my_values

class RedCubeNode(Node):
    def __init__(self):
        super().__init__("red_cube")
        self.publisher = self.create_publisher(Marker, "/visualization_marker", 10)
        self.create_timer(1.0, self.publish_marker)

    def publish_marker(self):
        marker = Marker(type=Marker.CUBE)
        marker.header.frame_id = "map"
        marker.pose.position.z = 0.5
        marker.scale.x = marker.scale.y = marker.scale.z = 1.0
        marker.color.r = marker.color.a = 1.0
        self.publisher.publish(marker)
# next cell
def half(length):
    return length / 2
# next cell
answer = 2 * my_values("week01.answer")["n"]
check("week01.answer", answer)
"""


def write_course(top: Path, settings: str = COURSE, hidden: str = HIDDEN) -> Course:
    """Write a small course of one week: a node, a function and a value."""
    for name, text in {
        "exercises/course.toml": settings,
        "exercises/checks/week01.py": CHECKS,
        "exercises/mistakes/week01.toml": MISTAKES,
        "solutions/checks/week01.py": hidden,
    }.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text(text)
    return Course(top / "exercises", top / "solutions")


@pytest.fixture
def course(tmp_path: Path) -> Course:
    """A course with limits for a machine that has much else to do."""
    return write_course(tmp_path / "course")


@pytest.fixture
def right() -> str:
    """The correct answer; a line `# next cell` separates the cells."""
    return RIGHT


def written(path: Path, code: str, **course: str) -> Path:
    """Write an exercise notebook."""
    cells = [{"cell_type": "code", "source": cell} for cell in code.split("# next cell\n")]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"nbformat": 4, "metadata": {"course": course}, "cells": cells}))
    return path


@pytest.fixture
def write_notebook() -> Callable[..., Path]:
    """Writes an exercise notebook."""
    return written
