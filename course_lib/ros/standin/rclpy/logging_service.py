"""The services by which other nodes query and set the log levels of a node's process."""

from rcl_interfaces.msg import LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

from rclpy.impl.node_handle import NodeInterface
from rclpy.logging import get_logger_level, set_logger_level


class LoggingService:
    """The services `get_logger_levels` and `set_logger_levels` of a node."""

    def __init__(self, node: NodeInterface) -> None:
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
            except ValueError as error:
                result = SetLoggerLevelsResult(successful=False, reason=str(error))
            response.results.append(result)
        return response
