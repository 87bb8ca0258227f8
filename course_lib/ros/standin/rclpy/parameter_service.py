"""The services of each node: its parameters, its process's log levels, and its types."""

import re
from contextlib import suppress
from functools import partial
from typing import Any

from rcl_interfaces import srv
from rcl_interfaces.msg import (
    LoggerLevel,
    ParameterDescriptor,
    ParameterType,
    SetLoggerLevelsResult,
    SetParametersResult,
)
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from type_description_interfaces.msg import Field, FieldType, IndividualTypeDescription, TypeSource
from type_description_interfaces.srv import GetTypeDescription

from course_lib.ros.messages.definitions import (
    EVENT_PART,
    describe_type,
    field_definitions,
    type_hash,
    typestore,
)
from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.impl.node_handle import AnyNode
from rclpy.logging import get_logger, get_logger_level, set_logger_level
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

    def __init__(self, node: AnyNode) -> None:
        self._node = node
        for name, kind in SERVICES.items():
            # rclpy calls the method, which a student's class may override.
            service = f"{node.get_name()}/{name}"
            callback = partial(self._answer, name)
            node.create_service(kind, service, callback, qos_profile=qos_profile_parameters)

    def _answer(self, service: str, request: Any, response: Any) -> Any:
        """Fill the response of a service. As in ROS, it stays empty if one parameter is unknown."""
        node = self._node
        with suppress(ParameterNotDeclaredException, ParameterUninitializedException):
            match service:
                case "describe_parameters":
                    response.descriptors = node.describe_parameters(request.names)
                case "get_parameters":
                    values = node.get_parameters(request.names)
                    response.values = [parameter.get_parameter_value() for parameter in values]
                case "get_parameter_types":
                    types = node.get_parameter_types(request.names)
                    response.types = [Parameter.Type(number).value for number in types]
                case "list_parameters":
                    response.result = node.list_parameters(request.prefixes, request.depth)
                case "set_parameters":
                    response.results = [self.__set_all([message]) for message in request.parameters]
                case "set_parameters_atomically":
                    response.result = self.__set_all(request.parameters)
        return response

    def __set_all(self, messages: list[Any]) -> SetParametersResult:
        parameters = [Parameter.from_parameter_msg(message) for message in messages]
        try:
            return self._node.set_parameters_atomically(parameters)
        except ParameterNotDeclaredException as error:
            return SetParametersResult(successful=False, reason=str(error))


class LoggingService:
    """The services `get_logger_levels` and `set_logger_levels` of a node."""

    def __init__(self, node: AnyNode) -> None:
        node.create_service(GetLoggerLevels, f"{node.handle.name}/get_logger_levels", self._get)
        node.create_service(SetLoggerLevels, f"{node.handle.name}/set_logger_levels", self._set)

    @staticmethod
    def _get(
        request: GetLoggerLevels.Request, response: GetLoggerLevels.Response
    ) -> GetLoggerLevels.Response:
        response.levels = [LoggerLevel(name=name, level=get_logger_level(name)) for name in request.names]
        return response

    @staticmethod
    def _set(
        request: SetLoggerLevels.Request, response: SetLoggerLevels.Response
    ) -> SetLoggerLevels.Response:
        for requested in request.levels:
            result = SetLoggerLevelsResult(successful=True)
            try:
                set_logger_level(requested.name, requested.level, detailed_error=True)
            except ValueError:
                reason = "Failed reason: Invalid logger level."
                result = SetLoggerLevelsResult(successful=False, reason=reason)
            response.results.append(result)
        return response


START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"
_ABOUT = "If enabled, start the ~/get_type_description service."
_HASH = re.compile(r"RIHS01_[0-9a-f]{64}")


class TypeDescriptionService:
    """The service `get_type_description` of a node, unless a parameter of the node disables it."""

    def __init__(self, node: AnyNode) -> None:
        self._node = node
        name = START_TYPE_DESCRIPTION_SERVICE_PARAM
        if not node.has_parameter(name):
            about = ParameterDescriptor(
                name=name, type=ParameterType.PARAMETER_BOOL, description=_ABOUT, read_only=True
            )
            node.declare_parameter(name, True, about)
        self.enabled = False
        parameter = node.get_parameter(name)
        if parameter.type_ is Parameter.Type.BOOL:
            self.enabled = parameter.value
        elif parameter.type_ is not Parameter.Type.NOT_SET:
            reason = f"Invalid type for parameter '{name}' {parameter.type_!r} should be bool"
            get_logger(node.handle.logger_name).error(reason)
        if self.enabled:
            node.create_service(GetTypeDescription, f"{node.handle.name}/get_type_description", self.__answer)

    def __answer(
        self, request: GetTypeDescription.Request, response: GetTypeDescription.Response
    ) -> GetTypeDescription.Response:
        """Describe the type with the requested hash.

        Failure reasons are quoted from rcl/src/rcl/node.c.
        """
        if not _HASH.fullmatch(request.type_hash):
            response.failure_reason = "Failed to parse type hash"
            return response
        # The types of the node's endpoints by their hashes.
        handle = self._node.handle
        endpoints = (info for info in handle.graph.endpoints() if info.node == handle.id)
        in_use = {info.type_name if info.service is None else info.service[1] for info in endpoints}
        name = {type_hash(name): name for name in sorted(in_use)}.get(request.type_hash)
        if name is None:
            response.failure_reason = "Type not currently in use by this node"
            return response
        descriptions = [
            IndividualTypeDescription(
                type_name=description["type_name"],
                fields=[Field(name=f["name"], type=FieldType(**f["type"])) for f in description["fields"]],
            )
            for description in describe_type(name).values()
        ]
        first, *referenced = descriptions
        referenced.sort(key=lambda description: description.type_name)
        response.type_description.type_description = first
        response.type_description.referenced_type_descriptions = referenced
        if request.include_type_sources:
            for type_name in (description.type_name for description in (first, *referenced)):
                # Service types and their events are not defined by a message's file.
                if type_name in field_definitions() and not type_name.endswith(EVENT_PART):
                    # The definition without comments and nested types.
                    text = typestore().generate_msgdef(type_name)[0].partition("=" * 80)[0]
                    source = TypeSource(type_name=type_name, encoding="msg", raw_file_contents=text)
                    response.type_sources.append(source)
        response.successful = True
        return response
