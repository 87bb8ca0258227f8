"""Week 2, joint states: hidden scenarios and checks."""

import math
from collections.abc import Sequence

from course_lib.grading import (
    Call,
    Message,
    Scenario,
    expect_frame,
    expect_joint_states,
    expect_joint_swing,
    expect_joints_still,
    expect_marker,
    expect_marker_count,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_topic,
    expect_value,
    inputs,
    my,
    with_formal,
)

STATES = "/joint_states"
NAMES = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
UR10 = [["z", [0.0, 0.0, 0.1273]], ["y", [0.0, 0.220941, 0.0]], ["y", [0.0, -0.1719, 0.612]]]  # axes, [m]
PAN, LIFT, ELBOW = 0.7, 0.6, 1.1  # [rad]
SCAN_STEP = math.radians(30)
DELAY = 0.2  # [s] from the stamp of a scan to its arrival
LAST = (-math.inf, 7.0, 0.0, math.nan, 6.5, 31.0, 2.25, 2.5, math.inf)  # [m]; the last beam but two
TOWARDS = -math.radians(120) + 6 * SCAN_STEP  # [rad]
WRISTS = {f"wrist_{number}_joint": 0.0 for number in (1, 2, 3)}  # [rad]
POSE = {"shoulder_lift": -90, "elbow": 60, "wrist_1": -45, "wrist_2": 90, "wrist_3": 0}  # [deg]
MARKER, COUNTING = "visualization_msgs/msg/Marker", 35  # scans in which a beam counts
AGAIN = expect_throughout("/nearest", hz=4.0)
SPHERE = expect_marker(
    "/nearest", type="SPHERE", scale=(0.2, 0.2, 0.2), color=(1.0, 0.0, 0.0, 1.0)
).requiring(AGAIN)


def wrist() -> list[float]:
    """Return the position of the UR10's wrist: the reach in the arm's plane, rotated by pan."""
    reach = 0.612 * math.sin(LIFT) + 0.5723 * math.sin(LIFT + ELBOW)  # [m]
    height = 0.1273 + 0.612 * math.cos(LIFT) + 0.5723 * math.cos(LIFT + ELBOW)
    side = 0.220941 - 0.1719
    x = reach * math.cos(PAN) - side * math.sin(PAN)
    return [x, reach * math.sin(PAN) + side * math.cos(PAN), height]


def rear_scan(ranges: Sequence[float], at: float, first: float = -1.0, step: float = 0.2) -> Message:
    """Return a message of the scanner at the rear, which arrives `at` [s] after the start."""
    return inputs.scan(ranges, at=at, frame="rear", first=first, step=step, delay=DELAY, best_effort=True)


HIDDEN = {
    "week02.joint_wave": (
        Scenario(
            "longer",
            seconds=10.0,  # [s]
            seed=7,
            checks=with_formal(
                (
                    expect_joint_states(NAMES, moving=True),
                    expect_joint_swing("shoulder_pan_joint", amplitude=my("amplitude"), hz=0.25).worth(4),
                    expect_joint_swing("elbow_joint", amplitude=0.5, hz=0.5),
                    expect_joints_still({"shoulder_lift_joint": -1.2, **WRISTS}),
                ),
                expect_rate(STATES, 50.0),
                expect_stamps(STATES),
            ),
        ),
    ),
    "week02.two_link": (
        Scenario(
            "other arms",
            calls=(
                Call(1.0, 0.5, math.pi / 6, -math.pi / 2),
                Call(0.3, 0.4, -math.pi / 3, math.pi),
                # The tip is below the x axis.
                Call(0.5, 0.4, -math.pi / 2, math.pi / 2),
            ),
            checks=(
                expect_value([math.sqrt(3) / 2 + 0.25, 0.5 - math.sqrt(3) / 4], call=0, unit="m", axes="x y"),
                expect_value([-0.05, 0.05 * math.sqrt(3)], call=1, unit="m", axes="x y"),
                expect_value([0.4, -0.5], call=2, unit="m", axes="x y"),
            ),
        ),
    ),
    "week02.tool_place": (
        Scenario(
            "other arms",
            calls=(
                Call(UR10, [PAN, LIFT, ELBOW], [0.0, 0.0, 0.5723]),
                Call(
                    [["x", [1.0, 0.0, 0.0]], ["z", [0.0, 2.0, 0.0]]],
                    [math.pi / 2, -math.pi / 2],
                    [0.3, 0.0, 0.1],
                ),
            ),
            checks=(
                expect_value(wrist(), call=0, unit="m", axes="x y z").worth(2),
                expect_value(
                    [1.0, -0.1, 1.7], call=1, unit="m", axes="x y z"
                ),  # y becomes z, then x becomes -y
            ),
        ),
    ),
    "week02.mended_states": (
        Scenario(
            "longer",
            seconds=9.0,  # [s]
            seed=11,
            checks=with_formal(
                (
                    expect_joint_states(NAMES, moving=True).worth(2),
                    expect_joint_swing("shoulder_pan_joint", amplitude=math.radians(30), hz=0.5),
                    expect_joints_still({f"{name}_joint": math.radians(a) for name, a in POSE.items()}),
                ),
                expect_rate(STATES, 20.0),
                expect_stamps(STATES),
            ),
        ),
    ),
    "week02.nearest": (
        Scenario(
            "another laser",
            seconds=8.0,  # [s]
            seed=13,
            inputs=(
                *(rear_scan((3.0,) * 9, at=0.1 + n / 4) for n in range(30)),
                # One beam counts: the first one, then the last one.
                rear_scan((4.0, *(math.inf,) * 8), at=7.5),
                rear_scan((*(math.inf,) * 8, 4.0), at=7.6),
                # The only distance equals range_min, then range_max.
                rear_scan((0.1, *(math.inf,) * 8), at=7.63),
                rear_scan((30.0, *(math.inf,) * 8), at=7.66),
                # Nothing is near.
                rear_scan((math.inf,) * 9, at=7.7),
                rear_scan(LAST, at=7.8, first=-math.radians(120), step=SCAN_STEP),
            ),
            checks=with_formal(
                (
                    SPHERE,
                    expect_marker(
                        "/nearest",
                        position=(2.25 * math.cos(TOWARDS), 2.25 * math.sin(TOWARDS), 0.0),
                    )
                    .requiring(AGAIN)
                    .worth(2),
                    expect_topic("/nearest", MARKER, at_least=COUNTING, at_most=COUNTING).requiring(SPHERE),
                    expect_marker_count("/nearest", 1).requiring(SPHERE),
                ),
                expect_frame("/nearest", "rear"),
                expect_stamps("/nearest", delay=DELAY),
            ),
        ),
    ),
}
