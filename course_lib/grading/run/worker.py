"""The process that runs a submission: its cells once, then each scenario in a fork of it.

It is a fork of `jail.template`. It holds no check, no expected value and no hidden text; what it says is
evidence, judged elsewhere and not believed.
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
from course_lib.grading.personal import give_values
from course_lib.grading.run.outcome import NOT_MADE, Outcome, describe
from course_lib.grading.run.scenario_graph import Instructions
from course_lib.grading.run.student_side import perform
from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.channel import Channel, ChannelClosedError
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph
from course_lib.ros.interrupts import watch
from course_lib.ros.messages import compile_wire
from course_lib.ros.process import make_shell
from course_lib.ros.remote_graph import RemoteGraph
from course_lib.ros.seeding import seeded

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

CELLS_SEED = 0
USUAL = (  # what most notebooks import, or need for a line of magic
    "numpy.random", "rclpy.node", "rclpy.executors", "rclpy.qos", "rclpy.signals", "geometry_msgs.msg",
    "std_msgs.msg", "visualization_msgs.msg", "sensor_msgs.msg", "nav_msgs.msg", "vision_msgs.msg",
    "diagnostic_msgs.msg", "tf2_ros", "launch_ros.actions", "asyncio", "yaml",
    "IPython.core.magics.extension", "course_lib.extension", "course_lib.displays.viewer",
    "course_lib.ros.launch_program", "course_lib.tools.notebook", "pygments.formatters.terminal256",
)  # fmt: skip
SENT = (  # by most nodes, or by the kit's own; a type in a message's list comes with it
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
WARM_RUNS, WARM_NS = 12, 1_000_000_000  # Python specializes code that has run some ten times
NO_SHELL = "There is no shell when graded: this line is left out."


class Worker:
    """The loop in which a worker does what the grader asks for.

    Args:
        channel: To the grader.
        shell: What `warm_up` made.
    """

    def __init__(self, channel: Channel, shell: "InteractiveShell") -> None:
        self._channel, self._shell, self._pid = channel, shell, os.getpid()
        self._bound: dict[str, Any] = {}
        bind_only(self._bound.__setitem__)

    def serve(self) -> None:
        """Do what the grader asks until it is gone."""
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

    def run_cells(self, cells: Sequence[str], values: dict[str, dict[str, Any]], skip: Sequence[int]) -> None:
        """Run all cells in order, but those to skip; an error in one does not stop the rest."""
        give_values(values)
        errors = []
        with baton.known(), seeded(CELLS_SEED):
            for index, cell in enumerate(cells):
                if index not in skip:
                    self._channel.send(["cell", index])
                    errors += self._run_cell(index, cell)
                    if self._is_crowded():
                        self._channel.send(["crowded"])
                        return
        _flush()
        gc.freeze()  # what the cells made stays shared with the scenarios' forks
        self._channel.send(["ran", errors])

    def run_scenario(
        self, task: str, name: str, kind: str, seed: int, calls: list[Any], end_ns: int, last_id: int
    ) -> None:
        """Run one scenario; nodes in a fork, so that they leave nothing behind for the next."""
        part, before = Instructions(kind, seed, calls), cpu_seconds()
        graph = RemoteGraph(self._channel, start_ns=START_NS, end_ns=end_ns, last_id=last_id)
        if kind != "node" and not threads_left():  # a fork takes longer than all the rest of it
            self._perform(task, name, part, graph)
            self._channel.send(["exit", 0, cpu_seconds() - before])
            return
        try:
            child = os.fork()
        except BlockingIOError as error:  # what an earlier cell left running has multiplied
            self._channel.send(["result", [], [describe(error)]])
            self._channel.send(["exit", 1, 0.0])
            return
        if child == 0:
            self._run_in_child(task, name, part, graph)
        status = os.waitpid(child, 0)[1]
        self._channel.send(["exit", status, cpu_seconds() - before])

    def _run_cell(self, index: int, cell: str) -> list[str]:
        self._shell.execution_count = index + 1
        try:
            result = self._shell.run_cell(cell)  # type: ignore[no-untyped-call]  # IPython does not annotate it
            error = result.error_before_exec or result.error_in_exec
        except Exception as stumble:  # IPython's own, over what the student's code put in its way
            error = stumble
        if os.getpid() != self._pid:
            os._exit(0)  # a fork that the cell made: the next cells are its parent's
        return [describe(error)] if error is not None else []

    def _is_crowded(self) -> bool:
        """Return whether the cells left so many processes and threads that no further one can start."""
        if not hasattr(os, "waitid"):
            return False  # macOS, where processes are not bounded
        try:
            os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        except ChildProcessError:
            if not threads_left():
                return False  # the usual case, at once
        try:
            probe = os.fork()
        except BlockingIOError:
            return True
        if probe == 0:
            os._exit(0)
        os.waitpid(probe, 0)
        return False

    def _run_in_child(self, task: str, name: str, part: Instructions, graph: Graph) -> None:
        status = 1
        try:
            self._perform(task, name, part, graph)
            status = 0
        finally:
            _flush()
            os._exit(status)  # no handler that the student's code left behind is run

    def _perform(self, task: str, name: str, part: Instructions, graph: Graph) -> None:
        outcome = Outcome()
        try:
            perform(part, self._subject(task, name), graph, outcome)
        except CourseError as error:
            outcome = Outcome(errors=[str(error)])
        _flush()
        self._channel.send(["result", outcome.returns, outcome.errors])

    def _subject(self, task: str, name: str) -> Any:
        """Return the object that `check` was called with, else the object with the declared name."""
        if task in self._bound:
            return self._bound[task]
        if name not in self._shell.user_ns:
            raise CourseError(f"{name} {NOT_MADE}")
        return self._shell.user_ns[name]


def cpu_seconds() -> float:
    """Return what this process and its children that have ended used, [s]; `time` has robot time here."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def threads_left() -> int:
    """Count the threads that the cells have left running; the one that watches callbacks is the kit's."""
    return _thread._count() - watch.threads


def write_files(files: dict[str, str]) -> None:
    """Write what came with the notebook; where the folder does not take one, the cells will miss it."""
    for name, text in files.items():
        with suppress(OSError):
            Path(name).parent.mkdir(parents=True, exist_ok=True)
            Path(name).write_text(text, encoding="utf-8")


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except Exception:  # the student's code may have closed it, or put anything in its place
            continue


def warm_up() -> "InteractiveShell":
    """Do all that is the same for every submission: imports, a first run of everything, the cells' shell."""
    standin_path.install()
    virtual_time.install()
    for module in map(importlib.import_module, USUAL + PUBLIC):
        for name in module.__all__ if module.__name__ in PUBLIC else ():
            getattr(module, name)  # it is imported now
    for type_name in SENT:
        compile_wire(type_name)
    shell = make_shell()
    shell.InteractiveTB.set_mode("Minimal")
    vars(shell).update(system=_no_shell, getoutput=_no_shell)
    formatter = shell.display_formatter
    importlib.import_module("course_lib.displays.viewer").Viewer.is_seen = False
    if formatter is not None:  # nobody looks: no picture is drawn
        formatter.active_types = ["text/plain"]
        formatter.mimebundle_formatter.enabled = False
    shell.run_cell("None")  # type: ignore[no-untyped-call]  # IPython does not annotate it
    for _ in range(WARM_RUNS):
        perform(Instructions("node", 0), _usual_node, Graph(end_ns=START_NS + WARM_NS), Outcome())
    return shell


def _usual_node() -> Any:
    """Return a node that does what most nodes do; its calls are those of every scenario."""
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
    print(NO_SHELL)  # noqa: T201  into the output of the cell
