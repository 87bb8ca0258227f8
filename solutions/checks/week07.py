"""Week 7, the dashboard: hidden scenarios and checks."""

from collections.abc import Iterable
from typing import Any

from course_lib.grading import (
    Call,
    Message,
    Scenario,
    expect_colors_apart,
    expect_display,
    expect_gone,
    expect_layout,
    expect_marker,
    expect_marker_count,
    expect_nothing_before,
    expect_parameters,
    expect_path,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_value,
    inputs,
    my,
)

MARKERS, PLAN, TRAJECTORY = "/perception/markers", "/planned_path", "/robot_trajectory"
K = [138.0, 0.0, 79.5, 0.0, 140.0, 59.5, 0.0, 0.0, 1.0]  # [px]: columns and rows differ

DOG = inputs.DetectedObject(3, "Dog", (1.2, -0.6, 0.3), (0.9, 0.3, 0.6), 0.62)
CAR = inputs.DetectedObject(8, "Car", (-4.0, 1.5, 0.9), (4.0, 1.9, 1.8), 0.5)  # just sure enough
BICYCLE = inputs.DetectedObject(4, "Bicycle", (0.8, 2.0, 0.5), (1.7, 0.5, 1.0), 0.97)
UNSURE = inputs.DetectedObject(6, "Car", (5.0, 5.0, 0.9), (4.0, 1.9, 1.8), 0.499)
OBJECTS = (DOG, CAR, BICYCLE, UNSURE)


def seen(last: float) -> Iterable[Message]:
    """Detections until a time [s], five a second."""
    return (inputs.detections(OBJECTS, at=0.1 + step / 5, frame="odom") for step in range(round(last * 5)))


def driven(frame: str, base: str, seconds: float) -> Iterable[Message]:
    """A straight way with 0.4 m/s along x, to the left, 20 times a second from 1 s on, for so long [s]."""
    for step in range(round(seconds * 20)):
        yield inputs.transforms([inputs.pose(frame, base, (0.02 * step, 1.0, 0.2), 1.2)], 1.03 + step / 20)


def rectangle(box: list[list[float]]) -> list[float]:
    """The rectangle of the corners of a box ahead, [px]."""
    columns, rows = [K[0] * x / z + K[2] for x, _, z in box], [K[4] * y / z + K[5] for _, y, z in box]
    return [min(columns), min(rows), max(columns), max(rows)]


ASIDE, FAR = (
    inputs.corners((-1.5, 0.4, 3.0), (1.0, 0.6, 2.0)),
    inputs.corners((2.0, -1.0, 9.0), (0.5, 1.8, 0.5)),
)
NEAR = inputs.corners((0.0, 0.0, 1.05), (0.6, 0.4, 2.0))  # its front is 0.05 m ahead
JUST = [[0.0, 0.0, 0.1], [0.1, 0.1, 1.0]]
ASIDE_BOX = expect_value(rectangle(ASIDE), call=0, tolerance=0.01, axes="left top right bottom")

ALWAYS = expect_throughout(MARKERS, hz=10.0)
KEPT_UP = expect_throughout(TRAJECTORY, hz=10.0, begin=1.1)
WITH_LABELS: dict[str, Any] = {"allow_others": True}  # each box has a label on the same topic
DOG_LOOKS: dict[str, Any] = {
    "type": "CUBE",
    "frame": "odom",
    "position": DOG.center,
    "scale": DOG.size,
    "color": (0.5, 0.5, 0.5, 0.5),
}
DOG_BOX = expect_marker(MARKERS, ns="boxes", id=3, **DOG_LOOKS, **WITH_LABELS).requiring(ALWAYS)
RED_CAR = expect_marker(MARKERS, ns="boxes", id=8, color=(1.0, 0.0, 0.0, 0.5), lifetime=1.0, **WITH_LABELS)
BICYCLE_BOX = expect_marker(
    MARKERS, ns="boxes", id=4, position=BICYCLE.center, scale=BICYCLE.size, **WITH_LABELS
)
LAST_CAR = expect_marker(MARKERS, ns="boxes", id=6, color=(0.2, 0.4, 0.6, 0.8), at=1.8, **WITH_LABELS)
DOG_BEFORE = expect_marker(MARKERS, ns="boxes", id=3, **DOG_LOOKS, at=1.5, **WITH_LABELS)
LAST_100 = expect_path(
    TRAJECTORY, count=100, frame="world", ends=((1.22, 1.0, 0.2), (5.14, 1.0, 0.2)), yaw=1.2, tolerance=0.06
).requiring(KEPT_UP)
LAST_8 = expect_path(
    TRAJECTORY, count=8, frame="odom", ends=((0.86, 1.0, 0.2), (1.14, 1.0, 0.2)), yaw=1.2, tolerance=0.06
).requiring(KEPT_UP)
PERCEPTION = {
    "marker_update_rate": 5.0,  # [Hz]
    "confidence_threshold": my("threshold"),
    "bicycle_color": [1.0, 1.0, 0.0, 0.5],
}
ALL_NODES = ("/tf_publisher", "/path_planner", "/perception_node", "/trajectory_node")
WITH_TF = expect_display("TF", properties={"Show Names": True})
A, B = [2.0, -1.0, -0.4], [-1.0, 3.0, 1.6]
CUT = [1.25, 0.0, 0.1]  # a quarter of the way
ENDS: dict[str, Any] = {"parts": ("first end", "second end"), "axes": "x y z", "unit": "m"}
FIRST_PART = expect_value([CUT, B], call=0, name="the part", **ENDS)


HIDDEN = {
    "week07.box_on_image": (
        Scenario(
            "other boxes, another camera",
            calls=(Call(K, ASIDE), Call(K, FAR), Call(K, NEAR), Call(K, JUST)),
            checks=(
                ASIDE_BOX,
                expect_value(rectangle(FAR), call=1, tolerance=0.01, axes="left top right bottom"),
                expect_value([], call=2).requiring(ASIDE_BOX),
                expect_value(rectangle(JUST), call=3, tolerance=0.01, axes="left top right bottom"),
            ),
        ),
    ),
    "week07.markers": (
        Scenario(
            "other objects",
            seconds=3.0,  # [s]
            seed=5,
            inputs=(*seen(3.0),),
            checks=(
                expect_marker_count(MARKERS, 3, type="CUBE").requiring(DOG_BOX),
                DOG_BOX.worth(2),
                RED_CAR.requiring(ALWAYS),
            ),
        ),
        Scenario(
            "other parameters",
            seconds=4.0,  # [s]
            seed=7,
            inputs=(
                *seen(4.0),
                inputs.set_parameters("/perception_node", 0.5, car_color=[0.2, 0.4, 0.6, 0.8]),
                inputs.set_parameters("/perception_node", 0.7, confidence_threshold=0.4),
                inputs.set_parameters("/perception_node", 2.0, max_detections=2),
            ),
            checks=(
                expect_marker_count(MARKERS, 4, type="CUBE", at=1.8).requiring(DOG_BOX),
                LAST_CAR.requiring(ALWAYS),
                expect_marker_count(MARKERS, 2, type="CUBE").requiring(DOG_BOX),
                BICYCLE_BOX.requiring(ALWAYS),
                DOG_BOX,
            ),
        ),
        Scenario(
            "the detector of others stops sooner",
            seconds=2.9,  # [s]
            seed=13,
            inputs=(
                *seen(2.0),
                inputs.set_parameters("/perception_node", 0.5, marker_lifetime=0.4),  # [s]
            ),
            checks=(expect_gone(MARKERS).requiring(DOG_BEFORE).worth(0.5), DOG_BEFORE.worth(0)),
        ),
        Scenario(
            "the detector of others stops",
            seconds=4.0,  # [s]
            seed=11,
            inputs=(*seen(2.0),),
            checks=(
                expect_gone(MARKERS).requiring(DOG_BEFORE),
                expect_rate(MARKERS, 10.0).requiring(expect_gone(MARKERS), DOG_BEFORE).worth(0.2),
            ),
        ),
    ),
    "week07.trajectory": (
        Scenario(
            "another way, which begins late",
            seconds=14.0,  # [s]
            seed=13,
            inputs=(*driven("world", "base_link", 12.9),),
            checks=(
                LAST_100,
                expect_nothing_before(TRAJECTORY, 1.0).requiring(LAST_100).worth(0.5),
                expect_stamps(TRAJECTORY, tolerance=0.12).requiring(LAST_100).worth(0.2),
            ),
        ),
        Scenario(
            "other frames and fewer points",
            seconds=4.0,  # [s]
            seed=15,
            inputs=(
                inputs.set_parameters("/trajectory_node", 0.2, world_frame="odom", base_frame="base"),
                inputs.set_parameters("/trajectory_node", 2.0, trajectory_max_points=8),
                *driven("odom", "base", 2.9),
            ),
            checks=(LAST_8,),
        ),
    ),
    "week07.params": (
        Scenario(
            "all of it",
            calls=(Call(),),
            checks=(
                *(
                    expect_parameters("/perception_node", {name: PERCEPTION[name]}).worth(
                        1 + 2 * (name == "confidence_threshold")
                    )
                    for name in PERCEPTION
                ),
                expect_parameters("/trajectory_node", {"trajectory_max_points": 50}),
                *(expect_parameters(node, {"world_frame": "odom"}).worth(0.25) for node in ALL_NODES),
            ),
        ),
    ),
    "week07.layout": (
        Scenario(
            "all of it",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="world").requiring(WITH_TF).worth(0.5),
                expect_layout(view=("TopDownOrtho", "Orbit")).requiring(WITH_TF).worth(0.5),
                WITH_TF,
                expect_display("MarkerArray", MARKERS),
                expect_display("Path", PLAN),
                expect_display("Path", TRAJECTORY),
                expect_colors_apart("Path", 100),
            ),
        ),
    ),
    "week07.part_ahead": (
        Scenario(
            "other edges",
            calls=(
                Call(A, B),
                Call(B, A),
                Call([1.0, 1.0, 0.1], [2.0, 2.0, 3.0]),
                Call([0.0, 0.0, 0.09], [0.0, 1.0, -2.0]),
            ),
            checks=(
                FIRST_PART,
                expect_value([B, CUT], call=1, name="the part from behind", **ENDS),
                expect_value([[1.0, 1.0, 0.1], [2.0, 2.0, 3.0]], call=2, name="an edge ahead", **ENDS),
                expect_value([], call=3, name="the part of an edge behind").requiring(FIRST_PART),
            ),
        ),
    ),
}
