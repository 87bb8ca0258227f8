"""The actions of a launch with nodes; each takes a `condition`."""

from collections.abc import Iterable
from contextlib import suppress
from typing import Any, ClassVar

from launch.actions import EmitEvent, RegisterEventHandler, TimerAction
from launch.entities import Action, BaseEventHandler, LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some
from lifecycle_msgs.msg import Transition

from launch_ros.composition import ComposableNodeContainer as ComposableNodeContainer
from launch_ros.composition import LoadComposableNodes as LoadComposableNodes
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState, StateTransition
from launch_ros.events.matchers import matches_node_name
from launch_ros.nodes import LifecycleNode as LifecycleNode
from launch_ros.nodes import Node as Node
from launch_ros.settings import PushROSNamespace as PushROSNamespace
from launch_ros.settings import PushRosNamespace as PushRosNamespace
from launch_ros.settings import SetParameter as SetParameter
from launch_ros.settings import SetParametersFromFile as SetParametersFromFile
from launch_ros.settings import SetRemap as SetRemap
from launch_ros.settings import SetROSLogDir as SetROSLogDir
from launch_ros.settings import SetUseSimTime as SetUseSimTime


class ROSTimer(TimerAction):
    """Actions after so many seconds of ROS time, which is robot time."""


RosTimer = ROSTimer


class LifecycleTransition(Action):
    """Leads lifecycle nodes through transitions, one after the other; an error of a node ends its row."""

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
        numbers = [_number(context, given) for given in self._ids]
        return [action for name in self._names for action in self._row(text_of(context, name), numbers)]

    def _row(self, name: str, numbers: list[int]) -> list[Action]:
        """Return the actions for one node: the first transition, and handlers that ask for the next ones."""
        is_node = matches_node_name(name)
        wishes = [
            EmitEvent(event=ChangeState(lifecycle_node_matcher=is_node, transition_id=number))
            for number in numbers
        ]
        handlers = [
            self._after(number, is_node, wish) for number, wish in zip(numbers, wishes[1:], strict=False)
        ]

        def end(event: Any, context: LaunchContext) -> None:
            for handler in handlers:
                with suppress(ValueError):  # it was used before
                    context.unregister_event_handler(handler)

        def fails(event: Any) -> bool:
            is_transition = isinstance(event, StateTransition) and is_node(event.action)
            return is_transition and event.goal_state == "errorprocessing"

        at_error = BaseEventHandler(matcher=fails, entities=end, handle_once=True)
        return [*(RegisterEventHandler(handler) for handler in (*handlers, at_error)), wishes[0]]

    def _after(self, number: int, is_node: Any, wish: Action) -> OnStateTransition:
        states = self.transition_targets[number]

        def matches(event: Any) -> bool:
            is_transition = isinstance(event, StateTransition) and is_node(event.action)
            return is_transition and (event.start_state, event.goal_state) == states

        return OnStateTransition(matcher=matches, entities=[wish], handle_once=True)


def _number(context: LaunchContext, given: int | Some) -> int:
    text = str(given) if isinstance(given, int) else text_of(context, given)
    try:
        return int(text)
    except ValueError as error:
        raise ValueError(f"expected integer for lifecycle transition, got {text}") from error
