import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from course_lib.grading import expect_circle
from course_lib.grading.evidence import Evidence

MakeEvidence = Callable[..., Evidence]
MakeCube = Callable[..., Any]
MakeRound = Callable[..., Evidence]

TOPIC = "/ball"
CIRCLE = expect_circle(TOPIC, radius=2.0, height=1.0, period=10.0, counter_clockwise=True)


@pytest.fixture
def going_round(evidence: MakeEvidence, cube: MakeCube) -> MakeRound:
    def make(
        radius: float = 2.0,
        height: float = 1.0,
        period: float = 10.0,
        seconds: float = 4.0,
        alpha: float = 1.0,
    ) -> Evidence:
        rows = []
        for tick in range(round(seconds * 10)):
            angle = math.tau * tick / 10 / period
            x, y = radius * math.cos(angle), radius * math.sin(angle)
            marker = cube(pose__position__x=x, pose__position__y=y, pose__position__z=height)
            marker.color.a = alpha
            rows.append((tick / 10, TOPIC, marker))
        return evidence(*rows, seconds=seconds)

    return make


def test_requested_circle_passes(going_round: MakeRound) -> None:
    assert CIRCLE.judge(going_round()).score == 1


@pytest.mark.parametrize(
    ("changes", "message", "mistake"),
    [
        ({"radius": 1.0}, "1.00 m too far in", "the path leaves the circle: wrong radius or centre"),
        ({"height": 0.5}, "the marker is 0.50 m too low", "the path is at the wrong height"),
        ({"period": -10.0}, "the marker goes clockwise (from above)", "the direction of turning is wrong"),
        ({"period": 5.0}, "one turn takes 5.00 s, expected 10.00 s: 5.00 s too fast", "the time of one turn"),
        (
            {"period": 0.23},
            "the marker jumps by 157° from one message to the next: are degrees",
            "an angle jumps",
        ),
        ({"period": 1e9}, "the marker stands still", "a marker does not move as expected"),
        ({"radius": math.nan}, "not a number", "the path leaves the circle"),
    ],
)
def test_faults_of_a_circular_motion_are_reported(
    going_round: MakeRound, changes: dict[str, float], message: str, mistake: str
) -> None:
    verdict = CIRCLE.judge(going_round(**changes))
    assert verdict.score == 0
    assert message in verdict.message
    assert verdict.mistake.startswith(mistake)


def moved(evidence: MakeEvidence, cube: MakeCube, angles: list[float]) -> Evidence:
    """Return the evidence of a marker at these angles [rad], one in each 0.1 s."""
    rows = []
    for tick, angle in enumerate(angles):
        x, y = 2.0 * math.cos(angle), 2.0 * math.sin(angle)
        marker = cube(pose__position__x=x, pose__position__y=y, pose__position__z=1.0)
        rows.append((tick / 10, TOPIC, marker))
    return evidence(*rows, seconds=len(angles) / 10)


def test_motion_in_steps_fails_the_check_of_the_period(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = CIRCLE.judge(moved(evidence, cube, [tick // 10 * math.tau / 10 for tick in range(101)]))
    assert verdict.message == (
        "the marker does not move in 90 of 100 messages, and jumps by 36° in others, expected an even motion"
    )


def test_single_jump_is_not_taken_for_degrees(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = CIRCLE.judge(moved(evidence, cube, [tick * math.tau / 100 % math.pi for tick in range(80)]))
    assert verdict.mistake == "an angle is set back"
    assert verdict.message.startswith("the marker jumps by 176° from one message to the next, after 5.00 s")


def test_circle_without_a_period_needs_half_a_turn(going_round: MakeRound) -> None:
    check = expect_circle(TOPIC, radius=2.0)
    assert check.judge(going_round(seconds=6.0)).score == 1
    assert "turns by only" in check.judge(going_round(seconds=2.0)).message


def test_other_marker_is_not_judged_by_the_circle_check(going_round: MakeRound) -> None:
    verdict = expect_circle(TOPIC, radius=2.0, type="SPHERE").judge(going_round())
    assert verdict.message == "no marker with type 'SPHERE' was added on /ball"


def test_invisible_marker_fails_the_circle_check(going_round: MakeRound) -> None:
    verdict = CIRCLE.judge(going_round(alpha=0.0))
    assert (verdict.score, verdict.message) == (0, "the marker is invisible: color.a is 0")


def test_motion_in_only_a_short_time_range_fails_the_circle_check(going_round: MakeRound) -> None:
    evidence = going_round(seconds=4.0)
    piece = replace(evidence, samples=evidence.samples[-5:])
    assert CIRCLE.judge(piece).message == "the marker moves for only 0.40 s of 4 s"


def test_circle_check_without_a_height_requires_constant_height(
    evidence: MakeEvidence, cube: MakeCube
) -> None:
    check = expect_circle(TOPIC, radius=1.0)

    def at(tick: int, height: float) -> tuple[float, str, Any]:
        x, y = math.cos(tick), math.sin(tick)
        return tick, TOPIC, cube(pose__position__x=x, pose__position__y=y, pose__position__z=height)

    assert check.judge(evidence(*(at(tick, 2.0) for tick in range(5)))).score == 1
    assert "moves up and down" in check.judge(evidence(*(at(tick, float(tick)) for tick in range(5)))).message
    assert check.judge(evidence(*(at(tick, math.nan) for tick in range(5)))).score == 0
