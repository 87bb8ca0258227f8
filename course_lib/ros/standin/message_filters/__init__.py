"""Filters that messages pass on the way from subscriptions to a callback."""

# ruff: noqa: N802 - the names are ROS's

import threading
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.clock import ROSClock
from rclpy.duration import Duration
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.time import Time

Queue = dict[int, Any]  # messages by stamp, [ns]
_HEADERLESS = (
    "can not use message filters messages without timestamp infomation when 'allow_headerless' is disabled. "
    "auto assign ROSTIME to headerless messages once enabling constructor option of 'allow_headerless'."
)


class SimpleFilter:
    """A filter with callbacks for its output."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., object], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., object], *args: Any) -> int:
        """Call `cb` with the filter's output, then `args`; returns the callback's number."""
        number = len(self.callbacks)
        self.callbacks[number] = (cb, args)
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Pass messages to the callbacks, in the order of their registration."""
        for callback, args in self.callbacks.values():
            callback(*msg, *args)


class Subscriber(SimpleFilter):
    """A subscription as the first filter: `Subscriber(node, type, topic, qos_profile=…)`."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.node, self.topic = args[0], args[2]
        self.sub = self.node.create_subscription(*args[1:], self.callback, **{"qos_profile": 10} | kwargs)

    def callback(self, msg: Any) -> None:
        """Pass a message on."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """Return the topic as it was given."""
        return str(self.topic)

    def __getattr__(self, key: str) -> Any:
        """Return an attribute of the subscription."""
        return getattr(self.sub, key)


class Cache(SimpleFilter):
    """The last `cache_size` messages of a filter, with their times; what comes in goes out at once."""

    def __init__(self, f: SimpleFilter, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__()
        self.connectInput(f)
        self.cache_size, self.allow_headerless = cache_size, allow_headerless
        self.cache_msgs: list[Any] = []
        self.cache_times: list[Time] = []

    def connectInput(self, f: SimpleFilter) -> None:
        """Receive the output of another filter."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Keep a message, and pass it on."""
        stamp = _stamp_of(msg, self.allow_headerless, "message_filters_cache")
        if stamp is None:
            return
        self.cache_times.append(stamp)
        self.cache_msgs.append(msg)
        if len(self.cache_msgs) > self.cache_size:
            del self.cache_times[0], self.cache_msgs[0]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Time, to_stamp: Time) -> list[Any]:
        """Return the messages between two times, both of them included."""
        assert from_stamp <= to_stamp
        return self._where(lambda stamp: from_stamp <= stamp <= to_stamp)

    def getElemAfterTime(self, stamp: Time) -> Any:
        """Return the first message that is not older than a time, or None."""
        return next(iter(self._where(lambda time: time >= stamp)), None)

    def getElemBeforeTime(self, stamp: Time) -> Any:
        """Return the last message that is not newer than a time, or None."""
        return next(reversed(self._where(lambda time: time <= stamp)), None)

    def getLastestTime(self) -> Time | None:
        """Return the time of the last message, or None; the spelling is ROS's."""
        return self.cache_times[-1] if self.cache_times else None

    def getOldestTime(self) -> Time | None:
        """Return the time of the first message, or None."""
        return self.cache_times[0] if self.cache_times else None

    def getLast(self) -> Any:
        """Return the first message that is not older than the last one, or None."""
        last = self.getLastestTime()
        return None if last is None else self.getElemAfterTime(last)

    def _where(self, fits: Callable[[Time], bool]) -> list[Any]:
        pairs = zip(self.cache_msgs, self.cache_times, strict=True)
        return [msg for msg, time in pairs if fits(time)]


class TimeSynchronizer(SimpleFilter):
    """Messages of several filters that have equal stamps, as one call with a message of each."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.connectInput(fs)
        self.queue_size, self.lock = queue_size, threading.Lock()

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:
        """Receive the outputs of filters, each into a queue of its own."""
        self.queues: list[Queue] = [{} for _ in fs]
        pairs = enumerate(zip(fs, self.queues, strict=True))
        self.input_connections = [f.registerCallback(self.add, queue, index) for index, (f, queue) in pairs]

    def add(self, msg: Any, my_queue: Queue, my_queue_index: int | None = None) -> None:
        """Keep a message, and pass on all sets that are complete, the oldest first."""
        with self.lock:
            self._keep(msg, Time.from_msg(msg.header.stamp).nanoseconds, my_queue)
            for stamp in sorted(set.intersection(*map(set, self.queues))):
                self._signal([stamp] * len(self.queues))

    def _keep(self, msg: Any, stamp: int, queue: Queue) -> None:
        queue[stamp] = msg
        while len(queue) > self.queue_size:
            del queue[min(queue)]

    def _signal(self, stamps: Sequence[int]) -> None:
        """Remove a message from each queue, and pass them on."""
        pairs = zip(self.queues, stamps, strict=True)
        self.signalMessage(*[queue.pop(stamp) for queue, stamp in pairs])


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Messages of several filters whose stamps differ by less than `slop`, [s], as one call."""

    def __init__(
        self, fs: Sequence[SimpleFilter], queue_size: int, slop: float, allow_headerless: bool = False
    ) -> None:
        super().__init__(fs, queue_size)
        self.slop, self.allow_headerless = Duration(seconds=slop), allow_headerless

    def add(self, msg: Any, my_queue: Queue, my_queue_index: int | None = None) -> None:
        """Keep a message, and pass on the set that it completes; of several, the one nearest to it."""
        time = _stamp_of(msg, self.allow_headerless, "message_filters_approx")
        if time is None:
            return
        with self.lock:
            stamp = time.nanoseconds
            self._keep(msg, stamp, my_queue)
            choices = [self._near(stamp, queue) for queue in self.queues]
            if my_queue_index is not None:
                choices[my_queue_index] = [stamp] if stamp in my_queue else []  # too old for a full queue
            together = self._together(choices, ())
            if together is not None:
                self._signal(together)

    def _near(self, stamp: int, queue: Queue) -> list[int]:
        """Return the stamps that are at most `slop` away, the nearest first."""
        near = [other for other in queue if abs(other - stamp) <= self.slop.nanoseconds]
        return sorted(near, key=lambda other: abs(other - stamp))

    def _together(self, choices: Sequence[Sequence[int]], chosen: tuple[int, ...]) -> tuple[int, ...] | None:
        """Choose a stamp of each queue so that all are within `slop`; the first queues choose first."""
        if not choices:
            return chosen
        for stamp in choices[0]:
            both = (*chosen, stamp)
            if max(both) - min(both) < self.slop.nanoseconds:
                found = self._together(choices[1:], both)
                if found is not None:
                    return found
        return None


def _stamp_of(msg: Any, allow_headerless: bool, logger: str) -> Time | None:
    """Return a message's time; without a header that is now, or None after a warning."""
    stamp = getattr(getattr(msg, "header", None), "stamp", None)
    if stamp is not None:
        return stamp if hasattr(stamp, "nanoseconds") else Time.from_msg(stamp)
    if allow_headerless:
        return ROSClock().now()
    log = get_logger(logger)
    log.set_level(LoggingSeverity.INFO)
    log.warn(_HEADERLESS)
    return None
