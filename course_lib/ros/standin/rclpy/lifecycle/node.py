"""Lifecycle nodes, whose state other nodes query and change, and their managed entities."""

from collections.abc import Callable
from enum import Enum
from functools import partial, wraps
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Concatenate, NamedTuple, ParamSpec, TypeVar, Unpack, cast, overload

from lifecycle_msgs import srv
from lifecycle_msgs.msg import State, Transition, TransitionDescription, TransitionEvent

from course_lib.errors import join_words
from course_lib.ros.hints import hint
from course_lib.ros.near_names import nearest
from course_lib.ros.notices import print_notice
from course_lib.ros.tracebacks import line_of_traceback
from rclpy.callback_groups import CallbackGroup
from rclpy.impl import private_names
from rclpy.impl.endpoint import MsgT
from rclpy.impl.implementation_singleton import RCLError
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.publisher import Publisher

if TYPE_CHECKING:
    from rclpy.node import NodeOptions

SelfT = TypeVar("SelfT", bound="SimpleManagedEntity")
P = ParamSpec("P")
Method = Callable[Concatenate[SelfT, P], Any]


class LifecycleState(NamedTuple):
    """A lifecycle state: its label, and its id in lifecycle_msgs/msg/State."""

    label: str
    state_id: int


class TransitionCallbackReturnType(Enum):
    """The result of a transition callback. Programs import it as TransitionCallbackReturn."""

    SUCCESS = Transition.TRANSITION_CALLBACK_SUCCESS
    FAILURE = Transition.TRANSITION_CALLBACK_FAILURE
    ERROR = Transition.TRANSITION_CALLBACK_ERROR

    def __int__(self) -> int:
        return self.value

    def to_label(self) -> str:
        """Return the label of the transition that follows this result."""
        return f"transition_{self.name.lower()}"


TransitionCallbackReturn = TransitionCallbackReturnType


class ManagedEntity:
    """An entity with a callback for each transition. A callback receives the previous state."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition to inactive."""
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition back to unconfigured."""
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition to finalized."""
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition to active."""
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle the transition back to inactive."""
        return TransitionCallbackReturn.SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Handle an error that another callback raised or returned."""
        return TransitionCallbackReturn.SUCCESS


class SimpleManagedEntity(ManagedEntity):
    """An entity that is enabled while its node is active."""

    def __init__(self) -> None:
        self._enabled = False

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Enable the entity."""
        self._enabled = True
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Disable the entity."""
        self._enabled = False
        return TransitionCallbackReturn.SUCCESS

    @property
    def is_activated(self) -> bool:
        """True while the entity is enabled."""
        return self._enabled

    @overload
    @staticmethod
    def when_enabled(
        wrapped: None = None, *, when_not_enabled: Callable[[], object] | None = None
    ) -> Callable[[Method[SelfT, P]], Callable[Concatenate[SelfT, P], None]]: ...

    @overload
    @staticmethod
    def when_enabled(
        wrapped: Method[SelfT, P], *, when_not_enabled: Callable[[], object] | None = None
    ) -> Callable[Concatenate[SelfT, P], None]: ...

    @staticmethod
    def when_enabled(
        wrapped: Method[SelfT, P] | None = None,
        *,
        when_not_enabled: Callable[[], object] | None = None,
    ) -> Any:
        """Decorate a method: while the entity is not enabled, `when_not_enabled` is called instead."""

        def decorated(method: Method[SelfT, P]) -> Any:
            @wraps(method)
            def call(self: SelfT, *args: P.args, **kwargs: P.kwargs) -> None:
                if self._enabled:
                    method(self, *args, **kwargs)
                elif when_not_enabled is not None:
                    when_not_enabled()

            return call

        return decorated if wrapped is None else decorated(wrapped)


class LifecyclePublisher(SimpleManagedEntity, Publisher[MsgT]):
    """A publisher that is active while its node is; created by `create_lifecycle_publisher`."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: MsgT | bytes) -> None:
        """Publish a message or serialized bytes. Do nothing while the node is not active."""
        Publisher.publish(self, msg)


STATES = {
    "unknown": State.PRIMARY_STATE_UNKNOWN,
    "unconfigured": State.PRIMARY_STATE_UNCONFIGURED,
    "inactive": State.PRIMARY_STATE_INACTIVE,
    "active": State.PRIMARY_STATE_ACTIVE,
    "finalized": State.PRIMARY_STATE_FINALIZED,
    "configuring": State.TRANSITION_STATE_CONFIGURING,
    "cleaningup": State.TRANSITION_STATE_CLEANINGUP,
    "shuttingdown": State.TRANSITION_STATE_SHUTTINGDOWN,
    "activating": State.TRANSITION_STATE_ACTIVATING,
    "deactivating": State.TRANSITION_STATE_DEACTIVATING,
    "errorprocessing": State.TRANSITION_STATE_ERRORPROCESSING,
}


class Step(NamedTuple):
    """A transition between two states, given by their labels."""

    number: int
    label: str
    start: str
    goal: str


SUCCESS, FAILURE, ERROR = "transition_success", "transition_failure", "transition_error"
# In rcl's order, in which the services return them.
STEPS = (
    Step(Transition.TRANSITION_CONFIGURE, "configure", "unconfigured", "configuring"),
    Step(Transition.TRANSITION_ON_CONFIGURE_SUCCESS, SUCCESS, "configuring", "inactive"),
    Step(Transition.TRANSITION_ON_CONFIGURE_FAILURE, FAILURE, "configuring", "unconfigured"),
    Step(Transition.TRANSITION_ON_CONFIGURE_ERROR, ERROR, "configuring", "errorprocessing"),
    Step(Transition.TRANSITION_CLEANUP, "cleanup", "inactive", "cleaningup"),
    Step(Transition.TRANSITION_ON_CLEANUP_SUCCESS, SUCCESS, "cleaningup", "unconfigured"),
    Step(Transition.TRANSITION_ON_CLEANUP_FAILURE, FAILURE, "cleaningup", "inactive"),
    Step(Transition.TRANSITION_ON_CLEANUP_ERROR, ERROR, "cleaningup", "errorprocessing"),
    Step(Transition.TRANSITION_ACTIVATE, "activate", "inactive", "activating"),
    Step(Transition.TRANSITION_ON_ACTIVATE_SUCCESS, SUCCESS, "activating", "active"),
    Step(Transition.TRANSITION_ON_ACTIVATE_FAILURE, FAILURE, "activating", "inactive"),
    Step(Transition.TRANSITION_ON_ACTIVATE_ERROR, ERROR, "activating", "errorprocessing"),
    Step(Transition.TRANSITION_DEACTIVATE, "deactivate", "active", "deactivating"),
    Step(Transition.TRANSITION_ON_DEACTIVATE_SUCCESS, SUCCESS, "deactivating", "inactive"),
    Step(Transition.TRANSITION_ON_DEACTIVATE_FAILURE, FAILURE, "deactivating", "active"),
    Step(Transition.TRANSITION_ON_DEACTIVATE_ERROR, ERROR, "deactivating", "errorprocessing"),
    Step(Transition.TRANSITION_UNCONFIGURED_SHUTDOWN, "shutdown", "unconfigured", "shuttingdown"),
    Step(Transition.TRANSITION_INACTIVE_SHUTDOWN, "shutdown", "inactive", "shuttingdown"),
    Step(Transition.TRANSITION_ACTIVE_SHUTDOWN, "shutdown", "active", "shuttingdown"),
    Step(Transition.TRANSITION_ON_SHUTDOWN_SUCCESS, SUCCESS, "shuttingdown", "finalized"),
    Step(Transition.TRANSITION_ON_SHUTDOWN_FAILURE, FAILURE, "shuttingdown", "finalized"),
    Step(Transition.TRANSITION_ON_SHUTDOWN_ERROR, ERROR, "shuttingdown", "errorprocessing"),
    Step(Transition.TRANSITION_ON_ERROR_SUCCESS, SUCCESS, "errorprocessing", "unconfigured"),
    Step(Transition.TRANSITION_ON_ERROR_FAILURE, FAILURE, "errorprocessing", "finalized"),
    Step(Transition.TRANSITION_ON_ERROR_ERROR, ERROR, "errorprocessing", "finalized"),
)


class StateMachine:
    """The state machine of one node. `publish` is called with an event for each transition."""

    def __init__(self, publish: Callable[[TransitionEvent], object]) -> None:
        self.label = "unconfigured"
        self._publish = publish

    @property
    def initialized(self) -> bool:
        """Always True: rclpy initializes the state machine when the node is created."""
        return True

    @property
    def current_state(self) -> tuple[int, str]:
        """The id and the label of the state, in this order. rclpy offers no other access."""
        return self.number, self.label

    @property
    def available_states(self) -> list[tuple[int, str]]:
        """The ids and labels of all states."""
        return [(number, label) for label, number in STATES.items()]

    @property
    def available_transitions(self) -> list[tuple[int, str, int, str, int, str]]:
        """The transitions from the current state: id and label of them and of both states."""
        return [
            (step.number, step.label, STATES[step.start], step.start, STATES[step.goal], step.goal)
            for step in self.steps()
        ]

    @property
    def number(self) -> int:
        """The id of the current state."""
        return STATES[self.label]

    def steps(self) -> list[Step]:
        """List the transitions from the current state."""
        return [step for step in STEPS if step.start == self.label]

    def find(self, transition: int | str) -> Step | None:
        """Return the transition with this id or label.

        If there is none, log rcl's warning and return None.
        """
        matching = [step for step in self.steps() if transition in (step.number, step.label)]
        if not matching:
            text = f"No transition matching {transition} found for current state {self.label}"
            get_logger("rcl_lifecycle").warning(text)
        return matching[0] if matching else None

    def go(self, transition: int | str) -> None:
        """Execute a transition.

        Raise an RCLError if the current state has no transition with this id or label.
        """
        step = self.find(transition)
        if step is None:
            raise RCLError(
                "Failed to trigger lifecycle state machine transition: Transition is not registered."
            )
        self.label = step.goal
        self._publish(TransitionEvent(start_state=message_of(step.start), goal_state=message_of(step.goal)))


def message_of(label: str) -> State:
    """Convert a state to a message."""
    return State(id=STATES[label], label=label)


def description_of(step: Step) -> TransitionDescription:
    """Convert a transition to a message."""
    return TransitionDescription(
        transition=Transition(id=step.number, label=step.label),
        start_state=message_of(step.start),
        goal_state=message_of(step.goal),
    )


class LifecycleServices:
    """The lifecycle services of one node. `change` executes a transition by its number."""

    def __init__(
        self,
        node: Node,
        machine: StateMachine,
        change: Callable[[int], TransitionCallbackReturn],
        group: CallbackGroup | None,
    ) -> None:
        self._machine, self._change = machine, change
        transitions, steps = srv.GetAvailableTransitions, "available_transitions"
        # The field of the response that each query fills, and how its value is read.
        queries: dict[str, tuple[Any, str, Callable[[], Any]]] = {
            "get_state": (srv.GetState, "current_state", lambda: message_of(machine.label)),
            "get_available_states": (
                srv.GetAvailableStates, "available_states", lambda: [message_of(label) for label in STATES]
            ),
            "get_available_transitions": (
                transitions, steps, lambda: [description_of(step) for step in machine.steps()]
            ),
            "get_transition_graph": (transitions, steps, lambda: [description_of(step) for step in STEPS]),
        }  # fmt: skip
        prefix = node.get_fully_qualified_name()
        node.create_service(
            srv.ChangeState, f"{prefix}/change_state", self._change_state, callback_group=group
        )
        for name, (kind, field, get_value) in queries.items():
            answer = partial(self._answer, field, get_value)
            node.create_service(kind, f"{prefix}/{name}", answer, callback_group=group)

    def _change_state(self, request: Any, response: Any) -> Any:
        """Trigger the requested transition, found by its label or, without one, by its number."""
        transition_id = request.transition.id
        if request.transition.label:
            step = self._machine.find(request.transition.label)
            if step is None:
                return response
            transition_id = step.number
        response.success = self._change(transition_id) is TransitionCallbackReturn.SUCCESS
        return response

    def _answer(self, field: str, get_value: Callable[[], Any], request: Any, response: Any) -> Any:
        setattr(response, field, get_value())
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
    """The methods that a LifecycleNode adds to Node.

    Args:
        enable_communication_interface: Whether other nodes can query and change the state.
        callback_group: The group of the services for these queries and changes.
    """

    def __init__(
        self,
        *,
        enable_communication_interface: bool = True,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.__callbacks = {number: getattr(self, name) for number, name in _CALLBACKS.items()}
        for name in [name for name in vars(type(self)) if name.startswith("on_")]:
            meant = nearest(name, set(_CALLBACKS.values()) - vars(type(self)).keys(), 0.85)
            if meant and name not in _CALLBACKS.values():
                print_notice(f"hint: no transition calls {name}: did you mean {meant}?")
        # A dict keeps the order in which the entities were added.
        self.__managed_entities: dict[ManagedEntity, None] = {}
        node = cast("Node", self)
        events = node.create_publisher(TransitionEvent, "~/transition_event", 10)
        node._course_hide(events)
        self.__state_machine = StateMachine(events.publish)
        if enable_communication_interface:
            LifecycleServices(node, self.__state_machine, self.__change_state, callback_group)

    __state_machine: StateMachine = private_names.set_by_init("_state_machine")

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Report attributes of a student's class whose names are private in rclpy."""
        super().__init_subclass__(**kwargs)
        private_names.check_class("Node", cls, private_names.OF_LIFECYCLE_NODES)

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Trigger the transition from unconfigured to inactive."""
        return self.__change_state(Transition.TRANSITION_CONFIGURE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Trigger the transition from inactive to unconfigured."""
        return self.__change_state(Transition.TRANSITION_CLEANUP)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Trigger the transition from unconfigured, inactive or active to finalized."""
        if self.__state_machine.label not in _SHUTDOWNS:
            raise RCLError("Shutdown transtion not possible")  # rclpy's spelling
        return self.__change_state(_SHUTDOWNS[self.__state_machine.label])

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Trigger the transition from inactive to active."""
        return self.__change_state(Transition.TRANSITION_ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Trigger the transition from active to inactive."""
        return self.__change_state(Transition.TRANSITION_DEACTIVATE)

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Add an entity whose callbacks run at each transition."""
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self.__managed_entities[entity] = None

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher[Any]:
        """Create a publisher that is active while the node is.

        The arguments are those of `create_publisher`.
        """
        if "publisher_class" in kwargs:
            raise TypeError("create_publisher() got an unexpected keyword argument 'publisher_class'")
        publisher = Node.create_publisher(
            cast("Node", self), *args, **kwargs, publisher_class=LifecyclePublisher
        )
        assert isinstance(publisher, LifecyclePublisher)
        self.add_managed_entity(publisher)
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher[Any]) -> bool:
        """Destroy a lifecycle publisher.

        Returns False if the node did not create it, or if it is destroyed already.
        """
        self.__managed_entities.pop(publisher, None)
        return Node.destroy_publisher(cast("Node", self), publisher)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Configure the managed entities."""
        return self.__call_entities("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clean up the managed entities."""
        return self.__call_entities("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shut down the managed entities."""
        return self.__call_entities("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Activate the managed entities.

        An overriding method has to call this one with `super()`.
        """
        return self.__call_entities("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate the managed entities.

        An overriding method has to call this one with `super()`.
        """
        return self.__call_entities("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Call `on_error` of the managed entities."""
        return self.__call_entities("on_error", state)

    def __call_entities(self, name: str, state: LifecycleState) -> TransitionCallbackReturn:
        """Call this callback of each managed entity, until one of them does not succeed."""
        for entity in self.__managed_entities:
            result = getattr(entity, name)(state)
            if not isinstance(result, TransitionCallbackReturn):
                raise TypeError(
                    f"{name}() return value of class {type(entity)} should be `TransitionCallbackReturn`.\n"
                    f"Instance of the class that caused the failure: {entity}"
                )
            if result is not TransitionCallbackReturn.SUCCESS:
                return result
        return TransitionCallbackReturn.SUCCESS

    def __change_state(self, transition_id: int) -> TransitionCallbackReturn:
        machine = self.__state_machine
        before = LifecycleState(label=machine.label, state_id=machine.number)
        machine.go(transition_id)
        result = self.__execute_callback(before)
        machine.go(result.to_label())
        if machine.label == "active":
            # Publishers that stay disabled drop messages although the node is active.
            publishers = [one for one in self.__managed_entities if isinstance(one, LifecyclePublisher)]
            if topics := [one.topic_name for one in publishers if not one.is_activated]:
                print_notice(
                    f"hint: the node is active, and {join_words(topics)} drops all messages: end "
                    "on_activate with return super().on_activate(state)."
                )
        if result is TransitionCallbackReturn.ERROR:
            machine.go(self.__execute_callback(before).to_label())
        return result

    def __execute_callback(self, before: LifecycleState) -> TransitionCallbackReturn:
        """Call the callback of the current transition state."""
        number = self.__state_machine.number
        try:
            return cast("TransitionCallbackReturn", self.__callbacks[number](before))
        # rclpy handles the error in the same way, but without printing it.
        except Exception as error:
            name, place = (
                cast("Node", self).get_fully_qualified_name(),
                line_of_traceback(error.__traceback__),
            )
            text = f"{name}: {_CALLBACKS[number]}() raised {type(error).__name__}: {error}"
            text = f"{text} ({place})" if place else text
            help_text = hint(error)
            print_notice(f"{text}; hint: {help_text}" if help_text else text)
            return TransitionCallbackReturn.ERROR


class LifecycleNode(LifecycleNodeMixin, Node):
    """A node with a managed state, initially unconfigured.

    The other arguments are those of Node.
    """

    def __init__(
        self,
        node_name: str,
        *,
        enable_communication_interface: bool = True,
        **kwargs: "Unpack[NodeOptions]",
    ) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)


_NAMES = private_names.OF_LIFECYCLE_NODES
private_names.watch_names(
    "Node", LifecycleNodeMixin, _NAMES, {name: attrgetter(f"_LifecycleNodeMixin_{name}") for name in _NAMES}
)
