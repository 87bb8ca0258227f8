"""Week 4, transforms: tasks, hints and public checks."""

import math
from typing import Any

from course_lib.grading import (
    Call,
    Check,
    Message,
    Scenario,
    Task,
    expect_circling_frame,
    expect_message,
    expect_rate,
    expect_topic,
    expect_transform,
    expect_value,
    inputs,
    my,
    with_formal,
)

OUT, POINT = "/obstacle_in_map", "geometry_msgs/msg/PointStamped"
SEEN = (1.0, 0.2, 0.0)  # [m] the obstacle in camera_link
ASKED = (0.57, 1.07, 2.52)  # [s] stamps of the obstacle, none of them that of a transform


def driving(at: float) -> Message:
    """A robot on a curve: at 1 m/s along x, turning by 0.5 rad/s."""
    base = inputs.pose("map", "base_link", (at, 0.0, 0.0), 0.5 * at)
    return inputs.transforms((base, inputs.pose("base_link", "camera_link", (0.3, 0.0, 0.5))), at)


def obstacle(stamp: float, frame: str = "camera_link") -> Message:
    """The obstacle, 0.2 s after it was seen."""
    fields = {"header": inputs.header(stamp, frame), "point": inputs.xyz(SEEN)}
    return Message("/obstacle", POINT, fields, at=stamp + 0.2)


def in_map(stamp: float) -> dict[str, Any]:
    """Return the obstacle of a stamp in the map, as fields of the message."""
    yaw, ahead, left = 0.5 * stamp, SEEN[0] + 0.3, SEEN[1]
    return {
        "header.frame_id": "map",
        "point.x": stamp + ahead * math.cos(yaw) - left * math.sin(yaw),
        "point.y": ahead * math.sin(yaw) + left * math.cos(yaw),
        "point.z": 0.5,
    }


POINT_TO_WORLD = Task(
    "week04.point_to_world",
    title="A point of the robot in the world",
    kind="function",
    name="point_to_world",
    hints=(
        "First rotate the point by yaw about z, then translate it by x and y.",
        "The rotated y is sin(yaw) * point[0] + cos(yaw) * point[1]; z does not change.",
        "Return [turned_x + x, turned_y + y, point[2]].",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call([1.0, 0.0, 0.5], 2.0, 0.0, 0.0),
                Call([1.3, 0.0, 0.5], 2.0, 0.0, math.pi / 2),
                # The cosine of this turn is -0.8 and its sine -0.6, so that both show.
                Call([1.0, 0.55, -0.25], -1.0, 3.0, math.atan2(-0.6, -0.8)),
            ),
            checks=(
                expect_value(
                    [3.0, 0.0, 0.5], call=0, unit="m", name="the point, robot not turned", axes="x y z"
                ),
                expect_value(
                    [2.0, 1.3, 0.5], call=1, unit="m", name="the point, robot turned by 90°", axes="x y z"
                ),
                expect_value(
                    [-1.47, 1.96, -0.25],
                    call=2,
                    unit="m",
                    name="a point on the left, robot elsewhere",
                    axes="x y z",
                ),
            ),
        ),
    ),
)

CAMERA = expect_transform("base_link", "camera_link", translation=(0.2, 0.0, 0.6), yaw=0.0).titled(
    "the camera on the robot, not turned"
)

ROBOT_FRAMES = Task(
    "week04.robot_frames",
    title="A robot that drives forward on a circle",
    kind="node",
    name="RobotFramesNode",
    hints=(
        "Change the parent, the radius, the period of the timer, the step and the yaw. Then add the camera.",
        "Per call the angle grows by 2 pi / (8 s * 50 Hz). Along the path is a quarter turn from outward.",
        "yaw = angle + math.pi / 2; x = R cos(angle), y = R sin(angle); camera_link at (0.2, 0, 0.6), once.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=10.0,  # [s]
            seed=1,
            checks=with_formal(
                (
                    expect_circling_frame("map", "base_link", radius=my("radius"), height=0.0)
                    .titled("on your circle, on the ground")
                    .worth(3),
                    expect_circling_frame(
                        "map", "base_link", period=8.0, counter_clockwise=True, start=0.0
                    ).titled("counter-clockwise, one round in 8 s, from the angle 0"),
                    expect_circling_frame("map", "base_link", heading=math.pi / 2).titled(
                        "looking along the path"
                    ),
                    CAMERA,
                    expect_transform("base_link", "camera_link", static=True)
                    .titled("the camera is broadcast as static")
                    .requiring(CAMERA)
                    .worth(0.5),
                ),
                expect_rate("/tf", 50.0).titled("50 times a second"),
            ),
        ),
    ),
    personal={"radius": (1.2, 1.5, 1.8, 2.2, 2.5, 3.0)},  # [m]; without 2.0, the value in the lesson
)

DRIVEN = tuple(driving(n / 20) for n in range(1, 60))


def at_most(count: int) -> Check:
    """No more points than this."""
    return expect_topic(OUT, POINT, at_most=count).titled("no second point for an obstacle")


def stamp_of(stamp: float) -> dict[str, int]:
    """The stamp of an obstacle, as fields of the message."""
    return {f"header.stamp.{name}": value for name, value in inputs.header(stamp, "")["stamp"].items()}


AGAIN = expect_topic(OUT, POINT, at_least=3).titled("a point for each obstacle").worth(0)
PLACE = (
    expect_message(OUT, in_map(ASKED[-1]), unit="m")
    .titled("in map, where the obstacle was when it was seen")
    .requiring(AGAIN)
)
GOES_ON = (
    expect_topic(OUT, POINT, at_least=2).titled("points also after a frame that tf2 does not know").worth(0)
)
AFTERWARDS = (
    expect_message(OUT, in_map(1.57), unit="m")
    .titled("the point after it is at the right place")
    .requiring(GOES_ON)
    .worth(0.5)
)

OBSTACLE_IN_MAP = Task(
    "week04.obstacle_in_map",
    title="An obstacle in the map",
    kind="node",
    name="ObstacleNode",
    hints=(
        "Where was the camera when it saw the obstacle? For which time must you ask tf2?",
        "buffer.transform(message, 'map') uses the stamp of the message. It needs import tf2_geometry_msgs.",
        "carried = self.buffer.transform(message, 'map'), in a try with except TransformException: return.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=(*DRIVEN, *(obstacle(stamp) for stamp in ASKED)),
            checks=(
                AGAIN,
                *with_formal(
                    (PLACE, at_most(3).requiring(PLACE).worth(0.25)),
                    expect_message(OUT, stamp_of(ASKED[-1])).titled("the stamp is kept"),
                ),
            ),
        ),
        Scenario(
            "a frame that tf2 does not know",
            seconds=3.0,  # [s]
            seed=3,
            inputs=(*DRIVEN, obstacle(0.57), obstacle(1.07, "nowhere"), obstacle(1.57)),
            checks=(
                GOES_ON,
                AFTERWARDS,
                at_most(2).titled("nothing is published for that frame").requiring(AFTERWARDS).worth(0.5),
            ),
        ),
    ),
)

FIXED = (("map", "base_link"), ("base_link", "arm_link"), ("hand_link", "finger_link"))
ARM = expect_transform("map", "arm_link", translation=(0.0, 0.0, 1.2), yaw=0.0).titled("the arm")
FINGER = expect_transform("hand_link", "finger_link", translation=(0.1, 0.0, 0.0), yaw=0.0).titled(
    "the finger"
)

MENDED_ARM = Task(
    "week04.mended_arm",
    title="Three faults in a tree",
    kind="node",
    name="MendedArm",
    hints=(
        "Run BrokenArm and look at its log, at the TF display and at view_frames.",
        "One name is misspelled, one stamp is not set, one quaternion is all zeros.",
        "Parent base_link instead of base; stamp = self.get_clock().now().to_msg(); rotation.w = 1.0.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            checks=with_formal(
                (
                    ARM,
                    expect_transform("map", "base_link", translation=(0.0, 0.0, 0.2), yaw=0.0)
                    .titled("its base")
                    .requiring(ARM)
                    .worth(0.25),
                    expect_transform(
                        "arm_link",
                        "hand_link",
                        at=2.0,
                        translation=(0.4, 0.0, 0.0),
                        yaw=1.0 - 0.025,
                    ).titled("the hand, at 2 s"),
                    FINGER,
                    *(
                        expect_transform(parent, child, static=True)
                        .titled(f"{child} is broadcast as static")
                        .requiring(ARM, FINGER)
                        .worth(0.25)
                        for parent, child in FIXED
                    ),
                ),
                expect_rate("/tf", 20.0).titled("the hand, 20 times a second"),
            ),
        ),
    ),
)

# Index of the angle in a pose, which may differ by a full turn.
YAW = (2,)
IN_BETWEEN = Task(
    "week04.in_between",
    title="Stretch: interpolate as tf2 does",
    kind="function",
    name="in_between",
    hints=(
        "x and y: a straight line. ratio 0 is the first pose, ratio 1 the second.",
        "The yaw takes the shorter way round: from 170° to -170° it is 20°, not 340°.",
        "math.remainder(yaw_b - yaw_a, 2 * math.pi) is the shorter way. Add ratio times that to yaw_a.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call([1.0, 3.0, 0.1], [3.0, 1.0, 0.5], 0.25),
                Call([0.0, 1.0, 3.0], [0.0, 1.0, -3.0], 0.25),
                Call([0.0, 0.0, -3.0], [0.0, 0.0, 3.0], 0.25),
                # More than a quarter turn: the remainder of pi would go the other way.
                Call([0.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0.25),
            ),
            checks=(
                expect_value(
                    [1.5, 2.5, 0.2],
                    call=0,
                    name="the pose after a quarter of the way",
                    angles=YAW,
                    axes="x y yaw",
                ),
                expect_value(
                    [0.0, 1.0, 3.0 + 0.25 * (2 * math.pi - 6.0)],
                    call=1,
                    name="the pose a quarter of the shorter way round, from 3 rad to -3 rad,",
                    angles=YAW,
                    axes="x y yaw",
                ).titled("the shorter way round"),
                expect_value(
                    [0.0, 0.0, -3.0 - 0.25 * (2 * math.pi - 6.0)],
                    call=2,
                    name="the pose a quarter of the shorter way round, from -3 rad to 3 rad,",
                    angles=YAW,
                    axes="x y yaw",
                ).titled("the shorter way round, clockwise"),
                expect_value(
                    [0.0, 0.0, 0.5],
                    call=3,
                    name="the pose a quarter of the way, from 0 to 2 rad,",
                    angles=YAW,
                    axes="x y yaw",
                ).titled("more than a quarter turn"),
            ),
        ),
    ),
)

TASKS = (POINT_TO_WORLD, ROBOT_FRAMES, OBSTACLE_IN_MAP, MENDED_ARM, IN_BETWEEN)
