"""Actions for nodes in launch descriptions. All of them accept a `condition`."""

from collections.abc import Iterable
from contextlib import suppress
from typing import Any, ClassVar

from launch.actions import EmitEvent, RegisterEventHandler, TimerAction
from launch.entities import Action, BaseEventHandler, LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some
from lifecycle_msgs.msg import Transition

from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState, StateTransition
from launch_ros.events.matchers import matches_node_name
from launch_ros.nodes import ComposableNodeContainer as ComposableNodeContainer
from launch_ros.nodes import LifecycleNode as LifecycleNode
from launch_ros.nodes import LoadComposableNodes as LoadComposableNodes
from launch_ros.nodes import Node as Node
from launch_ros.nodes import PushROSNamespace as PushROSNamespace
from launch_ros.nodes import PushRosNamespace as PushRosNamespace
from launch_ros.nodes import SetParameter as SetParameter
from launch_ros.nodes import SetParametersFromFile as SetParametersFromFile
from launch_ros.nodes import SetRemap as SetRemap
from launch_ros.nodes import SetROSLogDir as SetROSLogDir
from launch_ros.nodes import SetUseSimTime as SetUseSimTime


class ROSTimer(TimerAction):
    """Visits actions after a period of ROS time, which is robot time here."""


RosTimer = ROSTimer


class LifecycleTransition(Action):
    """Triggers a sequence of transitions of lifecycle nodes.

    The sequence of a node ends when one of its callbacks fails with an error.
    """

    transition_targets: ClassVar[dict[int, tuple[str, str]]] = {
        Transition.TRANSITION_CONFIGURE: ("configuring", "inactive"),
        Transition.TRANSITION_CLEANUP: ("cleaningup", "unconfigured"),
        Transition.TRANSITION_ACTIVATE: ("activating", "active"),
        Transition.TRANSITION_DEACTIVATE: ("deactivating", "inactive"),
        Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: ("shuttingdown", "finalized"),
        Transition.TRANSITION_INACTIVE_SHUTDOWN: ("shuttingdown", "finalized"),
        Transition.TRANSITION_ACTIVE_SHUTDOWN: ("shuttingdown", "finalized"),
    }

    def __init__(
        self,
        *,
        lifecycle_node_names: Iterable[Some],
        transition_ids: Iterable[int | Some],
        **options: Any,
    ) -> None:
        super().__init__(self._begin, **options)
        self._names, self._ids = list(lifecycle_node_names), list(transition_ids)
        if not self._ids:
            raise ValueError("No transition_ids provided.")
        if not self._names:
            raise ValueError("No lifecycle_node_names provided.")

    def _begin(self, context: LaunchContext) -> list[Action]:
        numbers = []
        for given in self._ids:
            text = str(given) if isinstance(given, int) else text_of(context, given)
            try:
                numbers.append(int(text))
            except ValueError as error:
                raise ValueError(f"expected integer for lifecycle transition, got {text}") from error
        return [action for name in self._names for action in self._row(text_of(context, name), numbers)]

    def _row(self, name: str, numbers: list[int]) -> list[Action]:
        """Return the actions for one node.

        They are a request for the first transition, and handlers that request the next transitions.
        """
        is_node = matches_node_name(name)
        requests = [
            EmitEvent(event=ChangeState(lifecycle_node_matcher=is_node, transition_id=number))
            for number in numbers
        ]
        handlers = [
            self._after(number, is_node, request)
            for number, request in zip(numbers, requests[1:], strict=False)
        ]

        def end(event: Any, context: LaunchContext) -> None:
            for handler in handlers:
                # A handler that has already been used is no longer registered.
                with suppress(ValueError):
                    context.unregister_event_handler(handler)

        def fails(event: Any) -> bool:
            is_transition = isinstance(event, StateTransition) and is_node(event.action)
            return is_transition and event.goal_state == "errorprocessing"

        at_error = BaseEventHandler(matcher=fails, entities=end, handle_once=True)
        return [*(RegisterEventHandler(handler) for handler in (*handlers, at_error)), requests[0]]

    def _after(self, number: int, is_node: Any, request: Action) -> OnStateTransition:
        """Return a handler that requests the next transition after this one."""
        states = self.transition_targets[number]

        def matches(event: Any) -> bool:
            is_transition = isinstance(event, StateTransition) and is_node(event.action)
            return is_transition and (event.start_state, event.goal_state) == states

        return OnStateTransition(matcher=matches, entities=[request], handle_once=True)
