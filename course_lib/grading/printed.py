"""What a student's code printed while it was checked: repeated lines collapsed, the rest cut."""

import io
import re
from collections.abc import Iterable

MAX_LINES = 20
MAX_LINE = 200  # characters
MAX_PRINTED = 1_000_000  # characters that are kept of a run in this process
_STAMP = re.compile(r"\[\d+\.\d{9}\] ")  # of a log line: it makes equal lines differ


class Bounded(io.StringIO):
    """A text of which only the beginning is kept, so that an endless loop does not fill the memory."""

    def write(self, text: str) -> int:
        """Keep what there is room for."""
        super().write(text[: max(0, MAX_PRINTED - self.tell())])
        return len(text)


def printed(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return the lines of the first output that is not empty, as a person wants to see them."""
    text = next((one for one in outputs if one.strip()), "")
    lines = collapsed(text.rstrip().splitlines())
    shown = [line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]} …" for line in lines[:MAX_LINES]]
    more = len(lines) - len(shown)
    return (*shown, f"… {more} more lines") if more > 0 else tuple(shown)


def collapsed(lines: Iterable[str]) -> list[str]:
    """Return lines of which those that follow an equal one are counted; times of logs do not matter."""
    made: list[str] = []
    last, repeated = None, 0
    for line in [*lines, None]:
        plain = None if line is None else _STAMP.sub("", line)
        if plain is not None and plain == last:
            repeated += 1
            continue
        if repeated:
            made.append(f"… repeated {repeated} times" if repeated > 1 else made[-1])
        last, repeated = plain, 0
        if line is not None:
            made.append(line)
    return made
