"""Log lines in a notebook: of equal ones in a row the first are shown, the others counted."""

import sys

SHOWN = 5  # equal lines in a row


class RepeatedLines:
    """Writes lines to stderr; how often one came again is told at 10, 100, 1000 … times and at the end."""

    def __init__(self) -> None:
        self._last, self._times, self._told = "", 0, 0

    def write(self, what: str, line: str) -> None:
        """Write a line, unless it says the same as those before; `what` is all of it but its time."""
        if what != self._last:
            self.end()
            self._last = what
        self._times += 1
        if self._times <= SHOWN:
            sys.stderr.write(f"{line}\n")
        elif str(self._times).strip("0") == "1":
            self._tell()

    def end(self) -> None:
        """Tell how often the last line came again, and begin anew."""
        if self._times > SHOWN and self._told != self._times:
            self._tell()
        self._last, self._times, self._told = "", 0, 0

    def _tell(self) -> None:
        self._told = self._times
        sys.stderr.write(f"… repeated {self._times - SHOWN} times\n")


repeated_lines = RepeatedLines()  # of this process, as stderr is
