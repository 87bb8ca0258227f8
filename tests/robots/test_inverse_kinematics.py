import numpy as np
import numpy.typing as npt
import pytest

from course_lib.errors import CourseError
from course_lib.robots.kinematics import (
    arm_of,
    configuration,
    joints_for,
    link_poses,
    motions_of,
    straight_line,
)
from course_lib.robots.mobile_manipulator import START, mobile_manipulator
from course_lib.robots.robot import load_robot
from course_lib.robots.urdf import MOVING
from tests.robots import by_pinocchio
from tests.robots.urdfs import ALL_KINDS, LIMIT, joint, links, robot

WRIST = "ur10wrist_3_link"
WIDE = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "link"), [("ur10", "tool0"), ("panda", "panda_link8"), ("ur5", "ee_link")])
def test_solution_reaches_the_pose_by_pinocchio_to_1e_9(name: str, link: str) -> None:
    robot, random = load_robot(name), np.random.default_rng(0)
    model = robot.model
    lower, upper = np.maximum(model.lowerPositionLimit, -3), np.minimum(model.upperPositionLimit, 3)
    for _ in range(20):
        chosen = dict(zip(model.names[1:], random.uniform(lower, upper).tolist(), strict=True))
        goal = by_pinocchio.link_poses(model, chosen)[link].homogeneous
        solution = joints_for(robot, link, goal)
        positions = by_pinocchio.configuration(model, solution)
        assert (positions >= model.lowerPositionLimit).all()
        assert (positions <= model.upperPositionLimit).all()
        reached = by_pinocchio.link_poses(model, solution)[link].homogeneous
        np.testing.assert_allclose(reached, goal, atol=1e-9)


@pytest.mark.slow
def test_jacobians_agree_with_pinocchio_for_every_link_of_each_kind_of_robot() -> None:
    pin, random = by_pinocchio.pin, np.random.default_rng(0)
    for name in ("ur10", "tiago", "solo12", "pr2"):
        robot = load_robot(name)
        model, joints = by_pinocchio.model_of(robot.urdf), motions_of(robot.tree).joints
        positions = {j.name: float(random.uniform(-3, 3)) for j in joints if j.kind in MOVING}
        data, values = model.createData(), by_pinocchio.configuration(model, positions)
        columns = {j.name: model.joints[model.getJointId(j.name)].idx_v for j in joints if j.kind in MOVING}
        for link in link_poses(robot):
            arm = arm_of(robot, link)
            jacobian = arm.jacobian(arm.poses(configuration(robot, positions)))
            frame = model.getFrameId(link, pin.FrameType.BODY)
            expected = pin.computeFrameJacobian(model, data, values, frame, pin.LOCAL)
            for index, one in enumerate(joints):
                column = expected[:, columns[one.name]] if one.name in columns else np.zeros(6)
                np.testing.assert_allclose(jacobian[:, index], column, rtol=0, atol=1e-9)


def test_solution_near_the_start_is_selected() -> None:
    robot = mobile_manipulator()
    goal = link_poses(robot, START)[WRIST]
    goal[2, 3] += 0.01  # [m]
    solution = joints_for(robot, WRIST, goal, START)
    assert max(abs(solution[name] - START.get(name, 0.0)) for name in solution) < 0.05  # [rad]


@pytest.mark.slow
def test_unreachable_pose_error_has_the_smallest_distance() -> None:
    robot, goal = mobile_manipulator(), np.eye(4)
    goal[:3, 3] = 5.0, 0.0, 1.3  # [m]: more than 2.7 m beyond the reach of 1.3 m from (0.9, 0, 1.3)
    says = r"^ur10tool0 cannot reach \(5.00, 0.00, 1.30\) m in base_link.* is (2\.[7-9]|3\.)\d+ m"
    with pytest.raises(CourseError, match=says):
        joints_for(robot, "ur10tool0", goal)


@pytest.mark.parametrize("pose", [np.eye(3), np.diag([2.0, 1, 1, 1]), np.full((4, 4), np.nan)])
def test_invalid_pose_is_rejected(pose: npt.NDArray[np.float64]) -> None:
    with pytest.raises(CourseError, match=r"is not a rigid transform of shape \(4, 4\), link to root"):
        joints_for(mobile_manipulator(), WRIST, pose)


def test_unknown_link_is_reported() -> None:
    with pytest.raises(CourseError, match="'mobile_manipulator' has no link 'hand'"):
        joints_for(mobile_manipulator(), "hand", np.eye(4))


def test_robot_with_wheels_and_unbounded_joints_can_solve_for_its_arm() -> None:
    robot = load_robot(ALL_KINDS)
    wanted = {"lift": 0.3}  # [m]
    solution = joints_for(robot, "finger", link_poses(robot, wanted)["finger"])
    assert {name: solution[name] for name in ("lift", "finger")} == pytest.approx(
        {"lift": 0.3, "finger": 1.1}
    )
    assert solution.keys() == {"drive", "lift", "finger", "thumb"}


# The middle joint drives the first one, backwards, and the last one, twice as far.
MIMICS = robot(
    links("base", "one", "two", "three"),
    joint("first", "base", "one", inner=WIDE + '<mimic joint="middle" multiplier="-0.5" offset="0.3"/>'),
    joint("middle", "one", "two", inner=WIDE + '<origin xyz="1 0 0"/><axis xyz="0 1 0"/>'),
    joint(
        "last",
        "two",
        "three",
        "prismatic",
        inner=LIMIT + '<origin xyz="0 0 1"/><mimic joint="middle" multiplier="2"/>',
    ),
)


@pytest.mark.slow
def test_mimic_joints_share_one_degree_of_freedom_with_their_joint() -> None:
    arm = load_robot(MIMICS)
    for middle in (-1.2, 0.0, 0.7):  # [rad]
        goal = link_poses(arm, {"middle": middle})["three"]
        solution = joints_for(arm, "three", goal, {"first": 0.1})
        assert solution == pytest.approx({"first": 0.3 - 0.5 * middle, "middle": middle, "last": 2 * middle})
        np.testing.assert_allclose(link_poses(arm, solution)["three"], goal, atol=1e-9)
    goal = link_poses(arm, {"middle": 0.5, "last": 0.5})["three"]  # no position of `middle` leads there
    with pytest.raises(CourseError, match="three cannot reach"):
        joints_for(arm, "three", goal)


def test_mimic_joints_move_as_in_the_pinocchio_model_with_mimic() -> None:
    follower = (
        WIDE + '<origin xyz="1 0 0"/><axis xyz="0 0 1"/><mimic joint="lead" multiplier="-2" offset="0.1"/>'
    )
    urdf = robot(
        links("base", "near", "far"),
        joint("lead", "base", "near", inner=WIDE + '<axis xyz="0 1 0"/>'),
        joint("follower", "near", "far", inner=follower),
    )
    model, position = by_pinocchio.pin.buildModelFromXML(urdf, mimic=True), 0.7  # [rad]
    data = model.createData()
    by_pinocchio.pin.framesForwardKinematics(model, data, np.array([position]))
    goal = data.oMf[model.getFrameId("far", by_pinocchio.pin.FrameType.BODY)].homogeneous
    solution = joints_for(load_robot(urdf), "far", goal)
    assert solution == pytest.approx({"lead": position, "follower": 0.1 - 2 * position})


def test_mimic_joint_outside_the_chain_follows_its_joint_unless_that_is_fixed() -> None:
    hand = robot(
        links("base", "left", "right", "stiff"),
        joint("left", "base", "left", "prismatic"),
        joint("right", "base", "right", "prismatic", LIMIT + '<mimic joint="left" multiplier="-1"/>'),
        joint("stiff", "right", "stiff", inner=LIMIT + '<mimic joint="glued" offset="0.2"/>'),
        links("cap"),
        joint("glued", "base", "cap", "fixed", ""),
    )
    arm, goal = load_robot(hand), link_poses(load_robot(hand), {"left": 0.4})["stiff"]
    assert joints_for(arm, "stiff", goal) == pytest.approx({"left": 0.4, "right": -0.4, "stiff": 0.2})


def test_trajectory_excludes_mimic_joints() -> None:
    start = {"drive": 0.0, "lift": 0.1}
    robot_of_all = load_robot(ALL_KINDS)
    goal = link_poses(robot_of_all, start)["mast"][:3, 3]
    assert straight_line(robot_of_all, "mast", start, goal, seconds=1.0).joint_names == ["drive", "lift"]


@pytest.mark.slow
def test_root_link_can_only_have_the_identity_pose() -> None:
    assert joints_for(load_robot("ur10"), "world", np.eye(4), {"elbow_joint": 0.5})["elbow_joint"] == 0.5
    with pytest.raises(CourseError, match="world cannot reach"):
        joints_for(load_robot("ur10"), "world", np.diag([-1.0, -1.0, 1.0, 1.0]))
