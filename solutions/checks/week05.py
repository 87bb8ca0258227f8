"""Week 5, configurations: hidden scenarios and checks."""

from collections.abc import Iterator

from course_lib.displays.layout import layout_of, text_at
from course_lib.errors import CourseError
from course_lib.grading.evidence import Check, Evidence, Verdict, failed, passed
from course_lib.grading.inputs import header, pose, scan, transforms, xyz
from course_lib.grading.task import Call, Message, Scenario, my
from course_lib.grading.vocabulary import expect_display, expect_drawn, expect_layout, expect_value

GREEN, RED = [0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]  # RGBA
FARTHEST = 50.0  # [m] from which a person can still be seen
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


def detections(at: float) -> Message:
    """Somebody else."""
    marker = {
        "header": header(at, "base_link"),
        "ns": "people",
        "type": 1,
        "pose": {"position": xyz((1.0, 0.0, 0.9)), "orientation": {"w": 1.0}},
        "scale": xyz((0.5, 0.5, 1.8)),
        "color": {"g": 1.0, "a": 1.0},
    }
    return Message("/detections", "visualization_msgs/msg/MarkerArray", {"markers": [marker]}, at=at)


def robot(at: float) -> Iterator[Message]:
    """The robot at another place: a quarter circle of 1 m, somebody else."""
    base = pose("world", "base_link", (-2.0, 3.0, 0.0), 1.0)
    yield transforms((base, pose("base_link", "laser", (0.2, 0.0, 0.5))), at)
    yield scan([1.0] * 31, at, first=0.0, step=0.05)  # [m], [rad]
    yield detections(at)


ROBOT = tuple(message for n in range(1, 5) for message in robot(n / 2))  # [s]
BEST_EFFORT = ("/scan",)


def near_enough(evidence: Evidence) -> Verdict:
    """The camera of an Orbit is not so far away that nothing can be seen."""
    try:
        view = layout_of(str(evidence.returns[0]), "layout").view
        distance = float(text_at(view, "Distance"))
    except (CourseError, IndexError, ValueError):
        return failed("the view has no distance", "the view is not as it was")
    if 0.5 <= distance <= FARTHEST:
        return passed("as expected")
    return failed(f"the camera is {distance:g} m away", "the camera is where nothing can be seen")


HIDDEN = {
    "week05.robot_layout": (
        Scenario(
            "the robot elsewhere",
            calls=(Call(),),
            checks=(
                expect_layout(
                    fixed_frame="world", view="Orbit", view_properties={"Distance": my("distance")}
                ),
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
                expect_layout(fixed_frame="earth"),
                expect_layout(fixed_frame="base_link", call=1),
                expect_display(
                    "PointCloud2",
                    "/b/points",
                    properties={"Topic/Reliability Policy": "Best Effort", "Name": "/b/points"},
                ),
                expect_display("Pose", "/goal", properties={"Topic/Reliability Policy": "Reliable"}),
                expect_display(
                    "LaserScan",
                    "/scan_back",
                    properties={"Topic/Reliability Policy": "Best Effort", "Name": "/scan_back"},
                    call=1,
                ),
            ),
        ),
    ),
    "week05.mended_layout": (
        Scenario(
            "the robot elsewhere",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="world"),
                expect_display("Grid", properties={"Name": "Floor", "Color": "100; 100; 200"}),
                expect_drawn("TF", ROBOT),
                expect_display("LaserScan", "/scan", properties={"Name": "Laser"}),
                expect_drawn("LaserScan", ROBOT, best_effort=BEST_EFFORT),
                expect_display("MarkerArray", "/detections", properties={"Name": "People"}),
                expect_drawn("MarkerArray", ROBOT),
                Check("the camera sees it", near_enough),
            ),
        ),
    ),
    "week05.battery_bar": (
        Scenario(
            "other charges",
            calls=(Call(0.2, 1.0), Call(0.19, 3.0), Call(1.4, 2.0), Call(-0.3, 2.0)),
            checks=(
                expect_value([[0.2, 0.2, 0.2], [0.0, 0.0, 0.1], GREEN], call=0),
                expect_value([[0.2, 0.2, 0.57], [0.0, 0.0, 0.285], RED], call=1),
                expect_value([[0.2, 0.2, 2.0], [0.0, 0.0, 1.0], GREEN], call=2),
                expect_value([[0.2, 0.2, 0.0], [0.0, 0.0, 0.0], RED], call=3),
            ),
        ),
    ),
    "week05.displays_in": (
        Scenario(
            "groups in groups",
            calls=(Call(DEEP_LAYOUT),),
            checks=(expect_value([["Plan", "Path"], ["Charge", "Battery"], ["Room", "Map"]]),),
        ),
    ),
}
