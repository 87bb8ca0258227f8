"""Lines in a cell's output: notices to the student, and log lines that repeat."""

import sys

SHOWN = 5  # equal lines in a row


def say(line: str) -> None:
    """Print a notice in the cell's output."""
    sys.stdout.write(f"{line}\n")


class RepeatedLines:
    """Log lines on stderr, of which equal ones in a row are counted: at 10, 100, 1000 … and at the end."""

    def __init__(self) -> None:
        self._last, self._times, self._told = "", 0, 0

    def write(self, what: str, line: str) -> None:
        """Write a line, unless it repeats the former ones; `what` is all of it but its time."""
        if what != self._last:
            self.end()
            self._last = what
        self._times += 1
        if self._times <= SHOWN:
            sys.stderr.write(f"{line}\n")
        elif str(self._times).strip("0") == "1":
            self._tell()

    def end(self) -> None:
        """Write how often the last line was repeated, and forget it."""
        if self._times > SHOWN and self._told != self._times:
            self._tell()
        self._last, self._times, self._told = "", 0, 0

    def _tell(self) -> None:
        self._told = self._times
        sys.stderr.write(f"… repeated {self._times - SHOWN} times\n")


repeated_lines = RepeatedLines()  # of this process, as stderr is
