"""A DiagnosticStatus that is easily filled; as in ROS, C++'s summaryf and addf are f-strings in Python."""

from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue


class DiagnosticStatusWrapper(DiagnosticStatus):
    """A DiagnosticStatus with methods to fill it."""

    def summary(self, *args: Any) -> None:
        """Set level and message: `summary(level, message)`, or those of another status."""
        self.level, self.message = _parts(args)

    def clearSummary(self) -> None:  # noqa: N802  # ROS's name, as those below
        """Set the level to OK and the message to nothing."""
        self.summary(DiagnosticStatus.OK, "")

    def mergeSummary(self, *args: Any) -> None:  # noqa: N802
        """Keep the worse level; messages are joined where both are OK, or neither is."""
        level, message = _parts(args)
        if (level > DiagnosticStatus.OK) == (self.level > DiagnosticStatus.OK):
            self.message = f"{self.message}; {message}" if self.message else message
        elif level > self.level:
            self.message = message
        self.level = max(level, self.level)

    def add(self, key: str, val: str) -> None:
        """Add a value; both are strings, in ROS as well."""
        self.values.append(KeyValue(key=key, value=val))


def _parts(args: tuple[Any, ...]) -> tuple[bytes, str]:
    if len(args) == 1:
        return args[0].level, args[0].message
    level, message = args
    return level, str(message)
