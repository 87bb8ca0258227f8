from collections.abc import Callable
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from sensor_msgs.msg import JointState

from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import load_robot
from course_lib.robots.state_publishers import RobotStatePublisher
from course_lib.ros.graph.graph import Graph
from course_lib.ros.tf2 import Transform
from tests.robots.urdfs import ALL_KINDS, ARM_2R

On = Callable[[str], list[Any]]
Run = Callable[..., None]
Rows = list[tuple[str, str]]


class Joints(Node):
    """Publishes given joint states."""

    def __init__(self) -> None:
        super().__init__("joints")
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)

    def say(self, positions: dict[str, float], stamp_ns: int | None = None) -> None:
        state = JointState(name=list(positions), position=list(positions.values()))
        now = self.get_clock().now() if stamp_ns is None else Time(nanoseconds=stamp_ns)
        state.header.stamp = now.to_msg()
        self.publisher.publish(state)


def frames(message: Any) -> Rows:
    return [(t.header.frame_id, t.child_frame_id) for t in message.transforms]


def matrices(message: Any) -> dict[str, Any]:
    found = {}
    for t in message.transforms:
        place, turn = t.transform.translation, t.transform.rotation
        pose = ((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
        found[t.child_frame_id] = Transform("", "", 0, *pose).matrix()
    return found


def test_node_has_the_interfaces_of_the_ros_node(graph: Graph) -> None:
    node = RobotStatePublisher(ARM_2R)
    for topic, type_name in {
        "/tf": "TFMessage",
        "/tf_static": "TFMessage",
        "/robot_description": "String",
    }.items():
        (found,) = node.get_publishers_info_by_topic(topic)
        assert (found.node_name, found.topic_type.split("/")[2]) == (node.get_name(), type_name)


def test_late_joining_subscription_receives_description_and_static_transforms(graph: Graph) -> None:
    RobotStatePublisher(ARM_2R)
    kept = {sample.topic for sample in graph.latched_samples()}
    assert kept == {"/rosout", "/robot_description", "/tf_static"}


def test_movable_joints_are_published_on_tf_with_the_stamp_of_the_joint_state(
    graph: Graph, on: On, run: Run
) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    stamp_ns = graph.now_ns - 123
    joints.say({"shoulder": 0.3, "elbow": -0.2}, stamp_ns)
    run(0.1, node, joints)
    (message,) = on("/tf")
    assert frames(message) == [("upper", "fore"), ("base", "upper")]  # by the names of the joints
    assert {Time.from_msg(t.header.stamp).nanoseconds for t in message.transforms} == {stamp_ns}


def test_fixed_joints_are_published_on_tf_static_once(graph: Graph, on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ALL_KINDS), Joints()
    joints.say({"drive": 1.0})
    run(1.0, node, joints)
    (message,) = on("/tf_static")
    assert frames(message) == [("balloon", "lamp"), ("base", "plate")]  # floating joints are left out
    np.testing.assert_allclose(matrices(message)["plate"][:3, 3], [0, 0, 1])


@pytest.mark.parametrize("name", ["ur10", "panda", "tiago"])
def test_all_transforms_together_agree_with_pinocchio_link_poses(name: str, on: On, run: Run) -> None:
    robot, random = load_robot(name), np.random.default_rng(1)
    free = [j for j in robot.tree.joints.values() if j.kind != "fixed" and not j.mimic]
    positions = {j.name: float(random.uniform(-1.5, 1.5)) for j in free}
    node, joints = RobotStatePublisher(robot.urdf), Joints()
    joints.say(positions)
    run(0.1, node, joints)
    step = matrices(on("/tf")[0]) | matrices(on("/tf_static")[0])
    parents = {j.child: j.parent for j in robot.tree.joints.values()}
    for link, transform_link_to_root in link_poses(robot, positions).items():
        chained, at = np.eye(4), link
        while at in parents:
            chained, at = step[at] @ chained, parents[at]
        np.testing.assert_allclose(transform_link_to_root, chained, atol=1e-9)


def test_complete_messages_are_published_at_most_20_times_a_second(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    joints.create_timer(0.02, lambda: joints.say({"shoulder": 0.0, "elbow": 0.0}))  # 50 Hz
    run(1.001, node, joints)
    assert len(on("/tf")) == 17  # every third: 60 ms is the first multiple of 20 ms that is 50 ms at least


@pytest.mark.parametrize(("frequency", "count"), [(1000.0, 50), (0.0, 50), (50.0, 50), (5.0, 5), (30.0, 25)])
def test_publish_frequency_is_a_limit(frequency: float, count: int, on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R, publish_frequency=frequency), Joints()
    joints.create_timer(0.02, lambda: joints.say({"shoulder": 0.0, "elbow": 0.0}))
    run(1.001, node, joints)
    assert len(on("/tf")) == count


def test_newly_received_joint_is_published_immediately(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    joints.say({"shoulder": 0.0})
    joints.say({"elbow": 0.0})
    joints.say({"shoulder": 0.1})
    run(0.1, node, joints)
    assert [frames(m) for m in on("/tf")] == [[("base", "upper")], [("upper", "fore")]]


def test_message_without_a_stamp_is_ignored_unless_timestamps_are_ignored(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    joints.say({"shoulder": 0.0}, stamp_ns=0)
    run(0.1, node, joints)
    assert on("/tf") == []
    node.destroy_node()
    lenient = RobotStatePublisher(ARM_2R, ignore_timestamp=True)
    joints.say({"shoulder": 0.0}, stamp_ns=0)
    run(0.1, lenient, joints)
    assert len(on("/tf")) == 1


def test_frame_names_have_the_prefix(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R, frame_prefix="left/"), Joints()
    joints.say({"shoulder": 0.0})
    run(0.1, node, joints)
    assert frames(on("/tf")[0]) == [("left/base", "left/upper")]
    assert frames(on("/tf_static")[0]) == [("left/fore", "left/tip")]


def test_unknown_and_fixed_joints_are_ignored_silently(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    joints.say({"tail": 1.0, "tip_joint": 1.0, "elbow": 0.5})
    joints.say({"tail": 1.0}, stamp_ns=joints.get_clock().now().nanoseconds + 10**9)
    run(0.1, node, joints)
    assert [frames(m) for m in on("/tf")] == [[("upper", "fore")], []]
    assert [m.msg for m in on("/rosout")] == ["Robot initialized"]


@pytest.mark.parametrize(
    ("positions", "stamp_ns", "hint"),
    [
        ({"sholder": 0.1}, None, "names sholder, which the robot does not have: did you mean shoulder?"),
        ({"upper": 0.1}, None, "names upper, which is a link: its joint is shoulder."),
        ({"shoulder": 45.0}, None, "moves shoulder to 45: positions are in radians, 90° is 1.5708."),
        ({"shoulder": 0.1}, 0, "has no stamp, and is ignored: set header.stamp to"),
        ({"shoulder": 0.1, "gripper": 0.2}, None, ""),
    ],
)
def test_joint_state_that_moves_nothing_has_a_hint_once(
    positions: dict[str, float],
    stamp_ns: int | None,
    hint: str,
    run: Run,
    capsys: pytest.CaptureFixture[str],
) -> None:
    joints, node = Joints(), RobotStatePublisher(ARM_2R)
    for _ in range(3):
        joints.say(positions, stamp_ns)
        run(0.2, node)
    found = [line for line in capsys.readouterr().out.splitlines() if line.startswith("hint:")]
    assert len(found) == bool(hint)
    assert not hint or hint in found[0]


@pytest.mark.parametrize("wrong", [Path("arm.urdf"), b"<robot/>", load_robot])
def test_description_that_is_not_a_string_is_rejected(graph: Graph, wrong: Any) -> None:
    with pytest.raises(CourseError, match="expected the text of a URDF"):
        RobotStatePublisher(wrong)


def test_mimic_joints_follow_one_joint_each_unless_set_explicitly(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ALL_KINDS), Joints()
    joints.say({"lift": 0.25})
    run(0.1, node, joints)
    robot = load_robot(ALL_KINDS)
    poses = link_poses(robot, {"lift": 0.25})
    moved = matrices(on("/tf")[0])
    assert list(moved) == ["finger", "mast", "thumb"]
    np.testing.assert_allclose(poses["thumb"], moved["mast"] @ moved["finger"] @ moved["thumb"], atol=1e-9)
    joints.say({"lift": 0.25, "finger": 0.0})
    run(0.1, node, joints)
    np.testing.assert_allclose(matrices(on("/tf")[1])["finger"], np.eye(4), atol=1e-12)


def test_nan_joint_position_is_published_unchanged_with_the_others(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    joints.say({"shoulder": nan, "elbow": 0.5})
    run(0.1, node, joints)
    fore, upper = on("/tf")[0].transforms
    assert isnan(upper.transform.rotation.w)
    assert not isnan(fore.transform.rotation.w)


def test_first_position_of_a_duplicate_joint_name_is_used(on: On, run: Run) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    state = JointState(name=["shoulder", "shoulder"], position=[0.0, 1.0])
    state.header.stamp = joints.get_clock().now().to_msg()
    joints.publisher.publish(state)
    run(0.1, node, joints)
    np.testing.assert_allclose(matrices(on("/tf")[0])["upper"], np.eye(4), atol=1e-12)


@pytest.mark.parametrize(
    ("positions", "text"),
    [
        ([], 'ignored a JointState message about joint(s) "a"(,...) whose position member was empty.'),
        ([1.0], "Robot state publisher ignored an invalid JointState message"),
    ],
)
def test_message_with_different_sizes_is_rejected_with_the_text_of_ros(
    positions: list[float], text: str, on: On, run: Run
) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    joints.publisher.publish(JointState(name=["a", "b"], position=positions))
    run(0.1, node, joints)
    assert text in on("/rosout")[-1].msg
    assert on("/tf") == []


def test_all_joints_are_published_again_after_a_backward_time_jump(
    graph: Graph, on: On, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    node, joints = RobotStatePublisher(ARM_2R), Joints()
    clock, real = node.get_clock(), node.get_clock().now
    monkeypatch.setattr(type(clock), "now", lambda self: Time(nanoseconds=real().nanoseconds + 10**10))
    joints.say({"shoulder": 0.0}, graph.now_ns + 10**10)
    run(0.1, node, joints)
    monkeypatch.undo()
    joints.say({"shoulder": 0.1}, graph.now_ns)
    run(0.1, node, joints)
    assert len(on("/tf")) == 2
    assert "Moved backwards in time, re-publishing joint transforms!" in [m.msg for m in on("/rosout")]


def test_robot_can_be_replaced(on: On, run: Run) -> None:
    node = RobotStatePublisher(ARM_2R)
    node.set_description(ALL_KINDS)
    assert [m.data for m in on("/robot_description")] == [ARM_2R, ALL_KINDS]
    assert len(on("/tf_static")) == 2


@pytest.mark.parametrize(
    ("text", "frequency", "reason"),
    [
        ("", 20.0, "robot_description parameter must not be empty"),
        ("<robot", 20.0, "The URDF is not XML"),
        (ARM_2R, 1001.0, "publish_frequency must be between 0 and 1000"),
        (ARM_2R, -1.0, "publish_frequency must be between 0 and 1000"),
        (ARM_2R, nan, "publish_frequency must be between 0 and 1000"),
    ],
)
def test_failing_constructor_raises_and_leaves_no_node(
    text: str, frequency: float, reason: str, graph: Graph
) -> None:
    with pytest.raises(CourseError, match=reason):
        RobotStatePublisher(text, publish_frequency=frequency)
    assert graph.nodes() == []


def test_command_line_parameters_take_precedence(graph: Graph) -> None:
    overrides = [Parameter("robot_description", value=ARM_2R), Parameter("frame_prefix", value="r/")]
    node = RobotStatePublisher(parameter_overrides=overrides)
    assert node.get_parameter("frame_prefix").value == "r/"


def test_valid_robot_description_can_be_set_as_a_parameter_and_an_invalid_one_is_rejected(
    graph: Graph,
) -> None:
    node = RobotStatePublisher(ARM_2R)
    received: list[str] = []
    graph.tap(lambda sample: received.append(sample.topic))
    for name, value, reason in (
        ("robot_description", ALL_KINDS, ""),
        ("robot_description", "", "Empty URDF is not allowed"),
        ("publish_frequency", 2000.0, "publish_frequency must be between 0.0 and 1000.0"),
    ):
        (result,) = node.set_parameters([Parameter(name, value=value)])
        assert (result.successful, result.reason) == (not reason, reason)
    assert received[:4] == ["/parameter_events", "/robot_description", "/rosout", "/tf_static"]
    assert node.get_parameter("robot_description").value == ALL_KINDS


def test_robot_description_in_a_rejected_request_changes_nothing(graph: Graph, on: On) -> None:
    node = RobotStatePublisher(ARM_2R)
    result = node.set_parameters_atomically(
        [Parameter("robot_description", value=ALL_KINDS), Parameter("publish_frequency", value=-1.0)]
    )
    assert not result.successful
    assert [message.data for message in on("/robot_description")] == [ARM_2R]
