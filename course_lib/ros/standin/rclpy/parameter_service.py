"""The services with which other nodes read and change a node's parameters."""

from typing import Any

from rcl_interfaces import srv
from rcl_interfaces.msg import SetParametersResult

from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.impl.node_handle import NodeInterface
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_parameters

SERVICES: dict[str, Any] = {
    "describe_parameters": srv.DescribeParameters,
    "get_parameters": srv.GetParameters,
    "get_parameter_types": srv.GetParameterTypes,
    "list_parameters": srv.ListParameters,
    "set_parameters": srv.SetParameters,
    "set_parameters_atomically": srv.SetParametersAtomically,
}


class ParameterService:
    """The parameter services of a node. A node creates one by default."""

    def __init__(self, node: NodeInterface) -> None:
        self._node = node
        for name, kind in SERVICES.items():
            answer = getattr(self, f"_{name}")
            node.create_service(
                kind, f"{node.handle.name}/{name}", answer, qos_profile=qos_profile_parameters
            )

    def _describe_parameters(self, request: Any, response: Any) -> Any:
        """Describe all requested parameters, or none if one of them is not declared, as in ROS."""
        node: Any = self._node
        if all(map(node.has_parameter, request.names)) or node._allow_undeclared_parameters:
            response.descriptors = self._node.describe_parameters(request.names)
        return response

    def _get_parameters(self, request: Any, response: Any) -> Any:
        try:
            parameters = self._node.get_parameters(request.names)
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            return response
        response.values = [parameter.get_parameter_value() for parameter in parameters]
        return response

    def _get_parameter_types(self, request: Any, response: Any) -> Any:
        try:
            response.types = self._node.get_parameter_types(request.names)
        except ParameterNotDeclaredException:
            response.types = []
        return response

    def _list_parameters(self, request: Any, response: Any) -> Any:
        response.result = self._node.list_parameters(request.prefixes, request.depth)
        return response

    def _set_parameters(self, request: Any, response: Any) -> Any:
        response.results = [self.__set_all([parameter]) for parameter in request.parameters]
        return response

    def _set_parameters_atomically(self, request: Any, response: Any) -> Any:
        response.result = self.__set_all(request.parameters)
        return response

    def __set_all(self, messages: list[Any]) -> SetParametersResult:
        try:
            return self._node.set_parameters_atomically([Parameter.from_parameter_msg(m) for m in messages])
        except ParameterNotDeclaredException as error:
            return SetParametersResult(successful=False, reason=str(error))
