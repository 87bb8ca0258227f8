"""Robot time and the heap of events that moves it."""

import heapq
from collections.abc import Callable

START_NS = 1_700_000_000 * 10**9  # [ns] robot time at the start of every run
THREADS = 1 << 30  # stands for the node where a thread, not a node, is woken: after all nodes


class Alarm:
    """One event that will happen, unless it is cancelled before."""

    __slots__ = ("action", "cancelled", "due_ns")

    def __init__(self, due_ns: int, action: Callable[[], None]) -> None:
        self.due_ns = due_ns
        self.action = action
        self.cancelled = False

    def cancel(self) -> None:
        """Cancel the event."""
        self.cancelled = True


class Clock:
    """The clock and its heap of events, in the order (due time, node start order, entity order, sequence)."""

    def __init__(self, start_ns: int = START_NS) -> None:
        self.now_ns = start_ns
        self._heap: list[tuple[int, int, int, int, Alarm]] = []
        self._sequence = 0

    def call_at(self, due_ns: int, action: Callable[[], None], *, node: int, entity: int) -> Alarm:
        """Schedule `action` at `due_ns`, or next in the order of events if that has passed."""
        alarm = Alarm(max(due_ns, self.now_ns), action)
        self._sequence += 1
        heapq.heappush(self._heap, (alarm.due_ns, node, entity, self._sequence, alarm))
        return alarm

    def next_due_ns(self) -> int | None:
        """Return the time of the next event; None if there is none."""
        while self._heap and self._heap[0][4].cancelled:
            heapq.heappop(self._heap)
        return self._heap[0][0] if self._heap else None

    def __len__(self) -> int:
        return len(self._heap)

    def pop(self) -> Alarm:
        """Remove and return the next event."""
        return heapq.heappop(self._heap)[4]
