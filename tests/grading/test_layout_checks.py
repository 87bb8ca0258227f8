from collections.abc import Callable
from typing import Any

import pytest

from course_lib.grading import (
    expect_colors_apart,
    expect_display,
    expect_displays_on,
    expect_drawn,
    expect_layout,
)
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.inputs import header, pose, transforms
from course_lib.grading.task import Message
from course_lib.grading.vocabulary.layouts import MAX_TEXT

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


def said(check: Check, layout: Any = LAYOUT) -> str:
    """Return the message of a check of a layout; "" if it passes."""
    verdict = check.judge(Evidence("week05.x", "public", 0.0, returns=(layout,)))
    return "" if verdict.score == 1 else verdict.message


def test_a_display_is_found_in_groups_with_its_topic_and_values() -> None:
    assert said(expect_display("LaserScan", "/scan", properties={"Name": "Laser"})) == ""
    assert said(expect_display("Grid", properties={"Plane Cell Count": 20})) == ""
    policy = {"Topic/Reliability Policy": "Reliable"}
    assert "is 'Best Effort', expected 'Reliable'" in said(expect_display("LaserScan", properties=policy))
    assert said(expect_display("LaserScan", "/other")) == "LaserScan listens to '/scan', expected '/other'"


def test_a_display_that_is_not_enabled_is_not_there() -> None:
    assert said(expect_display("TF")) == "no enabled display TF is in the layout, it has Grid and LaserScan"


def test_options_and_view_are_compared() -> None:
    assert said(expect_layout(fixed_frame="world", view="Orbit", view_properties={"Distance": 8.0})) == ""
    assert "the Fixed Frame is 'world', expected 'map'" in said(expect_layout(fixed_frame="map"))
    assert "the view is 'Orbit', expected 'FPS'" in said(expect_layout(view="FPS"))


def test_one_of_several_views_and_a_range_of_its_values_are_enough() -> None:
    assert said(expect_layout(view=("FPS", "Orbit"), view_within={"Distance": (0.5, 50.0)})) == ""
    assert said(expect_layout(view=("FPS", "XYOrbit"))) == "the view is 'Orbit', expected 'FPS' or 'XYOrbit'"
    too_far = "'Distance' of the view is 8, expected 0.5 to 5"
    assert said(expect_layout(view_within={"Distance": (0.5, 5.0)})) == too_far
    assert said(expect_layout(view_within={"Yaw": (0.0, 1.0)})) == "the view has no Yaw"
    nowhere = LAYOUT.replace("Distance: 8", "Distance: nan")
    assert "expected 0.5 to 50" in said(expect_layout(view_within={"Distance": (0.5, 50.0)}), nowhere)


def test_a_topic_without_a_display_or_with_two_is_named() -> None:
    assert said(expect_displays_on("/scan")) == ""
    assert said(expect_displays_on("/scan", "/plan")) == "0 enabled displays listen to '/plan', expected 1"
    assert said(expect_displays_on()) == "1 enabled displays listen to '/scan', expected 0"


@pytest.mark.parametrize(
    ("colors", "message"),
    [
        (("255; 0; 0", "150; 0; 0"), ""),
        (("255; 0; 0", "160; 0; 0"), "the colors of Path are 255; 0; 0 and 160; 0; 0: no channel differs by"),
        (("25; 255; 0", ""), "no channel differs by 100 or more"),
        (("255; 0; 0",), "the layout has one enabled display Path, expected two"),
        (("red", "0; 0; 0"), "the color is 'red', expected like '25; 255; 0'"),
        (("nan; 0; 0", "0; 0; 0"), "no channel differs"),
    ],
)
def test_colors_that_look_alike_are_named(colors: tuple[str, ...], message: str) -> None:
    rows = "".join(f"    - {{Class: rviz_default_plugins/Path, Color: {color}}}\n" for color in colors)
    layout = f"Visualization Manager:\n  Displays:\n{rows}"
    assert message in said(expect_colors_apart("Path", 100), layout)
    assert (message == "") == (said(expect_colors_apart("Path", 100), layout) == "")


def test_drawn_is_what_a_robots_messages_show_in_the_layout() -> None:
    check = expect_drawn("LaserScan", ROBOT, best_effort=("/scan",))
    assert said(check) == ""
    assert "RELIABILITY" in said(check, LAYOUT.replace("Best Effort", "Reliable"))
    assert "Frame [wrld] does not exist" in said(check, LAYOUT.replace("world", "wrld"))
    assert "no enabled display LaserScan" in said(check, LAYOUT.replace("LaserScan", "Image"))


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
def test_what_is_no_layout_fails_with_a_sentence(layout: Any) -> None:
    checks = (
        expect_display("Grid"),
        expect_layout(fixed_frame="a"),
        expect_drawn("LaserScan", ROBOT),
        expect_colors_apart("Path", 100),
        expect_displays_on("/scan"),
    )
    assert all(said(check, layout) for check in checks)


def test_a_grid_of_a_billion_cells_costs_nothing() -> None:
    layout = LAYOUT.replace("Plane Cell Count: 20", "Plane Cell Count: 1000000000")
    assert said(expect_drawn("LaserScan", ROBOT, best_effort=("/scan",)), layout) == ""


def test_a_layout_of_aliases_is_the_students_mistake(
    evidence: Callable[..., Evidence],
) -> None:
    levels = [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9 if n else 'x')}]" for n in range(9)]
    verdict = expect_layout(fixed_frame="map").judge(evidence(returns=("\n".join(levels),)))
    assert (verdict.score, verdict.mistake) == (0, "the layout is no YAML")
    assert "aliases" in verdict.message


def test_a_layout_reads_no_file_of_the_grader(evidence: Callable[..., Evidence]) -> None:
    robot = "{Class: rviz_default_plugins/RobotModel, Description Source: File, Description File: /etc/hosts}"
    text = f"Visualization Manager: {{Displays: [{robot}]}}"
    verdict = expect_drawn("RobotModel", ()).judge(evidence(returns=(text,)))
    assert verdict.mistake == "a description comes from a file"
