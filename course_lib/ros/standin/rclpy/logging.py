"""Functions for loggers without a node, and for the levels of all loggers."""

from rclpy.impl.arguments import LoggingSeverity as LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger


def get_logger(name: str) -> RcutilsLogger:
    """Return the logger with this name."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return RcutilsLogger(name)


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:
    """Set the lowest severity that a logger logs."""
    if name is None:
        raise RuntimeError("Failed to set level for logger")
    if not isinstance(name, str):
        raise TypeError("rclpy_logging_set_logger_level(): incompatible function arguments.")
    RcutilsLogger(name).set_level(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the level that was set for the logger itself; UNSET if none was set."""
    return RcutilsLogger(name).level


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return the severity with this name, ignoring case. Raise a RuntimeError if there is none."""
    if not isinstance(log_severity, str | None):
        raise TypeError("rclpy_logging_severity_level_from_string(): incompatible function arguments.")
    try:
        return LoggingSeverity[(log_severity or "").upper()]
    except KeyError:
        raise RuntimeError("Failed to get severity name") from None


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level of a logger, or the level that it inherits."""
    if name is None:
        raise RuntimeError("Failed to get effective level for logger")
    if not isinstance(name, str):
        raise TypeError("rclpy_logging_get_logger_effective_level(): incompatible function arguments.")
    return RcutilsLogger(name).get_effective_level()
