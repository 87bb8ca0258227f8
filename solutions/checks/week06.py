"""Week 6, tooling and diagnostics: hidden scenarios and checks."""

from collections.abc import Iterator
from typing import Any

from course_lib.grading.inputs import header, pose, scan, transforms, xyz
from course_lib.grading.task import Call, Message, Scenario, my
from course_lib.grading.vocabulary import (
    expect_display,
    expect_drawn,
    expect_fact,
    expect_layout,
    expect_level,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_value,
)

IMAGES, DIAGNOSTICS = "/camera/image_raw", "/diagnostics"
FACTS = ("image_rate", "image_width", "scan_reliability", "threshold", "trigger_service")


def set_parameter(at: float, name: str, **value: Any) -> Message:
    """What `ros2 param set /camera …` asks."""
    fields = {"parameters": [{"name": name, "value": value}]}
    return Message("/camera/set_parameters", "rcl_interfaces/srv/SetParameters", fields, at=at)


def images(hz: float, begin: float, end: float) -> Iterator[Message]:
    """Other small images, as often as that, between two times [s]."""
    for number in range(round(hz * (end - begin))):
        at = begin + (number + 0.5) / hz
        fields = {"header": header(at, "lens"), "width": 2, "height": 1, "step": 2, "data": [9, 9]}
        yield Message(IMAGES, "sensor_msgs/msg/Image", {**fields, "encoding": "mono8"}, at=at)


def robot_messages(at: float) -> Iterator[Message]:
    """A robot at another place, that looks elsewhere."""
    base = pose("odom", "base_link", (-3.0, 2.0, 0.0), 1.5)
    fixed = (pose("base_link", name, (0.1, 0.0, 0.4)) for name in ("laser_link", "camera_link"))
    yield transforms((base, *fixed), at)
    ranges = scan([1.0] * 21, at, "laser_link", first=0.0, step=0.05)
    yield Message("/robot/scan", ranges.type_name, ranges.fields, at=at)
    place = {"position": xyz((-3.0, 2.0, 0.0)), "orientation": {"w": 1.0}}
    odometry = {"header": header(at, "odom"), "child_frame_id": "base_link", "pose": {"pose": place}}
    yield Message("/robot/odom", "nav_msgs/msg/Odometry", odometry, at=at)
    plan = {"header": header(at, "odom"), "poses": [{"pose": place}, {"pose": {"orientation": {"w": 1.0}}}]}
    yield Message("/robot/plan", "nav_msgs/msg/Path", plan, at=at)
    ball = {
        "header": header(at, "laser_link"),
        "ns": "people",
        "type": 2,
        "pose": {"orientation": {"w": 1.0}},
        "scale": xyz((0.4, 0.4, 0.4)),
        "color": {"r": 1.0, "a": 1.0},
    }
    markers = {"markers": [ball]}
    yield Message("/robot/annotations", "visualization_msgs/msg/MarkerArray", markers, at=at)


ROBOT = tuple(message for n in range(1, 5) for message in robot_messages(n / 2))

HIDDEN = {
    "week06.robot_facts": (
        Scenario(
            "again",
            calls=(Call(),),
            checks=tuple(expect_fact(name, serial=my("serial")) for name in FACTS),
        ),
    ),
    "week06.camera": (
        Scenario(
            "another frame, then faster, then two rates that are refused",
            seconds=10.0,  # [s]
            seed=5,
            inputs=(
                set_parameter(2.0, "frame_id", type=4, string_value="lens"),
                set_parameter(4.0, "frame_rate", type=3, double_value=40.0),
                set_parameter(6.0, "frame_rate", type=3, double_value=0.0),
                set_parameter(8.0, "frame_rate", type=3, double_value=61.0),
            ),
            checks=(
                expect_rate(IMAGES, my("frame_rate"), end=3.9),
                expect_rate(IMAGES, 40.0, begin=4.1, end=5.9),
                expect_rate(IMAGES, 40.0, begin=6.1).worth(2),
                expect_message(IMAGES, {"header.frame_id": "lens"}),
                expect_stamps(IMAGES),
            ),
        ),
        Scenario(
            "nobody sets anything",
            seconds=3.0,  # [s]
            seed=6,
            checks=(
                expect_rate(IMAGES, my("frame_rate")),
                expect_message(IMAGES, {"header.frame_id": "camera_link"}),
            ),
        ),
    ),
    "week06.camera_monitor": (
        Scenario(
            "faster, slower, silent, and well again",
            seconds=18.5,  # [s]
            seed=7,
            inputs=(
                *images(40.0, 0.0, 3.0),
                *images(11.0, 3.0, 6.0),
                *images(9.0, 6.0, 9.0),
                *images(34.0, 12.0, 15.0),
                *images(26.0, 15.0, 18.5),
            ),
            checks=(
                expect_level("WARN", says="above normal", begin=0.0, end=3.0),
                expect_level("WARN", says="below normal", begin=3.0, end=6.0),
                expect_level("ERROR", says="low", begin=6.0, end=9.0),
                expect_level("ERROR", says="low", begin=9.0, end=12.0),
                expect_level("OK", says="normal", begin=12.0, end=15.0),
                expect_level("OK", says="normal", begin=15.0, end=18.0),
                expect_rate(DIAGNOSTICS, 1.0),
                expect_stamps(DIAGNOSTICS),
                expect_message(
                    DIAGNOSTICS,
                    {
                        "status.0.name": "Front camera",
                        "status.0.hardware_id": my("hardware_id"),
                        "status.0.values.0.key": "Rate (Hz)",
                        "status.0.values.0.value": "26",
                    },
                ),
            ),
        ),
        Scenario(
            "at the edges",
            seconds=12.5,  # [s]
            seed=8,
            inputs=(
                *images(25.0, 0.0, 3.0),
                *images(35.0, 3.0, 6.0),
                *images(36.0, 6.0, 9.0),
                *images(10.0, 9.0, 12.5),
            ),
            checks=(
                expect_level("OK", says="normal", begin=0.0, end=3.0),
                expect_level("OK", says="normal", begin=3.0, end=6.0),
                expect_level("WARN", says="above normal", begin=6.0, end=9.0),
                expect_level("WARN", says="below normal", begin=9.0, end=12.0),
            ),
        ),
    ),
    "week06.performance_table": (
        Scenario(
            "other topics",
            calls=(
                Call(
                    {
                        "/a": [(2.0, 10), (2.5, 30)],
                        "/silent": [],
                        "/b": [(5.0, 100), (5.5, 100), (7.0, 100), (7.25, 500)],
                    }
                ),
                Call({}),
            ),
            checks=(
                expect_value(
                    [
                        ["/b", 3 / 2.25, 200.0, 200.0 * 3 / 2.25, 1.5],
                        ["/a", 2.0, 20.0, 40.0, 0.5],
                        ["/silent", 0.0, 0.0, 0.0, 0.0],
                    ],
                    call=0,
                ),
                expect_value([], call=1),
            ),
        ),
    ),
    "week06.inspection_layout": (
        Scenario(
            "the robot elsewhere",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="odom"),
                expect_drawn("TF", ROBOT),
                expect_drawn("LaserScan", ROBOT, best_effort=("/robot/scan",)),
                expect_display("LaserScan", "/robot/scan"),
                expect_display("Odometry", "/robot/odom", properties={"Keep": my("keep")}),
                expect_drawn("Odometry", ROBOT),
                expect_drawn("Path", ROBOT),
                expect_drawn("MarkerArray", ROBOT),
                expect_display(
                    "Image",
                    "/robot/front_cam/image_raw",
                    properties={"Topic/Reliability Policy": "Best Effort"},
                ),
            ),
        ),
    ),
    "week06.detection_latency": (
        Scenario(
            "strangers, and stamps that differ a little",
            calls=(
                Call(
                    [[1.02, 1.0], [1.12, 1.1], [1.22, 1.2], [1.32, 1.3]],
                    [[1.09, 1.0], [0.95, 0.9], [1.42, 1.30004]],
                ),
                Call([], [[1.0, 0.9]]),
            ),
            checks=(
                expect_value([0.085, 0.1, 0.5], call=0),
                expect_value([0.0, 0.0, 0.0], call=1),
            ),
        ),
    ),
}
