"""Week 4, transforms: hidden scenarios and checks."""

import math

from course_lib.grading import (
    Call,
    Check,
    Evidence,
    Message,
    Scenario,
    Verdict,
    expect_circling_frame,
    expect_message,
    expect_rate,
    expect_topic,
    expect_transform,
    expect_value,
    failed,
    inputs,
    my,
    passed,
    with_formal,
)

OUT, POINT = "/obstacle_in_map", "geometry_msgs/msg/PointStamped"
SPEED = 2.0  # [m/s]
STAMP = 2.33  # [s] of the last obstacle


def driving(at: float) -> Message:
    """A robot that drives along y without turning, looking to the left; its camera hangs elsewhere."""
    base = inputs.pose("map", "base_link", (0.0, SPEED * at, 0.0), math.pi / 2)
    return inputs.transforms((base, inputs.pose("base_link", "lens", (-0.2, 0.1, 1.5), math.pi)), at)


def obstacle(stamp: float, frame: str = "lens") -> Message:
    """An obstacle 2 m before the lens and 0.5 m to its right, 0.13 s after it was seen."""
    fields = {"header": inputs.header(stamp, frame), "point": inputs.xyz((2.0, -0.5, 0.1))}
    return Message("/obstacle", POINT, fields, at=stamp + 0.13)


def turns_half_round(evidence: Evidence) -> Verdict:
    """Accept a result with or without a full turn if the shorter way goes through pi."""
    if not evidence.returns or not isinstance(evidence.returns[-1], list) or len(evidence.returns[-1]) != 3:
        return failed("no pose of three numbers came back", "a value is of the wrong kind")
    yaw = evidence.returns[-1][2]
    if isinstance(yaw, float) and math.isfinite(yaw) and abs(math.remainder(yaw - math.pi, math.tau)) < 1e-6:
        return passed("as expected")
    mistake = "the turn does not take the shorter way round"
    return failed(mistake, mistake)


CAMERA = expect_transform("base_link", "camera_link", at=16.0, translation=(0.2, 0.0, 0.6), yaw=0.0)
DRIVEN = tuple(driving(n / 10) for n in range(1, 30))
PLACE = expect_message(
    OUT,
    {
        "header.frame_id": "map",
        "point.x": -0.1 - 0.5,
        "point.y": SPEED * STAMP - 0.2 - 2.0,
        "point.z": 1.6,
    },
    unit="m",
).requiring(expect_topic(OUT, POINT, at_least=2))
FIXED = (("map", "base_link"), ("base_link", "arm_link"), ("hand_link", "finger_link"))
ARM = expect_transform("map", "arm_link", at=11.5, translation=(0.0, 0.0, 1.2), yaw=0.0)
FINGER = expect_transform("hand_link", "finger_link", at=6.0, translation=(0.1, 0.0, 0.0), yaw=0.0)

HIDDEN = {
    "week04.point_to_world": (
        Scenario(
            "other poses",
            calls=(
                Call([1.0, 2.0, -0.2], -1.0, 3.0, -math.pi / 2),
                Call([1.0, 1.0, 0.0], 0.5, 0.25, math.pi),
            ),
            checks=(
                expect_value([1.0, 2.0, -0.2], call=0, unit="m", axes="x y z"),
                expect_value([-0.5, -0.75, 0.0], call=1, unit="m", axes="x y z"),
            ),
        ),
    ),
    "week04.robot_frames": (
        Scenario(
            "two rounds",
            seconds=17.0,  # [s]
            seed=7,
            checks=with_formal(
                (
                    expect_circling_frame("map", "base_link", radius=my("radius"), height=0.0).worth(3),
                    expect_circling_frame("map", "base_link", period=8.0, counter_clockwise=True, start=0.0),
                    expect_circling_frame("map", "base_link", heading=math.pi / 2),
                    CAMERA,
                    expect_transform("map", "camera_link", at=15.5).requiring(CAMERA).worth(0.25),
                    expect_transform("base_link", "camera_link", static=True).requiring(CAMERA).worth(0.25),
                ),
                expect_rate("/tf", 50.0),
            ),
        ),
    ),
    "week04.obstacle_in_map": (
        Scenario(
            "another robot",
            seconds=3.0,  # [s]
            seed=11,
            inputs=(*DRIVEN, obstacle(0.92), obstacle(STAMP)),
            checks=with_formal(
                (PLACE, expect_topic(OUT, POINT, at_most=2).requiring(PLACE).worth(0.25)),
                expect_message(OUT, {"header.stamp.nanosec": 330_000_000}),
            ),
        ),
        Scenario(
            "a frame that nobody knows",
            seconds=3.0,  # [s]
            seed=17,
            inputs=(*DRIVEN, obstacle(0.92), obstacle(1.5, "nowhere"), obstacle(STAMP)),
            checks=(
                PLACE.worth(0.5),
                expect_topic(OUT, POINT, at_most=2).requiring(PLACE).worth(0.5),
            ),
        ),
    ),
    "week04.mended_arm": (
        Scenario(
            "longer",
            seconds=12.0,  # [s]
            seed=13,
            checks=with_formal(
                (
                    ARM,
                    expect_transform(
                        "arm_link", "hand_link", at=2.0, translation=(0.4, 0.0, 0.0), yaw=1.0 - 0.025
                    ),
                    expect_transform("map", "finger_link", at=11.5).requiring(ARM).worth(0.5),
                    FINGER,
                    *(
                        expect_transform(parent, child, static=True).requiring(ARM, FINGER).worth(0.25)
                        for parent, child in FIXED
                    ),
                ),
                expect_rate("/tf", 20.0),
            ),
        ),
    ),
    "week04.in_between": (
        Scenario(
            "round the back",
            calls=(
                Call([1.0, -1.0, 0.2], [3.0, 1.0, -0.6], 0.25),
                Call([0.0, 0.0, math.pi - 0.1], [0.0, 0.0, -math.pi + 0.1], 0.5),
            ),
            checks=(
                expect_value([1.5, -0.5, 0.0], call=0, angles=(2,), axes="x y yaw"),
                Check("half way round the back", turns_half_round),
            ),
        ),
    ),
}
