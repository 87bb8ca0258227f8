"""Clients of the parameter services of another node."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterEvent

from course_lib.ros.time.time_lock import time_lock
from rclpy.callback_groups import CallbackGroup
from rclpy.client import wait_for_partner
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.parameter_service import SERVICES
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.subscription import Subscription
from rclpy.task import Future

if TYPE_CHECKING:
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.node import Node
    from rclpy.qos_overriding_options import QoSOverridingOptions

# The order in which rclpy creates the clients.
ORDER = (
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "get_parameter_types",
    "describe_parameters",
    "set_parameters_atomically",
)
OnDone: TypeAlias = "Callable[[Future[Any]], object]"


class AsyncParameterClient:
    """A client of another node's parameter services. It works while `node` is spun.

    Each method returns a future and can also call a callback with the response.
    """

    def __init__(
        self,
        node: Node,
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.node, self.remote_node_name = node, remote_node_name
        self.__clients = {
            name: node.create_client(
                SERVICES[name],
                f"{remote_node_name}/{name}",
                qos_profile=qos_profile,
                callback_group=callback_group,
            )
            for name in ORDER
        }

    def services_are_ready(self) -> bool:
        """Return whether the services of the other node are available."""
        time_lock.poll()
        return self.__are_ready()

    def __are_ready(self) -> bool:
        return all(client._course_is_ready() for client in self.__clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait at most `timeout_sec` [s] for the services, without limit if None.

        Return whether they are available.
        """
        awaited = f"the parameters of {self.remote_node_name}"
        return wait_for_partner(self.node.handle, self.__are_ready, timeout_sec, awaited)

    def list_parameters(
        self,
        prefixes: list[str] | None = None,
        depth: int | None = None,
        callback: OnDone | None = None,
    ) -> Future[Any]:
        """Request the names below `prefixes`, at most `depth` tokens deep."""
        return self.__call("list_parameters", callback, prefixes=prefixes or [], depth=depth or 0)

    def get_parameters(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Request parameter values."""
        return self.__call("get_parameters", callback, names=names)

    def get_parameter_types(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Request parameter types."""
        return self.__call("get_parameter_types", callback, names=names)

    def describe_parameters(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Request parameter descriptors."""
        return self.__call("describe_parameters", callback, names=names)

    def set_parameters(
        self, parameters: Sequence[Parameter | ParameterMsg], callback: OnDone | None = None
    ) -> Future[Any]:
        """Set parameters independently of each other."""
        return self.__call("set_parameters", callback, parameters=_messages(parameters))

    def set_parameters_atomically(
        self, parameters: Sequence[Parameter | ParameterMsg], callback: OnDone | None = None
    ) -> Future[Any]:
        """Set all parameters or none of them."""
        return self.__call("set_parameters_atomically", callback, parameters=_messages(parameters))

    def delete_parameters(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Delete parameters, which have to be dynamically typed."""
        return self.set_parameters([Parameter(name) for name in names], callback)

    def load_parameter_file(
        self, parameter_file: str, use_wildcard: bool = False, callback: OnDone | None = None
    ) -> Future[Any]:
        """Set the parameters of a YAML file independently of each other."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters(list(parameters.values()), callback)

    def load_parameter_file_atomically(
        self, parameter_file: str, use_wildcard: bool = False, callback: OnDone | None = None
    ) -> Future[Any]:
        """Set all parameters of a YAML file or none of them."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters_atomically(list(parameters.values()), callback)

    def on_parameter_event(
        self,
        callback: Callable[[ParameterEvent], object],
        qos_profile: QoSProfile = qos_profile_parameter_events,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription[ParameterEvent]:
        """Subscribe to parameter events of all nodes."""
        return self.node.create_subscription(
            ParameterEvent,
            "/parameter_events",
            callback,
            qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )

    def __call(self, service: str, callback: OnDone | None, **request: Any) -> Future[Any]:
        future = self.__clients[service].call_async(SERVICES[service].Request(**request))
        if callback is not None:
            future.add_done_callback(callback)
        return future


def _messages(parameters: Iterable[Parameter | ParameterMsg]) -> list[ParameterMsg]:
    return [p.to_parameter_msg() if isinstance(p, Parameter) else p for p in parameters]
