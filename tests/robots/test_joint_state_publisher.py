from collections.abc import Callable
from math import pi
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.robots.robot import load_robot
from course_lib.robots.state_publishers import JointStatePublisher, RobotStatePublisher
from course_lib.ros.graph.graph import Graph
from tests.robots.urdfs import ALL_KINDS, ARM_2R, joint, links, robot

On = Callable[[str], list[Any]]
Run = Callable[..., None]


def limited(lower: float, upper: float, more: str = "") -> str:
    limit = f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'
    return robot(links("a", "b"), joint("j", "a", "b", inner=limit + more))


def test_all_movable_joints_are_published_ten_times_a_second(graph: Graph, on: On, run: Run) -> None:
    start_ns = graph.now_ns
    run(1.001, JointStatePublisher(ARM_2R))
    states = on("/joint_states")
    assert len(states) == 10
    assert states[0].name == ["shoulder", "elbow"]
    assert list(states[0].position) == [0.0, 0.0]
    assert Time.from_msg(states[0].header.stamp).nanoseconds == start_ns + 100_000_000


def test_rate_is_configurable(on: On, run: Run) -> None:
    run(1.001, JointStatePublisher(ARM_2R, rate=50))
    assert len(on("/joint_states")) == 50


@pytest.mark.parametrize("rate", [0, -1])
def test_invalid_rate_is_rejected(rate: int, graph: Graph) -> None:
    with pytest.raises(CourseError, match=f"The rate is {rate}, expected a positive number"):
        JointStatePublisher(ARM_2R, rate=rate)
    assert graph.nodes() == []


@pytest.mark.parametrize(("lower", "upper", "start"), [(-1, 2, 0), (1, 2, 1.5), (-3, -2, -2.5), (0, 2, 0)])
def test_joint_starts_at_0_or_in_the_middle_of_limits_that_exclude_0(
    lower: float, upper: float, start: float, graph: Graph
) -> None:
    assert JointStatePublisher(limited(lower, upper)).joints["j"].position == start


def test_joint_starts_at_its_configured_position(graph: Graph) -> None:
    assert JointStatePublisher(ARM_2R, zeros={"elbow": 0.5}).joints["elbow"].position == 0.5


def test_soft_limits_apply_if_they_are_narrower(graph: Graph) -> None:
    soft = '<safety_controller k_velocity="1" soft_lower_limit="-5" soft_upper_limit="0.5"/>'
    j = JointStatePublisher(limited(-1, 1, soft)).joints["j"]
    assert (j.lower, j.upper) == (-1, 0.5)


def test_continuous_joint_slider_covers_one_turn(graph: Graph) -> None:
    wheel = JointStatePublisher(ALL_KINDS).joints["drive"]
    assert (wheel.lower, wheel.upper, wheel.unit) == (-pi, pi, "rad")


def test_mimic_joints_follow_through_chains_and_cannot_be_set(on: On, run: Run) -> None:
    node = JointStatePublisher(ALL_KINDS)
    assert list(node.joints) == ["drive", "lift"]
    node.joints["lift"].position = 0.25
    run(0.11, node)
    (state,) = on("/joint_states")
    assert dict(zip(state.name, state.position, strict=True)) == {
        "drive": 0.0, "lift": 0.25, "finger": 1.0, "thumb": -1.0,
    }  # fmt: skip


def test_waiting_for_the_description_is_logged(on: On, run: Run) -> None:
    node = JointStatePublisher()
    run(0.5, node)
    assert on("/joint_states") == []
    assert [m.msg for m in on("/rosout")] == [
        "Waiting for robot_description to be published on the robot_description topic..."
    ]
    run(0.2, node, RobotStatePublisher(ARM_2R))
    assert on("/joint_states")[-1].name == ["shoulder", "elbow"]


def test_invalid_description_is_logged_and_the_previous_robot_kept(on: On, run: Run) -> None:
    node, other = JointStatePublisher(ARM_2R), Node("other")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    other.create_publisher(String, "/robot_description", latched).publish(String(data="<robot"))
    run(0.2, node, other)
    assert "The URDF is not XML" in on("/rosout")[-1].msg
    assert on("/joint_states")[-1].name == ["shoulder", "elbow"]


def test_joint_without_limits_is_rejected_with_the_text_of_ros(graph: Graph) -> None:
    no_upper = robot(
        links("a", "b"), joint("j", "a", "b", inner='<limit lower="0" effort="1" velocity="1"/>')
    )
    with pytest.raises(CourseError, match='"upper" limit must be specified for joint "j" of type "revolute"'):
        JointStatePublisher(no_upper)


def test_joint_and_robot_state_publishers_show_a_complete_panda(on: On, run: Run) -> None:
    urdf = load_robot("panda").urdf
    run(1.0, JointStatePublisher(urdf), RobotStatePublisher(urdf))
    moved = {t.child_frame_id for message in on("/tf") + on("/tf_static") for t in message.transforms}
    assert len(moved) == 12


COUPLED = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="arm" type="revolute"><parent link="a"/><child link="b"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/><safety_controller soft_lower_limit="-0.2"
soft_upper_limit="0.2" k_velocity="1"/></joint>
<joint name="wheel" type="continuous"><parent link="a"/><child link="c"/></joint>
<joint name="mimic" type="revolute"><parent link="a"/><child link="d"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="arm" multiplier="-2" offset="0.5"/></joint>
</robot>"""


@pytest.mark.parametrize(
    ("parameters", "position", "velocity", "effort"),
    [
        ({}, [0.0, 0.0, 0.5], [], []),
        ({"zeros.arm": 1, "zeros.wheel": 0.5}, [1.0, 0.5, -1.5], [], []),
        ({"publish_default_velocities": True}, [0.0, 0.0, 0.5], [0.0] * 3, []),
        ({"publish_default_efforts": True}, [0.0, 0.0, 0.5], [], [0.0] * 3),
        ({"publish_default_positions": False}, [0.0, 0.0, 0.0], [], []),
        ({"publish_default_positions": False, "use_mimic_tags": False}, [], [], []),
        ({"use_mimic_tags": False}, [0.0, 0.0, 0.0], [], []),
        ({"source_list": ["driver"]}, [0.0, 0.25, 0.5], [0.0, 3.0, 0.0], []),
        ({"delta": 0.15}, [0.15, 0.15, 0.2], [], []),
        ({"dependent_joints.wheel.parent": "arm"}, [0.0, 0.0, 0.5], [], []),
    ],
)
def test_parameters_have_the_same_effect_as_in_the_ros_node(
    on: On,
    run: Run,
    parameters: dict[str, Any],
    position: list[float],
    velocity: list[float],
    effort: list[float],
) -> None:
    overrides = [Parameter(name, value=value) for name, value in parameters.items()]
    node = JointStatePublisher(COUPLED, parameter_overrides=overrides)
    driver = Node("driver")
    publisher = driver.create_publisher(JointState, "driver", 10)
    publisher.publish(JointState(name=["wheel", "other"], position=[0.25, 9.0], velocity=[3.0, 9.0]))
    run(0.101, node, driver)
    (state,) = on("/joint_states")
    assert list(state.name) == ["arm", "wheel", "mimic"]
    assert [list(values) for values in (state.position, state.velocity, state.effort)] == [
        pytest.approx(position),
        velocity,
        effort,
    ]


def test_parameter_changed_after_the_start_has_no_effect_as_in_ros(on: On, run: Run) -> None:
    node = JointStatePublisher(COUPLED)
    node.set_parameters([Parameter("delta", value=0.15), Parameter("use_mimic_tags", value=False)])
    node.set_description(COUPLED)
    run(0.101, node)
    (state,) = on("/joint_states")
    assert list(state.position) == [0.0, 0.0, 0.5]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("dependent_joints.wheel.factor", "must at least have a parent"),
        ("dependent_joints.wheel.ratio", r"'ratio' \(allowed values are 'parent', 'factor', 'offset'\)"),
    ],
)
def test_wrong_dependent_joints_are_rejected(graph: Graph, name: str, message: str) -> None:
    with pytest.raises(CourseError, match=message):
        JointStatePublisher(COUPLED, parameter_overrides=[Parameter(name, value=2.0)])
