"""Clients of another node's parameters."""

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterEvent

from rclpy.callback_groups import CallbackGroup
from rclpy.client import wait_for_partner
from rclpy.parameter import Parameter
from rclpy.parameter_service import SERVICES
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.subscription import Subscription
from rclpy.task import Future

if TYPE_CHECKING:
    from rclpy.node import Node

OnDone = Callable[[Future[Any]], object]


class AsyncParameterClient:
    """A client of another node's parameter services, used while `node` is spun.

    Every answer comes as a future, and to a callback.
    """

    def __init__(
        self,
        node: "Node",
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.node, self.remote_node_name = node, remote_node_name
        self._clients = {
            name: node.create_client(
                kind, f"{remote_node_name}/{name}", qos_profile=qos_profile, callback_group=callback_group
            )
            for name, kind in SERVICES.items()
        }

    def services_are_ready(self) -> bool:
        """Return whether the other node is there."""
        return all(client.service_is_ready() for client in self._clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait until the other node is there, [s]; None: without limit; returns whether it is."""
        what = f"the parameters of {self.remote_node_name}"
        return wait_for_partner(self.node.handle, self.services_are_ready, timeout_sec, what)

    def list_parameters(
        self, prefixes: list[str] | None = None, depth: int | None = None, callback: OnDone | None = None
    ) -> Future[Any]:
        """List the names below `prefixes`, at most `depth` parts deep."""
        return self._call("list_parameters", callback, prefixes=prefixes or [], depth=depth or 0)

    def get_parameters(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Ask for values."""
        return self._call("get_parameters", callback, names=names)

    def get_parameter_types(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Ask for types."""
        return self._call("get_parameter_types", callback, names=names)

    def describe_parameters(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Ask for descriptors."""
        return self._call("describe_parameters", callback, names=names)

    def set_parameters(
        self, parameters: Sequence[Parameter | ParameterMsg], callback: OnDone | None = None
    ) -> Future[Any]:
        """Set values, each for itself."""
        return self._call("set_parameters", callback, parameters=_messages(parameters))

    def set_parameters_atomically(
        self, parameters: Sequence[Parameter | ParameterMsg], callback: OnDone | None = None
    ) -> Future[Any]:
        """Set all values or none."""
        return self._call("set_parameters_atomically", callback, parameters=_messages(parameters))

    def delete_parameters(self, names: list[str], callback: OnDone | None = None) -> Future[Any]:
        """Unset parameters, which have to be dynamically typed."""
        return self.set_parameters([Parameter(name) for name in names], callback)

    def on_parameter_event(
        self,
        callback: Callable[[ParameterEvent], object],
        qos_profile: QoSProfile = qos_profile_parameter_events,
        **options: Any,
    ) -> Subscription[ParameterEvent]:
        """Subscribe to every change of parameters, of all nodes."""
        return self.node.create_subscription(
            ParameterEvent, "/parameter_events", callback, qos_profile, **options
        )

    def _call(self, service: str, callback: OnDone | None, **request: Any) -> Future[Any]:
        future = self._clients[service].call_async(SERVICES[service].Request(**request))
        if callback is not None:
            future.add_done_callback(callback)
        return future


def _messages(parameters: Iterable[Parameter | ParameterMsg]) -> list[ParameterMsg]:
    return [one.to_parameter_msg() if isinstance(one, Parameter) else one for one in parameters]
