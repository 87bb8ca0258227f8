import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.robots.mobile_manipulator import mobile_manipulator
from course_lib.robots.robot import load_robot
from course_lib.robots.trajectory import SimulatedJoints


def ur10(**start: float) -> SimulatedJoints:
    return SimulatedJoints(mobile_manipulator().tree, {f"ur10{name}": p for name, p in start.items()})


def test_joints_within_limits_reach_their_commands() -> None:
    joints = ur10(elbow_joint=0.5)
    command = joints.positions + 0.01
    assert joints.follow(command, 0.02) == []
    assert joints.positions.tolist() == command.tolist()
    np.testing.assert_allclose(joints.velocities, 0.5, atol=1e-12)


def test_joint_velocity_is_limited_and_reported() -> None:
    joints = ur10()
    said = joints.follow(np.array([1.0, 0, 0, 0, 0, 0]), 0.02)
    assert said == ["Joint(s) [ur10shoulder_pan_joint] would exceed velocity limits, limiting"]
    assert joints.velocities[0] == pytest.approx(2.16)  # [rad/s]


def test_joints_stop_at_their_limits_and_report_it() -> None:
    joints = ur10(elbow_joint=3.14)
    said = joints.follow(np.array([0, 0, 3.2, 0, 0, 0]), 0.02)
    assert said == ["Joint(s) [ur10elbow_joint] would exceed position limits, limiting"]
    assert joints.positions[2] == pytest.approx(np.pi)


def test_invalid_start_is_rejected() -> None:
    with pytest.raises(CourseError, match=r"no joint 'ur10elbow', only ur10shoulder_pan_joint, "):
        ur10(elbow=1.0)
    with pytest.raises(
        CourseError, match=r"ur10elbow_joint cannot start at 4.0; its limits are -3.142 … 3.142"
    ):
        ur10(elbow_joint=4.0)
    with pytest.raises(CourseError, match="cannot start at nan"):
        ur10(elbow_joint=np.nan)


@pytest.mark.parametrize("name", ["panda", "tiago"])
def test_all_joints_except_mimic_joints_are_simulated(name: str) -> None:
    tree = load_robot(name).tree
    joints = SimulatedJoints(tree, {})
    mimics = [joint.name for joint in tree.joints.values() if joint.mimic]
    assert not set(mimics) & set(joints.names)
    assert np.isfinite(joints.speed).all()
