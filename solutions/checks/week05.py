"""Week 5, configurations: hidden scenarios and checks."""

from collections.abc import Iterator
from typing import Any

from course_lib.grading import (
    Call,
    Message,
    Scenario,
    expect_display,
    expect_displays_on,
    expect_drawn,
    expect_launch_argument,
    expect_launch_node,
    expect_layout,
    expect_value,
    inputs,
    my,
)

GREEN, RED = [0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]  # RGBA
SEEN_FROM = (0.5, 50.0)  # minimum distance at which a person is visible [m]
DEEP_LAYOUT = """
Visualization Manager:
  Displays:
    - Class: rviz_common/Group
      Name: All
      Enabled: true
      Displays:
        - {Class: rviz_default_plugins/Path, Name: Plan}
        - Class: rviz_common/Group
          Name: Off
          Enabled: false
          Displays:
            - {Class: rviz_default_plugins/Image, Name: Hidden, Enabled: true}
        - Class: rviz_common/Group
          Name: Deep
          Displays:
            - {Class: my_robot/Battery, Name: Charge, Enabled: true}
    - {Class: rviz_default_plugins/TF, Name: Frames, Enabled: false}
    - {Class: rviz_default_plugins/Map, Name: Room, Enabled: true}
"""

FLAT_LAYOUT = """
Visualization Manager:
  Displays:
    - {Class: rviz_default_plugins/Path, Name: Way}
    - {Class: rviz_default_plugins/Grid, Name: Ground, Enabled: false}
    - {Class: rviz_default_plugins/PointStamped, Name: Spot, Enabled: true}
"""


def detections(at: float) -> Message:
    """Somebody else."""
    marker = {
        "header": inputs.header(at, "base_link"),
        "ns": "people",
        "type": 1,
        "pose": {"position": inputs.xyz((1.0, 0.0, 0.9)), "orientation": {"w": 1.0}},
        "scale": inputs.xyz((0.5, 0.5, 1.8)),
        "color": {"g": 1.0, "a": 1.0},
    }
    return Message("/detections", "visualization_msgs/msg/MarkerArray", {"markers": [marker]}, at=at)


def robot(at: float) -> Iterator[Message]:
    """Return the robot's messages at another position: a quarter circle of 1 m, and another person."""
    base = inputs.pose("world", "base_link", (-2.0, 3.0, 0.0), 1.0)
    yield inputs.transforms((base, inputs.pose("base_link", "laser", (0.2, 0.0, 0.5))), at)
    yield inputs.scan([0.57] * 9 + [1.0] * 22, at, first=0.0, step=0.05)  # [m], [rad]
    yield detections(at)


ROBOT = tuple(message for n in range(1, 5) for message in robot(n / 2))  # [s]
BEST_EFFORT = ("/scan",)


SENSOR = {"Topic/Reliability Policy": "Best Effort"}
CLOUD_SHOWN = expect_display("PointCloud2", "/b/points", properties=SENSOR)
SCAN_SHOWN = expect_display("LaserScan", "/scan_back", properties=SENSOR, call=1)
GOAL_NAMED = expect_display("Pose", "/goal", properties={"Name": "/goal"})
MENDED_FRAME = expect_layout(fixed_frame="world")
BAR: dict[str, Any] = {"parts": ("size", "centre", "color"), "axes": "x y z, red green blue alpha"}
NEARLY_EMPTY = expect_value([[0.2, 0.2, 0.57], [0.0, 0.0, 0.285], RED], call=1, **BAR)

PLACE = {"--x": 0.2, "--z": my("height"), "--frame-id": "base_link", "--child-frame-id": "camera_link"}

HIDDEN = {
    "week05.launch_file": (
        Scenario(
            "again",
            calls=(Call(),),
            checks=(
                expect_launch_argument("layout", default="robot_layout.rviz"),
                expect_launch_node("rviz2", "rviz2", options={"-d": "$(layout)"}),
                expect_launch_node(
                    "tf2_ros", "static_transform_publisher", name="camera_frame", options=PLACE
                ).worth(2),
            ),
        ),
    ),
    "week05.robot_layout": (
        Scenario(
            "the robot elsewhere",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="world"),
                expect_layout(view="Orbit", view_properties={"Distance": my("distance")}).worth(4),
                expect_display("Grid", properties={"Plane Cell Count": 50}),
                expect_display("TF", properties={"Show Names": True}),
                expect_display("MarkerArray", "/detections", properties={"Name": "Detections"}),
                expect_drawn("MarkerArray", ROBOT),
                expect_drawn("LaserScan", ROBOT, best_effort=BEST_EFFORT),
            ),
        ),
    ),
    "week05.layout_for": (
        Scenario(
            "another robot",
            calls=(
                Call("earth", {"/a/points": "PointCloud2", "/goal": "Pose", "/b/points": "PointCloud2"}),
                Call("base_link", {"/scan_back": "LaserScan"}),
            ),
            checks=(
                CLOUD_SHOWN,
                SCAN_SHOWN,
                expect_display("Pose", "/goal", properties={"Topic/Reliability Policy": "Reliable"}),
                expect_display("PointCloud2", "/b/points", properties={"Name": "/b/points"}),
                GOAL_NAMED,
                expect_displays_on("/a/points", "/goal", "/b/points").requiring(GOAL_NAMED),
                expect_layout(fixed_frame="earth").requiring(CLOUD_SHOWN),
                expect_layout(fixed_frame="base_link", call=1).requiring(SCAN_SHOWN),
            ),
        ),
    ),
    "week05.mended_layout": (
        Scenario(
            "the robot elsewhere",
            calls=(Call(),),
            checks=(
                MENDED_FRAME,
                expect_drawn("TF", ROBOT),
                expect_drawn("LaserScan", ROBOT, best_effort=BEST_EFFORT),
                expect_drawn("MarkerArray", ROBOT),
                expect_layout(view_within={"Distance": SEEN_FROM}),
                expect_display("Grid", properties={"Name": "Floor", "Color": "100; 100; 200"})
                .worth(0.2)
                .requiring(MENDED_FRAME),
                *(
                    expect_display(kind, properties={"Name": name}).worth(0.2).requiring(MENDED_FRAME)
                    for kind, name in (("TF", "Frames"), ("LaserScan", "Laser"), ("MarkerArray", "People"))
                ),
            ),
        ),
    ),
    "week05.battery_bar": (
        Scenario(
            "other charges",
            calls=(Call(0.2, 2.5), Call(0.19, 3.0), Call(1.4, 2.0), Call(-0.3, 2.0)),
            checks=(
                expect_value([[0.2, 0.2, 0.5], [0.0, 0.0, 0.25], GREEN], call=0, **BAR),
                NEARLY_EMPTY,
                expect_value([[0.2, 0.2, 2.0], [0.0, 0.0, 1.0], GREEN], call=2, **BAR),
                expect_value([[0.2, 0.2, 0.0], [0.0, 0.0, 0.0], RED], call=3, **BAR).requiring(NEARLY_EMPTY),
            ),
        ),
    ),
    "week05.displays_in": (
        Scenario(
            "groups in groups",
            calls=(Call(DEEP_LAYOUT), Call(FLAT_LAYOUT)),
            checks=(
                expect_value([["Plan", "Path"], ["Charge", "Battery"], ["Room", "Map"]], call=0),
                expect_value([["Way", "Path"], ["Spot", "PointStamped"]], call=1).worth(0.4),
            ),
        ),
    ),
}
