from collections.abc import Callable
from math import pi
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.robots.joint_state_publisher import JointStatePublisher
from course_lib.robots.robot import load_robot
from course_lib.robots.robot_state_publisher import RobotStatePublisher
from course_lib.ros.graph import Graph
from tests.robots.urdfs import ALL_KINDS, ARM_2R, joint, links, robot

On = Callable[[str], list[Any]]
Run = Callable[..., None]


def limited(lower: float, upper: float, more: str = "") -> str:
    limit = f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'
    return robot(links("a", "b"), joint("j", "a", "b", inner=limit + more))


def test_it_publishes_all_moving_joints_ten_times_a_second(graph: Graph, on: On, run: Run) -> None:
    start_ns = graph.now_ns
    run(1.001, JointStatePublisher(ARM_2R))
    states = on("/joint_states")
    assert len(states) == 10
    assert states[0].name == ["shoulder", "elbow"]
    assert list(states[0].position) == [0.0, 0.0]
    assert Time.from_msg(states[0].header.stamp).nanoseconds == start_ns + 100_000_000


def test_the_rate_may_be_another(on: On, run: Run) -> None:
    run(1.001, JointStatePublisher(ARM_2R, rate=50))
    assert len(on("/joint_states")) == 50


@pytest.mark.parametrize("rate", [0, -1])
def test_a_rate_that_is_none_is_refused(rate: int, graph: Graph) -> None:
    with pytest.raises(CourseError, match=f"The rate is {rate}, expected one above 0"):
        JointStatePublisher(ARM_2R, rate=rate)
    assert graph.nodes() == []


@pytest.mark.parametrize(("lower", "upper", "start"), [(-1, 2, 0), (1, 2, 1.5), (-3, -2, -2.5), (0, 2, 0)])
def test_a_joint_begins_at_0_or_in_the_middle_of_limits_that_exclude_0(
    lower: float, upper: float, start: float, graph: Graph
) -> None:
    assert JointStatePublisher(limited(lower, upper)).joints["j"].position == start


def test_a_joint_begins_where_one_says(graph: Graph) -> None:
    assert JointStatePublisher(ARM_2R, zeros={"elbow": 0.5}).joints["elbow"].position == 0.5


def test_soft_limits_count_where_they_are_narrower(graph: Graph) -> None:
    soft = '<safety_controller k_velocity="1" soft_lower_limit="-5" soft_upper_limit="0.5"/>'
    j = JointStatePublisher(limited(-1, 1, soft)).joints["j"]
    assert (j.lower, j.upper) == (-1, 0.5)


def test_a_continuous_joint_goes_once_around(graph: Graph) -> None:
    wheel = JointStatePublisher(ALL_KINDS).joints["drive"]
    assert (wheel.lower, wheel.upper, wheel.unit) == (-pi, pi, "rad")


def test_mimic_joints_follow_through_chains_and_are_not_set(on: On, run: Run) -> None:
    node = JointStatePublisher(ALL_KINDS)
    assert list(node.joints) == ["drive", "lift"]
    node.joints["lift"].position = 0.25
    run(0.11, node)
    (state,) = on("/joint_states")
    assert dict(zip(state.name, state.position, strict=True)) == {
        "drive": 0.0, "lift": 0.25, "finger": 1.0, "thumb": -1.0,
    }  # fmt: skip


def test_it_waits_for_the_description_and_says_so(on: On, run: Run) -> None:
    node = JointStatePublisher()
    run(0.5, node)
    assert on("/joint_states") == []
    assert [m.msg for m in on("/rosout")] == [
        "Waiting for robot_description to be published on the robot_description topic..."
    ]
    run(0.2, node, RobotStatePublisher(ARM_2R))
    assert on("/joint_states")[-1].name == ["shoulder", "elbow"]


def test_a_description_that_is_none_is_logged_and_the_former_robot_goes_on(on: On, run: Run) -> None:
    node, other = JointStatePublisher(ARM_2R), Node("other")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    other.create_publisher(String, "/robot_description", latched).publish(String(data="<robot"))
    run(0.2, node, other)
    assert "The URDF is not XML" in on("/rosout")[-1].msg
    assert on("/joint_states")[-1].name == ["shoulder", "elbow"]


def test_a_joint_without_limits_is_refused_with_ross_text(graph: Graph) -> None:
    no_upper = robot(
        links("a", "b"), joint("j", "a", "b", inner='<limit lower="0" effort="1" velocity="1"/>')
    )
    with pytest.raises(CourseError, match='"upper" limit must be specified for joint "j" of type "revolute"'):
        JointStatePublisher(no_upper)


def test_both_publishers_together_show_a_whole_panda(on: On, run: Run) -> None:
    urdf = load_robot("panda").urdf
    run(1.0, JointStatePublisher(urdf), RobotStatePublisher(urdf))
    moved = {t.child_frame_id for message in on("/tf") + on("/tf_static") for t in message.transforms}
    assert len(moved) == 12
