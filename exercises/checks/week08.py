"""Week 8, the painting robot: tasks, hints and public checks."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

from course_lib.grading import (
    Call,
    Check,
    Message,
    Scenario,
    Task,
    expect_marker,
    expect_marker_count,
    expect_topic,
    expect_trajectory,
    expect_value,
    inputs,
    lightly_weighted,
    my,
)

ARM = "/arm_controller/joint_trajectory"
PAINT = "/visualization_marker"
OTHERS = ("shoulder_pan", "wrist_1", "wrist_2", "wrist_3")
UPPER_ARM, FOREARM = 0.612, 0.5723  # [m]
LATE = 0.5  # [s] when TF begins
RISING = [0.25 + 0.1 * step for step in range(13)]  # [m] heights of the wrist, one per 0.1 s
FIRST = [(1.0, 0.2, z) for z in RISING if z > 0.5]  # [m] where paint belongs
SECOND = [(1.0, 0.6, z) for z in RISING[-2::-1] if z > 0.5]


def standing(lift: Any) -> dict[str, Any]:
    """Return the goal of a command: a shoulder lift, an elbow of 0.5, the other joints at 0, [rad]."""
    others = {f"ur10{name}_joint": 0.0 for name in OTHERS}
    return {"ur10shoulder_lift_joint": lift, "ur10elbow_joint": 0.5, **others}


def robot(at: float, base: tuple[float, float, float], height: float, yaw: float = 0.0) -> Message:
    """The base in map and the wrist in the base, [m], `at` [s] after the start; the base has a yaw [rad]."""
    wrist = inputs.pose("base_link", "ur10wrist_3_link", (1.0, 0.2, height))
    return inputs.transforms((inputs.pose("map", "base_link", base, yaw), wrist), at)


def motion() -> Iterable[Message]:
    """The wrist rises, the base moves 0.4 m to the left, the wrist descends; each step takes 0.1 s."""
    heights = [0.25] * 5 + RISING + [RISING[-1]] * 9 + RISING[-2::-1] + [0.25] * 5
    lefts = [0.0] * 18 + [0.05 * step for step in range(1, 9)] + [0.4] * 30
    for step, (height, left) in enumerate(zip(heights, lefts, strict=False)):
        yield robot(LATE + 0.05 + 0.1 * step, (0.0, left, 0.0), height)


def folded(lift: float, elbow: float) -> tuple[float, float]:
    """Return the position of the wrist in the arm's plane: ahead of and above the shoulder [m]."""
    ahead = UPPER_ARM * math.cos(lift) + FOREARM * math.cos(lift + elbow)
    return ahead, -UPPER_ARM * math.sin(lift) - FOREARM * math.sin(lift + elbow)


HALF = expect_value(0.75, call=0, unit="rad", name="the joint at half the time")
AFTER = expect_value(-0.2, call=2, unit="rad", name="the joint after the end")

JOINT_AT = Task(
    "week08.joint_at",
    title="Between two points",
    kind="function",
    name="joint_at",
    hints=(
        "u is t / seconds while the joint moves. It must never be below 0 or above 1.",
        "After the end t / seconds is above 1. min(..., 1.0) cuts it. And before the start?",
        "`u = min(max(t / seconds, 0.0), 1.0)`",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call(0.0, 1.5, 3.0, 1.5),
                Call(1.0, -0.2, 4.0, 1.0),
                Call(1.0, -0.2, 4.0, 5.0),
                Call(0.5, 2.0, 4.0, -1.0),
            ),
            checks=lightly_weighted(
                HALF.requiring(AFTER),
                expect_value(0.8125, call=1, unit="rad", name="the joint at a quarter of the time"),
                AFTER.requiring(HALF),
                expect_value(0.5, call=3, unit="rad", name="the joint before the start").requiring(HALF),
            ),
        ),
    ),
)

SWEEP_NODE = Task(
    "week08.sweep_node",
    title="Two commands for the arm: four faults",
    kind="node",
    name="SweepNode",
    hints=(
        "Read the controller's log: which names does it expect? Print list(robot.tree.joints) and compare.",
        "Position number 2 belongs to name number 2. And how long are 3 nanoseconds?",
        "The prefix ur10, shoulder_lift before elbow, time_from_start.sec = 3, and 5 instead of 4.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=9.0,  # [s]
            seed=1,
            checks=(
                expect_trajectory(ARM, standing(1.5), at=1.0, seconds=3.0, points=1).titled(
                    "the first command"
                ),
                expect_trajectory(
                    ARM, standing(my("lift")), index=1, at=5.0, seconds=3.0, points=1, of=2
                ).titled("the second command, with your number"),
                expect_trajectory(ARM, standing(my("lift")), index=1, at=5.0, seconds=3.0, of=2)
                .worth(0.5)
                .titled("two commands, and no more"),
            ),
        ),
    ),
    personal={"lift": (-0.4, -0.35, -0.3, -0.2, -0.15, -0.1)},  # [rad]; -0.25 is the lesson's
)

RAMP = [*[(0.0, 0.0, z) for z in (0.5, 0.6, 0.7)], *[(0.0, 0.05 * n, 0.7) for n in range(1, 6)]]
SLOWLY = [(0.0, 0.0, 0.7 + 0.006 * step) for step in range(1, 6)]
SLOW = [*[(0.0, 0.0, z) for z in (0.5, 0.6, 0.7)], *SLOWLY, (0.0, 0.0, 0.75), (0.0, 0.0, 0.77)]
SMALL_DRIVE = [(0.0, 0.0, 0.5), (0.0, 0.0, 0.6), (0.09, 0.0, 0.6), (0.09, 0.0, 0.7), (0.09, 0.0, 0.8)]
FAR_IN_STEPS = [(0.0, 0.0, 0.5), (0.0, 0.0, 0.6), (0.06, 0.0, 0.6), (0.12, 0.0, 0.6), (0.12, 0.0, 0.8)]
# The base turns by 0.2 rad per step. Its distance from where it was is 0, but not that of the map's
# origin from the base.
TURN = 0.2  # [rad]
ON_THE_SPOT = [(2.0, 0.0, z) for z in (0.5, 0.6, 0.7, 0.8, 0.9)]
TWO_DRIVES = [(x, 0.0, z) for x in (0.0, 0.2, 0.4) for z in (0.5, 0.6, 0.7, 0.7)]


def painted(
    steps: Sequence[tuple[float, float, float]], turn: float = 0.0
) -> list[list[tuple[float, float, float]]]:
    """The stripes by the two rules, for x and z of the base and the height of the wrist, [m].

    The base turns by `turn` [rad] in each step.
    """
    stripes: list[list[tuple[float, float, float]]] = []
    last: tuple[float, float] | None = None
    for number, ((_, _, before), (x, z, height)) in enumerate(pairwise(steps), 1):
        if abs(height - before) > 0.01 and height > 0.5:
            if last is None or math.dist(last, (x, z)) > 0.1:
                stripes.append([])
            sine, cosine = math.sin(turn * number), math.cos(turn * number)
            stripes[-1].append((x + cosine - 0.2 * sine, sine + 0.2 * cosine, z + height))
            last = (x, z)
    return stripes


def each_point(stripes: Sequence[Sequence[Any]]) -> Check:
    """Return a check that a marker is published with every new point."""
    return expect_topic(PAINT, "visualization_msgs/msg/Marker", at_least=sum(map(len, stripes))).worth(0)


def rule(name: str, steps: Sequence[tuple[float, float, float]], turn: float = 0.0) -> Scenario:
    """A scenario of a few steps, one per 0.1 s, that shows whether one rule is kept."""
    moves = (robot(0.05 + 0.1 * n, (x, 0.0, z), height, turn * n) for n, (x, z, height) in enumerate(steps))
    expected = painted(steps, turn)
    each = each_point(expected).titled(f"{name}: each point is published")
    found = [expect_marker(PAINT, points=stripe).requiring(each) for stripe in expected]
    stripes = [check.titled(f"{name}: stripe {number}") for number, check in enumerate(found, 1)]
    count = expect_marker_count(PAINT, len(stripes), type="LINE_STRIP").requiring(*stripes)
    # All public scenarios together may earn a tenth of the points.
    count = count.titled(f"{name}: the number of stripes").worth(0.5)
    return Scenario(
        name, seconds=2.0, seed=1, inputs=tuple(moves), checks=lightly_weighted(each, *stripes, count)
    )


POINTWISE = each_point((FIRST, SECOND))
SWEEPS = [expect_marker(PAINT, points=points).requiring(POINTWISE) for points in (FIRST, SECOND)]

PAINT_NODE = Task(
    "week08.paint_node",
    title="Paint by rules",
    kind="node",
    name="PaintNode",
    hints=(
        "self.place('base_link', WRIST)[2] is the height. Keep it in self.height for the next tick.",
        "Put both lookups into a try, with except TransformException: return. Then compare, then paint.",
        "math.dist(base, self.base) > 0.1: self.new_stripe(self.marker.id + 1). Then `self.base = base`.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=LATE + 5.0,  # [s]
            seed=1,
            inputs=tuple(motion()),
            checks=lightly_weighted(
                expect_marker_count(PAINT, 2, type="LINE_STRIP")
                .requiring(*SWEEPS)
                .titled("two stripes, two ids"),
                POINTWISE.titled("each point is published"),
                SWEEPS[0].titled("the points of the first sweep"),
                SWEEPS[1].titled("the points of the second sweep"),
            ),
        ),
        rule("a base that drives up a ramp paints nothing", RAMP),
        rule("a wrist that moves by 0.006 m paints nothing, by 0.02 m it does", SLOW),
        rule("a drive of less than 0.1 m does not begin a stripe", SMALL_DRIVE),
        rule("two small drives together begin a stripe", FAR_IN_STEPS),
        rule("a base that turns on the spot does not begin a stripe", ON_THE_SPOT, TURN),
        rule("each of three stripes has an id of its own", TWO_DRIVES),
    ),
    ghost=tuple(
        Message(
            "/expected",
            "visualization_msgs/msg/Marker",
            {
                "header": {"frame_id": "map"},
                "ns": "expected",
                "id": number,
                "type": 4,
                "pose": {"orientation": {"w": 1.0}},
                "scale": inputs.xyz((0.26, 0.0, 0.0)),  # [m] blue, and wider than the paint: seen beside it
                "color": {"r": 0.3, "g": 0.6, "b": 1.0, "a": 1.0},
                "points": [inputs.xyz(point) for point in stripe],
            },
        )
        for number, stripe in enumerate((FIRST, SECOND))
    ),
)

# The lift may differ by a full turn, because the task leaves its range open.
LIFT = (0,)
ABOVE = expect_value(
    [-1.2, 0.5], call=0, unit="rad", angles=LIFT, name="(lift, elbow) for a place above", axes="lift elbow"
)

LIFT_AND_ELBOW = Task(
    "week08.lift_and_elbow",
    title="Two angles for a place",
    kind="function",
    name="lift_and_elbow",
    hints=(
        "Shoulder, elbow and wrist are a triangle. You know all three sides. Which angle is the elbow?",
        "cos(elbow) = (ahead**2 + up**2 - a**2 - b**2) / (2 a b). Beyond -1 or 1 there is no such triangle.",
        "lift = -atan2(up, ahead) - atan2(b sin(elbow), a + b cos(elbow)).",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call(*folded(-1.2, 0.5)),
                Call(*folded(0.3, math.pi / 2)),
                Call(1.2, 0.5),
                Call(0.01, -0.02),
                Call(*folded(-1.9, 0.4)),
            ),
            checks=lightly_weighted(
                ABOVE,
                expect_value(
                    [0.3, math.pi / 2],
                    call=1,
                    unit="rad",
                    angles=LIFT,
                    name="(lift, elbow) for a place below",
                    axes="lift elbow",
                ),
                expect_value(
                    [-1.9, 0.4],
                    call=4,
                    unit="rad",
                    angles=LIFT,
                    name="(lift, elbow) for a place behind",
                    axes="lift elbow",
                ),
                expect_value([], call=2, name="the answer for a place out of reach").requiring(ABOVE),
                expect_value([], call=3, name="the answer for a place too near").requiring(ABOVE),
            ),
        ),
    ),
)

ONE_STRIPE = expect_value(0.1, call=0, tolerance=0.01, name="the coverage of one stripe")

COVERAGE = Task(
    "week08.coverage",
    title="Stretch: how much is painted?",
    kind="function",
    name="coverage",
    hints=(
        "Cut the wall into small squares, and ask for each one: is its middle in some stripe?",
        "y = np.arange(0.0025, width, 0.005) are the middles. A table of booleans says what is painted.",
        "painted |= np.outer(abs(y - middle) < 0.1, (z > low) & (z < high)) for each; then painted.mean().",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call([[0.5, 0.5, 1.5]], 1.0, 2.0),
                Call([[0.5, 0.5, 1.5], [0.6, 0.5, 1.5]], 1.0, 2.0),
                Call([[0.0, 1.0, 3.0], [1.5, 0.0, 2.0]], 1.0, 2.0),
                Call([], 1.0, 2.0),
                Call([[0.2, -1.0, 1.0], [3.0, 0.0, 1.0]], 1.0, 2.5),
                Call([[0.2, 0.0, 1.0], [0.25, 0.5, 2.0]], 1.0, 2.5),
            ),
            checks=lightly_weighted(
                ONE_STRIPE,
                expect_value(0.15, call=1, tolerance=0.01, name="the coverage of two that overlap"),
                expect_value(0.05, call=2, tolerance=0.01, name="the coverage of stripes beside the wall"),
                expect_value(0.0, call=3, tolerance=0.01, name="the coverage of none")
                .requiring(ONE_STRIPE)
                .worth(0.4),
                expect_value(
                    0.08, call=4, tolerance=0.01, name="the coverage of one from below the wall"
                ).worth(0.4),
                expect_value(
                    0.17, call=5, tolerance=0.01, name="the coverage of two that overlap in part"
                ).worth(0.4),
            ),
        ),
    ),
)

TASKS = (JOINT_AT, SWEEP_NODE, PAINT_NODE, LIFT_AND_ELBOW, COVERAGE)
