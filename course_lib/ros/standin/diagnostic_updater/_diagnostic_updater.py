"""Diagnostic statuses and tasks, and the updater that runs the tasks and publishes on /diagnostics."""

# ruff: noqa: N802 - the names are ROS's

from collections.abc import Callable, Sequence
from threading import Lock
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from course_lib.ros.mistakes import Mistake, mark

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
