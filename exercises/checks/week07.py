"""Week 7, the dashboard: tasks, hints and public checks."""

from collections.abc import Iterable
from math import cos, pi, sin
from typing import Any

from course_lib.grading.evidence import Check, Evidence, Verdict, failed, passed
from course_lib.grading.inputs import Found, detections, pose, set_parameters, transforms
from course_lib.grading.task import Call, Message, Row, Scenario, Task, my
from course_lib.grading.vocabulary import (
    expect_display,
    expect_layout,
    expect_marker,
    expect_marker_count,
    expect_parameters,
    expect_path,
    expect_rate,
    expect_value,
)

MARKERS, PLAN, TRAJECTORY = "/perception/markers", "/planned_path", "/robot_trajectory"
K = [277.0, 0.0, 159.5, 0.0, 277.0, 119.5, 0.0, 0.0, 1.0]  # [px]
FEWEST, MOST = 150, 300  # words of a report

PERSON = Found(1, "Person", (3.0, 2.0, 0.9), (0.5, 0.5, 1.8), 0.92)
CAR = Found(2, "Car", (8.0, -3.0, 0.75), (4.5, 2.0, 1.5), 0.7)
BICYCLE = Found(5, "Bicycle", (3.0, 3.0, 0.5), (1.8, 0.6, 1.0), 0.45)
OBJECTS = (PERSON, CAR, BICYCLE)


def corners(center: tuple[float, float, float], size: tuple[float, float, float]) -> list[list[float]]:
    """The eight corners of a box, [m]."""
    signs = [(a, b, c) for a in (-0.5, 0.5) for b in (-0.5, 0.5) for c in (-0.5, 0.5)]
    return [[m + s * e for m, s, e in zip(center, sign, size, strict=True)] for sign in signs]


def seen(first: float, last: float, rate: float = 5.0) -> Iterable[Message]:
    """The same detections again and again, between two times [s]."""
    return (
        detections(OBJECTS, at=first + step / rate, frame="world")
        for step in range(round((last - first) * rate))
    )


def driven(seconds: float) -> Iterable[Message]:
    """The robot on a circle of 3 m, ahead, 20 times a second for so long [s]."""
    for step in range(round(seconds * 20)):
        angle = 0.1 * step / 2  # [rad]
        place = (3.0 * cos(angle), 3.0 * sin(angle), 0.0)  # [m]
        yield transforms([pose("world", "base_link", place, angle + pi / 2)], 0.03 + step / 20)


def words(evidence: Evidence) -> Verdict:
    """As many words as a report needs; a person reads what they say."""
    text = evidence.returns[0] if evidence.returns else ""
    count = len(text.split()) if isinstance(text, str) else 0
    if FEWEST <= count <= MOST:
        return passed(f"{count} words; a person reads them")
    return failed(f"{count} words, expected {FEWEST} to {MOST}", "the length of the report")


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
                Call(K, corners((0.0, 0.0, 4.0), (0.5, 1.8, 0.5))),
                Call(K, corners((1.0, 0.0, 0.5), (1.0, 1.0, 4.0))),
            ),
            checks=(
                expect_value(
                    [141.0333, 53.02, 177.9667, 185.98],
                    call=0,
                    tolerance=0.01,
                    unit="px",
                    name="the rectangle",
                ),
                expect_value([], call=1, name="the answer for a box that is partly behind the camera"),
            ),
        ),
    ),
)

MARKERS_TASK = Task(
    "week07.markers",
    title="Markers that obey parameters",
    kind="node",
    name="PerceptionNode",
    hints=(
        "self.last.detections has them all. Leave out what is not sure, sort the rest, cut the list.",
        "sorted(sure, key=score_of, reverse=True)[:most]. Ask self.has_parameter(key) before the color.",
        "Too old: age_of(self.last, self.get_clock().now()) > self.value('marker_lifetime'). Return [] then.",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=4.0,  # [s]
            seed=1,
            inputs=(*seen(0.2, 4.0),),
            checks=(
                expect_marker_count(MARKERS, 2, type="CUBE").titled("two boxes are sure enough"),
                expect_marker(
                    MARKERS,
                    type="CUBE",
                    ns="boxes",
                    id=1,
                    position=PERSON.center,
                    scale=PERSON.size,
                    color=(0.0, 1.0, 0.0, 0.5),
                ).titled("the person's box: place, size and color"),
                expect_rate(MARKERS, 10.0),
            ),
        ),
        Scenario(
            "your threshold, set while it runs",
            seconds=4.0,  # [s]
            seed=3,
            inputs=(
                *seen(0.2, 4.0),
                set_parameters("/perception_node", 1.5, confidence_threshold=my("threshold")),
            ),
            checks=(expect_marker_count(MARKERS, 1, type="CUBE").titled("one box is above your threshold"),),
        ),
    ),
    personal={"threshold": (0.72, 0.75, 0.78, 0.81, 0.84, 0.87)},
)

TRAJECTORY_TASK = Task(
    "week07.trajectory",
    title="Where it has been",
    kind="node",
    name="TrajectoryNode",
    hints=(
        "lookup_transform(world, base, Time()) gives the newest. Ask can_transform(...) before it.",
        "The translation becomes pose.position, the rotation pose.orientation, the header the header.",
        "self.poses = [*self.poses, pose][-most:], then publish Path(header=found.header, poses=self.poses).",
    ),
    scenarios=(
        Scenario(
            "public",
            seconds=4.0,  # [s]
            seed=1,
            inputs=(*driven(3.9),),
            checks=(
                expect_path(
                    TRAJECTORY,
                    count=40,
                    frame="world",
                    ends=((3.0 * cos(0.05), 3.0 * sin(0.05), 0.0), (3.0 * cos(3.85), 3.0 * sin(3.85), 0.0)),
                    tolerance=0.2,
                ).titled("the way from its beginning to now"),
                expect_rate(TRAJECTORY, 10.0),
            ),
        ),
    ),
)

PARAMS = Task(
    "week07.params",
    title="The parameters in a file",
    kind="function",
    name="robot_params",
    hints=(
        "A node's name, below it ros__parameters, below that its parameters. Indent by two spaces.",
        "Rates are floating point numbers: write 5.0. The number of points is an integer: write 50.",
        'Begin with "/**:\\n  ros__parameters:\\n    world_frame: odom\\n", then perception_node.',
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                expect_parameters("/perception_node", {"marker_update_rate": 5.0}),
                expect_parameters("/trajectory_node", {"trajectory_max_points": 50}),
            ),
        ),
    ),
    personal={"threshold": (0.55, 0.6, 0.65, 0.7, 0.75, 0.8)},
)

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
                expect_layout(fixed_frame="world"),
                expect_display("TF", properties={"Show Names": True}),
                expect_display("MarkerArray", MARKERS),
                expect_display("Path", PLAN),
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
        "One sentence of each kind: it publishes ..., I saw ..., because ..., somebody would miss ...",
    ),
    scenarios=(Scenario("public", checks=(Check("its length", words),)),),
    rubric=(
        Row("It is complete: nodes, topics and rates, measured", 5),
        Row("A fault: what was seen, and how its cause was found", 5),
        Row("A judgement: what somebody who watches a robot would miss, and why", 5),
    ),
)


def part_ahead(a: list[float], b: list[float]) -> Any:
    """The check's own answer, for edges whose ends are on two sides: where z is 0.1 m."""
    share = (0.1 - a[2]) / (b[2] - a[2])
    return [m + share * (n - m) for m, n in zip(a, b, strict=True)]


FRONT, BACK = [1.0, 0.5, 2.1], [0.0, 0.5, -1.9]

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
            calls=(Call(FRONT, BACK), Call([0.0, 0.0, -1.0], [1.0, 0.0, 0.05])),
            checks=(
                expect_value([FRONT, part_ahead(FRONT, BACK)], call=0, unit="m", name="the part"),
                expect_value([], call=1, name="the part of an edge behind the camera"),
            ),
        ),
    ),
)

TASKS = (BOX_ON_IMAGE, MARKERS_TASK, TRAJECTORY_TASK, PARAMS, LAYOUT, REPORT, PART_AHEAD)
