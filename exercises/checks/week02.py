"""Week 2, joint states: tasks, hints and public checks."""

import math

from course_lib.grading.inputs import scan, xyz
from course_lib.grading.task import Call, Message, Scenario, Task, my
from course_lib.grading.vocabulary import (
    expect_joint_states,
    expect_joint_swing,
    expect_marker,
    expect_marker_count,
    expect_rate,
    expect_stamps,
    expect_value,
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
RANGES = (math.inf, 3.0, 1.5, 0.05, 2.0, 4.0, math.inf)  # [m]; 0.05 is less than range_min
NEAREST = (1.5 * math.cos(-0.5), 1.5 * math.sin(-0.5), 0.0)  # [m]

JOINT_WAVE = Task(
    "week02.joint_wave",
    title="Joints that swing",
    kind="node",
    name="JointWaveNode",
    hints=(
        "A JointState has a stamp, names and positions. The positions stand in the order of the names.",
        "The time is steps * 0.02 s. A sine that swings 0.25 times a second is sin(2 pi * 0.25 * time).",
        "position = [A sin(angle), -1.2, 0.5 sin(2 angle), 0.0, 0.0, 0.0], with A your amplitude.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=5.0,  # [s]
            seed=1,
            checks=(
                expect_joint_states(NAMES).titled("six names, six positions"),
                expect_joint_swing("shoulder_pan_joint", amplitude=my("amplitude"), hz=0.25)
                .titled("the shoulder swings by your amplitude")
                .worth(2),
                expect_rate(STATES, 50.0).titled("50 times a second").worth(0.5),
                expect_stamps(STATES).titled("stamped with the time").worth(0.5),
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
        "The second angle counts from the first link. So the second link points to first + second.",
        "x = a cos(first) + b cos(first + second); y is the same with sin.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(2.0, 1.0, 0.0, math.pi / 2), Call(2.0, 1.0, math.pi / 2, math.pi / 2)),
            checks=(
                expect_value([2.0, 1.0], call=0, unit="m", name="the tip, elbow bent by 90°"),
                expect_value([-1.0, 2.0], call=1, unit="m", name="the tip, both bent by 90°"),
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
        "Begin with np.eye(4). Each joint brings a shift, then a turn. How do matrices chain?",
        "In the loop: place = place @ shifted(shift) @ turned(axis, angle).",
        "At the end a column takes the tip: (place @ [*tip, 1.0])[:3].",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call(UR10, [0.0, math.pi / 2, 0.0], WRIST),
                Call(UR10, [math.pi / 2, math.pi / 2, 0.0], WRIST),
                Call(UR10, [0.0, 0.0, 0.0], WRIST),
            ),
            checks=(
                expect_value([FORWARD, SIDE, UP], call=0, unit="m", name="the wrist, arm straight ahead"),
                expect_value([-SIDE, FORWARD, UP], call=1, unit="m", name="the wrist, turned to the left"),
                expect_value([0.0, SIDE, UP + FORWARD], call=2, unit="m", name="the wrist, arm straight up"),
            ),
        ),
    ),
)

MENDED_STATES = Task(
    "week02.mended_states",
    title="A mended robot",
    kind="node",
    name="MendedStates",
    hints=(
        "Start BrokenStates and read its log and the table of statuses. Mend one fault, then look again.",
        "The log says that the message is invalid: count names and positions. Then read each name aloud.",
        "wrist_3_joint needs a position, elbow_jont needs an i, and angles are radians: math.radians(...).",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=4.0,  # [s]
            seed=1,
            checks=(
                expect_joint_states(NAMES).titled("all six joints have a name and a position").worth(3),
                expect_joint_swing("elbow_joint", amplitude=0.0, hz=0.0, middle=math.radians(60)).titled(
                    "the elbow stands at 60°"
                ),
                expect_joint_swing("shoulder_pan_joint", amplitude=math.radians(30), hz=0.5).titled(
                    "the shoulder swings by 30°"
                ),
            ),
        ),
    ),
)

NEAREST_OBSTACLE = Task(
    "week02.nearest",
    title="Stretch: the nearest obstacle",
    kind="node",
    name="NearestNode",
    hints=(
        "Which beams count? Leave out all below range_min and above range_max; inf and NaN go with them.",
        "Beam number i looks along angle_min + i * angle_increment. 0 is x, and it counts to the left.",
        "x = r cos(angle), y = r sin(angle), in the frame of the scan: marker.header = message.header.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=3.0,  # [s]
            seed=1,
            inputs=tuple(scan(RANGES, at=0.3 + step / 2, first=-1.5, step=0.5) for step in range(5)),
            checks=(
                expect_marker_count("/nearest", 1, type="SPHERE").titled("one sphere"),
                expect_marker("/nearest", position=NEAREST).titled("where the nearest beam ends"),
                expect_marker("/nearest", frame="laser", scale=(0.2, 0.2, 0.2)).titled("frame and size"),
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
                "pose": {"position": xyz(NEAREST)},
                "scale": xyz((0.2, 0.2, 0.2)),  # [m]
                "color": {"r": 1.0, "g": 0.0, "b": 0.0, "a": 1.0},
            },
        ),
    ),
)

TASKS = (JOINT_WAVE, TWO_LINK, TOOL_PLACE, MENDED_STATES, NEAREST_OBSTACLE)
