"""The time that a submission waits for a processor of a busy machine, which its limits do not count."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from course_lib.grading.jail.limits import descendants
from course_lib.ros import wall

MOST = 9.0  # times a limit, that it grows by at most
SHORTEST = 0.1  # [s] by which it grows
OWN = 0  # the number of the calling thread


@dataclass(frozen=True)
class ThreadTimes:
    """Times of a thread's life [s]: in which it ran, and in which it could have run but had no processor."""

    ran: float = 0.0
    waited: float = 0.0

    def after(self, earlier: "ThreadTimes") -> "ThreadTimes":
        """Return what it has done since."""
        return ThreadTimes(self.ran - earlier.ran, self.waited - earlier.waited)


class Waiting:
    """The waiting of a process's descendants, and of the thread that serves them, since `begin`.

    Where the kernel does not count it, there is none. `given` is what limits have grown by [s].

    Args:
        top: The number of the process.
        limit: Of each step [s] of the wall clock.
    """

    def __init__(self, top: int, limit: float) -> None:
        self._top = top
        self.begin(limit)

    def begin(self, limit: float) -> None:
        """Count from now on, with a limit of each step [s]."""
        self.given, self._most = 0.0, MOST * limit
        self._since, self._before = wall.monotonic(), dict(_threads(self._top))

    def grow(self) -> float:
        """Return the time [s] by which a limit that was just met grows; 0 where nothing waited."""
        more = min(self._waited(), self._most) - self.given
        if more < SHORTEST:
            return 0.0
        self.given += more
        return more

    def _waited(self) -> float:
        """Return the longest waiting of a thread [s], without the time in which another one ran."""
        spent = {n: one.after(self._before.get(n, ThreadTimes())) for n, one in _threads(self._top)}
        own = spent.pop(OWN, ThreadTimes()).waited
        ran = sum(one.ran for one in spent.values())
        longest = max((one.waited for one in spent.values()), default=0.0)
        return min(own + longest, wall.monotonic() - self._since - ran)


def _threads(top: int) -> Iterator[tuple[int, ThreadTimes]]:
    """Yield all threads of a process's descendants, and the calling one, by their numbers."""
    files = [Path("/proc/thread-self/schedstat")]
    files += [file for pid in descendants(top) for file in Path(f"/proc/{pid}/task").glob("*/schedstat")]
    for file in files:
        number = int(file.parent.name) if file is not files[0] else OWN
        with suppress(OSError, ValueError):  # not Linux, or the thread has just ended
            ran, waited, _ = map(int, file.read_text().split())
            yield number, ThreadTimes(ran / 1e9, waited / 1e9)
