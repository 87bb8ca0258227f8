"""Loggers without a node, and the levels of all loggers."""

from rclpy.impl.logging_severity import LoggingSeverity as LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger


def get_logger(name: str) -> RcutilsLogger:
    """Return a logger by its name."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return RcutilsLogger(name)


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:
    """Log nothing of a logger that is less severe than `level`."""
    RcutilsLogger(name).set_level(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the level that was set for a logger itself; UNSET if none was."""
    return RcutilsLogger(name).level


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return the severity of a name, in any letters; raises a RuntimeError for an unknown one."""
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError:
        raise RuntimeError(f"failed to get severity from string: '{log_severity}'") from None


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level that a logger goes by, its own or the nearest above."""
    return RcutilsLogger(name).get_effective_level()
