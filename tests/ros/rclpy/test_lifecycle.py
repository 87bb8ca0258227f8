"""Lifecycle nodes, with programs in the style of ROS's lifecycle demo."""

from pathlib import Path
from typing import Any

import pytest
import rclpy
from lifecycle_msgs.msg import State as StateMsg
from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rclpy.impl.implementation_singleton import RCLError
from rclpy.lifecycle import LifecycleNode, Node, SimpleManagedEntity, State, TransitionCallbackReturn
from rclpy.lifecycle.node import ManagedEntity
from std_msgs.msg import String

from course_lib.recording import record
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.hints import hint
from course_lib.ros.messages import deserialize
from course_lib.ros.programs.program import run_files

TALKER = """
import rclpy
from rclpy.lifecycle import Node, Publisher, State, TransitionCallbackReturn
from std_msgs.msg import String


class LifecycleTalker(Node):
    def __init__(self, node_name, **kwargs):
        self._count = 0
        self._pub = None
        self._timer = None
        super().__init__(node_name, **kwargs)

    def publish(self):
        self._count += 1
        self._pub.publish(String(data=f"Lifecycle HelloWorld #{self._count}"))

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        self._pub = self.create_lifecycle_publisher(String, "lifecycle_chatter", 10)
        self._timer = self.create_timer(1.0, self.publish)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: State) -> TransitionCallbackReturn:
        self.get_logger().info("on_activate() is called.")
        return super().on_activate(state)


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(LifecycleTalker("lc_talker"))
    try:
        executor.spin()
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
"""
CLIENT = """
import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rclpy.node import Node

rclpy.init()
node = Node("service_client")
client = node.create_client(ChangeState, "lc_talker/change_state")
assert client.wait_for_service(timeout_sec=5.0)
for number in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
    rclpy.spin_until_future_complete(node, rclpy.Future(), timeout_sec=2.5)
    future = client.call_async(ChangeState.Request(transition=Transition(id=number)))
    rclpy.spin_until_future_complete(node, future)
    assert future.result().success
"""
SUCCESS, FAILURE, ERROR = TransitionCallbackReturn


class Talker(LifecycleNode):
    """Returns or raises the entries of `results`."""

    def __init__(self, **results: Any) -> None:
        super().__init__("lc_talker")
        self.results, self.befores = results, list[State]()
        self.out = self.create_lifecycle_publisher(String, "chatter", 10)

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        return self._result("configure", state)

    def on_cleanup(self, state: State) -> TransitionCallbackReturn:
        return self._result("cleanup", state)

    def on_shutdown(self, state: State) -> TransitionCallbackReturn:
        return self._result("shutdown", state)

    def on_error(self, state: State) -> TransitionCallbackReturn:
        return self._result("error", state)

    def _result(self, name: str, state: State) -> TransitionCallbackReturn:
        self.befores.append(state)
        result = self.results.get(name, SUCCESS)
        if isinstance(result, Exception):
            raise result
        assert isinstance(result, TransitionCallbackReturn)
        return result


def call_service(node: rclpy.node.Node, kind: Any, service: str, **fields: Any) -> Any:
    client = node.create_client(kind, f"/lc_talker/{service}")
    future = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, future)
    return future.result()


def state(node: LifecycleNode) -> tuple[int, str]:
    current = call_service(node, GetState, "get_state").current_state
    return current.id, current.label


@pytest.mark.usefixtures("started_graph")
class TestLifecycleNode:
    def test_lifecycle_node_passes_through_the_states_of_rcl(self) -> None:
        node = Talker()
        seen = [state(node)]
        for go in ("configure", "activate", "deactivate", "cleanup", "shutdown"):
            assert getattr(node, f"trigger_{go}")() is SUCCESS
            seen.append(state(node))
        assert seen == [
            (1, "unconfigured"),
            (2, "inactive"),
            (3, "active"),
            (2, "inactive"),
            (1, "unconfigured"),
            (4, "finalized"),
        ]
        assert node.befores == [State("unconfigured", 1), State("inactive", 2), State("unconfigured", 1)]
        with pytest.raises(RCLError, match=r"^Shutdown transtion not possible$"):
            node.trigger_shutdown()

    @pytest.mark.parametrize(
        ("results", "returned", "label"),
        [
            ({"configure": FAILURE}, FAILURE, "unconfigured"),
            ({"configure": ERROR}, ERROR, "unconfigured"),
            ({"configure": ERROR, "error": FAILURE}, ERROR, "finalized"),
            ({"configure": ERROR, "error": ERROR}, ERROR, "finalized"),
        ],
    )
    def test_next_state_depends_on_the_return_value_of_the_callback(
        self, results: Any, returned: Any, label: str
    ) -> None:
        node = Talker(**results)
        assert node.trigger_configure() is returned
        assert state(node)[1] == label

    def test_callback_exception_is_logged_and_counts_as_transition_error(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        node = Talker(configure=ValueError("no laser"))
        assert node.trigger_configure() is ERROR
        output = capsys.readouterr().out
        assert output.startswith(
            "/lc_talker: on_configure() raised ValueError: no laser (test_lifecycle.py, line "
        )
        assert output.endswith(": raise result)\n")
        assert node.befores == [State("unconfigured", 1)] * 2

    def test_callback_with_a_wrong_signature_is_logged_with_a_hint(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        class Wrong(LifecycleNode):
            def on_configure(self) -> Any: ...  # type: ignore[override]

        assert Wrong("wrong").trigger_configure() is ERROR
        assert capsys.readouterr().out.endswith(
            "on_configure() takes 1 positional argument but 2 were given; hint: the callback gets the state "
            "before the transition: write `def on_configure(self, state)`.\n"
        )

    def test_unavailable_transition_raises_the_error_of_rcl(self, capsys: pytest.CaptureFixture[str]) -> None:
        node = Talker()
        with pytest.raises(RCLError, match="Transition is not registered"):
            node.trigger_activate()
        assert "[rcl_lifecycle]: No transition matching 3 found for current state unconfigured" in (
            capsys.readouterr().err
        )

    def test_managed_publisher_publishes_only_while_its_node_is_active(self) -> None:
        node = Talker()
        values: list[str] = []
        node.create_subscription(String, "chatter", lambda message: values.append(message.data), 10)
        for go in ("configure", "activate", "deactivate"):
            node.out.publish(String(data=f"before {go}"))
            getattr(node, f"trigger_{go}")()
        node.out.publish(String(data="at the end"))
        rclpy.spin_once(node)
        rclpy.spin_once(node, timeout_sec=0.1)
        assert values == ["before deactivate"]
        assert not node.out.is_activated
        assert node.destroy_lifecycle_publisher(node.out)
        assert not node.destroy_lifecycle_publisher(node.out)

    def test_each_transition_is_published_as_an_event(self) -> None:
        node = Talker()
        received: list[tuple[str, str]] = []

        def hear(event: TransitionEvent) -> None:
            received.append((event.start_state.label, event.goal_state.label))

        node.create_subscription(TransitionEvent, "/lc_talker/transition_event", hear, 10)
        node.trigger_configure()
        for _ in range(2):
            rclpy.spin_once(node)
        assert received == [("unconfigured", "configuring"), ("configuring", "inactive")]

    def test_other_nodes_change_the_state_by_transition_id_or_label(self) -> None:
        node = Talker()
        wanted = Transition(id=Transition.TRANSITION_CONFIGURE)
        assert call_service(node, ChangeState, "change_state", transition=wanted).success
        assert call_service(
            node, ChangeState, "change_state", transition=Transition(label="activate")
        ).success
        assert not call_service(
            node, ChangeState, "change_state", transition=Transition(label="cleanup")
        ).success
        assert state(node) == (3, "active")

    def test_other_nodes_receive_all_states_and_transitions_in_the_order_of_rcl(self) -> None:
        node = Talker()
        states = call_service(node, GetAvailableStates, "get_available_states").available_states
        graph = call_service(node, GetAvailableTransitions, "get_transition_graph").available_transitions
        now = call_service(node, GetAvailableTransitions, "get_available_transitions").available_transitions
        assert [one.id for one in states] == [0, 1, 2, 3, 4, 10, 11, 12, 13, 14, 15]
        numbers = [one.transition.id for one in graph]
        assert numbers[:5] == [1, 10, 11, 12, 2]
        assert numbers[-6:] == [50, 51, 52, 60, 61, 62]
        assert len(numbers) == 25
        assert [(one.transition.id, one.transition.label) for one in now] == [
            (1, "configure"),
            (5, "shutdown"),
        ]
        assert now[0].goal_state == StateMsg(id=10, label="configuring")

    def test_managed_entities_follow_the_node_up_to_the_first_failure(self) -> None:
        class Refusing(ManagedEntity):
            def on_activate(self, state: State) -> TransitionCallbackReturn:
                return FAILURE

        node, first, last = Node("lc_talker"), SimpleManagedEntity(), SimpleManagedEntity()
        for entity in (first, Refusing(), last):
            node.add_managed_entity(entity)
        node.trigger_configure()
        assert node.trigger_activate() is FAILURE
        assert (first.is_activated, last.is_activated) == (True, False)
        with pytest.raises(TypeError, match=r"Expected a rclpy.lifecycle.ManagedEntity instance"):
            node.add_managed_entity("camera")  # type: ignore[arg-type]

    def test_method_can_be_replaced_while_its_entity_is_not_enabled(self) -> None:
        calls: list[str] = []

        class Light(SimpleManagedEntity):
            @SimpleManagedEntity.when_enabled(when_not_enabled=lambda: calls.append("off"))
            def blink(self, text: str) -> None:
                calls.append(text)

        light = Light()
        light.blink("a")
        light.on_activate(State("inactive", 2))
        light.blink("b")
        assert calls == ["off", "b"]

    def test_node_without_lifecycle_services_changes_its_own_state(self) -> None:
        node = LifecycleNode("lc_talker", enable_communication_interface=False)
        assert not [name for name, _ in node.get_service_names_and_types() if "state" in name]
        assert node.trigger_configure() is SUCCESS


def test_talker_of_the_demo_is_silent_until_a_client_activates_it(tmp_path: Path) -> None:
    files = [tmp_path / "lc_talker.py", tmp_path / "lc_service_client.py"]
    for file, text in zip(files, (TALKER, CLIENT), strict=True):
        file.write_text(text)
    graph = Graph()
    graph.end_ns = graph.now_ns + 8 * 10**9
    with use_graph(graph), record(graph) as recorder:
        assert run_files(files, seed=0) == 0
    recording = recorder.recording()
    messages = [
        deserialize(one.cdr, String).data for one in recording.samples if one.topic == "/lifecycle_chatter"
    ]
    events = [one for one in recording.samples if one.topic == "/lc_talker/transition_event"]
    assert messages[:2] == ["Lifecycle HelloWorld #3", "Lifecycle HelloWorld #4"]
    assert len(events) == 4


class Camera(LifecycleNode):
    """Publishes without a call of `super().on_activate`."""

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        self.images = self.create_lifecycle_publisher(String, "/images", 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: State) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.SUCCESS

    def on_deactivated(self, state: State) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.OK  # type: ignore[attr-defined,no-any-return]


def test_active_node_with_a_disabled_publisher_has_a_hint(
    started_graph: Graph, capsys: pytest.CaptureFixture[str]
) -> None:
    camera = Camera("camera")
    name_hint = "hint: no transition calls on_deactivated: did you mean on_deactivate?\n"
    assert capsys.readouterr().out == name_hint
    camera.trigger_configure()
    assert not capsys.readouterr().out
    camera.trigger_activate()
    assert capsys.readouterr().out == (
        "hint: the node is active, and /images drops all messages: end on_activate with return "
        "super().on_activate(state).\n"
    )
    with pytest.raises(AttributeError) as error:
        camera.on_deactivated(State("", 0))
    assert hint(error.value) == "TransitionCallbackReturn has SUCCESS, FAILURE and ERROR."
