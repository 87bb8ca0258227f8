"""Week 8, the painting robot: hidden scenarios and checks."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

from course_lib.grading import (
    Call,
    Message,
    Scenario,
    expect_marker,
    expect_marker_count,
    expect_topic,
    expect_trajectory,
    expect_value,
    inputs,
    my,
)

ARM = "/arm_controller/joint_trajectory"
PAINT = "/visualization_marker"
OTHERS = ("shoulder_pan", "wrist_1", "wrist_2", "wrist_3")
UPPER_ARM, FOREARM = 0.612, 0.5723  # [m]
Step = tuple[float, float, float]  # [m]: x and z of the base in map, height of the wrist in base_link

RISE = [0.43 + 0.05 * step for step in range(8)]  # [m] per 0.1 s, up to 0.78
FALL = [0.70 - 0.02 * step for step in range(1, 16)]  # [m] per 0.1 s, down to 0.40
STEPS: list[Step] = [
    *((0.0, 0.0, z) for z in [0.43, *RISE]),
    *((0.035 * step, 0.025 * step, 0.78) for step in range(1, 7)),  # up a ramp, the arm rests
    *((0.21, 0.15, 0.78 + 0.006 * step) for step in range(10)),  # too slow to paint
    *((0.21, 0.15, z) for z in (0.79, 0.75, 0.75)),
    *((0.26, 0.15, z) for z in (0.75, 0.75, 0.70)),  # a pause and a small drive within a stripe
    *((0.26 - 0.1 * step, 0.15, 0.70) for step in range(5)),  # far away
    *((-0.14, 0.15, z) for z in FALL),
    (-0.14, 0.15, 0.40),
]
LATE = 0.75  # start of the TF broadcasts [s]


ONE_SWEEP: list[Step] = [(0.1, 0.0, 0.38 + 0.05 * step) for step in range(9)]


# The base stands 2 m from the origin and turns by 0.2 rad per step. Its distance from where it was
# is 0, but not that of the origin as seen from the base.
TURN = 0.2  # [rad]
TURNING: list[Step] = [(2.0, 0.0, z) for _, _, z in ONE_SWEEP]


def painted(steps: Sequence[Step] = STEPS, turn: float = 0.0) -> list[list[tuple[float, float, float]]]:
    """The stripes that belong there, by the two rules; points in map, [m]."""
    stripes: list[list[tuple[float, float, float]]] = []
    last: tuple[float, float] | None = None
    for number, ((_, _, before), (x, z, height)) in enumerate(pairwise(steps), 1):
        if abs(height - before) > 0.01 and height > 0.5:
            if last is None or math.dist(last, (x, z)) > 0.1:
                stripes.append([])
            sine, cosine = math.sin(turn * number), math.cos(turn * number)
            stripes[-1].append((x + 0.9 * cosine + 0.1 * sine, 0.9 * sine - 0.1 * cosine, z + height))
            last = (x, z)
    return stripes


def motion(steps: Sequence[Step] = STEPS, turn: float = 0.0) -> Iterable[Message]:
    """The steps, one per 0.1 s, half way between two ticks of the painter, each with a turn [rad]."""
    for number, (x, z, height) in enumerate(steps):
        wrist = inputs.pose("base_link", "ur10wrist_3_link", (0.9, -0.1, height))
        base = inputs.pose("map", "base_link", (x, 0.0, z), turn * number)
        yield inputs.transforms((base, wrist), LATE + 0.1 * number)


def standing(lift: Any) -> dict[str, Any]:
    """Return the goal of a command: a shoulder lift, an elbow of 0.5, the other joints at 0, [rad]."""
    others = {f"ur10{name}_joint": 0.0 for name in OTHERS}
    return {"ur10shoulder_lift_joint": lift, "ur10elbow_joint": 0.5, **others}


def folded(lift: float, elbow: float) -> tuple[float, float]:
    """Return the position of the wrist in the arm's plane: ahead of and above the shoulder [m]."""
    ahead = UPPER_ARM * math.cos(lift) + FOREARM * math.cos(lift + elbow)
    return ahead, -UPPER_ARM * math.sin(lift) - FOREARM * math.sin(lift + elbow)


LIFT = expect_trajectory(ARM, standing(my("lift")), index=1, at=5.0, seconds=3.0, points=1, of=2)
HALF, AFTER = expect_value(4.0, call=3, unit="rad"), expect_value(3.0, call=2, unit="rad")
POINTWISE, ONE_BY_ONE = (
    expect_topic(PAINT, "visualization_msgs/msg/Marker", at_least=sum(map(len, painted(steps))))
    for steps in (STEPS, ONE_SWEEP)
)
STRIPES = [expect_marker(PAINT, frame="map", points=stripe).requiring(POINTWISE) for stripe in painted()]
SWEEP = expect_marker(PAINT, frame="map", points=painted(ONE_SWEEP)[0]).requiring(ONE_BY_ONE)
WHILE_TURNING = expect_marker(PAINT, frame="map", points=painted(TURNING, TURN)[0]).requiring(ONE_BY_ONE)
LIFT_ANGLE = (0,)  # index of the angle that may differ by a full turn
NEAR_PLACE = expect_value([-0.4, 1.1], call=0, unit="rad", angles=LIFT_ANGLE, axes="lift elbow")
WITH_PARTS_BESIDE = expect_value((0.1 * 1.0 + 0.2 * 2.0) / 4.0, call=0, tolerance=0.01)

HIDDEN = {
    "week08.joint_at": (
        Scenario(
            "other ways",
            calls=(
                Call(-1.2, 1.5, 2.0, 1.5),
                Call(0.4, 0.2, 5.0, -1.0),
                Call(2.0, 3.0, 0.5, 9.0),
                Call(2.0, 6.0, 1.0, 0.5),
            ),
            checks=(
                expect_value(-1.2 + 2.7 * 0.84375, call=0, unit="rad").worth(2),
                expect_value(0.4, call=1, unit="rad").requiring(HALF),
                AFTER.requiring(HALF),
                HALF.requiring(AFTER),
            ),
        ),
    ),
    "week08.sweep_node": (
        Scenario(
            "longer",
            seconds=20.0,  # [s]
            seed=7,
            checks=(
                expect_trajectory(ARM, standing(1.5), at=1.0, seconds=3.0, points=1),
                LIFT,
                expect_trajectory(ARM, standing(my("lift")), index=1, at=5.0, seconds=3.0, of=2).worth(0.5),
            ),
        ),
    ),
    "week08.paint_node": (
        Scenario(
            "a ramp, a pause, and a late start of TF",
            seconds=6.5,  # [s]
            seed=11,
            inputs=tuple(motion()),
            checks=(
                expect_marker_count(PAINT, len(STRIPES), type="LINE_STRIP").requiring(*STRIPES),
                *(stripe.worth(2) for stripe in STRIPES),
            ),
        ),
        Scenario(
            "one sweep",
            seconds=3.0,  # [s]
            seed=12,
            inputs=tuple(motion(ONE_SWEEP)),
            checks=(SWEEP.worth(0.5),),
        ),
        Scenario(
            "a base that turns on the spot",
            seconds=3.0,  # [s]
            seed=13,
            inputs=tuple(motion(TURNING, TURN)),
            checks=(WHILE_TURNING.worth(0.5),),
        ),
    ),
    "week08.lift_and_elbow": (
        Scenario(
            "other places",
            calls=(
                Call(*folded(-0.4, 1.1)),
                Call(*folded(0.2, 0.3)),
                Call(0.02, -0.01),
                Call(0.9, -0.9),
                Call(*folded(-2.0, 0.7)),
            ),
            checks=(
                NEAR_PLACE,
                expect_value([0.2, 0.3], call=1, unit="rad", angles=LIFT_ANGLE, axes="lift elbow"),
                expect_value([], call=2).requiring(NEAR_PLACE),
                expect_value([], call=3).requiring(NEAR_PLACE),
                expect_value([-2.0, 0.7], call=4, unit="rad", angles=LIFT_ANGLE, axes="lift elbow"),
            ),
        ),
    ),
    "week08.coverage": (
        Scenario(
            "beside and across",
            calls=(
                Call([[0.0, -1.0, 1.0], [1.5, 0.5, 9.0], [4.0, 0.0, 1.0]], 1.6, 2.5),
                Call([[0.5, 0.0, 1.0], [0.5, 0.5, 1.5], [0.55, 0.0, 0.5]], 1.0, 2.0),
                Call([], 1.0, 1.0),
            ),
            checks=(
                WITH_PARTS_BESIDE,
                expect_value((0.2 * 1.5 + 0.05 * 0.5) / 2.0, call=1, tolerance=0.01),
                expect_value(0.0, call=2, tolerance=1e-9).requiring(WITH_PARTS_BESIDE).worth(0.2),
            ),
        ),
    ),
}
