"""Severities of log messages, and the log levels that a program has set."""

from dataclasses import dataclass, field
from enum import IntEnum


class LoggingSeverity(IntEnum):
    """The severities, as rcutils numbers them."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


@dataclass
class LogLevels:
    """The log levels of one program in a run, by logger name."""

    by_logger: dict[str, int] = field(default_factory=dict)
