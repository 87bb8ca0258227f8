"""The services with which other nodes see and change a node's state."""

from collections.abc import Callable
from typing import Any

from lifecycle_msgs import srv

from rclpy.callback_groups import CallbackGroup
from rclpy.lifecycle.managed_entity import TransitionCallbackReturn
from rclpy.lifecycle.state_machine import STATES, STEPS, StateMachine, description_of, message_of
from rclpy.node import Node


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
