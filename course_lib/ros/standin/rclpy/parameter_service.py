"""The services with which other nodes see and change a node's parameters."""

from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_parameters

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node


class ParameterService:
    """Offers a node's parameters to others; a node makes one unless it is told not to."""

    def __init__(self, node: "Node") -> None:
        self._node = node
        services: dict[str, tuple[type, Callable[[Any, Any], Any]]] = {
            "describe_parameters": (DescribeParameters, self._describe),
            "get_parameters": (GetParameters, self._get),
            "get_parameter_types": (GetParameterTypes, self._get_types),
            "list_parameters": (ListParameters, self._list),
            "set_parameters": (SetParameters, self._set),
            "set_parameters_atomically": (SetParametersAtomically, self._set_atomically),
        }
        for name, (kind, answer) in services.items():
            node.create_service(kind, f"~/{name}", answer, qos_profile=qos_profile_parameters)

    def _describe(self, request: Any, response: Any) -> Any:
        """Describe all that are asked for, or none if one of them is not there, as in ROS."""
        if all(map(self._node.has_parameter, request.names)) or self._node._allow_undeclared_parameters:
            response.descriptors = self._node.describe_parameters(request.names)
        return response

    def _get(self, request: Any, response: Any) -> Any:
        try:
            parameters = self._node.get_parameters(request.names)
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            return response
        response.values = [parameter.get_parameter_value() for parameter in parameters]
        return response

    def _get_types(self, request: Any, response: Any) -> Any:
        try:
            response.types = self._node.get_parameter_types(request.names)
        except ParameterNotDeclaredException:
            response.types = []
        return response

    def _list(self, request: Any, response: Any) -> Any:
        response.result = self._node.list_parameters(request.prefixes, request.depth)
        return response

    def _set(self, request: Any, response: Any) -> Any:
        response.results = [self._set_all([parameter]) for parameter in request.parameters]
        return response

    def _set_atomically(self, request: Any, response: Any) -> Any:
        response.result = self._set_all(request.parameters)
        return response

    def _set_all(self, messages: list[Any]) -> SetParametersResult:
        try:
            return self._node.set_parameters_atomically([Parameter.from_parameter_msg(m) for m in messages])
        except ParameterNotDeclaredException as error:
            return SetParametersResult(successful=False, reason=str(error))
