"""Lines in a cell's output: notices to the student, and log lines that repeat."""

import sys

SHOWN = 5  # equal lines in a row


def say(line: str) -> None:
    """Print a notice in the cell's output."""
    sys.stdout.write(f"{line}\n")


class Replacements:
    """Nodes that new ones of the same name have replaced, in one line at the end of the cell.

    Outside of cells each is named immediately.
    """

    def __init__(self) -> None:
        self.waits = False  # a cell runs, at whose end somebody calls `tell`
        self._names: list[str] = []

    def add(self, name: str) -> None:
        """Note a node's full name."""
        self._names.append(name)
        if not self.waits:
            self.tell()

    def tell(self) -> None:
        """Print the line, if a node was replaced since the last one."""
        names = list(dict.fromkeys(self._names))
        self._names.clear()
        if len(names) == 1:
            say(f"The new node {names[0]} replaces the one of the same name.")
        elif names:
            say(f"New nodes replace those of the same names: {', '.join(names)}.")


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
replacements = Replacements()
