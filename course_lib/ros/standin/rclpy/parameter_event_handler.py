"""Callbacks for parameter changes of any node."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterEvent

from rclpy.impl import names
from rclpy.qos import QoSProfile, qos_profile_parameter_events

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.node import Node
    from rclpy.qos_overriding_options import QoSOverridingOptions


@dataclass(eq=False)
class ParameterCallbackHandle:
    """Handle with which a callback for one parameter is removed."""

    parameter_name: str
    node_name: str
    callback: Callable[[ParameterMsg], object]


@dataclass(eq=False)
class ParameterEventCallbackHandle:
    """Handle with which a callback for all events is removed."""

    callback: Callable[[ParameterEvent], object]


class ParameterEventHandler:
    """Calls callbacks for /parameter_events while its node is spun, the newest callback first."""

    def __init__(
        self,
        node: "Node",
        qos_profile: QoSProfile = qos_profile_parameter_events,
        callback_group: "CallbackGroup | None" = None,
        event_callbacks: "SubscriptionEventCallbacks | None" = None,
        qos_overriding_options: "QoSOverridingOptions | None" = None,
        raw: bool = False,  # positional in rclpy
    ) -> None:
        self.node = node
        self.__handles: list[ParameterCallbackHandle] = []
        self.__event_handles: list[ParameterEventCallbackHandle] = []
        self.parameter_event_subscription = node.create_subscription(
            ParameterEvent,
            "/parameter_events",
            self.__on_event,
            qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )

    def destroy(self) -> None:
        """Destroy the subscription to parameter events."""
        self.node.destroy_subscription(self.parameter_event_subscription)

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[ParameterMsg], object]
    ) -> ParameterCallbackHandle:
        """Register a callback for each new value of a parameter.

        `node_name` "" stands for the handler's own node.
        """
        if not node_name:
            full_name = self.node.get_fully_qualified_name()
        elif node_name.startswith("/"):
            full_name = node_name
        else:
            full_name = names.join(self.node.get_namespace(), node_name)
        handle = ParameterCallbackHandle(parameter_name, full_name, callback)
        self.__handles.insert(0, handle)
        return handle

    def add_parameter_event_callback(
        self, callback: Callable[[ParameterEvent], object]
    ) -> ParameterEventCallbackHandle:
        """Register a callback for each parameter event."""
        handle = ParameterEventCallbackHandle(callback)
        self.__event_handles.insert(0, handle)
        return handle

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        """Remove a callback for a parameter. Raise a RuntimeError if it was not added."""
        # The handle of a callback for all events has no parameter_name, and raises AttributeError.
        if not handle.parameter_name or handle not in self.__handles:
            raise RuntimeError("Callback doesn't exist")
        self.__handles.remove(handle)

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        """Remove a callback for all events. Raise a RuntimeError if it was not added."""
        if handle not in self.__event_handles:
            raise RuntimeError("Callback doesn't exist")
        self.__event_handles.remove(handle)

    @staticmethod
    def get_parameters_from_event(event: ParameterEvent) -> Iterator[ParameterMsg]:
        """Return the parameters that an event reports as new or changed."""
        yield from event.new_parameters
        yield from event.changed_parameters

    @staticmethod
    def get_parameter_from_event(
        event: ParameterEvent, parameter_name: str, node_name: str
    ) -> ParameterMsg | None:
        """Return a parameter that an event reports as new or changed, or None."""
        parameters = ParameterEventHandler.get_parameters_from_event(event)
        same = (
            parameter
            for parameter in parameters
            if parameter.name == parameter_name and event.node == node_name
        )
        return next(same, None)

    def __on_event(self, event: ParameterEvent) -> None:
        for handle in tuple(self.__handles):
            parameter = self.get_parameter_from_event(event, handle.parameter_name, handle.node_name)
            if parameter is not None:
                handle.callback(parameter)
        for event_handle in tuple(self.__event_handles):
            event_handle.callback(event)
