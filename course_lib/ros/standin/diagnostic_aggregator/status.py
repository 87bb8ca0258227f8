"""Names and levels of aggregated statuses (diagnostic_aggregator/status_item.hpp)."""

from collections.abc import Sequence

from diagnostic_msgs.msg import DiagnosticStatus

OK, ERROR, STALE = DiagnosticStatus.OK, DiagnosticStatus.ERROR, DiagnosticStatus.STALE
_WORDS = {OK: "OK", DiagnosticStatus.WARN: "Warning", ERROR: "Error", STALE: "Stale"}


def word(level: bytes) -> str:
    """Say a level in a word."""
    return _WORDS.get(level, "Error")


def worst(levels: Sequence[bytes]) -> bytes:
    """Sum levels up: the worst of them, but what is stale beside what is not is an error."""
    level = max(levels)
    return ERROR if level == STALE and set(levels) != {STALE} else level


def output_name(name: str) -> str:
    """Give an item's name below its analyzer's path: slashes become spaces."""
    return name.replace("/", " ")


def without_prefix(name: str, prefix: str) -> str:
    """Leave a prefix out of the last part of a path, with the colon and the spaces behind it."""
    begin = name.rfind("/") + 1
    if not prefix:
        return name
    last = name[begin:]
    if name.find(prefix) == begin:  # as in ROS, not if it occurs in the path as well
        last = last.removeprefix(prefix)
    return name[:begin] + last.removeprefix(":").lstrip(" ")
