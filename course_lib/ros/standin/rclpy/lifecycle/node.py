"""Nodes whose state other nodes see and change."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Unpack, cast

from lifecycle_msgs import srv
from lifecycle_msgs.msg import State, Transition, TransitionEvent

from course_lib.ros.notices import say
from course_lib.ros.tracebacks import line_of_traceback
from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import RCLError
from rclpy.lifecycle.managed_entity import LifecycleState, ManagedEntity, TransitionCallbackReturn
from rclpy.lifecycle.publisher import LifecyclePublisher
from rclpy.lifecycle.state_machine import STATES, STEPS, StateMachine, description_of, message_of
from rclpy.node import Node

if TYPE_CHECKING:
    from rclpy.node import NodeOptions


class LifecycleServices:
    """The services of one node; `change` makes a transition by its number."""

    def __init__(
        self,
        node: Node,
        machine: StateMachine,
        change: Callable[[int], TransitionCallbackReturn],
        group: CallbackGroup | None,
    ) -> None:
        self._machine, self._change = machine, change
        for kind, name, answer in (
            (srv.ChangeState, "change_state", self._change_state),
            (srv.GetState, "get_state", self._get_state),
            (srv.GetAvailableStates, "get_available_states", self._get_states),
            (srv.GetAvailableTransitions, "get_available_transitions", self._get_transitions),
            (srv.GetAvailableTransitions, "get_transition_graph", self._get_graph),
        ):
            node.create_service(kind, f"~/{name}", answer, callback_group=group)

    def _change_state(self, request: Any, response: Any) -> Any:
        """Trigger the transition of the request's label or, without a label, of its number."""
        wanted = request.transition.id
        if request.transition.label:
            step = self._machine.find(request.transition.label)
            if step is None:
                return response
            wanted = step.number
        response.success = self._change(wanted) is TransitionCallbackReturn.SUCCESS
        return response

    def _get_state(self, request: Any, response: Any) -> Any:
        response.current_state = message_of(self._machine.label)
        return response

    def _get_states(self, request: Any, response: Any) -> Any:
        response.available_states = [message_of(label) for label in STATES]
        return response

    def _get_transitions(self, request: Any, response: Any) -> Any:
        response.available_transitions = [description_of(step) for step in self._machine.steps()]
        return response

    def _get_graph(self, request: Any, response: Any) -> Any:
        response.available_transitions = [description_of(step) for step in STEPS]
        return response


_CALLBACKS = {
    State.TRANSITION_STATE_CONFIGURING: "on_configure",
    State.TRANSITION_STATE_CLEANINGUP: "on_cleanup",
    State.TRANSITION_STATE_SHUTTINGDOWN: "on_shutdown",
    State.TRANSITION_STATE_ACTIVATING: "on_activate",
    State.TRANSITION_STATE_DEACTIVATING: "on_deactivate",
    State.TRANSITION_STATE_ERRORPROCESSING: "on_error",
}
_SHUTDOWNS = {
    "unconfigured": Transition.TRANSITION_UNCONFIGURED_SHUTDOWN,
    "inactive": Transition.TRANSITION_INACTIVE_SHUTDOWN,
    "active": Transition.TRANSITION_ACTIVE_SHUTDOWN,
}


class LifecycleNodeMixin(ManagedEntity):
    """The part of LifecycleNode that is added to Node.

    Args:
        enable_communication_interface: Whether other nodes may see and change the state.
        callback_group: The group of the services with which they do.
    """

    def __init__(
        self,
        *,
        enable_communication_interface: bool = True,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self._callbacks = {number: getattr(self, name) for number, name in _CALLBACKS.items()}
        self._managed_entities: dict[ManagedEntity, None] = {}  # in the order of their making
        node = cast("Node", self)
        events = node.create_publisher(TransitionEvent, "~/transition_event", 10)
        self._state_machine = StateMachine(events.publish)
        if enable_communication_interface:
            LifecycleServices(node, self._state_machine, self.__change_state, callback_group)

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Go from unconfigured to inactive."""
        return self.__change_state(Transition.TRANSITION_CONFIGURE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Go from inactive to unconfigured."""
        return self.__change_state(Transition.TRANSITION_CLEANUP)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Go from unconfigured, inactive or active to finalized."""
        if self._state_machine.label not in _SHUTDOWNS:
            raise RCLError("Shutdown transtion not possible")  # rclpy's spelling
        return self.__change_state(_SHUTDOWNS[self._state_machine.label])

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Go from inactive to active."""
        return self.__change_state(Transition.TRANSITION_ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Go from active to inactive."""
        return self.__change_state(Transition.TRANSITION_DEACTIVATE)

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Add an entity whose callbacks are called at each transition."""
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self._managed_entities[entity] = None

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher[Any]:
        """Create a publisher that publishes while the node is active; arguments as of `create_publisher`."""
        if "publisher_class" in kwargs:
            raise TypeError("create_publisher() got an unexpected keyword argument 'publisher_class'")
        publisher = Node.create_publisher(
            cast("Node", self), *args, **kwargs, publisher_class=LifecyclePublisher
        )
        assert isinstance(publisher, LifecyclePublisher)
        self.add_managed_entity(publisher)
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher[Any]) -> bool:
        """Destroy such a publisher; False if the node has not created it, or it is destroyed already."""
        self._managed_entities.pop(publisher, None)
        return Node.destroy_publisher(cast("Node", self), publisher)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Configure the managed entities."""
        return self.__call_entities("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clean the managed entities up."""
        return self.__call_entities("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shut the managed entities down."""
        return self.__call_entities("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Activate the managed entities; a node's own `on_activate` calls this one with `super()`."""
        return self.__call_entities("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate the managed entities; a node's own `on_deactivate` calls this one with `super()`."""
        return self.__call_entities("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Report an error to the managed entities."""
        return self.__call_entities("on_error", state)

    def __call_entities(self, name: str, state: LifecycleState) -> TransitionCallbackReturn:
        """Call a callback of each entity, up to the first that doesn't succeed."""
        for entity in self._managed_entities:
            result = getattr(entity, name)(state)
            if not isinstance(result, TransitionCallbackReturn):
                raise TypeError(
                    f"{name}() return value of class {type(entity)} should be `TransitionCallbackReturn`.\n"
                    f"Instance of the class that caused the failure: {entity}"
                )
            if result is not TransitionCallbackReturn.SUCCESS:
                return result
        return TransitionCallbackReturn.SUCCESS

    def __change_state(self, wanted: int) -> TransitionCallbackReturn:
        machine = self._state_machine
        before = LifecycleState(label=machine.label, state_id=machine.number)
        machine.go(wanted)
        result = self.__call_back(before)
        machine.go(result.to_label())
        if result is TransitionCallbackReturn.ERROR:
            machine.go(self.__call_back(before).to_label())
        return result

    def __call_back(self, before: LifecycleState) -> TransitionCallbackReturn:
        """Call the callback of the state between two others."""
        number = self._state_machine.number
        try:
            return cast("TransitionCallbackReturn", self._callbacks[number](before))
        except Exception as error:  # as in rclpy, which keeps silent about it
            name, place = (
                cast("Node", self).get_fully_qualified_name(),
                line_of_traceback(error.__traceback__),
            )
            text = f"{name}: {_CALLBACKS[number]}() raised {type(error).__name__}: {error}"
            say(f"{text} ({place})" if place else text)
            return TransitionCallbackReturn.ERROR


class LifecycleNode(LifecycleNodeMixin, Node):
    """A node with a state; it begins unconfigured. The other arguments are those of Node."""

    def __init__(
        self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: "Unpack[NodeOptions]"
    ) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)
