"""The services by which other nodes see and set the levels of a node's process."""

from rcl_interfaces.msg import LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

from rclpy.impl.node_parameters import Node
from rclpy.logging import get_logger_level, set_logger_level


class LoggingService:
    """The services `get_logger_levels` and `set_logger_levels` of a node."""

    def __init__(self, node: Node) -> None:
        node.create_service(GetLoggerLevels, "~/get_logger_levels", self._get)
        node.create_service(SetLoggerLevels, "~/set_logger_levels", self._set)

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
        response.results = [_set_level(wanted) for wanted in request.levels]
        return response


def _set_level(wanted: LoggerLevel) -> SetLoggerLevelsResult:
    try:
        set_logger_level(wanted.name, wanted.level, detailed_error=True)
    except ValueError as error:
        return SetLoggerLevelsResult(successful=False, reason=str(error))
    return SetLoggerLevelsResult(successful=True)
