"""Callbacks at changes of parameters, of any node."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterEvent

from rclpy.impl import names
from rclpy.qos import QoSProfile, qos_profile_parameter_events

if TYPE_CHECKING:
    from rclpy.node import Node


@dataclass(eq=False)
class ParameterCallbackHandle:
    """The handle of a callback for one parameter, with which it is removed."""

    parameter_name: str
    node_name: str
    callback: Callable[[ParameterMsg], object]


@dataclass(eq=False)
class ParameterEventCallbackHandle:
    """The handle of a callback for all events, with which it is removed."""

    callback: Callable[[ParameterEvent], object]


class ParameterEventHandler:
    """Callbacks for /parameter_events while its node is spun; the newest are called first."""

    def __init__(
        self, node: "Node", qos_profile: QoSProfile = qos_profile_parameter_events, **options: Any
    ) -> None:
        self.node = node
        self._handles: list[ParameterCallbackHandle | ParameterEventCallbackHandle] = []
        self.parameter_event_subscription = node.create_subscription(
            ParameterEvent, "/parameter_events", self._tell, qos_profile, **options
        )

    def destroy(self) -> None:
        """Listen no more."""
        self.node.destroy_subscription(self.parameter_event_subscription)

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[ParameterMsg], object]
    ) -> ParameterCallbackHandle:
        """Call back with each new value of one parameter; "" means the handler's own node."""
        if not node_name:
            full_name = self.node.get_fully_qualified_name()
        elif node_name.startswith("/"):
            full_name = node_name
        else:
            full_name = names.join(self.node.get_namespace(), node_name)
        handle = ParameterCallbackHandle(parameter_name, full_name, callback)
        self._handles.insert(0, handle)
        return handle

    def add_parameter_event_callback(
        self, callback: Callable[[ParameterEvent], object]
    ) -> ParameterEventCallbackHandle:
        """Call back with each event."""
        handle = ParameterEventCallbackHandle(callback)
        self._handles.insert(0, handle)
        return handle

    def remove_parameter_callback(
        self, handle: ParameterCallbackHandle | ParameterEventCallbackHandle
    ) -> None:
        """Call it no more; raises a RuntimeError if it was not to be called."""
        if handle not in self._handles:
            raise RuntimeError("Callback doesn't exist")
        self._handles.remove(handle)

    remove_parameter_event_callback = remove_parameter_callback

    @staticmethod
    def get_parameters_from_event(event: ParameterEvent) -> Iterator[ParameterMsg]:
        """List what an event gave a value."""
        yield from event.new_parameters
        yield from event.changed_parameters

    @staticmethod
    def get_parameter_from_event(
        event: ParameterEvent, parameter_name: str, node_name: str
    ) -> ParameterMsg | None:
        """Find a parameter in an event."""
        found = ParameterEventHandler.get_parameters_from_event(event)
        same = (one for one in found if one.name == parameter_name and event.node == node_name)
        return next(same, None)

    def _tell(self, event: ParameterEvent) -> None:
        for handle in [one for one in self._handles if isinstance(one, ParameterCallbackHandle)]:
            found = self.get_parameter_from_event(event, handle.parameter_name, handle.node_name)
            if found is not None:
                handle.callback(found)
        for every in [one for one in self._handles if isinstance(one, ParameterEventCallbackHandle)]:
            every.callback(event)
