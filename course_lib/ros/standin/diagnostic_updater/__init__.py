"""Diagnostic statuses and tasks, and the updater that runs the tasks and publishes on /diagnostics.

Predefined tasks observe frequencies, ages of time stamps, a heartbeat, and topics.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from threading import Lock
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import ROSClock
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.time import Time

from course_lib.ros.mistakes import Mistake, mark

# ruff: noqa: N802 - the names are ROS's


# ROS's warning contains the indentation of its source code.
_GAP = " " * 16
_NO_HARDWARE_ID = _GAP.join(
    (
        "diagnostic_updater: No HW_ID was set. This is probably",
        "a bug. Please report it. For devices that do not have a",
        "HW_ID, set this value to none. This warning only occurs",
        "once all diagnostics are OK so it is okay to wait until",
        "the device is open before calling setHardwareID.",
    )
)


class DiagnosticStatusWrapper(DiagnosticStatus):
    """A DiagnosticStatus with methods to fill it.

    C++'s summaryf and addf are f-strings in Python.
    """

    def summary(self, *args: Any) -> None:
        """Set level and message: `summary(level, message)`, or copy them from another status."""
        self.level, self.message = _level_and_message(args)

    def clearSummary(self) -> None:
        """Set the level to OK and the message to ""."""
        self.summary(DiagnosticStatus.OK, "")

    def mergeSummary(self, *args: Any) -> None:
        """Keep the worse level. Messages are joined if both levels are OK, or if neither is."""
        level, message = _level_and_message(args)
        if (level > DiagnosticStatus.OK) == (self.level > DiagnosticStatus.OK):
            self.message = f"{self.message}; {message}" if self.message else message
        elif level > self.level:
            self.message = message
        self.level = max(level, self.level)

    def add(self, key: str, val: str) -> None:
        """Add a key and a value. Both must be strings, as in ROS."""
        self.values.append(KeyValue(key=key, value=val))


# A function that fills its argument and returns it.
Fill = Callable[[DiagnosticStatusWrapper], DiagnosticStatusWrapper]


class DiagnosticTask:
    """A check. Subclasses fill the status in `run`."""

    def __init__(self, name: str) -> None:
        self.name = name

    def getName(self) -> str:
        """Return the name of the task."""
        return self.name

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill the status and return it."""
        return stat


class FunctionDiagnosticTask(DiagnosticTask):
    """A task that calls a function."""

    def __init__(self, name: str, fn: Fill) -> None:
        super().__init__(name)
        self.fn = fn

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Call the function."""
        return self.fn(stat)


class CompositeDiagnosticTask(DiagnosticTask):
    """Several tasks with one status: the worst level, the joined messages, and all values."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.tasks: list[DiagnosticTask] = []

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Run the tasks. Each starts with the summary that was passed in."""
        original, combined = DiagnosticStatusWrapper(), DiagnosticStatusWrapper()
        original.summary(stat)
        for task in self.tasks:
            stat.summary(original)
            stat = task.run(stat)
            combined.mergeSummary(stat)
        stat.summary(combined)
        return stat

    def addTask(self, t: DiagnosticTask) -> None:
        """Add a task."""
        self.tasks.append(t)


class Updater:
    """Runs its tasks every `period` [s] and publishes their statuses on /diagnostics.

    Declares the parameters diagnostic_updater.period and diagnostic_updater.use_fqn of its node.
    """

    def __init__(self, node: Node, period: float = 1.0) -> None:
        self.tasks: list[DiagnosticTask] = []
        self.lock = Lock()
        self.node = node
        self.publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 1)
        self._period: float = node.declare_parameter("diagnostic_updater.period", period).value
        self.timer = node.create_timer(self._period, self.update)
        self.verbose = False
        self.hwid = ""
        self.warn_nohwid_done = False
        if not node.has_parameter("diagnostic_updater.use_fqn"):
            node.declare_parameter("diagnostic_updater.use_fqn", False)
        full = node.get_parameter("diagnostic_updater.use_fqn").value
        self.node_name = f"{node.get_namespace()}/{node.get_name()}" if full else node.get_name()

    @property
    def period(self) -> float:
        """The period of publishing, [s]."""
        return self._period

    @period.setter
    def period(self, period: float) -> None:
        self._period = period
        # As in ROS, the previous timer continues to run in addition to the new one.
        self.timer.reset()
        self.timer = self.node.create_timer(period, self.update)

    def add(self, task: DiagnosticTask | str, fn: Fill | None = None) -> None:
        """Add a task, `add(task)` or `add(name, function)`, and publish that the node starts up."""
        new_task = FunctionDiagnosticTask(task, fn) if isinstance(task, str) and fn else task
        if isinstance(new_task, str):
            raise TypeError(f"add({task!r}): give the task's function, too, like add({task!r}, self.check).")
        with self.lock:
            self.tasks.append(new_task)
            self.publish(DiagnosticStatusWrapper(name=new_task.getName(), message="Node starting up"))

    def removeByName(self, name: str) -> bool:
        """Remove the first task with this name. Return whether there was one."""
        with self.lock:
            removed_task = next((task for task in self.tasks if task.name == name), None)
            if removed_task is not None:
                self.tasks.remove(removed_task)
        return removed_task is not None

    def update(self) -> None:
        """Run the tasks and publish. Warn once if all levels are OK and no hardware ID was set."""
        with self.lock:
            statuses = [self._run(task) for task in self.tasks]
        well = all(status.level == DiagnosticStatus.OK for status in statuses)
        if well and not self.hwid and not self.warn_nohwid_done:
            self.node.get_logger().warn(_NO_HARDWARE_ID)
            self.warn_nohwid_done = True
        self.publish(statuses)

    def force_update(self) -> None:
        """Publish now, independently of the period."""
        self.update()

    def broadcast(self, lvl: bytes, msg: str) -> None:
        """Publish the same level and message as the status of every task."""
        statuses = [DiagnosticStatusWrapper(name=task.name) for task in self.tasks]
        for status in statuses:
            status.summary(lvl, msg)
        self.publish(statuses)

    def setHardwareID(self, hwid: str) -> None:
        """Set the hardware ID of the statuses; "none" if there is no device."""
        self.hwid = hwid

    def publish(self, msg: DiagnosticStatus | Sequence[DiagnosticStatus]) -> None:
        """Publish statuses, with the node's name before their names."""
        array = DiagnosticArray()
        array.header.stamp = self.node.get_clock().now().to_msg()
        for status in [msg] if isinstance(msg, DiagnosticStatus) else msg:
            fields = {name: getattr(status, name) for name in ("level", "message", "hardware_id", "values")}
            array.status.append(DiagnosticStatus(name=f"{self.node_name}: {status.name}", **fields))
        self.publisher.publish(array)

    def _run(self, task: DiagnosticTask) -> DiagnosticStatusWrapper:
        initial = DiagnosticStatusWrapper(name=task.name, hardware_id=self.hwid)
        initial.summary(DiagnosticStatus.ERROR, "No message was set")
        status = task.run(initial)
        try:
            level = status.level
        except AttributeError as error:
            mark(error, Mistake.NO_STATUS)
            raise
        if level != DiagnosticStatus.OK and self.verbose:
            text = f"Name: {status.name}, status{' ' * 24}{level!r}: {status.message}"
            self.node.get_logger().warn(f"Non-zero diagnostic status. {text}")
        return status


def _level_and_message(args: tuple[Any, ...]) -> tuple[bytes, str]:
    if len(args) == 1:
        return args[0].level, args[0].message
    level, message = args
    return level, str(message)


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
