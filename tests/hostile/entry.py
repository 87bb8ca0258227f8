"""Attacks and mistakes as tiny submissions: an extra cell, or a change of the right answer.

A cell that reaches what it must not reach prints BROKEN. Names TOP, PORT, GRADER, LIB are given to
it.
"""

from collections.abc import Callable
from dataclasses import dataclass

FULL = 110.0
PUBLISH = "        self.publisher.publish(marker)\n"
SECOND_TICK = "        if self.get_clock().now().nanoseconds > 1_700_000_001 * 10**9: "


def _same(cell: str) -> str:
    return cell


def in_callback(code: str) -> Callable[[str], str]:
    """Code that is run in every call of the node's timer, instead of publishing."""
    lines = "".join(f"        {line}\n" for line in code.splitlines())
    return lambda cell: cell.replace(PUBLISH, lines)


def replaced(before: str, after: str) -> Callable[[str], str]:
    """Return the right answer with a replaced string."""
    return lambda cell: cell.replace(before, after)


@dataclass(frozen=True)
class Entry:
    """One submission.

    Args:
        name: Of the student.
        cell: Run between the right answer's first and second cell.
        change: Of each cell of the right answer.
        final: The mark it must get.
        status: In the gradebook.
        reason: In the gradebook.
        says: What the result must hold somewhere.
        claims: The student that the file names, if another one.
    """

    name: str
    cell: str = ""
    change: Callable[[str], str] = _same
    final: float = FULL
    status: str = "graded"
    reason: str = ""
    says: str = ""
    claims: str = ""


def tries(name: str, *lines: str, **more: object) -> Entry:
    """Each line is tried for itself; one that raises nothing has broken something."""
    cell = "import ctypes, os, signal, socket, subprocess, sys\nlibc = ctypes.CDLL(None, use_errno=True)\n"
    cell += "def call(*a):\n    if libc.syscall(*a) < 0: raise OSError(ctypes.get_errno(), 'no')\n"
    for line in lines:
        cell += f"try:\n    {line}\n    print('BROKEN', {line!r})\nexcept Exception as e:\n    pass\n"
    return Entry(name, cell, **more)  # type: ignore[arg-type]  # the fields above
