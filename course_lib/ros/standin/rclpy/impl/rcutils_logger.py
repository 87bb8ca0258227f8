"""Loggers, which write lines to stderr in ROS's format and publish messages on /rosout."""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, ClassVar

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.notices import repeated_lines
from rclpy.clock import Clock
from rclpy.impl.arguments import LoggingSeverity, LogLevels
from rclpy.time import Time

if TYPE_CHECKING:
    from rcl_interfaces.msg import Log

# rcl's warning. The field is the name of the logger.
SAME_NAME = (
    "Publisher already registered for node name: '{0}'. If this is due to multiple nodes with "
    "the same name then all logs for the logger named '{0}' will go out over the existing "
    "publisher. As soon as any node with that name is destructed it will unregister the "
    "publisher, preventing any further logs for that name from being published on the rosout "
    "topic."
)


class LoggingFilter:
    """Base class of the logging filters, which decide whether a logging call is shown.

    `params` has the options with their defaults. An option with the default None is required. A
    context is the state of one call in the source code.
    """

    params: ClassVar[dict[str, Any]] = {}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        """Store the options and the initial state in the context of a call."""
        for option, default in cls.params.items():
            context[option] = kwargs.get(option, default)
            if context[option] is None:
                raise TypeError(
                    f'Required parameter "{option}" was not specified for logging filter "{cls.__name__}"'
                )

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Return whether the call is shown now, and update the context."""
        return True


class Once(LoggingFilter):
    """Passes only the first execution of a call."""

    params: ClassVar[dict[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        """Store the options and the initial state in the context of a call."""
        super().initialize_context(context, **kwargs)
        context["has_been_logged_once"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Return whether this is the first execution."""
        is_first, context["has_been_logged_once"] = not context["has_been_logged_once"], True
        return is_first


class Throttle(LoggingFilter):
    """Shows a call if the last one that was shown is at least `throttle_duration_sec` ago."""

    params: ClassVar[dict[str, Any]] = {
        "throttle_duration_sec": None,
        "throttle_time_source_type": Clock(),
    }

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        """Store the options and the initial state in the context of a call."""
        super().initialize_context(context, **kwargs)
        context["throttle_last_logged"] = 0
        source = context["throttle_time_source_type"]
        if not isinstance(source, Clock):
            raise ValueError(f'Received throttle_time_source_type of "{source}" is not a clock instance')

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Return whether the duration has passed."""
        now_ns: int = context["throttle_time_source_type"].now().nanoseconds
        is_over: bool = now_ns >= context["throttle_last_logged"] + context["throttle_duration_sec"] * 1e9
        if is_over:
            context["throttle_last_logged"] = now_ns
        return is_over


class SkipFirst(LoggingFilter):
    """Shows all executions of a call except the first."""

    params: ClassVar[dict[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        """Store the options and the initial state in the context of a call."""
        super().initialize_context(context, **kwargs)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Return whether the first execution was skipped before."""
        was_skipped: bool = context["first_has_been_skipped"]
        context["first_has_been_skipped"] = True
        return was_skipped


# In the order of their evaluation.
supported_filters: dict[str, type[LoggingFilter]] = {
    "throttle": Throttle,
    "skip_first": SkipFirst,
    "once": Once,
}


def get_filters_from_kwargs(**kwargs: Any) -> list[str]:
    """Return the names of the filters that a call's options select, in order of evaluation.

    Raise a TypeError if a required option is missing, or an option is unknown.
    """
    filters = [
        name for name, rule in supported_filters.items() if any(kwargs.get(option) for option in rule.params)
    ]
    for name in filters:
        for option, default in supported_filters[name].params.items():
            if option not in kwargs and default is None:
                raise TypeError(
                    f'required parameter "{option}" not specified '
                    f'but is required for the the logging filter "{name}"'
                )
    known = [option for value in supported_filters.values() for option in value.params]
    for option in kwargs:
        if option not in known:
            raise TypeError(f'parameter "{option}" is not one of the recognized logging options "{known}"')
    return filters


@dataclass
class Rosout:
    """The functions that publish log messages on /rosout, by logger name, for one program in a run."""

    publish: "dict[str, Callable[[Log], None]]" = field(default_factory=dict)


@dataclass
class CallSite:
    """A logging call in the source: the options of its first execution, and its filters' state."""

    options: dict[str, Any]
    context: dict[str, Any] = field(default_factory=dict)


class RcutilsLogger:
    """A logger. The logger `a.b` inherits the level of `a`."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.__sites: dict[tuple[str, str, int, int], CallSite] = {}

    def get_child(self, name: str) -> "RcutilsLogger":
        """Return the child logger with this name."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(self.name + "." + name if self.name else name)

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Set the lowest severity that is logged. UNSET restores the inherited level."""
        current_graph().state(LogLevels).by_logger[self.name] = LoggingSeverity(level)

    @property
    def level(self) -> LoggingSeverity:
        """The level that was set for this logger; UNSET if none was set."""
        return LoggingSeverity(
            current_graph().state(LogLevels).by_logger.get(self.name, LoggingSeverity.UNSET)
        )

    def get_effective_level(self) -> LoggingSeverity:
        """Return the level of this logger or of the nearest ancestor that has one; INFO by default."""
        levels = current_graph().state(LogLevels).by_logger
        ancestor_levels = (levels[name] for name in _with_ancestors(self.name) if levels.get(name))
        return LoggingSeverity(next(ancestor_levels, LoggingSeverity.INFO))

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Return whether messages of a severity are logged."""
        return LoggingSeverity(severity) >= self.get_effective_level()

    def log(
        self,
        message: str | bytes | None,
        severity: LoggingSeverity | int,
        **kwargs: Any,
    ) -> bool:
        """Log a message and return whether it was logged.

        `once=True`, `skip_first=True` and `throttle_duration_sec=...` (with a clock as
        `throttle_time_source_type`) filter the calls from this line of code; these options must
        stay the same between calls. `name` replaces the logger's name.
        """
        if not self.is_enabled_for(severity):
            return False
        severity, name = LoggingSeverity(severity), kwargs.pop("name", self.name)
        if not isinstance(name, str | None):
            raise TypeError("rclpy_logging_rcutils_log(): incompatible function arguments.")
        name = name or ""
        # The frame that called the logger.
        frame = sys._getframe(1)
        while frame.f_back is not None and frame.f_code.co_filename == __file__:
            frame = frame.f_back
        key = (frame.f_code.co_filename, frame.f_code.co_name, frame.f_lineno, frame.f_lasti)
        options = _collect_options(severity, name, kwargs)
        filters = [supported_filters[each] for each in options["Requested logging filters"]]
        site = self.__sites.get(key)
        if site is None:
            site = CallSite(options)
            for each in filters:
                each.initialize_context(site.context, **kwargs)
            self.__sites[key] = site
        for option, value in options.items():
            if value != site.options[option]:
                raise ValueError(f"{option} cannot be changed between calls.")
        if not all(each.should_log(site.context) for each in filters):
            return False
        _write(severity, name, _text(message), frame)
        return True

    def debug(self, message: str | bytes | None, **kwargs: Any) -> bool:
        """Log debugging details. Shown if the level is DEBUG."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str | bytes | None, **kwargs: Any) -> bool:
        """Log an informational message."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str | bytes | None, **kwargs: Any) -> bool:
        """Log a warning."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    warn = warning

    def error(self, message: str | bytes | None, **kwargs: Any) -> bool:
        """Log an error."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str | bytes | None, **kwargs: Any) -> bool:
        """Log an error after which the program cannot continue."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)


def _text(message: object) -> str:
    """Return a message as the C function of rclpy receives it.

    It takes bytes and None as well, and its strings end at a zero character.
    """
    if message is None:
        return "(null)"
    if isinstance(message, (bytes, bytearray)):
        message = message.decode(errors="replace")
    if not isinstance(message, str):
        raise TypeError(
            "rclpy_logging_rcutils_log(): incompatible function arguments: the message must be a "
            f"str, not {type(message).__name__}; write str(...) or an f-string"
        )
    if not message.isascii():
        try:
            message.encode()
        except UnicodeEncodeError:
            raise TypeError(
                "rclpy_logging_rcutils_log(): incompatible function arguments: the message has "
                "half of a surrogate pair, which UTF-8 cannot encode"
            ) from None
    return message.partition("\0")[0]


def _write(severity: LoggingSeverity, name: str, message: str, frame: FrameType) -> None:
    seconds, nanoseconds = divmod(current_graph().now_ns, 10**9)
    line = f"[{severity.name}] [{seconds}.{nanoseconds:09d}] [{name}]: {message}"
    if current_graph().notebook:
        repeated_lines.write(f"{severity.name} {name} {message}", line)
    else:
        sys.stderr.write(f"{line}\n")
    rosout = current_graph().state(Rosout).publish
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


@cache
def _file_name(code_file: str) -> str:
    """Return a file name that is the same on all machines; "cell" for a notebook cell, which has no file."""
    path = Path(code_file)
    return path.name if path.is_file() else "cell"


def _with_ancestors(name: str) -> list[str]:
    """List a logger's name and the names of its ancestors up to the root logger."""
    parts = name.split(".")
    return [".".join(parts[:count]) for count in range(len(parts), 0, -1)] + ([""] if name else [])


def _collect_options(
    severity: LoggingSeverity,
    name: str,
    keywords: Mapping[str, Any],
) -> dict[str, Any]:
    """Collect a call's options under the names of rclpy's error for changed options."""
    filters = get_filters_from_kwargs(**keywords)
    parameters = {
        option: keywords.get(option, default)
        for each in filters
        for option, default in supported_filters[each].params.items()
    }
    return {
        "Logger severity": severity,
        "Logger name": name,
        "Requested logging filters": filters,
        "Logging filter parameters": parameters,
    }
