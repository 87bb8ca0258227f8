"""Messages between Zenoh's threads and the thread that runs the events: bounded, counted and timed."""

from _queue import SimpleQueue  # queue's own is put on robot time by virtual_time
from _thread import allocate_lock
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from course_lib.ros import wall

MAX_MESSAGES, MAX_BYTES = 1000, 64 * 2**20  # of a topic, that nobody has taken yet
WINDOW = 200  # messages of a topic that its rate is measured over
RECENT_NS = 5 * 10**9  # [ns]

Actions = SimpleQueue[Callable[[], None]]


@dataclass(frozen=True, slots=True)
class Packet:
    """One message from the network; times in [ns] since 1970, by the sender's clock and by ours."""

    cdr: bytes
    sequence: int
    source_ns: int
    gid: bytes  # of its publisher
    received_ns: int


class Traffic:
    """Counts of one topic: its rate, and the messages that were lost on the way."""

    def __init__(self) -> None:
        self.heard, self.lost = 0, 0  # lost: by the gaps between sequence numbers
        self._recent: deque[tuple[int, int]] = deque(maxlen=WINDOW)  # time of arrival [ns], size [B]
        self._lags: deque[int] = deque(maxlen=WINDOW)  # [ns] from the sender's clock to ours
        self._last: dict[bytes, int] = {}  # sequence number, by publisher

    def note(self, arrival: Packet) -> None:
        """Count a message."""
        last = self._last.get(arrival.gid, arrival.sequence)
        self.lost += max(0, arrival.sequence - last - 1)
        self._last[arrival.gid] = max(last, arrival.sequence)
        self.heard += 1
        self._recent.append((arrival.received_ns, len(arrival.cdr)))
        self._lags.append(arrival.received_ns - arrival.source_ns)

    def forget_sequences(self) -> None:
        """Begin to count gaps again: what was sent while the link was down is not lost on the way."""
        self._last.clear()

    @property
    def share_lost(self) -> float:
        """The share of messages that were lost, from 0 to 1."""
        return self.lost / max(1, self.lost + self.heard)

    @property
    def lag_ns(self) -> int | None:
        """The shortest time from the sender's clock to ours, [ns]: the way, and the clocks' difference."""
        return min(tuple(self._lags), default=None)

    def rates(self) -> tuple[float, float]:
        """Return messages and bytes a second, over the last few seconds."""
        since = wall.time_ns() - RECENT_NS
        recent = [(at, size) for at, size in tuple(self._recent) if at >= since]
        if len(recent) < 2:
            return 0.0, 0.0
        seconds = max(recent[-1][0] - recent[0][0], 1) * 1e-9
        return (len(recent) - 1) / seconds, sum(size for _, size in recent[1:]) / seconds


class Inbox:
    """The newest messages of a topic that were not taken yet: a busy kernel drops old ones, as a queue does.

    Args:
        actions: The queue that the graph takes from; it holds one action for each message here.
        take: Called with each message, in the graph's thread.
    """

    def __init__(self, actions: Actions, take: Callable[[Packet], None]) -> None:
        self.traffic = Traffic()
        self.dropped = 0
        self._actions, self._take = actions, take
        self._waiting: deque[Packet] = deque()
        self._bytes = 0
        self._mutex = allocate_lock()

    def put(self, arrival: Packet) -> None:
        """Add a message; called by Zenoh's threads."""
        self.traffic.note(arrival)
        with self._mutex:
            self._waiting.append(arrival)
            self._bytes += len(arrival.cdr)
            full = len(self._waiting) > MAX_MESSAGES or (self._bytes > MAX_BYTES and len(self._waiting) > 1)
            if full:
                self._bytes -= len(self._waiting.popleft().cdr)
                self.dropped += 1
        if not full:
            self._actions.put(self._take_one)

    def _take_one(self) -> None:
        with self._mutex:
            arrival = self._waiting.popleft() if self._waiting else None
            self._bytes -= len(arrival.cdr) if arrival else 0
        if arrival is not None:
            self._take(arrival)
