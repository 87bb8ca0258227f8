"""Time that a submission's tasks share, so that a slow task takes none from the others."""

from collections.abc import Collection


class TimeShares:
    """Half of the time is reserved for the tasks in equal parts; the other half goes to whichever needs it.

    Args:
        seconds: Of the wall clock, for the scenarios of all tasks.
        tasks: Their ids.
    """

    def __init__(self, seconds: float, tasks: Collection[str]) -> None:
        self._common = seconds / 2
        self._reserved = dict.fromkeys(tasks, seconds / 2 / max(len(tasks), 1))

    def left(self, task: str) -> float:
        """Return the time that the task may still take, [s]."""
        return self._reserved[task] + self._common

    def take(self, task: str, seconds: float) -> None:
        """Charge a task: its own part first."""
        own = min(seconds, self._reserved[task])
        self._reserved[task] -= own
        self._common = max(self._common - (seconds - own), 0.0)
