import math
from collections.abc import Callable
from typing import Any

import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from course_lib.grading import (
    expect_joint_states,
    expect_joint_swing,
    expect_joints_still,
)
from course_lib.grading.evidence import Evidence

MakeEvidence = Callable[..., Evidence]
NAMES = ("pan", "lift")


def swing(amplitude: float = 0.5, hz: float = 0.5, phase: float = 0.0, middle: float = 0.2) -> list[Any]:
    """Four seconds of a joint that swings and one that stands, 50 times a second."""
    return [
        (
            0.02 * n + 0.02,
            "/joint_states",
            JointState(
                name=["lift", "pan"],
                position=[1.0, middle + amplitude * math.sin(2 * math.pi * hz * 0.02 * n + phase)],
            ),
        )
        for n in range(200)
    ]


SWING = expect_joint_swing("pan", amplitude=0.5, hz=0.5, middle=0.2)


def test_joints_in_any_order_pass_with_the_expected_swing(evidence: MakeEvidence) -> None:
    recorded = evidence(*swing())
    for check in (
        expect_joint_states(NAMES),
        SWING,
        expect_joint_swing("lift", amplitude=0.0, hz=0.0, middle=1.0),
    ):
        assert check.judge(recorded).message == "as expected"


def test_swing_time_may_start_one_period_before_the_first_message(evidence: MakeEvidence) -> None:
    assert SWING.judge(evidence(*swing(phase=2 * math.pi * 0.5 * 0.02))).message == "as expected"


@pytest.mark.parametrize(
    ("wrong", "message", "mistake"),
    [
        (
            {"amplitude": math.degrees(0.5)},
            "swings by 28.65 rad, expected 0.50 rad: is it in degrees instead of radians?",
            "amplitude",
        ),
        ({"amplitude": -0.5}, "phase error of 3.14 rad; half a turn means a wrong sign", "sign"),
        ({"phase": math.pi / 2}, "a phase error of 1.57 rad", "phase"),
        ({"hz": 1.0}, "pan swings 1.00 times a second, expected 0.50", "the frequency of a joint"),
        ({"hz": 0.5 / math.tau}, "pan swings 0.0796 times a second, expected 0.50", "the frequency"),
        ({"hz": 0.6}, "does not follow a sine at 0.50 Hz", "does not swing as expected"),
        ({"middle": 0.0}, "the middle of pan is 0.00 rad, expected 0.20 rad", "middle position"),
        ({"amplitude": 0.0}, "pan stands still, expected it to swing by 0.50 rad", "stands still"),
        ({"middle": math.nan}, "a position of pan is not finite", "not finite"),
    ],
)
def test_each_wrong_property_of_a_swing_is_reported(
    evidence: MakeEvidence, wrong: dict[str, float], message: str, mistake: str
) -> None:
    verdict = SWING.judge(evidence(*swing(**wrong)))
    assert message in verdict.message
    assert mistake in verdict.mistake


def test_single_message_is_neither_a_swing_nor_a_rest_position(evidence: MakeEvidence) -> None:
    for check in (SWING, expect_joint_swing("lift", amplitude=0.0, hz=0.0, middle=1.0)):
        verdict = check.judge(evidence(*swing()[-1:], seconds=4.0))
        assert (verdict.score, verdict.mistake) == (0, "a joint is not published all the time")


@pytest.mark.parametrize(("amplitude", "score"), [(0.5, 1), (28.6, 1), (0.0, 0)])
def test_swing_without_expected_amplitude_accepts_every_amplitude_except_0(
    evidence: MakeEvidence, amplitude: float, score: float
) -> None:
    check = expect_joint_swing("pan", amplitude=None, hz=0.5)
    assert check.judge(evidence(*swing(amplitude))).score == score


def test_moving_joint_is_reported_if_expected_to_stand_still(evidence: MakeEvidence) -> None:
    verdict = expect_joint_swing("pan", amplitude=0.0, hz=0.0, middle=0.2).judge(evidence(*swing()))
    assert verdict.message == "pan moves by 0.50 rad, expected it to stand still"


@pytest.mark.parametrize(
    ("state", "message"),
    [
        (
            JointState(name=["pan", "lft"], position=[0.0, 0.0]),
            "the robot has no joint lft; missing: lift",
        ),
        (JointState(name=["pan"], position=[0.0]), "a message lacks lift"),
        (JointState(name=["pan", "lift"], position=[0.0]), "has 2 names and 1 position"),
        (JointState(name=["pan", "lift"], position=[0.0, math.inf]), "a position is not finite"),
        (String(data="pan"), "a std_msgs/msg/String was published, expected sensor_msgs/msg/JointState"),
    ],
)
def test_malformed_joint_state_is_reported_with_its_time(
    evidence: MakeEvidence, state: Any, message: str
) -> None:
    verdict = expect_joint_states(NAMES).judge(evidence(*swing(), (5.0, "/joint_states", state)))
    assert verdict.message.startswith("after 5.00 s ")
    assert message in verdict.message


@pytest.mark.parametrize(("amplitude", "message"), [(0.5, "as expected"), (0.0, "no joint moves")])
def test_constant_positions_are_not_a_motion(evidence: MakeEvidence, amplitude: float, message: str) -> None:
    verdict = expect_joint_states(NAMES, moving=True).judge(evidence(*swing(amplitude)))
    assert verdict.message.startswith(message)


def test_positions_of_several_still_joints_are_checked_together(evidence: MakeEvidence) -> None:
    recorded = evidence(*swing(amplitude=0.0))
    assert expect_joints_still({"pan": 0.2, "lift": 1.0}).judge(recorded).message == "as expected"
    verdict = expect_joints_still({"pan": 0.2, "lift": 0.5, "knee": 0.0}).judge(recorded)
    assert "lift stands at 1.00 rad, expected 0.50 rad" in verdict.message
    assert "no position of knee was published on /joint_states" in verdict.message


def test_checks_fail_if_nothing_is_published(evidence: MakeEvidence) -> None:
    for check in (expect_joint_states(NAMES), SWING):
        assert "nothing was published on /joint_states" in check.judge(evidence()).message


def test_missing_joint_is_reported(evidence: MakeEvidence) -> None:
    verdict = expect_joint_swing("elbow", amplitude=0.5, hz=0.5).judge(evidence(*swing()))
    assert (
        "no position of elbow was published on /joint_states; the last message has lift, pan"
        in verdict.message
    )


@pytest.mark.parametrize("first", [0.5, 0.3])
def test_joint_with_several_positions_in_one_message_is_reported(
    evidence: MakeEvidence, first: float
) -> None:
    states = swing(first)
    for _, _, state in states:
        state.name = [*state.name, "pan", "pan"]
        state.position = [*state.position, 0.2, 0.9]
    recorded = evidence(*states)
    verdict = SWING.judge(recorded)
    assert verdict.score == 0
    assert "contains pan more than once" in verdict.message
    assert verdict.mistake == "a joint is named more than once"
    assert expect_joint_states(NAMES).judge(recorded).mistake == "a joint is named more than once"
    assert expect_joint_swing("lift", amplitude=0.0, hz=0.0, middle=1.0).judge(recorded).score == 1
