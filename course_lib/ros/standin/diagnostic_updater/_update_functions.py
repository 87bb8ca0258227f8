"""Predefined tasks: frequencies, ages of time stamps, a heartbeat, and diagnostics of topics."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.clock import ROSClock
from rclpy.publisher import Publisher
from rclpy.time import Time

from course_lib.ros.mistakes import Mistake, mark
from diagnostic_updater._diagnostic_updater import (
    CompositeDiagnosticTask,
    DiagnosticStatusWrapper,
    DiagnosticTask,
    Updater,
)


@dataclass
class FrequencyStatusParam:
    """The acceptable frequency: from min * (1 - tolerance) to max * (1 + tolerance)."""

    # {"min": …, "max": …}, [Hz]; without "max" there is no upper bound.
    freq_bound: Mapping[str, float]
    tolerance: float = 0.1
    # The number of updates over which the frequency is measured.
    window_size: int = 5


class FrequencyStatus(DiagnosticTask):
    """Checks the frequency of the calls of `tick`."""

    def __init__(self, params: FrequencyStatusParam, name: str = "FrequencyStatus") -> None:
        super().__init__(name)
        self.params = params
        self.lock = Lock()
        self.clear()

    def clear(self) -> None:
        """Reset the counters."""
        with self.lock:
            self.count = 0
            size = self.params.window_size
            # (time [ns], count) at each update.
            self._history = deque([(_now_ns(), 0)] * size, maxlen=size)

    def tick(self) -> None:
        """Count an event."""
        with self.lock:
            self.count += 1

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Compare the frequency since the oldest update in the window with the bounds."""
        with self.lock:
            now_ns = _now_ns()
            from_ns, from_count = self._history[0]
            self._history.append((now_ns, self.count))
            events, seconds = self.count - from_count, max(now_ns - from_ns, 1) * 1e-9
        rate, limits, tolerance = events / seconds, self.params.freq_bound, self.params.tolerance
        low, high = limits["min"] * (1 - tolerance), limits.get("max", float("inf")) * (1 + tolerance)
        if events == 0:
            stat.summary(DiagnosticStatus.ERROR, "No events recorded.")
        elif rate < low:
            stat.summary(DiagnosticStatus.WARN, "Frequency too low.")
        elif rate > high:
            stat.summary(DiagnosticStatus.WARN, "Frequency too high.")
        else:
            stat.summary(DiagnosticStatus.OK, "Desired frequency met")
        for key, value, is_shown in (
            ("Events in window", f"{events}", True),
            ("Events since startup", f"{self.count}", True),
            ("Duration of window (s)", f"{seconds:f}", True),
            ("Actual frequency (Hz)", f"{rate:f}", True),
            ("Target frequency (Hz)", f"{limits['min']:f}", limits["min"] == limits.get("max")),
            ("Minimum acceptable frequency (Hz)", f"{low:f}", limits["min"] > 0),
            ("Maximum acceptable frequency (Hz)", f"{high:f}", "max" in limits),
        ):
            if is_shown:
                stat.add(key, value)
        return stat


@dataclass
class TimeStampStatusParam:
    """The acceptable age of time stamps on arrival, [s].

    A stamp in the future has a negative age.
    """

    min_acceptable: float = -1
    max_acceptable: float = 5


class TimeStampStatus(DiagnosticTask):
    """Checks the age of the time stamps that are passed to `tick`."""

    def __init__(
        self,
        params: TimeStampStatusParam | None = None,
        name: str = "Timestamp Status",
    ) -> None:
        super().__init__(name)
        self.params = params or TimeStampStatusParam()
        self.lock = Lock()
        self.early_count = self.late_count = self.zero_count = 0
        self.zero_seen = False
        # Ages [s] since the last update.
        self._ages: list[float] = []

    def tick(self, stamp: Time | float) -> None:
        """Record a time stamp; a number is in [s]."""
        try:
            stamp_ns = stamp * 1e9 if isinstance(stamp, float) else stamp.nanoseconds
        except AttributeError as error:
            mark(error, Mistake.STAMP)
            raise
        with self.lock:
            if stamp_ns == 0:
                self.zero_seen = True
            else:
                self._ages.append((_now_ns() - stamp_ns) * 1e-9)

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Compare the ages since the last update with the bounds."""
        with self.lock:
            ages, self._ages = self._ages, []
            zero_seen, self.zero_seen = self.zero_seen, False
        earliest, latest = min(ages, default=0.0), max(ages, default=0.0)
        low, high = self.params.min_acceptable, self.params.max_acceptable
        stat.summary(DiagnosticStatus.OK, "Timestamps are reasonable.")
        if not ages:
            stat.summary(DiagnosticStatus.WARN, "No data since last update.")
        elif earliest < low or latest > high or zero_seen:
            self.early_count += earliest < low
            self.late_count += latest > high
            self.zero_count += zero_seen
            in_future = "Timestamps too far in future seen."
            in_past = "Timestamps too far in past seen." if latest > high else in_future
            stat.summary(DiagnosticStatus.ERROR, "Zero timestamp seen." if zero_seen else in_past)
        for key, value in (
            ("Earliest timestamp delay:", f"{earliest:f}"),
            ("Latest timestamp delay:", f"{latest:f}"),
            ("Earliest acceptable timestamp delay:", f"{low:f}"),
            ("Latest acceptable timestamp delay:", f"{high:f}"),
            ("Late diagnostic update count:", f"{self.late_count}"),
            ("Early diagnostic update count:", f"{self.early_count}"),
            ("Zero seen diagnostic update count:", f"{self.zero_count}"),
        ):
            stat.add(key, value)
        return stat


class Heartbeat(DiagnosticTask):
    """A task that always reports OK, to show that the node runs."""

    def __init__(self) -> None:
        super().__init__("Heartbeat")

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Set the message "Alive"."""
        stat.summary(DiagnosticStatus.OK, "Alive")
        return stat


class HeaderlessTopicDiagnostic(CompositeDiagnosticTask):
    """Checks the frequency of a topic. Call `tick` for each message."""

    def __init__(self, name: str, diag: Updater, freq: FrequencyStatusParam) -> None:
        super().__init__(f"{name} topic status")
        self.diag = diag
        self.freq = FrequencyStatus(freq)
        self.addTask(self.freq)
        diag.add(self)

    def tick(self) -> None:
        """Count a message."""
        self.freq.tick()

    def clear_window(self) -> None:
        """Reset the counters."""
        self.freq.clear()


class TopicDiagnostic(HeaderlessTopicDiagnostic):
    """Checks the frequency of a topic and the age of its time stamps."""

    def __init__(
        self, name: str, diag: Updater, freq: FrequencyStatusParam, stamp: TimeStampStatusParam
    ) -> None:
        super().__init__(name, diag, freq)
        self.stamp = TimeStampStatus(stamp)
        self.addTask(self.stamp)

    def tick(self, stamp: Time | float) -> None:  # type: ignore[override]  # ROS's signature
        """Count a message with this time stamp."""
        self.stamp.tick(stamp)
        super().tick()


class DiagnosedPublisher(TopicDiagnostic):
    """A publisher whose messages, which must have a header, are checked."""

    def __init__(
        self,
        pub: Publisher[Any],
        diag: Updater,
        freq: FrequencyStatusParam,
        stamp: TimeStampStatusParam,
    ) -> None:
        super().__init__(pub.topic_name, diag, freq, stamp)
        self.publisher = pub

    def publish(self, message: Any) -> None:
        """Publish a message and count it."""
        self.tick(Time.from_msg(message.header.stamp))
        self.publisher.publish(message)


def _now_ns() -> int:
    return ROSClock().now().nanoseconds
