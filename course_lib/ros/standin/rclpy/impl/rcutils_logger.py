"""Loggers: lines on stderr as ROS writes them, and messages on /rosout."""

import sys
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

from course_lib.ros.graph import current_graph
from course_lib.ros.repeated import repeated_lines
from rclpy.impl.log_filters import CallSite, asked
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.impl.run import current_run
from rclpy.time import Time


class RcutilsLogger:
    """A logger; `a.b` inherits the level of `a`."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._sites: dict[tuple[str, str, int, int], CallSite] = {}

    def get_child(self, name: str) -> "RcutilsLogger":
        """Return the logger for a part of what this one is for."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Log nothing that is less severe than `level`; UNSET goes back to the inherited level."""
        current_run().log_levels[self.name] = LoggingSeverity(level)

    def get_effective_level(self) -> LoggingSeverity:
        """Return the level that was set here, or else nearest above; INFO if nowhere."""
        levels = current_run().log_levels
        found = (levels[name] for name in _with_ancestors(self.name) if levels.get(name))
        return LoggingSeverity(next(found, LoggingSeverity.INFO))

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Say whether messages of a severity are logged."""
        return LoggingSeverity(severity) >= self.get_effective_level()

    def log(self, message: str, severity: LoggingSeverity | int, **kwargs: Any) -> bool:
        """Log a message; returns whether it was.

        `once=True`, `skip_first=True`, `throttle_duration_sec=...` (with a clock as
        `throttle_time_source_type`) choose among the calls from this place in the code, which may not ask for
        something else later; `name` stands in for the logger's.
        """
        if not self.is_enabled_for(severity):
            return False
        severity, name = LoggingSeverity(severity), kwargs.pop("name", self.name)
        frame = _caller()
        key = (frame.f_code.co_filename, frame.f_code.co_name, frame.f_lineno, frame.f_lasti)
        wanted = asked(severity, name, kwargs)
        if not self._sites.setdefault(key, CallSite(wanted)).lets_pass(wanted):
            return False
        if not isinstance(message, str):
            raise TypeError(
                "rclpy_logging_rcutils_log(): incompatible function arguments: the message must be a str, "
                f"not {type(message).__name__}; write str(...) or an f-string"
            )
        _write(severity, name, message, frame)
        return True

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Log what helps to find a mistake; shown when the level is DEBUG."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log what is good to know."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log what may be wrong."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    warn = warning

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log what went wrong."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log what the program cannot go on after."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)


def _write(severity: LoggingSeverity, name: str, message: str, frame: FrameType) -> None:
    seconds, nanoseconds = divmod(current_graph().now_ns, 10**9)
    line = f"[{severity.name}] [{seconds}.{nanoseconds:09d}] [{name}]: {message}"
    if current_graph().notebook:
        repeated_lines.write(f"{severity.name} {name} {message}", line)
    else:
        sys.stderr.write(f"{line}\n")
    rosout = current_run().rosout
    publisher = next((rosout[part] for part in _with_ancestors(name) if part in rosout), None)
    if publisher is None or not publisher.handle.node.context.is_valid:
        return
    from rcl_interfaces.msg import Log

    publisher.publish(
        Log(
            stamp=Time(nanoseconds=current_graph().now_ns).to_msg(),
            level=int(severity),
            name=name,
            msg=message,
            file=_file_name(frame.f_code.co_filename),
            function=frame.f_code.co_name,
            line=frame.f_lineno,
        )
    )


def _caller() -> FrameType:
    """Find the frame of the program's call."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
    return frame


@cache
def _file_name(code_file: str) -> str:
    """Name a file in a way that is the same on all machines; a notebook's cells have no files."""
    path = Path(code_file)
    return path.name if path.is_file() else "cell"


def _with_ancestors(name: str) -> list[str]:
    """List a logger's name, those of its ancestors, and the root's."""
    parts = name.split(".")
    return [".".join(parts[:count]) for count in range(len(parts), 0, -1)] + ([""] if name else [])
