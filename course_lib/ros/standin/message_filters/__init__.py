"""Message filters, through which messages pass between a subscription and a callback."""

# ruff: noqa: N802 - the names are ROS's

import threading
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.clock import ROSClock
from rclpy.duration import Duration
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.time import Time

# Messages by stamp [ns].
Queue = dict[int, Any]
_HEADERLESS = (
    "can not use message filters messages without timestamp infomation when 'allow_headerless' is "
    "disabled. auto assign ROSTIME to headerless messages once enabling constructor option of "
    "'allow_headerless'."
)


class SimpleFilter:
    """A filter with callbacks that receive its output."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., object], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., object], *args: Any) -> int:
        """Call `cb` with the filter's output and `args`. Return the id of the callback."""
        number = len(self.callbacks)
        self.callbacks[number] = (cb, args)
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Call the callbacks with messages, in the order of their registration."""
        for callback, args in self.callbacks.values():
            callback(*msg, *args)


class Subscriber(SimpleFilter):
    """A filter that outputs the messages of a subscription.

    The arguments are those of `create_subscription`.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.node, self.topic = args[0], args[2]
        self.sub = self.node.create_subscription(*args[1:], self.callback, **{"qos_profile": 10} | kwargs)

    def callback(self, msg: Any) -> None:
        """Forward a message to the callbacks."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """Return the topic name as passed to the constructor."""
        return str(self.topic)

    def __getattr__(self, key: str) -> Any:
        """Return an attribute of the subscription."""
        return getattr(self.sub, key)


class Cache(SimpleFilter):
    """Stores a filter's last `cache_size` messages and their times, and forwards each message."""

    def __init__(
        self,
        f: SimpleFilter,
        cache_size: int = 1,
        allow_headerless: bool = False,
    ) -> None:
        super().__init__()
        self.connectInput(f)
        self.cache_size, self.allow_headerless = cache_size, allow_headerless
        self.cache_msgs: list[Any] = []
        self.cache_times: list[Time] = []

    def connectInput(self, f: SimpleFilter) -> None:
        """Connect to the output of another filter."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Store a message and forward it."""
        stamp = _stamp_of(msg, self.allow_headerless, "message_filters_cache")
        if stamp is None:
            return
        self.cache_times.append(stamp)
        self.cache_msgs.append(msg)
        if len(self.cache_msgs) > self.cache_size:
            del self.cache_times[0], self.cache_msgs[0]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Time, to_stamp: Time) -> list[Any]:
        """Return the messages between two times, inclusive."""
        assert from_stamp <= to_stamp
        return self._where(lambda stamp: from_stamp <= stamp <= to_stamp)

    def getElemAfterTime(self, stamp: Time) -> Any:
        """Return the first message at or after a time, or None."""
        return next(iter(self._where(lambda time: time >= stamp)), None)

    def getElemBeforeTime(self, stamp: Time) -> Any:
        """Return the last message at or before a time, or None."""
        return next(reversed(self._where(lambda time: time <= stamp)), None)

    def getLastestTime(self) -> Time | None:
        """Return the time of the last message, or None. The name is misspelled in ROS, too."""
        return self.cache_times[-1] if self.cache_times else None

    def getOldestTime(self) -> Time | None:
        """Return the time of the oldest message, or None."""
        return self.cache_times[0] if self.cache_times else None

    def getLast(self) -> Any:
        """Return the first message at or after the time of the last one, or None."""
        last = self.getLastestTime()
        return None if last is None else self.getElemAfterTime(last)

    def _where(self, fits: Callable[[Time], bool]) -> list[Any]:
        pairs = zip(self.cache_msgs, self.cache_times, strict=True)
        return [msg for msg, time in pairs if fits(time)]


class TimeSynchronizer(SimpleFilter):
    """Combines messages of several filters with equal stamps into one call."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.connectInput(fs)
        self.queue_size, self.lock = queue_size, threading.Lock()

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:
        """Connect to the outputs of filters, with one queue for each."""
        self.queues: list[Queue] = [{} for _ in fs]
        pairs = enumerate(zip(fs, self.queues, strict=True))
        self.input_connections = [f.registerCallback(self.add, queue, index) for index, (f, queue) in pairs]

    def add(self, msg: Any, my_queue: Queue, my_queue_index: int | None = None) -> None:
        """Store a message and forward all complete sets, the oldest first."""
        with self.lock:
            self._keep(msg, Time.from_msg(msg.header.stamp).nanoseconds, my_queue)
            for stamp in sorted(set.intersection(*map(set, self.queues))):
                self._signal([stamp] * len(self.queues))

    def _keep(self, msg: Any, stamp: int, queue: Queue) -> None:
        queue[stamp] = msg
        while len(queue) > self.queue_size:
            del queue[min(queue)]

    def _signal(self, stamps: Sequence[int]) -> None:
        """Forward one message of each queue, and then remove the set, even if a callback raises."""
        pairs = list(zip(self.queues, stamps, strict=True))
        try:
            self.signalMessage(*[queue[stamp] for queue, stamp in pairs])
        finally:
            for queue, stamp in pairs:
                del queue[stamp]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Combines messages of several filters with stamps closer than `slop` [s] into one call."""

    def __init__(
        self,
        fs: Sequence[SimpleFilter],
        queue_size: int,
        slop: float,
        allow_headerless: bool = False,
    ) -> None:
        super().__init__(fs, queue_size)
        self.slop, self.allow_headerless = Duration(seconds=slop), allow_headerless

    def add(self, msg: Any, my_queue: Queue, my_queue_index: int | None = None) -> None:
        """Store a message and forward the set that it completes, with the closest stamps."""
        time = _stamp_of(msg, self.allow_headerless, "message_filters_approx")
        if time is None:
            return
        with self.lock:
            stamp = time.nanoseconds
            self._keep(msg, stamp, my_queue)
            # For each queue, the stamps within `slop`, the closest first.
            slop_ns = self.slop.nanoseconds
            near_stamps = (
                [other for other in queue if abs(other - stamp) <= slop_ns] for queue in self.queues
            )
            choices = [sorted(stamps, key=lambda other: abs(other - stamp)) for stamps in near_stamps]
            if my_queue_index is not None:
                # A message that is older than a full queue has been dropped.
                choices[my_queue_index] = [stamp] if stamp in my_queue else []
            together = self._together(choices, ())
            if together is not None:
                self._signal(together)

    def _together(
        self,
        choices: Sequence[Sequence[int]],
        chosen: tuple[int, ...],
    ) -> tuple[int, ...] | None:
        """Choose one stamp from each queue such that all are within `slop`.

        The choices of earlier queues take precedence.
        """
        if not choices:
            return chosen
        for stamp in choices[0]:
            extended = (*chosen, stamp)
            if max(extended) - min(extended) < self.slop.nanoseconds:
                match = self._together(choices[1:], extended)
                if match is not None:
                    return match
        return None


def _stamp_of(msg: Any, allow_headerless: bool, logger: str) -> Time | None:
    """Return a message's stamp.

    Without a header, return the current time, or None after a warning.
    """
    stamp = getattr(getattr(msg, "header", None), "stamp", None)
    if stamp is not None:
        return stamp if hasattr(stamp, "nanoseconds") else Time.from_msg(stamp)
    if allow_headerless:
        return ROSClock().now()
    log = get_logger(logger)
    log.set_level(LoggingSeverity.INFO)
    log.warn(_HEADERLESS)
    return None
