"""Week 2, joint states: tasks, hints and public checks."""

import math
from functools import partial

from course_lib.grading import (
    Call,
    Check,
    Evidence,
    Message,
    Scenario,
    Task,
    Verdict,
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
    failed,
    inputs,
    my,
    passed,
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
WRIST = [0.0, 0.0, 0.5723]  # [m] in the forearm's frame
SIDE, FORWARD, UP = 0.220941 - 0.1719, 0.612 + 0.5723, 0.1273  # [m]
WRISTS = {f"wrist_{number}_joint": 0.0 for number in (1, 2, 3)}  # [rad]
POSE = {"shoulder_lift": -90, "elbow": 60, "wrist_1": -45, "wrist_2": 90, "wrist_3": 0}  # [deg]
# Two beams that do not count follow each other: 0.05 is less than range_min. The first beam that
# counts is not the nearest one.
RANGES = (math.inf, 0.05, 3.0, 2.0, 1.5, 4.0, math.inf)  # [m]
EARLIER = (math.nan, 3.0, 2.5, 2.5, 1.2, 4.0, math.inf)
NOTHING = (math.inf, 0.05, math.nan, 31.0, math.inf, 0.0, -math.inf)  # 31 is more than range_max
# One beam counts: the first one, or the last one.
FIRST = (2.0, *NOTHING[1:])
LAST = (*NOTHING[:-1], 2.0)
# A distance equal to range_min, and one equal to range_max, also count.
LIMITS = ((0.1, *NOTHING[1:]), (*NOTHING[:-1], 30.0))
SCANS = (FIRST, EARLIER, NOTHING, EARLIER, NOTHING, EARLIER, LAST, RANGES)  # three times a second
NEAREST = (1.5 * math.cos(0.5), 1.5 * math.sin(0.5), 0.0)  # [m]

JOINT_WAVE = Task(
    "week02.joint_wave",
    title="Joints that swing",
    kind="node",
    name="JointWaveNode",
    hints=(
        "Of the six numbers, in the order of NAMES, only the first and the third change with the time.",
        "A sine that swings 0.25 times a second is sin(2 pi * 0.25 * time). The elbow swings twice as fast.",
        "state.position = [A sin(angle), -1.2, 0.5 sin(2 angle), 0.0, 0.0, 0.0], with A your amplitude.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=5.0,  # [s]
            seed=1,
            checks=with_formal(
                (
                    expect_joint_states(NAMES, moving=True).titled("six names, six positions"),
                    expect_joint_swing("shoulder_pan_joint", amplitude=my("amplitude"), hz=0.25)
                    .titled("the shoulder swings by your amplitude, and first rises")
                    .worth(4),
                    expect_joint_swing("elbow_joint", amplitude=0.5, hz=0.5).titled(
                        "the elbow swings by 0.5 rad"
                    ),
                    expect_joints_still({"shoulder_lift_joint": -1.2, **WRISTS}).titled(
                        "the shoulder lift stays at -1.2 rad, the wrists at 0"
                    ),
                ),
                expect_rate(STATES, 50.0).titled("50 times a second"),
                expect_stamps(STATES).titled("stamped with the time"),
            ),
        ),
    ),
    personal={"amplitude": (0.3, 0.45, 0.6, 0.75, 0.9, 1.1)},  # [rad]; 0.5 is the lesson's
)

TWO_LINK = Task(
    "week02.two_link",
    title="An arm of two links",
    kind="function",
    name="two_link",
    hints=(
        "Go along the first link, then along the second one. In which direction does each of them point?",
        "The second angle counts from the first link. So the second link points along first + second.",
        "x = a cos(first) + b cos(first + second); y is the same with sin.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call(2.0, 1.0, 0.0, math.pi / 2),
                Call(2.0, 1.0, math.pi / 2, math.pi / 2),
                # Lengths in fractions of a metre, so that rounding shows, and no right angle.
                Call(0.6, 0.35, math.pi / 6, math.pi / 6),
                Call(0.5, 0.4, -math.pi / 2, math.pi / 2),
            ),
            checks=(
                expect_value([2.0, 1.0], call=0, unit="m", name="the tip, elbow bent by 90°", axes="x y"),
                expect_value([-1.0, 2.0], call=1, unit="m", name="the tip, both bent by 90°", axes="x y"),
                expect_value(
                    [0.3 * math.sqrt(3) + 0.175, 0.3 + 0.175 * math.sqrt(3)],
                    call=2,
                    unit="m",
                    name="the tip of a small arm, both bent by 30°",
                    axes="x y",
                ),
                expect_value([0.4, -0.5], call=3, unit="m", name="the tip below the x axis", axes="x y"),
            ),
        ),
    ),
)

TOOL_PLACE = Task(
    "week02.tool_place",
    title="The place of the tool on any arm",
    kind="function",
    name="tool_place",
    hints=(
        "Begin with np.eye(4). Each joint adds a shift, then a turn. How do you combine matrices?",
        "In the loop: `place = place @ shifted(shift) @ turned(axis, angle)`.",
        "At the end, transform the tip: `(place @ [*tip, 1.0])[:3]`.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call(UR10, [0.0, math.pi / 2, 0.0], WRIST),
                Call(UR10, [math.pi / 2, math.pi / 2, 0.0], WRIST),
                Call(UR10, [0.0, 0.0, 0.0], WRIST),
                Call(UR10, [0.0, math.pi / 2, -math.pi / 2], WRIST),
                Call([["x", [1.0, 0.0, 0.0]]], [math.pi / 2], [0.5, 0.0, 0.2]),
            ),
            checks=(
                expect_value(
                    [FORWARD, SIDE, UP], call=0, unit="m", name="the wrist, arm straight ahead", axes="x y z"
                ),
                expect_value(
                    [-SIDE, FORWARD, UP], call=1, unit="m", name="the wrist, turned to the left", axes="x y z"
                ),
                expect_value(
                    [0.0, SIDE, UP + FORWARD],
                    call=2,
                    unit="m",
                    name="the wrist, arm straight up",
                    axes="x y z",
                ),
                expect_value(
                    [0.612, SIDE, UP + 0.5723],
                    call=3,
                    unit="m",
                    name="the wrist, elbow bent (first the shift, then the turn),",
                    axes="x y z",
                ).titled("the wrist, elbow bent: first the shift, then the turn"),
                expect_value(
                    [1.5, -0.2, 0.0],
                    call=4,
                    unit="m",
                    name="the tip of one joint that turns about x",
                    axes="x y z",
                ),
            ),
        ),
    ),
)

MENDED_STATES = Task(
    "week02.mended_states",
    title="Find the faults: a robot that stays white",
    kind="node",
    name="MendedStates",
    hints=(
        "Run BrokenStates, and read its log and the table of statuses. Fix one fault, then look again.",
        "The log says that the message is invalid: count names and positions. Then check each spelling.",
        "wrist_3_joint needs a position, elbow_jont lacks an i, angles are in radians: math.radians(...).",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=4.0,  # [s]
            seed=1,
            checks=with_formal(
                (
                    expect_joint_states(NAMES, moving=True)
                    .titled("all six joints have a name and a position")
                    .worth(2),
                    expect_joint_swing("shoulder_pan_joint", amplitude=math.radians(30), hz=0.5).titled(
                        "the shoulder swings by 30°"
                    ),
                    expect_joints_still(
                        {f"{name}_joint": math.radians(angle) for name, angle in POSE.items()}
                    ).titled("the other joints stay at their angles"),
                ),
                expect_rate(STATES, 20.0).titled("20 times a second"),
                expect_stamps(STATES).titled("stamped with the time"),
            ),
        ),
    ),
)

DELAY = 0.15  # [s] from the stamp of a scan to its arrival
# A scanner publishes with Best Effort.
_scan = partial(inputs.scan, first=-1.1, step=0.4, delay=DELAY, best_effort=True)
COUNTING = sum(ranges is not NOTHING for ranges in SCANS)
AGAIN = expect_throughout("/nearest", hz=2.0).titled("published again and again").worth(0)
SPHERE = (
    expect_marker("/nearest", type="SPHERE", scale=(0.2, 0.2, 0.2), color=(1.0, 0.0, 0.0, 1.0))
    .titled("a red sphere of 0.2 m")
    .requiring(AGAIN)
)


def counts_limits(evidence: Evidence) -> Verdict:
    """Expect a sphere for each scan whose only distance equals range_min or range_max."""
    distances = [
        math.hypot(marker.pose.position.x, marker.pose.position.y)
        for _, marker in evidence.messages("/nearest")
    ]
    if not distances:
        return failed("nothing was published on /nearest", "nothing was published on an expected topic")
    low, high = 0.1, 30.0  # [m] range_min and range_max
    for distance in distances:
        if not low * 0.999 <= distance <= high * 1.001:
            text = f"the centre of a sphere is {distance:.3g} m away, expected {low:g} to {high:g} m"
            return failed(f"{text}, range_min to range_max", "a value is wrong: the limits")
    for name, limit in (("range_min", low), ("range_max", high)):
        if not any(math.isclose(distance, limit, rel_tol=1e-3) for distance in distances):
            text = f"no sphere was published for a scan whose only distance in range is {name}, {limit:g} m"
            return failed(f"{text}: a distance equal to {name} counts", "a value is wrong: the limits")
    return passed("as expected")


NEAREST_OBSTACLE = Task(
    "week02.nearest",
    title="Stretch: find five faults: the nearest obstacle",
    kind="node",
    name="NearestNode",
    hints=(
        "Which beams count? A beam must be between range_min and range_max. And what if none is?",
        "Beam number i looks along angle_min + i * angle_increment. In which frame? Is the sphere visible?",
        "Check low <= distance <= high, return without beams, add angle_min, copy the header, set color.a.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=tuple(_scan(ranges, at=0.3 + step / 3) for step, ranges in enumerate(SCANS)),
            checks=(
                AGAIN,
                *with_formal(
                    (
                        SPHERE,
                        expect_marker("/nearest", position=NEAREST)
                        .titled("where the nearest beam ends")
                        .requiring(AGAIN)
                        .worth(2),
                        expect_topic(
                            "/nearest", "visualization_msgs/msg/Marker", at_least=COUNTING, at_most=COUNTING
                        )
                        .titled("one for each scan in which a beam counts, none for the others")
                        .requiring(SPHERE),
                        expect_marker_count("/nearest", 1).titled("one sphere").requiring(SPHERE),
                    ),
                    expect_frame("/nearest", "laser").titled("in the frame of the scan"),
                    expect_stamps("/nearest", delay=DELAY).titled("with the stamp of the scan"),
                ),
            ),
        ),
        Scenario(
            "distances at the limits",
            seconds=2.0,  # [s]
            seed=2,
            inputs=tuple(
                _scan(ranges, at=0.3 + step / 3) for step, ranges in enumerate((RANGES, *LIMITS, RANGES))
            ),
            checks=(
                Check("range_min and range_max themselves count", counts_limits).requiring(SPHERE).worth(0.5),
            ),
        ),
    ),
    ghost=(
        Message(
            "/expected",
            "visualization_msgs/msg/Marker",
            {
                "header": {"frame_id": "laser"},
                "ns": "expected",
                "type": 2,
                "pose": {"position": inputs.xyz(NEAREST)},
                "scale": inputs.xyz((0.2, 0.2, 0.2)),  # [m]
                "color": {"r": 1.0, "g": 0.0, "b": 0.0, "a": 1.0},
            },
        ),
    ),
)

TASKS = (JOINT_WAVE, TWO_LINK, TOOL_PLACE, MENDED_STATES, NEAREST_OBSTACLE)
