"""Week 7, the dashboard: tasks, hints and public checks."""

from math import pi
from typing import Any

from course_lib.grading import (
    Call,
    Check,
    Evidence,
    Row,
    Scenario,
    Task,
    Verdict,
    expect_colors_apart,
    expect_display,
    expect_gone,
    expect_layout,
    expect_length,
    expect_marker,
    expect_marker_count,
    expect_nothing_before,
    expect_parameters,
    expect_path,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_value,
    failed,
    inputs,
    lightly_weighted,
    my,
    passed,
)

MARKERS, PLAN, TRAJECTORY = "/perception/markers", "/planned_path", "/robot_trajectory"
K = [277.0, 0.0, 159.5, 0.0, 277.0, 119.5, 0.0, 0.0, 1.0]  # [px]
WIDE = [150.0, 0.0, 99.5, 0.0, 160.0, 74.5, 0.0, 0.0, 1.0]  # [px]: columns and rows differ

PERSON = inputs.DetectedObject(1, "Person", (3.0, 2.0, 0.9), (0.5, 0.5, 1.8), 0.92)
CAR = inputs.DetectedObject(2, "Car", (8.0, -3.0, 0.75), (4.5, 2.0, 1.5), 0.7)
BICYCLE = inputs.DetectedObject(5, "Bicycle", (3.0, 3.0, 0.5), (1.8, 0.6, 1.0), 0.45)
# Its confidence is just sufficient, and its class has no color.
DOG = inputs.DetectedObject(7, "Dog", (-1.0, 2.0, 0.3), (0.9, 0.3, 0.6), 0.5)
OBJECTS = (CAR, DOG, PERSON, BICYCLE)
SEEN = [inputs.detections(OBJECTS, at=0.2 + step / 5, frame="world") for step in range(19)]  # up to 4 s

AHEAD = inputs.corners((0.0, 0.0, 4.0), (0.5, 1.8, 0.5))
ASIDE = inputs.corners((1.0, -0.5, 3.0), (1.0, 0.6, 2.0))
# The first corner of one is ahead, the last one of the other: all corners have to be looked at.
BEYOND = inputs.corners((1.0, 0.0, 0.5), (1.0, 1.0, 4.0))[::-1]
CLOSE = inputs.corners((0.0, 0.0, 1.05), (0.5, 0.5, 2.0))
# Its left and top are outside the picture.
OUTSIDE = inputs.corners((-1.5, -0.2, 2.5), (1.0, 1.6, 1.0))
PARTLY = "a box that is partly behind the camera"
EDGE = [[0.0, 0.0, 0.1], [0.2, 0.1, 1.0]]  # just far enough
SIDES = ("left", "top", "right", "bottom")
PX: dict[str, Any] = {"tolerance": 0.01, "unit": "px", "parts": SIDES}
IN_MIDDLE = expect_value([141.0333, 53.02, 177.9667, 185.98], call=0, name="the rectangle", **PX)

BOX_ON_IMAGE = Task(
    "week07.box_on_image",
    title="A box on the picture",
    kind="function",
    name="box_on_image",
    hints=(
        "Project all eight corners first. The rectangle goes from the smallest to the largest of them.",
        "columns = [k[0] * x / z + k[2] for x, y, z in corners], and rows with k[4] and k[5].",
        "Before that: if any z is below 0.1, return [].",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                *(Call(K, AHEAD), Call(WIDE, ASIDE), Call(K, EDGE)),
                *(Call(K, BEYOND), Call(K, CLOSE), Call(WIDE, OUTSIDE)),
            ),
            checks=lightly_weighted(
                IN_MIDDLE,
                expect_value([118.25, 10.5, 212.0, 66.5], call=1, name="another rectangle", **PX),
                expect_value([159.5, 119.5, 214.9, 147.2], call=2, name="the one from 0.1 m on", **PX),
                expect_value([], call=3, name=f"the answer for {PARTLY}").requiring(IN_MIDDLE),
                expect_value([], call=4, name="the answer for a box 0.05 m ahead").requiring(IN_MIDDLE),
                expect_value(
                    [-50.5, -5.5, 49.5, 122.5], call=5, name="the rectangle partly outside the picture", **PX
                ),
            ),
        ),
    ),
)

GREEN, GREY = (0.0, 1.0, 0.0, 0.5), (0.5, 0.5, 0.5, 0.5)  # RGBA
WITH_LABELS: dict[str, Any] = {"allow_others": True}  # each box has a label on the same topic
LOOKS: dict[str, Any] = {"type": "CUBE", "position": PERSON.center, "scale": PERSON.size, "color": GREEN}
ALWAYS = expect_throughout(MARKERS, hz=10.0).worth(0)
PERSON_BOX = (
    expect_marker(MARKERS, ns="boxes", id=1, **LOOKS, **WITH_LABELS)
    .requiring(ALWAYS)
    .titled("the person's box")
)
SURE, SUREST = (PERSON_BOX.titled(f"the person's box, {why}") for why in ("sure enough", "the surest"))
PERSON_BEFORE = expect_marker(MARKERS, ns="boxes", id=1, **LOOKS, at=1.5, **WITH_LABELS)
DOG_BOX = expect_marker(MARKERS, type="CUBE", ns="boxes", id=7, scale=DOG.size, color=GREY, **WITH_LABELS)
DOG_BOX = DOG_BOX.requiring(ALWAYS)
BLUE = (0.0, 0.5, 1.0, 0.5)  # RGBA
BLUE_CAR = expect_marker(MARKERS, type="CUBE", ns="boxes", id=2, color=BLUE, at=1.3, **WITH_LABELS)
BLUE_CAR = BLUE_CAR.requiring(ALWAYS).titled("the car in its new color")


def boxes(count: int) -> Check:
    """Return a check of the number of boxes, which counts where the person's is right."""
    return expect_marker_count(MARKERS, count, type="CUBE").requiring(PERSON_BOX)


def changed(*checks: Check, **parameters: Any) -> Scenario:
    """Return a scenario in which parameters are set while the node runs: at 0.5 s, and a second at 1.5 s."""
    sets = [
        inputs.set_parameters("/perception_node", 0.5 + place, **{name: parameters[name]})
        for place, name in enumerate(parameters)
    ]
    name = f"{', then '.join(parameters)}, set while it runs"
    return Scenario(name, seconds=3.0, seed=3, inputs=(*SEEN[:14], *sets), checks=lightly_weighted(*checks))


MARKERS_TASK = Task(
    "week07.markers",
    title="Markers that follow parameters",
    kind="node",
    name="PerceptionNode",
    hints=(
        "self.last.detections has them all. Remove those below the threshold, sort the rest, cut the list.",
        "sorted(sure, key=score_of, reverse=True)[:most], with most = self.value('max_detections').",
        "Too old: age_of(self.last, self.get_clock().now()) > self.value('marker_lifetime'). Return [] then.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=4.0,  # [s]
            inputs=tuple(SEEN),
            checks=lightly_weighted(
                ALWAYS,
                PERSON_BOX,
                DOG_BOX.titled("the dog's box: a class without a color is grey"),
                boxes(3).titled("three boxes are sure enough"),
                expect_rate(MARKERS, 10.0).requiring(PERSON_BOX).worth(0.2),
            ),
        ),
        changed(
            boxes(1).titled("one is above your threshold"),
            SURE,
            confidence_threshold=my("threshold"),
            marker_update_rate=10.0,  # [Hz], the default: the node must stand it
        ),
        changed(BLUE_CAR, boxes(1).titled("one box only"), SUREST, car_color=list(BLUE), max_detections=1),
        Scenario(
            "the detector stops",
            seconds=4.5,  # [s]
            # The last one is at 2.0 s: whole seconds draw its boxes until 4 s.
            inputs=tuple(SEEN[:10]),
            checks=lightly_weighted(
                PERSON_BEFORE.titled("a box while the detector runs"),
                # Its boxes are published until 3 s, and then stay for their lifetime of 1 s.
                expect_marker(MARKERS, ns="boxes", id=1, **LOOKS, at=3.5, **WITH_LABELS)
                .requiring(PERSON_BEFORE)
                .titled("a box as long as the message is not older than marker_lifetime")
                .worth(0.5),
                expect_gone(MARKERS).requiring(PERSON_BEFORE).titled("no box when the message is too old"),
            ),
        ),
        Scenario(
            "the detector stops, with another marker_lifetime",
            # The last detection is at 1.6 s: a fixed limit of 1 s draws until 2.6 s.
            seconds=2.6,  # [s]
            inputs=(*SEEN[:8], inputs.set_parameters("/perception_node", 0.5, marker_lifetime=0.4)),
            checks=lightly_weighted(
                PERSON_BEFORE.titled("a box with a marker_lifetime of 0.4 s"),
                expect_gone(MARKERS)
                .requiring(PERSON_BEFORE)
                .titled("no box when the message is older than 0.4 s"),
            ),
        ),
    ),
    personal={"threshold": (0.72, 0.75, 0.78, 0.81, 0.84, 0.87)},
)

EARLY, LATER, LAST, END = (inputs.circle_position(at) for at in (1.08, 3.08, 4.98, 6.48))  # [m]
# The yaw is far from 0, where a quaternion whose w stays 1 is nearly right.
END_YAW = 6.48 + pi / 2 - 2 * pi  # [rad]
CIRCLING = tuple(inputs.circling(1.03, 6.49))
KEPT_UP = expect_throughout(TRAJECTORY, hz=10.0, begin=1.1).worth(0)
WAY = expect_path(
    TRAJECTORY, count=55, frame="world", ends=(EARLY, END), yaw=END_YAW, tolerance=0.2
).requiring(KEPT_UP)


def keeps_stamps(evidence: Evidence) -> Verdict:
    """Expect the stamp of a transform in each pose of the last path."""
    paths = evidence.messages(TRAJECTORY)
    if not paths:
        # The silence has one message in all rows.
        return KEPT_UP.judge(evidence)
    sent = {round(message.at * 1e3) for message in CIRCLING}  # [ms]
    for pose in paths[-1][1].poses:
        stamp = pose.header.stamp
        if round((stamp.sec - 1_700_000_000) * 1e3 + stamp.nanosec / 1e6) not in sent:
            text = "a pose has a stamp that no transform has: expected the header of the transform"
            return failed(text, "a stamp is not copied")
    return passed("as expected")


LAST_20 = expect_path(TRAJECTORY, count=20, frame="odom", ends=(LATER, LAST), tolerance=0.2).requiring(
    KEPT_UP
)

TRAJECTORY_TASK = Task(
    "week07.trajectory",
    title="Where it has been: four faults",
    kind="node",
    name="TrajectoryNode",
    hints=(
        "Print found.transform.translation: is it where the robot is in the world? Compare the two frames.",
        "Which half of the list does [:most] keep? And which way does the robot look in every pose?",
        "lookup_transform(world, base, ...), found.transform.rotation, [-most:], header=found.header.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=6.5,  # [s]
            inputs=CIRCLING,
            checks=lightly_weighted(
                KEPT_UP,
                WAY.titled("the way from its beginning to now"),
                expect_nothing_before(TRAJECTORY, 1.0).requiring(WAY).titled("nothing until tf2 knows"),
                expect_rate(TRAJECTORY, 10.0, begin=1.1).requiring(WAY).worth(0.2),
                expect_stamps(TRAJECTORY, tolerance=0.12).requiring(KEPT_UP).worth(0.2).titled("the header"),
                Check("each pose has the header of its transform", keeps_stamps).requiring(WAY).worth(0.2),
            ),
        ),
        Scenario(
            "other frames and 20 points, set while it runs",
            seconds=5.0,  # [s]
            inputs=(
                inputs.set_parameters("/trajectory_node", 0.2, world_frame="odom", base_frame="base"),
                inputs.set_parameters("/trajectory_node", 3.0, trajectory_max_points=20),
                # The default, which changes nothing, and which the node must stand.
                inputs.set_parameters("/trajectory_node", 3.5, trajectory_update_rate=10.0),  # [Hz]
                *inputs.circling(0.53, 4.99, "odom", "base"),
            ),
            checks=lightly_weighted(LAST_20.titled("the last 20 poses, in the frames that were set")),
        ),
    ),
)

ALL_NODES = ("/tf_publisher", "/path_planner", "/perception_node", "/trajectory_node")
PERCEPTION = {
    "marker_update_rate": 5.0,  # [Hz]
    "confidence_threshold": my("threshold"),
    "bicycle_color": [1.0, 1.0, 0.0, 0.5],
}


# The parameters of each node, as the exercise declares them.
DEFAULTS = {
    "marker_update_rate": 10.0,
    "transform_update_rate": 20.0,
    "path_update_rate": 1.0,
    "trajectory_update_rate": 10.0,
    "marker_lifetime": 1.0,
    "trajectory_max_points": 100,
    "confidence_threshold": 0.5,
    "max_detections": 20,
    "base_frame": "base_link",
    "bicycle_color": [0.0, 0.0, 1.0, 0.5],
    "car_color": [1.0, 0.0, 0.0, 0.5],
    "person_color": [0.0, 1.0, 0.0, 0.5],
    "text_size": 0.4,
}
# The parameters that the task sets, by node.
SET = {"/perception_node": PERCEPTION, "/trajectory_node": {"trajectory_max_points": 50}}


def keeps_defaults(evidence: Evidence) -> Verdict:
    """Expect the defaults of all parameters that the task does not set."""
    for node in ALL_NODES:
        defaults = {key: value for key, value in DEFAULTS.items() if key not in SET.get(node, {})}
        verdict = expect_parameters(node, {"world_frame": "odom"}, unchanged=defaults).judge(evidence)
        if verdict.score < 1:
            return verdict
    return passed("as expected")


def parameter(node: str, name: str, value: Any) -> Check:
    """Return a check of one parameter that a node gets from the file."""
    return expect_parameters(node, {name: value}).titled(f"{name} of {node}")


PARAMS = Task(
    "week07.params",
    title="The parameters in a file: six faults",
    kind="function",
    name="robot_params",
    hints=(
        "Read each name letter by letter: nodes, ros__parameters, parameters. ROS ignores unknown names.",
        "Rates are floating point numbers: 5.0. The number of points is an integer: 50. A list has one type.",
        "ros__parameters below /**, perception_node, 5.0, confidence_threshold, [1.0, 1.0, 0.0, 0.5], 50.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                *(
                    parameter("/perception_node", name, value).worth(1 + 2 * (name == "confidence_threshold"))
                    for name, value in PERCEPTION.items()
                ),
                parameter("/trajectory_node", "trajectory_max_points", 50),
                *(parameter(node, "world_frame", "odom").worth(0.25) for node in ALL_NODES),
                Check("everything else keeps its default", keeps_defaults).worth(0.5),
            ),
        ),
    ),
    personal={"threshold": (0.55, 0.6, 0.65, 0.7, 0.75, 0.8)},
)

FRAME_AND_VIEW = expect_layout(fixed_frame="world", view=("TopDownOrtho", "Orbit"))
WITH_TF = expect_display("TF", properties={"Show Names": True})

LAYOUT = Task(
    "week07.layout",
    title="The layout",
    kind="function",
    name="dashboard_layout",
    hints=(
        "viewer.add takes the class, the topic, and properties by their labels.",
        "made.add('Path', '/planned_path', color='25; 255; 0') is the first of two.",
        "made.save_rviz('dashboard.rviz'), then return File('dashboard.rviz').read_text().",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                WITH_TF.titled("TF with names"),
                expect_display("MarkerArray", MARKERS).titled("the markers"),
                expect_display("Path", PLAN).titled("the plan"),
                expect_display("Path", TRAJECTORY).titled("the trajectory"),
                expect_colors_apart("Path", 100).titled("two colors that differ clearly"),
                FRAME_AND_VIEW.requiring(WITH_TF).titled("Fixed Frame and view"),
            ),
        ),
    ),
)

REPORT = Task(
    "week07.report",
    title="The report",
    kind="written",
    name="dashboard_report",
    hints=(
        "Write down while you look: numbers, and what surprised you.",
        "ros2 topic hz for the rates. For the fault: what did you see, and what did you ask next?",
        "One sentence of each kind: it publishes ..., I saw ..., because ..., an operator would miss ...",
    ),
    scenarios=(Scenario("public", checks=(expect_length(150, 300),)),),
    rubric=(
        Row("It is complete: nodes, topics and rates, measured", 5),
        Row("A fault: what was seen, and how its cause was found", 5),
        Row("A judgement: what an operator would miss, and why", 5),
    ),
)

FRONT, BACK, FAR = [1.0, 0.5, 2.1], [0.0, 0.5, -1.9], [4.0, -1.0, 2.1]  # [m]; the last is as far as the first
# A quarter of the first edge is behind the camera's near plane, half of an edge in each other call.
NEAR, BEHIND = ([1.0, 0.0, 0.05], [1.0, 0.4, 0.25]), ([0.0, 0.0, -1.0], [1.0, 0.0, 0.05])  # [m]
JUST_AHEAD = ([0.0, 1.0, 0.1], [2.0, 1.0, 1.0])  # [m]
EDGES = ((FRONT, BACK), (BACK, FRONT), (FRONT, FAR), BEHIND, NEAR, JUST_AHEAD)
ENDS: dict[str, Any] = {"parts": ("first end", "second end"), "axes": "x y z", "unit": "m"}
CUT = expect_value([FRONT, [0.5, 0.5, 0.1]], call=0, name="the part", **ENDS)

PART_AHEAD = Task(
    "week07.part_ahead",
    title="Stretch: an edge that passes the camera",
    kind="function",
    name="part_ahead",
    hints=(
        "Three cases: both ends ahead, none, one. Only the last needs arithmetic.",
        "Between the ends all three coordinates grow in step. At which share of the way is z 0.1?",
        "share = (0.1 - a[2]) / (b[2] - a[2]), and each coordinate is a + share * (b - a).",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=tuple(Call(*ends) for ends in EDGES),
            checks=lightly_weighted(
                CUT,
                expect_value([[0.5, 0.5, 0.1], FRONT], call=1, name="the part from behind", **ENDS),
                expect_value([FRONT, FAR], call=2, name="an edge that is ahead", **ENDS),
                expect_value([], call=3, name="the part of an edge behind the camera").requiring(CUT),
                expect_value(
                    [[1.0, 0.1, 0.1], NEAR[1]],
                    call=4,
                    name="the part of an edge near the camera",
                    **ENDS,
                ),
                expect_value(list(JUST_AHEAD), call=5, name="an edge from exactly 0.1 m on", **ENDS),
            ),
        ),
    ),
)

TASKS = (BOX_ON_IMAGE, MARKERS_TASK, TRAJECTORY_TASK, PARAMS, LAYOUT, REPORT, PART_AHEAD)
