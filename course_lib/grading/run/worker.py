"""The process that runs a submission: its cells once, then each scenario in a fork.

It is a fork of `jail.template`. It contains no checks, no expected values and no hidden texts. Its
messages are evidence: they are judged in another process and never trusted.
"""

import _thread
import gc
import importlib
import os
import resource
import sys
import timeit  # noqa: F401  before robot time is there: %timeit measures, also when graded
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.grading.check import bind_only
from course_lib.grading.inputs import set_values
from course_lib.grading.run.outcome import NOT_DEFINED, Outcome, describe
from course_lib.grading.run.scenario import Instructions, perform
from course_lib.grading.task import ON_A_GRAPH
from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.graph.remote import Channel, ChannelClosedError, RemoteGraph
from course_lib.ros.messages import compile_wire
from course_lib.ros.programs import import_path
from course_lib.ros.programs.packages import MANIFEST, prepend_paths
from course_lib.ros.programs.process import make_shell
from course_lib.ros.programs.program import seed_generators
from course_lib.ros.time import virtual_time
from course_lib.ros.time.interrupts import watch
from course_lib.ros.time.time_lock import time_lock
from course_lib.third_party import TOO_DEEP

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

CELLS_SEED = 0
SPARE = 64_000_000  # [B]
# Modules that most notebooks import, or that magics need.
USUAL = (
    "numpy.random", "rclpy.node", "rclpy.executors", "rclpy.qos", "rclpy.signals", "geometry_msgs.msg",
    "std_msgs.msg", "visualization_msgs.msg", "sensor_msgs.msg", "nav_msgs.msg", "vision_msgs.msg",
    "diagnostic_msgs.msg", "tf2_ros", "launch_ros.actions", "asyncio", "yaml",
    "IPython.core.magics.extension", "course_lib.extension", "course_lib.displays.viewer",
    "course_lib.grading.run.scenario", "course_lib.tools.notebook", "pygments.formatters.terminal256",
)  # fmt: skip
# Types that most nodes publish, or the kit itself; nested types are compiled with them.
SENT = (
    "rcl_interfaces/msg/Log", "rcl_interfaces/msg/ParameterEvent", "std_msgs/msg/Bool",
    "std_msgs/msg/Float64", "std_msgs/msg/String", "geometry_msgs/msg/PointStamped",
    "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/Twist", "tf2_msgs/msg/TFMessage",
    "nav_msgs/msg/Odometry", "nav_msgs/msg/Path",
    "sensor_msgs/msg/BatteryState", "sensor_msgs/msg/Image", "sensor_msgs/msg/Imu",
    "sensor_msgs/msg/JointState", "sensor_msgs/msg/LaserScan", "diagnostic_msgs/msg/DiagnosticArray",
    "trajectory_msgs/msg/JointTrajectory", "vision_msgs/msg/Detection3DArray",
    "visualization_msgs/msg/MarkerArray", "rcl_interfaces/srv/SetParameters_Request",
    "rcl_interfaces/srv/SetParameters_Response",
)  # fmt: skip
PUBLIC = ("course_lib", *(f"course_lib.{room}" for room in ("displays", "robots", "sensors", "export")))
WARM_RUNS, WARM_NS = 12, 1_000_000_000  # Python specializes code after about ten runs
NO_SHELL = "Grading has no shell: this line is skipped."


class Worker:
    """The loop in which a worker executes the grader's requests.

    Args:
        channel: The channel to the grader.
        shell: The shell created by `warm_up`.
    """

    def __init__(self, channel: Channel, shell: "InteractiveShell") -> None:
        self._channel, self._shell, self._pid = channel, shell, os.getpid()
        self._bound_objects: dict[str, Any] = {}
        bind_only(self._bound_objects.__setitem__)

    def serve(self) -> None:
        """Execute the grader's requests until the grader disconnects."""
        handlers: dict[str, Callable[..., None]] = {
            "files": write_files,
            "cells": self.run_cells,
            "scenario": self.run_scenario,
        }
        while True:
            try:
                name, *arguments = self._channel.receive()
            except ChannelClosedError:
                return
            handlers[name](*arguments)

    def run_cells(
        self,
        cells: Sequence[str],
        values: dict[str, dict[str, Any]],
        skip: Sequence[int],
    ) -> None:
        """Run all cells in order except the cells in `skip`.

        An error in one does not stop the others.
        """
        set_values(values)
        errors = []
        with time_lock.hold(), seed_generators(CELLS_SEED):
            for index, cell in enumerate(cells):
                if index not in skip:
                    self._channel.send(["cell", index])
                    errors += self._run_cell(index, cell)
                    if self._is_crowded():
                        self._channel.send(["crowded"])
                        return
        _flush()
        # Frozen objects keep their memory pages shared with the forks of the scenarios.
        gc.freeze()
        self._channel.send(["ran", errors])

    def run_scenario(
        self,
        task: str,
        name: str,
        kind: str,
        seed: int,
        calls: list[Any],
        end_ns: int,
        last_id: int,
    ) -> None:
        """Run one scenario. Nodes run in a fork, so that they cannot affect the next scenario."""
        part, before = Instructions(kind, seed, calls), cpu_seconds()
        graph = RemoteGraph(self._channel, start_ns=START_NS, end_ns=end_ns, last_id=last_id)
        # Functions and values are fast, and a fork would take longer than their scenario.
        if kind not in ON_A_GRAPH and not running_threads():
            self._perform(task, name, part, graph)
            self._channel.send(["exit", 0, cpu_seconds() - before])
            return
        try:
            child = os.fork()
        except BlockingIOError as error:
            # Processes that an earlier cell left running have used up the process limit.
            self._channel.send(["result", [], [describe(error)]])
            self._channel.send(["exit", 1, 0.0])
            return
        if child == 0:
            code = 1
            try:
                self._perform(task, name, part, graph)
                code = 0
            finally:
                _flush()
                # Skip the exit handlers that the student's code may have registered.
                os._exit(code)
        status = os.waitpid(child, 0)[1]
        self._channel.send(["exit", status, cpu_seconds() - before])

    def _run_cell(self, index: int, cell: str) -> list[str]:
        self._shell.execution_count = index + 1
        try:
            result = self._shell.run_cell(cell)
            error = result.error_before_exec or result.error_in_exec
            if isinstance(result.error_before_exec, MemoryError | RecursionError):
                # If enough memory is left for a compiler, no limit was reached: Python raises these
                # errors for a cell that is nested too deeply.
                with suppress(MemoryError):
                    bytearray(SPARE)
                    error = SyntaxError(f"{TOO_DEEP}. This cell was not run")
        except Exception as stumble:
            # Student code can break IPython itself.
            error = stumble
        if os.getpid() != self._pid:
            # The cell forked this process; only its parent runs the next cells.
            os._exit(0)
        return [describe(error)] if error is not None else []

    def _is_crowded(self) -> bool:
        """Return whether so many processes and threads are still running that no further one can start."""
        if not hasattr(os, "waitid"):
            # On macOS the number of processes is not limited.
            return False
        try:
            os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        except ChildProcessError:
            if not running_threads():
                # The usual case: nothing is running, so no fork is needed as a test.
                return False
        try:
            probe = os.fork()
        except BlockingIOError:
            return True
        if probe == 0:
            os._exit(0)
        os.waitpid(probe, 0)
        return False

    def _perform(self, task: str, name: str, part: Instructions, graph: Graph) -> None:
        """Run the object that `check` was called with, else the object with the task's name."""
        outcome, objects = Outcome(), self._shell.user_ns
        if task not in self._bound_objects and name not in objects:
            outcome.errors.append(f"{name} {NOT_DEFINED}")
        else:
            subject = self._bound_objects[task] if task in self._bound_objects else objects[name]
            try:
                perform(part, subject, graph, outcome)
            except CourseError as error:
                outcome = Outcome(errors=[str(error)])
        _flush()
        self._channel.send(["result", outcome.returns, outcome.errors])


def cpu_seconds() -> float:
    """Return the CPU time [s] of this process and its ended children.

    The module `time` is no substitute: it has robot time here.
    """
    resources = [resource.getrusage(target) for target in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in resources)


def running_threads() -> int:
    """Count the threads that the cells left running, without the kit's own watcher."""
    return _thread._count() - watch.threads


def write_files(files: dict[str, str | bytes]) -> None:
    """Write the submitted files, and the assets. One that can't be written is missing."""
    for name, content in files.items():
        with suppress(OSError):
            Path(name).parent.mkdir(parents=True, exist_ok=True)
            Path(name).write_bytes(content.encode() if isinstance(content, str) else content)
    if any(Path(name).name == MANIFEST for name in files):
        # Cells import message packages, but a grading process does not search its working folder.
        prepend_paths("ROS_PACKAGE_PATH", [Path.cwd()])


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except Exception:
            # Student code may have closed or replaced the stream.
            continue


def warm_up() -> "InteractiveShell":
    """Prepare the state that all submissions share: imports, a first run of each code path, the shell."""
    import_path.install()
    virtual_time.install()
    for module in map(importlib.import_module, USUAL + PUBLIC):
        for name in module.__all__ if module.__name__ in PUBLIC else ():
            # Access imports a lazily imported name.
            getattr(module, name)
    for type_name in SENT:
        compile_wire(type_name)
    shell = make_shell()
    shell.InteractiveTB.set_mode("Minimal")
    vars(shell).update(system=_no_shell, getoutput=_no_shell)
    formatter = shell.display_formatter
    importlib.import_module("course_lib.displays.viewer").Viewer.is_seen = False
    # Nothing is displayed during grading, so no images are rendered.
    if formatter is not None:
        formatter.active_types = ["text/plain"]
        formatter.mimebundle_formatter.enabled = False
    shell.run_cell("None")
    for _ in range(WARM_RUNS):
        perform(Instructions("node", 0), _make_usual_node, Graph(end_ns=START_NS + WARM_NS), Outcome())
    return shell


def _make_usual_node() -> Any:
    """Return a node that makes the calls that most nodes make."""
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node
    from tf2_ros import Buffer, TransformBroadcaster, TransformListener
    from visualization_msgs.msg import Marker, MarkerArray

    node = Node("warm_up")
    node.declare_parameter("rate", 10.0)
    publisher, broadcaster = node.create_publisher(MarkerArray, "warm_up", 1), TransformBroadcaster(node)
    buffer = Buffer()
    TransformListener(buffer, node)
    node.create_subscription(MarkerArray, "warm_up", lambda message: len(message.markers), 1)

    def tick() -> None:
        marker = Marker(ns="warm_up", id=1, type=Marker.CUBE)
        marker.header.frame_id, marker.header.stamp = "map", node.get_clock().now().to_msg()
        marker.pose.position.x = marker.color.a = node.get_parameter("rate").value
        transform = TransformStamped(header=marker.header, child_frame_id="base_link")
        broadcaster.sendTransform(transform)
        publisher.publish(MarkerArray(markers=[marker]))
        if buffer.can_transform("map", "base_link", marker.header.stamp):
            buffer.lookup_transform("map", "base_link", marker.header.stamp)

    node.create_timer(0.1, tick)
    return [node]


def _no_shell(*_: Any, **__: Any) -> None:
    print(NO_SHELL)  # noqa: T201
