import numpy as np
import numpy.typing as npt
import pytest

from course_lib.errors import CourseError
from course_lib.robots.inverse_kinematics import joints_for
from course_lib.robots.kinematics import configuration, link_poses
from course_lib.robots.mobile_manipulator import START, mobile_manipulator
from course_lib.robots.robot import load_robot

WRIST = "ur10wrist_3_link"


@pytest.mark.parametrize(("name", "link"), [("ur10", "tool0"), ("panda", "panda_link8"), ("ur5", "ee_link")])
def test_the_joints_found_bring_the_link_there_by_pinocchio_to_1e_9(name: str, link: str) -> None:
    import pinocchio as pin

    robot, random = load_robot(name), np.random.default_rng(0)
    model, data = robot.model, robot.model.createData()
    for _ in range(20):
        lower, upper = np.maximum(model.lowerPositionLimit, -3), np.minimum(model.upperPositionLimit, 3)
        pin.framesForwardKinematics(model, data, random.uniform(lower, upper))
        goal = data.oMf[model.getFrameId(link)].homogeneous
        found = configuration(robot, joints_for(robot, link, goal))
        assert (found >= model.lowerPositionLimit).all()
        assert (found <= model.upperPositionLimit).all()
        pin.framesForwardKinematics(model, data, found)
        np.testing.assert_allclose(data.oMf[model.getFrameId(link)].homogeneous, goal, atol=1e-9)


def test_of_several_solutions_it_takes_one_near_the_start() -> None:
    robot = mobile_manipulator()
    goal = link_poses(robot, START)[WRIST]
    goal[2, 3] += 0.01  # [m]
    found = joints_for(robot, WRIST, goal, START)
    assert max(abs(found[name] - START.get(name, 0.0)) for name in found) < 0.05  # [rad]


def test_what_is_out_of_reach_says_how_near_it_comes() -> None:
    robot, goal = mobile_manipulator(), np.eye(4)
    goal[:3, 3] = 5.0, 0.0, 1.3  # [m]: more than 2.7 m beyond the reach of 1.3 m from (0.9, 0, 1.3)
    says = r"^ur10tool0 cannot be brought to \(5.00, 0.00, 1.30\) m in base_link.* is (2\.[7-9]|3\.)\d+ m"
    with pytest.raises(CourseError, match=says):
        joints_for(robot, "ur10tool0", goal)


@pytest.mark.parametrize("pose", [np.eye(3), np.diag([2.0, 1, 1, 1]), np.full((4, 4), np.nan)])
def test_a_pose_that_is_none_is_refused(pose: npt.NDArray[np.float64]) -> None:
    with pytest.raises(CourseError, match=r"is not a rigid transform of shape \(4, 4\), link to root"):
        joints_for(mobile_manipulator(), WRIST, pose)


def test_a_link_that_is_not_there_is_named() -> None:
    with pytest.raises(CourseError, match="'mobile_manipulator' has no link 'hand'"):
        joints_for(mobile_manipulator(), "hand", np.eye(4))
