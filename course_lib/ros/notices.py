"""Notices in the output of a cell, and log lines that repeat."""

import sys
from dataclasses import dataclass, field

from course_lib.errors import format_count

# Number of consecutive equal lines that are printed.
SHOWN_LINES = 5


def print_notice(line: str) -> None:
    """Print a notice in the cell's output."""
    sys.stdout.write(f"{line}\n")


def print_to_stderr(line: str) -> None:
    """Print a line to stderr, separately from the output of a program or tool."""
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()


@dataclass(eq=False, repr=False)
class ReplacedNodes:
    """Reports nodes that were replaced by new nodes of the same name, as one line at the end of the cell.

    Outside of cells, each is reported immediately.
    """

    # Whether a cell is running, at whose end `report` is called.
    is_deferred: bool = False
    _names: list[str] = field(default_factory=list)

    def add(self, name: str) -> None:
        """Record the full name of a replaced node."""
        self._names.append(name)
        if not self.is_deferred:
            self.report()

    def report(self) -> None:
        """Print the line if a node was replaced since the last call."""
        names = list(dict.fromkeys(self._names))
        self._names.clear()
        if len(names) == 1:
            print_notice(f"The new node {names[0]} replaces the one of the same name.")
        elif names:
            print_notice(f"New nodes replace nodes with the same names: {', '.join(names)}.")


@dataclass(eq=False, repr=False)
class RepeatedLines:
    """Writes log lines to stderr and counts equal lines in a row.

    The count is printed at 10, 100, 1000, … repetitions, and at the end.
    """

    _last_subject: str = ""
    _times: int = 0
    _reported: int = 0

    def write(self, subject: str, line: str) -> None:
        """Write a line unless it repeats the previous lines.

        `subject` is the line without its time.
        """
        if subject != self._last_subject:
            self.end()
            self._last_subject = subject
        self._times += 1
        if self._times <= SHOWN_LINES:
            sys.stderr.write(f"{line}\n")
        elif str(self._times).strip("0") == "1":
            self._report()

    def end(self) -> None:
        """Print how often the last line was repeated, and reset the count."""
        if self._times > SHOWN_LINES and self._reported != self._times:
            self._report()
        self._last_subject, self._times, self._reported = "", 0, 0

    def _report(self) -> None:
        self._reported = self._times
        sys.stderr.write(f"… repeated {format_count(self._times - SHOWN_LINES, 'time')}\n")


# One object for the process, because stderr belongs to the process.
repeated_lines = RepeatedLines()
replacements = ReplacedNodes()
