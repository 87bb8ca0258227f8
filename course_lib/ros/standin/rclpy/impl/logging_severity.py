"""How bad a message is."""

from enum import IntEnum


class LoggingSeverity(IntEnum):
    """The severities, as rcutils numbers them."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50
