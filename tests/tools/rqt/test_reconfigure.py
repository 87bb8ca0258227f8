from typing import Any

import ipywidgets
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter

from course_lib.controls import Slider
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from course_lib.tools.rqt.services import ReconfigureView


@pytest.fixture
def view(graph: Graph, arm: Node) -> ReconfigureView:
    view = ReconfigureView(graph, ["arm/controller"])
    view.listen()
    view.body()
    return view


def row(view: ReconfigureView, name: str) -> tuple[Any, str, str]:
    control, note, said = view.rows[name].children
    return control, note.value, said.value


def test_controls_match_parameter_types_and_ranges(view: ReconfigureView) -> None:
    slider, note, _ = row(view, "gain")
    assert isinstance(slider, Slider)
    assert (slider.min, slider.max, slider.value) == (0.0, 5.0, 1.5)
    assert "0 … 5 · How fast" in note
    assert isinstance(row(view, "use_sim_time")[0], ipywidgets.Checkbox)
    assert row(view, "limits")[0].value == "[0.5, 1.5]"
    assert row(view, "serial")[0].disabled
    assert "read-only" in row(view, "serial")[1]


def test_text_fields_and_check_boxes_are_not_wider_than_a_narrow_window(view: ReconfigureView) -> None:
    assert {row(view, name)[0].layout.max_width for name in ("use_sim_time", "limits")} == {"100%"}


def test_change_is_set_in_the_node(view: ReconfigureView, arm: Node) -> None:
    row(view, "gain")[0].value = 2.25
    row(view, "limits")[0].value = "[1.0, 2.0, 3.0]"
    assert arm.get_parameter("gain").value == 2.25
    assert list(arm.get_parameter("limits").value) == [1.0, 2.0, 3.0]
    assert row(view, "gain")[2] == "set"


def test_rejected_value_is_reverted_and_the_reason_shown(view: ReconfigureView, arm: Node) -> None:
    row(view, "frame")[0].value = "map"
    assert row(view, "frame")[0].value == arm.get_parameter("frame").value == "base"
    assert "Not set: there is only base" in row(view, "frame")[2]
    row(view, "limits")[0].value = "[1.0"
    assert "is not a parameter value" in row(view, "limits")[2]


def test_values_set_by_other_nodes_are_shown(view: ReconfigureView, arm: Node) -> None:
    arm.set_parameters([Parameter("gain", value=4.0)])
    spin_for(0.1)
    assert row(view, "gain")[0].value == 4.0


def test_parameters_of_all_nodes_are_printed_without_a_page(graph: Graph, arm: Node) -> None:
    picture = ReconfigureView(graph, []).picture()
    assert "<td>gain</td><td>1.5</td><td>0 … 5 · How fast</td>" in picture


def test_unknown_node_error_suggests_the_closest(graph: Graph, arm: Node) -> None:
    with pytest.raises(CourseError, match=r"Node not found: /arm/controler.*/arm/controller"):
        ReconfigureView(graph, ["arm/controler"])
