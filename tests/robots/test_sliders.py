from collections.abc import Callable
from typing import Any

import pytest
import rclpy

from course_lib.robots.state_publishers import JointStatePublisher, joint_sliders
from course_lib.ros.graph.graph import Graph
from tests.robots.urdfs import ALL_KINDS, ARM_2R


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that a page watches."""
    monkeypatch.setattr("course_lib.ros.time.pace.mode", lambda: "real")


def rows(box: Any) -> list[tuple[Any, str]]:
    return [(row.children[0], row.children[1].value) for row in box.children[1:]]


def test_no_sliders_are_created_without_a_page(graph: Graph) -> None:
    assert joint_sliders(JointStatePublisher(ARM_2R)) is None


def test_each_movable_joint_has_a_slider_with_its_limits(graph: Graph, page: None) -> None:
    found = rows(joint_sliders(JointStatePublisher(ALL_KINDS)))
    assert [(slider.description, text) for slider, text in found] == [
        ("drive", "-3.142 … 3.142 rad"),
        ("lift", "-1.000 … 1.000 m"),
    ]
    assert (found[1][0].min, found[1][0].max) == (-1.0, 1.0)


def test_slider_values_are_published(graph: Graph, page: None, on: Callable[[str], list[Any]]) -> None:
    node = JointStatePublisher(ARM_2R)
    (_, _), (elbow, _) = rows(joint_sliders(node))
    elbow.value = 0.75
    rclpy.spin_once(node)
    assert list(on("/joint_states")[-1].position) == [0.0, 0.75]


def test_sliders_follow_positions_that_are_set_by_code(graph: Graph, page: None) -> None:
    node = JointStatePublisher(ARM_2R)
    _, (elbow, _) = rows(joint_sliders(node))
    node.joints["elbow"].position = -0.5
    assert elbow.value == -0.5
    beyond = elbow.max + 1.0
    node.joints["elbow"].position = beyond
    assert (elbow.value, node.joints["elbow"].position) == (-0.5, beyond)


def test_center_button_resets_all_joints(graph: Graph, page: None) -> None:
    node = JointStatePublisher(ARM_2R, zeros={"elbow": 0.5})
    box = joint_sliders(node)
    for slider, _ in rows(box):
        slider.value = 0.9
    assert box is not None
    box.children[0].click()
    assert [joint.position for joint in node.joints.values()] == [0.0, 0.5]


def test_changed_robot_gets_its_own_sliders(graph: Graph, page: None) -> None:
    node = JointStatePublisher(ARM_2R)
    box = joint_sliders(node)
    node.set_description(ALL_KINDS)
    assert [slider.description for slider, _ in rows(box)] == ["drive", "lift"]


def test_page_without_widgets_lists_the_values_of_all_sliders(graph: Graph, page: None) -> None:
    box: Any = joint_sliders(JointStatePublisher(ARM_2R))
    rows(box)[1][0].value = 0.75
    assert box._repr_mimebundle_()["text/plain"].splitlines()[::2] == [
        "Sliders of joints were here. Run this cell to use them.",
        f"elbow: 0.750 ({rows(box)[1][1].replace(' rad', '')} rad)",
    ]
