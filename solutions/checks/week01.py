"""Week 1, the first marker: hidden scenarios and checks."""

import math
from itertools import pairwise
from typing import Any

from course_lib.grading.evidence import Check, Evidence, Verdict, failed, passed
from course_lib.grading.task import Scenario, my
from course_lib.grading.vocabulary import (
    expect_circle,
    expect_marker,
    expect_marker_count,
    expect_message,
    expect_rate,
    expect_stamps,
)
from course_lib.grading.vocabulary.marker_state import no_markers, shown

TOPIC = "/visualization_marker"
LAMPS = (((1.0, 0.0, 0.0, 1.0), 1.8), ((1.0, 1.0, 0.0, 1.0), 1.3), ((0.0, 1.0, 0.0, 1.0), 0.8))  # RGBA, [m]
SIDE = 2.0  # [m] of the square


def steady(*checks: Check, hz: float, seconds: float, seed: int) -> tuple[Scenario, ...]:
    """A longer run with another seed, in which rate and stamps must hold too."""
    always = (expect_rate(TOPIC, hz), expect_stamps(TOPIC))
    return (Scenario("longer", seconds=seconds, seed=seed, checks=(*checks, *always)),)


def closed_square(evidence: Evidence) -> Verdict:
    """The line goes round the square: every piece is one side, and the last point is the first."""
    markers = shown(evidence, TOPIC)
    if not markers:
        problem = no_markers(evidence, TOPIC)
        return failed(problem.message, problem.mistake)
    for marker in markers:
        corners = [(point.x, point.y, point.z) for point in marker.points]
        if corners and _sides(corners) == [SIDE] * 4 and math.dist(corners[0], corners[-1]) < 0.01:
            return passed("as expected")
    mistake = "the points of the line do not go round the square side by side"
    return failed(mistake, mistake)


def _sides(corners: list[Any]) -> list[float]:
    """Lengths between neighbours, [m], to the centimetre."""
    return [round(math.dist(a, b), 2) for a, b in pairwise(corners)]


HIDDEN = {
    "week01.red_cube": steady(
        expect_marker(
            TOPIC,
            type="CUBE",
            frame="map",
            position=(0.0, 0.0, 0.5),
            scale=(1.0, 1.0, 1.0),
            color=(1.0, 0.0, 0.0, 0.8),
        ).worth(2),
        hz=1.0,
        seconds=10.0,
        seed=7,
    ),
    "week01.blue_cylinder": steady(
        expect_marker(
            TOPIC,
            type="CYLINDER",
            frame="map",
            position=(1.0, 0.0, my("height", times=0.5)),
            scale=(0.4, 0.4, my("height")),
            color=(0.0, 0.0, 1.0, 1.0),
        ).worth(2),
        hz=1.0,
        seconds=10.0,
        seed=11,
    ),
    "week01.traffic_light": steady(
        expect_marker_count(TOPIC, 3),
        *(
            expect_marker(
                TOPIC,
                type="SPHERE",
                ns="traffic_light",
                frame="map",
                position=(0.0, 0.0, height),
                scale=(0.4, 0.4, 0.4),
                color=color,
            )
            for color, height in LAMPS
        ),
        hz=1.0,
        seconds=10.0,
        seed=13,
    ),
    "week01.purple_circle": steady(
        expect_circle(TOPIC, radius=2.0, height=0.5, period=10.0, counter_clockwise=True).worth(2),
        expect_marker(TOPIC, type="SPHERE", frame="map", scale=(0.5, 0.5, 0.5), color=(1.0, 0.0, 1.0, 1.0)),
        expect_marker_count(TOPIC, 1),
        hz=10.0,
        seconds=25.0,
        seed=17,
    ),
    "week01.square_route": steady(
        Check("the line closes the square", closed_square).worth(2),
        expect_marker(TOPIC, type="LINE_STRIP", frame="map", position=(0.0, 0.0, 0.0)),
        expect_message(TOPIC, {"scale.x": 0.05, "color.a": 1.0}),
        hz=1.0,
        seconds=10.0,
        seed=19,
    ),
}
