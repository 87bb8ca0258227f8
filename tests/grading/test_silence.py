"""A topic may be silent for as long as its rate allows, at the beginning, in between and at the end."""

from collections.abc import Callable

import pytest
from visualization_msgs.msg import Marker

from course_lib.grading import (
    Check,
    Evidence,
    expect_circle,
    expect_joint_swing,
    expect_rate,
    expect_throughout,
)
from course_lib.grading.evidence import all_checks
from tests.grading.test_marker_binding import judge_messages, marker, red_cube

MakeEvidence = Callable[..., Evidence]
Publish = Callable[[float], bool]
T = "/tick"


def ticks(evidence: MakeEvidence, times: list[float], seconds: float, *checks: Check) -> Evidence:
    from std_msgs.msg import String

    return evidence(*((at, T, String()) for at in times), seconds=seconds, checks=all_checks(checks))


def every(period: float, begin: float, end: float) -> list[float]:
    return [begin + step * period for step in range(round((end - begin) / period) + 1)]


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (every(1.0, 1.0, 10.0), "as expected"),
        (every(1.0, 2.0, 8.0), "as expected"),
        (every(1.0, 1.0, 7.0), "/tick is silent from 7.00 s to 10.00 s"),
        (every(1.0, 3.0, 10.0), "/tick is silent from 0.00 s to 3.00 s"),
        ([*every(1.0, 1.0, 4.0), *every(1.0, 7.0, 10.0)], "/tick is silent from 4.00 s to 7.00 s"),
    ],
)
def test_silence_longer_than_two_periods_is_detected(
    evidence: MakeEvidence, times: list[float], message: str
) -> None:
    given, bare = expect_throughout(T, hz=1.0), expect_throughout(T)
    assert given.judge(ticks(evidence, times, 10.0)).message.startswith(message)
    stated = ticks(evidence, times, 10.0, bare, expect_rate(T, 1.0))
    assert bare.judge(stated).message.startswith(message)
    # Without a stated rate, the usual time between two messages counts.
    assert bare.judge(ticks(evidence, times, 10.0)).message.startswith(message)


def test_lowest_expected_rate_determines_the_allowed_silence(evidence: MakeEvidence) -> None:
    times, bare = [*every(0.1, 0.1, 3.0), *every(1.0, 4.0, 10.0)], expect_throughout(T)
    slower = expect_rate(T, 1.0, begin=3.0)
    rated = ticks(evidence, times, 10.0, bare, expect_rate(T, 10.0, end=3.0), slower)
    assert bare.judge(rated).message == "as expected"
    assert bare.judge(ticks(evidence, times, 10.0, bare, expect_rate(T, 10.0))).score == 0


def test_topic_may_be_silent_until_it_is_expected(evidence: MakeEvidence) -> None:
    late = every(0.1, 1.1, 5.0)
    assert expect_throughout(T, hz=10.0, begin=1.1).judge(ticks(evidence, late, 5.0)).score == 1
    assert expect_throughout(T, hz=10.0).judge(ticks(evidence, late, 5.0)).score == 0
    bare = expect_throughout(T)
    assert bare.judge(ticks(evidence, late, 5.0, bare, expect_rate(T, 10.0, begin=1.1))).score == 1
    assert expect_throughout(T, hz=10.0, begin=1.1, end=3.0).judge(ticks(evidence, late[:22], 5.0)).score == 1


def test_node_that_stops_publishing_fails_its_content_checks() -> None:
    assert judge_messages("week01.red_cube", lambda _: [red_cube()]).score == 15
    result = judge_messages("week01.red_cube", lambda at: [red_cube()] if at <= 7 else [])
    hidden = [check for check in result.checks if check.is_hidden and check.weight]
    assert hidden
    assert result.score <= 11
    assert "a topic is not published all the time" in {check.mistake for check in result.checks}


def test_motion_that_stops_early_is_detected(evidence: MakeEvidence) -> None:
    import math

    from sensor_msgs.msg import JointState

    def sphere(at: float) -> object:
        angle = at * math.tau / 10
        place = (2 * math.cos(angle), 2 * math.sin(angle), 0.5)
        return marker(Marker.SPHERE, place, (0.5, 0.5, 0.5), (1, 0, 1, 1))

    def state(at: float) -> object:
        return JointState(name=["elbow"], position=[math.sin(math.tau * 0.5 * (at - 0.1))])

    for make, topic, check in (
        (sphere, T, expect_circle(T, radius=2.0, height=0.5, period=10.0)),
        (state, "/joint_states", expect_joint_swing("elbow", amplitude=1.0, hz=0.5)),
    ):
        rows = [(at, topic, make(at)) for at in every(0.1, 0.1, 10.0)]
        assert check.judge(evidence(*rows, seconds=10.0)).message == "as expected"
        assert "is silent from 7.00 s to 10.00 s" in check.judge(evidence(*rows[:70], seconds=10.0)).message
        gap = [*rows[:40], *rows[45:]]
        assert "is silent from 4.00 s to 4.60 s" in check.judge(evidence(*gap, seconds=10.0)).message
