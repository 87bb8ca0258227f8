"""Week 4, transforms: tasks, hints and public checks."""

import math

from course_lib.grading.inputs import header, pose, transforms, xyz
from course_lib.grading.task import Call, Message, Scenario, Task, my
from course_lib.grading.vocabulary import (
    expect_circling_frame,
    expect_message,
    expect_rate,
    expect_topic,
    expect_transform,
    expect_value,
)

OUT = "/obstacle_in_map"
SEEN = (1.0, 0.2, 0.0)  # [m] the obstacle in camera_link
ASKED = (0.57, 1.07, 2.52)  # [s] stamps of the obstacle, none of them that of a transform


def driving(at: float) -> Message:
    """A robot on a curve: at 1 m/s along x, turning by 0.5 rad/s."""
    base = pose("map", "base_link", (at, 0.0, 0.0), 0.5 * at)
    return transforms((base, pose("base_link", "camera_link", (0.3, 0.0, 0.5))), at)


def obstacle(stamp: float, frame: str = "camera_link") -> Message:
    """The obstacle, 0.2 s after it was seen."""
    fields = {"header": header(stamp, frame), "point": xyz(SEEN)}
    return Message("/obstacle", "geometry_msgs/msg/PointStamped", fields, at=stamp + 0.2)


def in_map(stamp: float) -> dict[str, float]:
    """Where the obstacle of a stamp is in the map, as fields of the message."""
    yaw, ahead, left = 0.5 * stamp, SEEN[0] + 0.3, SEEN[1]
    return {
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
        "First turn the point by yaw about z, then shift it by x and y.",
        "Turned: (cos yaw * px - sin yaw * py, sin yaw * px + cos yaw * py, pz).",
        "A matrix of 4 x 4 does both: rows (c, -s, 0, x), (s, c, 0, y), (0, 0, 1, 0), (0, 0, 0, 1).",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call([1.0, 0.0, 0.5], 2.0, 0.0, 0.0), Call([1.3, 0.0, 0.5], 2.0, 0.0, math.pi / 2)),
            checks=(
                expect_value([3.0, 0.0, 0.5], call=0, unit="m", name="the point, robot not turned"),
                expect_value([2.0, 1.3, 0.5], call=1, unit="m", name="the point, robot turned by 90°"),
            ),
        ),
    ),
)

ROBOT_FRAMES = Task(
    "week04.robot_frames",
    title="A robot that drives forward on a circle",
    kind="node",
    name="RobotFramesNode",
    hints=(
        "Two broadcasters: one for what moves, one for what is fixed. Which frame is the parent of which?",
        "Per call the angle grows by 2 pi / (8 s * 50 Hz). Along the path is a quarter turn from outward.",
        "yaw = angle + math.pi / 2; x = R cos(angle), y = R sin(angle); camera_link at (0.2, 0, 0.6), once.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.0,  # [s]
            seed=1,
            checks=(
                expect_circling_frame("map", "base_link", radius=my("radius"), heading=math.pi / 2).titled(
                    "on your circle, looking along the path"
                ),
                expect_transform("base_link", "camera_link", translation=(0.2, 0.0, 0.6)).titled(
                    "the camera on the robot"
                ),
                expect_rate("/tf", 50.0).titled("50 times a second"),
                expect_topic("/tf_static", "tf2_msgs/msg/TFMessage").titled(
                    "what is fixed goes out as static"
                ),
            ),
        ),
    ),
    personal={"radius": (1.2, 1.5, 1.8, 2.2, 2.5, 3.0)},  # [m]; 2.0 is left out: it is the lesson's
)

OBSTACLE_IN_MAP = Task(
    "week04.obstacle_in_map",
    title="An obstacle carried to the map",
    kind="node",
    name="ObstacleNode",
    hints=(
        "Where was the camera when it saw the obstacle? Which time do you have to ask tf2 for?",
        "buffer.transform(message, 'map') uses the stamp of the message. It needs import tf2_geometry_msgs.",
        "carried = self.buffer.transform(message, 'map'), in a try with except TransformException: return.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=(*(driving(n / 20) for n in range(1, 60)), *(obstacle(stamp) for stamp in ASKED)),
            checks=(
                expect_topic(OUT, "geometry_msgs/msg/PointStamped", at_least=3).titled("a point for each"),
                expect_message(OUT, {"header.frame_id": "map"}).titled("in the frame map"),
                expect_message(OUT, in_map(ASKED[-1]), unit="m").titled("at the right place"),
                expect_message(OUT, {"header.stamp.nanosec": 520_000_000}).titled("the stamp is kept"),
            ),
        ),
    ),
)

MENDED_ARM = Task(
    "week04.mended_arm",
    title="A mended tree",
    kind="node",
    name="MendedArm",
    hints=(
        "Start BrokenArm and look at its log, at the TF display and at view_frames. There are three faults.",
        "One name is misspelled, one stamp is not set, one rotation is no rotation.",
        "Parent base_link instead of base; stamp = self.get_clock().now().to_msg(); rotation.w = 1.0.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            checks=(
                expect_transform("map", "arm_link", translation=(0.0, 0.0, 1.2)).titled("the arm"),
                expect_transform("arm_link", "hand_link", at=1.0, translation=(0.4, 0.0, 0.0)).titled(
                    "the hand, at 1 s"
                ),
                expect_transform("hand_link", "finger_link", translation=(0.1, 0.0, 0.0)).titled(
                    "the finger"
                ),
            ),
        ),
    ),
)

IN_BETWEEN = Task(
    "week04.in_between",
    title="Stretch: interpolate as tf2 does",
    kind="function",
    name="in_between",
    hints=(
        "x and y: a straight line. ratio 0 is the first pose, ratio 1 the second.",
        "The turn takes the shorter way round: from 170° to -170° it is 20°, not 340°.",
        "math.remainder(yaw_b - yaw_a, 2 * math.pi) is the shorter way. Add its share to yaw_a.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call([0.0, 0.0, 0.0], [1.0, 2.0, 0.4], 0.5),
                Call([0.0, 1.0, 3.0], [0.0, 1.0, -3.0], 0.25),
            ),
            checks=(
                expect_value([0.5, 1.0, 0.2], call=0, name="the pose half way"),
                expect_value(
                    [0.0, 1.0, 3.0 + 0.25 * (2 * math.pi - 6.0)],
                    call=1,
                    name="the pose a quarter of the shorter way round, from 3 rad to -3 rad,",
                ).titled("the shorter way round"),
            ),
        ),
    ),
)

TASKS = (POINT_TO_WORLD, ROBOT_FRAMES, OBSTACLE_IN_MAP, MENDED_ARM, IN_BETWEEN)
