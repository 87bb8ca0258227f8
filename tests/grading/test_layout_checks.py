from collections.abc import Callable
from typing import Any

import pytest

from course_lib.grading import (
    Call,
    Scenario,
    Task,
    expect_colors_apart,
    expect_display,
    expect_displays_on,
    expect_drawn,
    expect_layout,
    my,
)
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.inputs import header, pose, transforms
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.task import Message
from course_lib.grading.vocabulary.files import MAX_TEXT

LAYOUT = """
Visualization Manager:
  Global Options: {Fixed Frame: world}
  Displays:
    - {Class: rviz_default_plugins/Grid, Name: Grid, Plane Cell Count: 20}
    - Class: rviz_common/Group
      Name: Sensors
      Displays:
        - Class: rviz_default_plugins/LaserScan
          Name: Laser
          Topic: {Value: /scan, Reliability Policy: Best Effort}
    - {Class: rviz_default_plugins/TF, Name: TF, Enabled: false}
  Views:
    Current: {Class: rviz_default_plugins/Orbit, Distance: 8}
"""
SCAN = {"angle_min": 0.0, "angle_max": 1.0, "angle_increment": 0.1, "range_max": 9.0, "ranges": [1.0] * 11}
ROBOT = (
    transforms([pose("world", "laser", (1.0, 0.0, 0.0))], 0.1),
    Message("/scan", "sensor_msgs/msg/LaserScan", {"header": header(0.1, "laser"), **SCAN}, at=0.2),
)


def message_of(check: Check, layout: Any = LAYOUT) -> str:
    """Return the message of a layout check, or "" if it passes."""
    verdict = check.judge(Evidence("week05.x", "public", 0.0, returns=(layout,)))
    return "" if verdict.score == 1 else verdict.message


def test_display_in_a_group_is_found_with_its_topic_and_values() -> None:
    assert message_of(expect_display("LaserScan", "/scan", properties={"Name": "Laser"})) == ""
    assert message_of(expect_display("Grid", properties={"Plane Cell Count": 20})) == ""
    policy = {"Topic/Reliability Policy": "Reliable"}
    assert "is 'Best Effort', expected 'Reliable'" in message_of(
        expect_display("LaserScan", properties=policy)
    )
    assert (
        message_of(expect_display("LaserScan", "/other"))
        == "LaserScan subscribes to '/scan', expected '/other'"
    )


def test_disabled_display_counts_as_missing() -> None:
    assert (
        message_of(expect_display("TF")) == "the layout has no enabled display TF, it has Grid and LaserScan"
    )


def test_global_options_and_view_are_compared() -> None:
    assert (
        message_of(expect_layout(fixed_frame="world", view="Orbit", view_properties={"Distance": 8.0})) == ""
    )
    assert "the Fixed Frame is 'world', expected 'map'" in message_of(expect_layout(fixed_frame="map"))
    assert "the view is 'Orbit', expected 'FPS'" in message_of(expect_layout(view="FPS"))


def test_one_of_several_expected_views_within_its_value_range_passes() -> None:
    assert message_of(expect_layout(view=("FPS", "Orbit"), view_within={"Distance": (0.5, 50.0)})) == ""
    assert (
        message_of(expect_layout(view=("FPS", "XYOrbit")))
        == "the view is 'Orbit', expected 'FPS' or 'XYOrbit'"
    )
    too_far = "'Distance' of the view is 8, expected 0.5 to 5"
    assert message_of(expect_layout(view_within={"Distance": (0.5, 5.0)})) == too_far
    assert message_of(expect_layout(view_within={"Yaw": (0.0, 1.0)})) == "the view has no Yaw"
    nowhere = LAYOUT.replace("Distance: 8", "Distance: nan")
    assert "expected 0.5 to 50" in message_of(expect_layout(view_within={"Distance": (0.5, 50.0)}), nowhere)


def test_topic_without_a_display_or_with_two_is_reported() -> None:
    assert message_of(expect_displays_on("/scan")) == ""
    assert (
        message_of(expect_displays_on("/scan", "/plan"))
        == "0 enabled displays subscribe to '/plan', expected 1"
    )
    assert message_of(expect_displays_on()) == "1 enabled displays subscribe to '/scan', expected 0"


@pytest.mark.parametrize(
    ("colors", "message"),
    [
        (("255; 0; 0", "150; 0; 0"), ""),
        (("255; 0; 0", "160; 0; 0"), "the colors of Path are 255; 0; 0 and 160; 0; 0: no channel differs by"),
        (("25; 255; 0", ""), "no channel differs by 100 or more"),
        (("255; 0; 0",), "the layout has one enabled display Path, expected two"),
        (("red", "0; 0; 0"), "the color is 'red', expected a color like '25; 255; 0'"),
        (("nan; 0; 0", "0; 0; 0"), "no channel differs"),
    ],
)
def test_similar_display_colors_are_reported(colors: tuple[str, ...], message: str) -> None:
    rows = "".join(f"    - {{Class: rviz_default_plugins/Path, Color: {color}}}\n" for color in colors)
    layout = f"Visualization Manager:\n  Displays:\n{rows}"
    assert message in message_of(expect_colors_apart("Path", 100), layout)
    assert (message == "") == (message_of(expect_colors_apart("Path", 100), layout) == "")


def test_expect_drawn_judges_the_display_of_robot_messages() -> None:
    check = expect_drawn("LaserScan", ROBOT, best_effort=("/scan",))
    assert message_of(check) == ""
    assert "RELIABILITY" in message_of(check, LAYOUT.replace("Best Effort", "Reliable"))
    assert "Frame [wrld] does not exist" in message_of(check, LAYOUT.replace("world", "wrld"))
    assert "no enabled display LaserScan" in message_of(check, LAYOUT.replace("LaserScan", "Image"))


@pytest.mark.parametrize(
    "layout",
    [
        None,
        5,
        "",
        "a: [",
        "Displays: 3",
        "x" * (MAX_TEXT + 1),
        "a: &a [1]\nb: &b [*a, *a]\nc: [*b, *b]",
        "\0",
    ],
)
def test_invalid_layout_fails_with_a_message(layout: Any) -> None:
    checks = (
        expect_display("Grid"),
        expect_layout(fixed_frame="a"),
        expect_drawn("LaserScan", ROBOT),
        expect_colors_apart("Path", 100),
        expect_displays_on("/scan"),
    )
    assert all(message_of(check, layout) for check in checks)


def test_grid_with_a_billion_cells_is_judged_quickly() -> None:
    layout = LAYOUT.replace("Plane Cell Count: 20", "Plane Cell Count: 1000000000")
    assert message_of(expect_drawn("LaserScan", ROBOT, best_effort=("/scan",)), layout) == ""


@pytest.mark.slow
def test_layout_with_recursive_yaml_aliases_is_reported_as_a_student_mistake(
    evidence: Callable[..., Evidence],
) -> None:
    levels = [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9 if n else 'x')}]" for n in range(9)]
    verdict = expect_layout(fixed_frame="map").judge(evidence(returns=("\n".join(levels),)))
    assert (verdict.score, verdict.mistake) == (0, "the layout is not valid YAML")
    assert "aliases" in verdict.message


def test_layout_cannot_read_files_of_the_grader(evidence: Callable[..., Evidence]) -> None:
    robot = "{Class: rviz_default_plugins/RobotModel, Description Source: File, Description File: /etc/hosts}"
    text = f"Visualization Manager: {{Displays: [{robot}]}}"
    verdict = expect_drawn("RobotModel", ()).judge(evidence(returns=(text,)))
    assert verdict.mistake == "a description comes from a file"


def test_displays_with_every_class_and_value_do_not_earn_full_marks() -> None:
    grid = "    - {{Class: rviz_default_plugins/Grid, Name: Grid, Plane Cell Count: {}}}\n"
    several = LAYOUT.replace("  Displays:\n", "  Displays:\n" + grid.format(30), 1)
    kinds = ("Axes", "Path", "Map", "Image", "Range", "PointCloud2")
    all_kinds = "".join(f"    - {{Class: rviz_default_plugins/{kind}, Name: {kind}}}\n" for kind in kinds)
    checks = (
        expect_display("Grid", properties={"Plane Cell Count": my("cells")}).titled("cells"),
        expect_display("LaserScan", "/scan").titled("topic"),
        expect_drawn("LaserScan", ROBOT, best_effort=("/scan",)).titled("drawn"),
    )
    assert failing(checks, LAYOUT, cells=20) == {}
    assert failing(checks, several, cells=30) == {
        "cells": "the layout has 2 enabled displays Grid, expected at most 1: remove or disable the others"
    }
    assert failing(checks, LAYOUT.replace("  Displays:\n", "  Displays:\n" + all_kinds, 1), cells=20) == {
        "drawn": "the layout has 6 enabled displays that the task does not require: remove or disable them"
    }
    counting = (*checks, expect_displays_on("/scan").worth(0))
    assert failing(counting, several, cells=30) == {}


def test_one_display_per_expected_topic_is_accepted() -> None:
    path = "    - {{Class: rviz_default_plugins/Path, Name: {}, Color: {}, Topic: {{Value: {}}}}}\n"
    rows = path.format("A", "255; 0; 0", "/a") + path.format("B", "0; 255; 0", "/b")
    two = LAYOUT.replace("  Displays:\n", "  Displays:\n" + rows, 1)
    checks = (expect_display("Path", "/a"), expect_display("Path", "/b"), expect_colors_apart("Path", 100))
    assert failing(checks, two) == {}
    three = two.replace("  Displays:\n", "  Displays:\n" + path.format("C", "0; 0; 255", "/a"), 1)
    assert list(failing(checks, three)) == ["the displays Path differ in color"]


def failing(checks: tuple[Check, ...], layout: str, **personal: Any) -> dict[str, str]:
    """Return the messages of the checks of one scenario that fail, by title."""
    scenario = Scenario("public", calls=(Call(),), checks=checks)
    task = Task("week05.x", "A layout", "function", "layout", ("a", "b", "c"), (scenario,))
    evidence = Evidence("week05.x", "public", 0.0, returns=(layout,), personal=personal)
    result = judge_task(task, 10.0, False, [Run(scenario, evidence)])
    return {check.title: check.message for check in result.checks if not check.passed}
