"""Loggers: lines on stderr as ROS writes them, and messages on /rosout."""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

from course_lib.ros.graph import current_graph
from course_lib.ros.notices import repeated_lines
from rclpy.clock import Clock
from rclpy.impl.logging_severity import LoggingSeverity, LogLevels
from rclpy.time import Time

if TYPE_CHECKING:
    from rcl_interfaces.msg import Log

# The filters in the order they are asked in, and their options, of which the first one is required.
FILTERS = {
    "throttle": ("throttle_duration_sec", "throttle_time_source_type"),
    "skip_first": ("skip_first",),
    "once": ("once",),
}
KNOWN = [option for options in FILTERS.values() for option in options]
_CLOCK = Clock()


@dataclass
class Rosout:
    """The functions that publish log messages on /rosout, by logger, of one program in a run."""

    publish: "dict[str, Callable[[Log], None]]" = field(default_factory=dict)


@dataclass
class CallSite:
    """A place in the code that logs: the options of its first call, and its state so far."""

    asked: dict[str, Any]
    last_ns: int = 0
    logged_once: bool = False
    skipped_first: bool = False

    def lets_pass(self, asked: dict[str, Any]) -> bool:
        """Return whether a call is logged; raises a ValueError if its options have changed."""
        for what, value in asked.items():
            if value != self.asked[what]:
                raise ValueError(f"{what} cannot be changed between calls.")
        ask = {"throttle": self._throttle, "skip_first": self._skip_first, "once": self._once}
        return all(ask[name]() for name in asked["Requested logging filters"])

    def _throttle(self) -> bool:
        options = self.asked["Logging filter parameters"]
        now_ns: int = (options["throttle_time_source_type"] or _CLOCK).now().nanoseconds
        if now_ns < self.last_ns + options["throttle_duration_sec"] * 1e9:
            return False
        self.last_ns = now_ns
        return True

    def _skip_first(self) -> bool:
        passes, self.skipped_first = self.skipped_first, True
        return passes

    def _once(self) -> bool:
        passes, self.logged_once = not self.logged_once, True
        return passes


class RcutilsLogger:
    """A logger; `a.b` inherits the level of `a`."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._sites: dict[tuple[str, str, int, int], CallSite] = {}

    def get_child(self, name: str) -> "RcutilsLogger":
        """Return the logger of a part."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Set the lowest severity that is logged; UNSET goes back to the inherited level."""
        current_graph().part(LogLevels).by_logger[self.name] = LoggingSeverity(level)

    @property
    def level(self) -> LoggingSeverity:
        """The level that was set here; UNSET if none was."""
        return LoggingSeverity(
            current_graph().part(LogLevels).by_logger.get(self.name, LoggingSeverity.UNSET)
        )

    def get_effective_level(self) -> LoggingSeverity:
        """Return the level that was set here, or else nearest above; INFO if nowhere."""
        levels = current_graph().part(LogLevels).by_logger
        found = (levels[name] for name in _with_ancestors(self.name) if levels.get(name))
        return LoggingSeverity(next(found, LoggingSeverity.INFO))

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Return whether messages of a severity are logged."""
        return LoggingSeverity(severity) >= self.get_effective_level()

    def log(self, message: str, severity: LoggingSeverity | int, **kwargs: Any) -> bool:
        """Log a message; returns whether it was.

        `once=True`, `skip_first=True`, `throttle_duration_sec=...` (with a clock as
        `throttle_time_source_type`) choose among the calls from this place in the code, whose options may not
        change; `name` replaces the logger's.
        """
        if not self.is_enabled_for(severity):
            return False
        severity, name = LoggingSeverity(severity), kwargs.pop("name", self.name)
        frame = _caller()
        key = (frame.f_code.co_filename, frame.f_code.co_name, frame.f_lineno, frame.f_lasti)
        wanted = _asked(severity, name, kwargs)
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
        """Log a detail that helps to find a mistake; shown when the level is DEBUG."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log a piece of information."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log a warning."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    warn = warning

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log an error."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log an error after which the program cannot go on."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)


def _write(severity: LoggingSeverity, name: str, message: str, frame: FrameType) -> None:
    seconds, nanoseconds = divmod(current_graph().now_ns, 10**9)
    line = f"[{severity.name}] [{seconds}.{nanoseconds:09d}] [{name}]: {message}"
    if current_graph().notebook:
        repeated_lines.write(f"{severity.name} {name} {message}", line)
    else:
        sys.stderr.write(f"{line}\n")
    rosout = current_graph().part(Rosout).publish
    publish = next((rosout[part] for part in _with_ancestors(name) if part in rosout), None)
    if publish is None:
        return
    from rcl_interfaces.msg import Log

    publish(
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


def _asked(severity: LoggingSeverity, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Collect the options of a call, by the words in which rclpy complains if they change."""
    filters = [each for each, options in FILTERS.items() if any(given.get(option) for option in options)]
    for each in filters:
        if FILTERS[each][0] not in given:
            raise TypeError(
                f'required parameter "{FILTERS[each][0]}" not specified '
                f'but is required for the the logging filter "{each}"'
            )
    for option in given:
        if option not in KNOWN:
            raise TypeError(f'parameter "{option}" is not one of the recognized logging options "{KNOWN}"')
    source = given.get("throttle_time_source_type", _CLOCK)
    if not isinstance(source, Clock):
        raise ValueError(f'Received throttle_time_source_type of "{source}" is not a clock instance')
    parameters = {option: given.get(option) for each in filters for option in FILTERS[each]}
    return {
        "Logger severity": severity,
        "Logger name": name,
        "Requested logging filters": filters,
        "Logging filter parameters": parameters,
    }
