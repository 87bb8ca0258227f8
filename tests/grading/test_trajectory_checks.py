from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.grading import expect_trajectory
from course_lib.grading.evidence import Evidence

MakeEvidence = Callable[..., Evidence]
TOPIC = "/arm_controller/joint_trajectory"
CHECK = expect_trajectory(TOPIC, {"lift": 1.5, "elbow": 0.5}, at=1.0, seconds=3.0)


def sent(at: float = 1.0, names: tuple[str, ...] = ("elbow", "lift"), seconds: int = 3, **point: Any) -> Any:
    fields = {"positions": [0.5, 1.5], "velocities": [0.0, 0.0]} | point
    last = JointTrajectoryPoint(**fields)
    last.time_from_start.sec = seconds
    return (at, TOPIC, JointTrajectory(joint_names=list(names), points=[last]))


def test_joints_in_any_order_pass(evidence: MakeEvidence) -> None:
    assert CHECK.judge(evidence(sent())).message == "as expected"


@pytest.mark.parametrize(
    ("wrong", "message", "mistake"),
    [
        (
            sent(positions=[0.5, -1.5]),
            "lift goes to -1.50 rad, expected 1.50 rad",
            "a trajectory leads to the wrong position of a joint",
        ),
        (
            sent(names=("elbow", "shoulder")),
            "the controller rejects it: Incoming joint shoulder doesn't match the controller's joints.",
            "the controller rejects the trajectory",
        ),
        (
            sent(velocities=[]),
            "its last point has no velocities, so the arm would stop with a jerk",
            "a trajectory has no velocities",
        ),
        (
            sent(seconds=30),
            "its last point is reached after 30.00 s, expected 3.00 s",
            "the time of a trajectory is wrong",
        ),
        (
            sent(at=0.0),
            "the trajectory was published after 0.00 s, expected after 1.00 s",
            "a trajectory is sent at the wrong time",
        ),
    ],
)
def test_faults_of_a_trajectory_are_reported(
    evidence: MakeEvidence, wrong: Any, message: str, mistake: str
) -> None:
    verdict = CHECK.judge(evidence(wrong))
    assert (verdict.score, verdict.message, verdict.mistake) == (0.0, message, mistake)


def test_trajectory_stamp_before_1970_is_reported(evidence: MakeEvidence) -> None:
    at, topic, message = sent()
    message.header.stamp.sec = -1
    verdict = CHECK.judge(evidence((at, topic, message)))
    assert verdict.message == "the controller rejects it: Seconds value must not be negative"


def test_missing_trajectory_is_reported(evidence: MakeEvidence) -> None:
    assert "nothing was published on" in CHECK.judge(evidence()).message
    second = expect_trajectory(TOPIC, {"lift": 1.5, "elbow": 0.5}, index=1, at=1.0, seconds=3.0)
    assert "1 trajectory was published on" in second.judge(evidence(sent())).message


def test_extra_trajectories_or_missing_points_are_reported(evidence: MakeEvidence) -> None:
    goal = {"lift": 1.5, "elbow": 0.5}
    two = evidence(sent(), sent(at=2.0))
    only_one = expect_trajectory(TOPIC, goal, at=1.0, seconds=3.0, of=1)
    assert only_one.judge(two).message == f"2 trajectories were published on {TOPIC}, expected 1"
    of_two = expect_trajectory(TOPIC, goal, at=1.0, seconds=3.0, points=2)
    assert of_two.judge(two).message == "the trajectory has 1 point, expected 2"


def test_trajectory_that_no_controller_receives_is_reported(evidence: MakeEvidence) -> None:
    made = evidence(sent())
    samples = tuple(replace(one, qos=replace(one.qos, reliability="best_effort")) for one in made.samples)
    verdict = CHECK.judge(replace(made, samples=samples))
    assert (verdict.score, verdict.mistake) == (0.0, "a command is published with Best Effort")
    assert "receives nothing" in verdict.message
