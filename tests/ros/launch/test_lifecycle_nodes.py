"""Launch files with lifecycle nodes, in the style of ROS's lifecycle demo."""

from pathlib import Path
from typing import Any

import pytest
from launch.events import matches_action
from launch_ros.actions import LifecycleNode
from launch_ros.actions import Node as NodeAction
from launch_ros.descriptions import ComposableLifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState, StateTransition, matches_node_name
from lifecycle_msgs.msg import State, TransitionEvent

from course_lib.ros.messages import deserialize
from tests.ros.launch.run import recorded

TALKER = """
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Talker(LifecycleNode):
    def __init__(self):
        super().__init__("talker")
        self.out = self.create_lifecycle_publisher(String, "chatter", 10)
        self.create_timer(1.0, lambda: self.out.publish(String(data="hello")))

    def on_cleanup(self, state):
        return TransitionCallbackReturn.FAILURE


def main():
    rclpy.init()
    rclpy.spin(Talker())
"""
SETUP = 'setup(name="my_robot", entry_points={"console_scripts": ["lc_talker = my_robot.lc_talker:main"]})'
LAUNCH = """
import launch
import launch.actions
import launch.events
import launch_ros.actions
import launch_ros.events.lifecycle
from lifecycle_msgs.msg import Transition


def generate_launch_description():
    talker = launch_ros.actions.LifecycleNode(
        name="lc_talker", namespace="NAMESPACE", package="my_robot", executable="lc_talker", output="screen")

    def change(number):
        return launch.actions.EmitEvent(event=launch_ros.events.lifecycle.ChangeState(
            lifecycle_node_matcher=launch.events.matches_action(talker), transition_id=number))

    def when(state, *entities):
        return launch.actions.RegisterEventHandler(launch_ros.event_handlers.OnStateTransition(
            target_lifecycle_node=talker, goal_state=state, entities=list(entities)))

    return launch.LaunchDescription([
        when("inactive", launch.actions.LogInfo(msg="talker is inactive"), THEN),
        when("active", launch.actions.LogInfo(msg="talker is active")),
        talker,
        change(Transition.TRANSITION_CONFIGURE),
    ])
"""


@pytest.fixture
def demo(robot: Path) -> Any:
    """Write the demo's launch file with the actions after `inactive` and the node's namespace."""
    (robot / "my_robot" / "lc_talker.py").write_text(TALKER)
    (robot / "setup.py").write_text(SETUP)

    def write(then: str, namespace: str = "") -> Path:
        file = robot / "launch" / "lifecycle.launch.py"
        file.write_text(LAUNCH.replace("THEN", then).replace("NAMESPACE", namespace))
        return file

    return write


@pytest.mark.parametrize("namespace", ["", "front"])
def test_launch_drives_a_lifecycle_node_through_its_states(
    demo: Any, capsys: pytest.CaptureFixture[str], namespace: str
) -> None:
    file = demo("change(Transition.TRANSITION_ACTIVATE)", namespace)
    recording, code = recorded(file, seconds=3.5)
    topics = [one.topic for one in recording.samples if one.type_name == "std_msgs/msg/String"]
    out = capsys.readouterr().out
    assert code == 0
    assert topics == [f"{namespace and '/front'}/chatter"] * 3
    assert out.index("talker is inactive") < out.index("talker is active")


ROW = """
from launch import LaunchDescription
from launch.substitutions import TextSubstitution
from launch_ros.actions import LifecycleNode, LifecycleTransition


def generate_launch_description():
    return LaunchDescription([
        LifecycleNode(name="lc_talker", namespace="", package="my_robot", executable="lc_talker"),
        LifecycleTransition(lifecycle_node_names=["lc_talker"],
                            transition_ids=[1, TextSubstitution(text="3"), 4, 3]),
    ])
"""


AUTOSTART = """
from launch import LaunchDescription
from launch_ros.actions import LifecycleNode


def generate_launch_description():
    return LaunchDescription([
        LifecycleNode(name="lc_talker", namespace="NAMESPACE", package="my_robot", executable="lc_talker",
                      autostart=True),
    ])
"""


@pytest.mark.parametrize("namespace", ["", "front"])
def test_lifecycle_node_with_autostart_is_configured_and_activated(
    demo: Any, robot: Path, namespace: str
) -> None:
    demo("").write_text(AUTOSTART.replace("NAMESPACE", namespace))
    recording, _ = recorded(robot / "launch" / "lifecycle.launch.py", seconds=2.0)
    events = [one.cdr for one in recording.samples if one.topic.endswith("/lc_talker/transition_event")]
    goals = [deserialize(cdr, TransitionEvent).goal_state.label for cdr in events]
    assert [goal for goal in goals if not goal.endswith("ing")] == ["inactive", "active"]
    with pytest.raises(TypeError, match="got an unexpected keyword argument 'autostart'"):
        NodeAction(package="my_robot", executable="lc_talker", autostart=True)


@pytest.mark.parametrize("fails", [False, True])
def test_transitions_are_requested_in_sequence_until_a_node_fails(
    demo: Any, robot: Path, fails: bool
) -> None:
    demo("").write_text(ROW)
    if fails:
        at_once = "    def on_activate(self, state):\n        raise ValueError\n"
        (robot / "my_robot" / "lc_talker.py").write_text(
            TALKER.replace("\n\n\ndef main", f"\n\n{at_once}\n\ndef main")
        )
    recording, _ = recorded(robot / "launch" / "lifecycle.launch.py", seconds=2.0)
    cdrs = [one.cdr for one in recording.samples if one.topic == "/lc_talker/transition_event"]
    goals = [deserialize(cdr, TransitionEvent).goal_state.label for cdr in cdrs]
    assert [goal for goal in goals if not goal.endswith("ing")] == (
        ["inactive", "unconfigured"] if fails else ["inactive", "active", "inactive", "active"]
    )


COMPONENT = """
from launch import LaunchDescription
from launch_ros.actions import ComposableNodeContainer, LifecycleTransition
from launch_ros.descriptions import ComposableLifecycleNode
from lifecycle_msgs.msg import Transition


def generate_launch_description():
    talker = ComposableLifecycleNode(
        package="my_robot", plugin="my_robot::Talker", name="lc_talker", namespace="one", autostart=AUTO)
    return LaunchDescription([
        ComposableNodeContainer(
            name="box", namespace="", package="rclcpp_components", executable="component_container",
            composable_node_descriptions=[talker]),
        THEN
    ])
"""
CONFIGURE = (
    "LifecycleTransition(lifecycle_node_names=['/one/lc_talker'], "
    "transition_ids=[Transition.TRANSITION_CONFIGURE])"
)


@pytest.mark.parametrize(
    ("auto", "then", "goals"),
    [
        ("True", "", ["configuring", "inactive", "activating", "active"]),
        ("'false'", CONFIGURE, ["configuring", "inactive"]),
        ("False", "", []),
    ],
)
def test_lifecycle_component_has_the_transitions_of_the_launch(
    robot: Path, auto: str, then: str, goals: list[str]
) -> None:
    (robot / "my_robot" / "lc_talker.py").write_text(TALKER)
    entry_point = "my_robot::Talker = my_robot.lc_talker:Talker"
    (robot / "setup.py").write_text(SETUP.replace("lc_talker = my_robot.lc_talker:main", entry_point))
    file = robot / "launch" / "component.launch.py"
    file.write_text(COMPONENT.replace("AUTO", auto).replace("THEN", then))
    recording, code = recorded(file)
    assert code == 0
    samples = [s for s in recording.samples if s.topic == "/one/lc_talker/transition_event"]
    events = [deserialize(sample.cdr, TransitionEvent) for sample in samples]
    assert [event.goal_state.label for event in events] == goals


def test_lifecycle_component_without_a_name_is_rejected() -> None:
    with pytest.raises(TypeError, match="expected the node's name"):
        ComposableLifecycleNode(package="p", plugin="p::C")


def test_transition_rejected_by_the_node_is_logged(demo: Any, capsys: pytest.CaptureFixture[str]) -> None:
    recorded(demo("change(Transition.TRANSITION_CLEANUP)"), seconds=0.5)
    text = "Failed to make transition 'TRANSITION_CLEANUP' for LifecycleNode '/lc_talker'"
    assert f"[ERROR] [launch_ros.actions.lifecycle_node]: {text}\n" in capsys.readouterr().out


def test_launch_ends_if_its_node_never_started(robot: Path, demo: Any) -> None:
    file = demo("change(Transition.TRANSITION_ACTIVATE)")
    (robot / "my_robot" / "lc_talker.py").write_text("def main():\n    return 3\n")
    _, code = recorded(file, seconds=None)
    assert code == 3


def test_events_and_handlers_are_matched_as_in_launch_ros() -> None:
    given: dict[str, Any] = {"name": "a", "namespace": "", "package": "p", "executable": "e"}
    node, other = LifecycleNode(**given), LifecycleNode(**given)
    node.node_name = "/a"
    message = TransitionEvent(start_state=State(label="activating"), goal_state=State(label="active"))
    event = StateTransition(action=node, msg=message)
    for handler, matches in (
        (OnStateTransition(entities=[]), True),
        (OnStateTransition(entities=[], target_lifecycle_node=node, goal_state="active"), True),
        (OnStateTransition(entities=[], target_lifecycle_node=other), False),
        (OnStateTransition(entities=[], start_state="inactive"), False),
        (OnStateTransition(entities=[], goal_state="x", matcher=lambda event: True), True),
    ):
        assert handler.matches(event) is matches
    assert matches_node_name("a")(node)
    assert not matches_node_name("/a")(other)


def test_invalid_targets_and_transitions_are_rejected_with_the_error_text_of_ros() -> None:
    node: Any = NodeAction(package="p", executable="e")
    with pytest.raises(RuntimeError, match="requires a 'LifecycleNode' action as the target"):
        OnStateTransition(entities=[], target_lifecycle_node=node)
    with pytest.raises(
        ValueError, match=r"given transition_id of '99', expected one of \{TRANSITION_CREATE: 0"
    ):
        ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=99)
    with pytest.raises(TypeError, match="namespace"):
        LifecycleNode(package="p", executable="e", name="a")  # type: ignore[call-arg]
