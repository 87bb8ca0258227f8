"""A submission of all possible answers gets fewer points than the right answer."""

from collections.abc import Callable, Sequence
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.grading import (
    Evidence,
    expect_joint_states,
    expect_joints_still,
    expect_level,
    expect_parameters,
    expect_path,
    expect_text,
    expect_trajectory,
    expect_value,
)

MakeEvidence = Callable[..., Evidence]
EVERY = (0.3, 0.45, 0.6)


def test_joint_published_at_every_position_fails_the_still_check(evidence: MakeEvidence) -> None:
    def published(*positions: float) -> Evidence:
        rows = [(at / 10, p) for at in range(1, 31) for p in positions]
        return evidence(*((s, "/joint_states", JointState(name=["elbow"], position=[p])) for s, p in rows))

    check = expect_joints_still({"elbow": 0.45})
    assert check.judge(published(0.45)).score == 1
    assert check.judge(published(*EVERY)).score == 0


def test_joint_states_of_several_robots_fail_the_check_for_one_robot(evidence: MakeEvidence) -> None:
    state = JointState(name=["elbow", "other"], position=[0.0, 0.0])
    assert expect_joint_states(["elbow"]).judge(evidence((1.0, "/joint_states", state))).score == 0


def test_several_levels_at_one_time_fail_the_level_check(evidence: MakeEvidence) -> None:
    def published(levels: Sequence[bytes]) -> Evidence:
        arrays = [DiagnosticArray(status=[DiagnosticStatus(level=one, message="normal")]) for one in levels]
        return evidence(*((s, "/diagnostics", array) for s in (1.0, 2.0, 3.0) for array in arrays))

    check = expect_level("OK", says="normal", begin=0.0, end=3.0)
    assert check.judge(published([DiagnosticStatus.OK])).score == 1
    assert check.judge(published([DiagnosticStatus.OK, DiagnosticStatus.WARN])).score == 0


def trajectory(lift: float) -> Any:
    point = JointTrajectoryPoint(positions=[lift], velocities=[0.0])
    point.time_from_start.sec = 3
    return JointTrajectory(joint_names=["lift"], points=[point])


def test_trajectories_to_every_position_fail_the_check(evidence: MakeEvidence) -> None:
    check = expect_trajectory("/arm", {"lift": 0.45}, at=1.0, seconds=3.0, of=1)
    assert check.judge(evidence((1.0, "/arm", trajectory(0.45)))).score == 1
    several = evidence(*((1.0, "/arm", trajectory(lift)) for lift in EVERY))
    assert check.judge(several).message == "3 trajectories were published on /arm, expected 1"


def test_path_properties_must_be_satisfied_by_a_single_path(evidence: MakeEvidence) -> None:
    def path(length: float, frame: str = "map") -> Any:
        header = Header(frame_id=frame)
        message = Path(header=header, poses=[PoseStamped(header=header), PoseStamped(header=header)])
        message.poses[1].pose.position.x = length
        return message

    check = expect_path("/plan", count=2, frame="map", ends=((0, 0, 0), (2, 0, 0)))
    assert check.judge(evidence((1.0, "/plan", path(2.0)))).score == 1
    assert check.judge(evidence((1.0, "/plan", path(2.0, "odom")), (1.0, "/plan", path(3.0)))).score == 0


def handed_in(value: Any) -> Evidence:
    return Evidence("week01.demo", "public", 0.0, returns=(value,))


def test_text_listing_every_answer_fails_the_check() -> None:
    check = expect_text("fixed frame", but_not=("target frame",))
    assert check.judge(handed_in("It is the Fixed Frame.")).score == 1
    verdict = check.judge(handed_in("fixed frame, target frame"))
    assert verdict.mistake == "the answer is not right"
    assert "'target frame' is not right, give one answer" in verdict.message


def test_list_of_every_value_fails_the_value_check() -> None:
    assert expect_value(0.45).judge(handed_in(0.45)).score == 1
    assert expect_value(0.45).judge(handed_in(list(EVERY))).score == 0


def test_last_repeated_parameter_value_overrides_earlier_values() -> None:
    check = expect_parameters("/node", {"rate": 0.45})
    text = "/**: {ros__parameters: {rate: 0.45}}\n"
    assert check.judge(handed_in(text)).score == 1
    assert check.judge(handed_in(text + "node: {ros__parameters: {rate: 0.6}}\n")).score == 0
