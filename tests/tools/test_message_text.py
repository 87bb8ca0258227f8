from array import array
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point, PoseWithCovariance
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Float64MultiArray, Header, String
from visualization_msgs.msg import Marker

from course_lib.ros.messages import RosMessage
from course_lib.ros.messages.conversions import PrintOptions, to_csv, to_yaml

POINTS = """header:
  stamp:
    sec: 0
    nanosec: 0
  frame_id: map
points:
- x: 1.0
  y: 0.0
  z: 0.0
- x: 0.0
  y: 0.0
  z: 0.0
"""


def test_yaml_is_in_block_style_with_the_fields_in_order() -> None:
    marker = Marker(header=Header(frame_id="map"), points=[Point(x=1.0), Point()])
    lines = to_yaml(marker, PrintOptions()).splitlines(keepends=True)
    assert "".join(lines[:5]) in POINTS
    assert "".join(lines[lines.index("points:\n") :]).startswith(POINTS[POINTS.index("points:") :])
    assert "colors: []\n" in lines


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "data: ''\n"),
        ("yes", "data: 'yes'\n"),
        ("1.0", "data: '1.0'\n"),
        ("Größe ✓", "data: Größe ✓\n"),
        ("a: b", "data: 'a: b'\n"),
        ("x" * 129, f"data: {'x' * 128}...\n"),
        ("w " * 60, f"data: '{'w ' * 60}'\n"),
    ],
)
def test_strings_are_quoted_and_truncated_as_in_pyyaml_and_ros(text: str, line: str) -> None:
    assert to_yaml(String(data=text), PrintOptions()) == line


def test_long_sequences_are_truncated_with_dots() -> None:
    scan = LaserScan(ranges=[0.5] * 200)
    assert to_yaml(scan, PrintOptions()).count("- 0.5\n") == 128
    assert "- 0.5\n- '...'\nintensities: []\n" in to_yaml(scan, PrintOptions())
    assert to_yaml(scan, PrintOptions(truncate=None)).count("- 0.5\n") == 200


def test_bytes_are_printed_as_characters() -> None:
    assert to_yaml(DiagnosticStatus(level=b"\x02", name="a"), PrintOptions()).startswith(
        'level: "\\x02"\nname: a\n'
    )


def test_flow_style_prints_sequences_on_one_line_and_messages_in_lines_as_ros2cli() -> None:
    assert to_yaml(Time(sec=1), PrintOptions(flow=True)) == "sec: 1\nnanosec: 0\n"
    joints = JointState(name=["a", "true"], position=[1.0])
    assert to_yaml(joints, PrintOptions(flow=True)).splitlines()[4:] == [
        "  frame_id: ''",
        "name: [a, 'true']",
        "position: [1.0]",
        "velocity: []",
        "effort: []",
    ]
    diagnostics = DiagnosticArray(status=[DiagnosticStatus(name="a")])
    assert 'status: [{level: "\\0", name: a, ' in to_yaml(diagnostics, PrintOptions(flow=True))


def test_placeholders_replace_arrays_and_strings_on_request() -> None:
    text = to_yaml(Marker(ns="abc", points=[Point()]), PrintOptions(no_arrays=True, no_strings=True))
    assert "ns: '<string length: <3>>'\n" in text
    assert "points: '<sequence type: geometry_msgs/msg/Point, length: 1>'\n" in text
    covariance = to_yaml(PoseWithCovariance(), PrintOptions(no_arrays=True))
    assert "covariance: '<array type: double[36]>'\n" in covariance
    status = DiagnosticStatus(values=[KeyValue(key="ab", value="c")])
    assert "- key: '<string length: <2>>'\n  value: '<string length: <1>>'\n" in to_yaml(
        status, PrintOptions(no_strings=True)
    )


CSV: list[tuple[RosMessage, PrintOptions, str]] = [
    (Header(stamp=Time(sec=1, nanosec=2), frame_id="map"), PrintOptions(), "1,2,map"),
    (Float64MultiArray(data=[1.0, 2.0, 3.0]), PrintOptions(truncate=2), "0,1.0,2.0,..."),
    (JointState(name=["a", "b"]), PrintOptions(no_strings=True), "0,0,<string length: <0>>,"),
    (String(data="abcd"), PrintOptions(truncate=2), "ab..."),
    (KeyValue(key="", value="v"), PrintOptions(), "v"),
]


@pytest.mark.parametrize(("message", "style", "row"), CSV)
def test_csv_is_one_line_of_field_values(message: RosMessage, style: PrintOptions, row: str) -> None:
    assert to_csv(message, style).startswith(row)


def test_csv_accepts_any_sequence() -> None:
    values: list[Any] = [array("i", [1, 2]), (1, 2), [1, 2]]
    assert {to_csv(value, PrintOptions()) for value in values} == {"1,2"}
