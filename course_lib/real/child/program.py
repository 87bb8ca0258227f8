"""Runs a program unchanged under the real rclpy: `python program.py SETTINGS SUBJECT FILE ARGUMENTS…`.

The environment's packages have priority. Packages without a wheel are added: those of the kit that
are Python code on top of rclpy (tf2_ros …), and types (`late_types`). If SUBJECT is not "-", the
file is a module whose class or function SUBJECT creates the nodes to spin, as in a grading
scenario, and ARGUMENTS are topics that the kit publishes. SETTINGS is a dictionary:

- kit: the folder that contains `course_lib`
- python: the Python of the kit, which describes types
- packages: packages of types without a wheel
- used: a file that receives a line for each package that is not from ROS
- is_timed: whether the kit, not the user, interrupts the program
- parent: the process id of the kit
"""

import ast
import ctypes
import os
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import spec_from_loader
from pathlib import Path
from types import FrameType, ModuleType, SimpleNamespace, TracebackType
from typing import Any

PACKAGES = (
    "cv_bridge",
    "diagnostic_updater",
    "image_geometry",
    "interactive_markers",
    "laser_geometry",
    "message_filters",
    "sensor_msgs_py",
    "tf2_geometry_msgs",
    "tf2_py",
    "tf2_ros",
    "tf2_sensor_msgs",
    "tf_transformations",
)
# Topics of every node.
OWN_TOPICS = ("/rosout", "/parameter_events")
# Time limit for connecting all topics [s].
CONNECT_SECONDS = 3.0
# Polling period of a waiting thread [s].
WAIT = 0.005
KINDS = ("msg", "srv", "action")
# An option of Linux's prctl.
PARENT_DEATH_SIGNAL = 1
PARENT = os.getppid()
# Time that a program has to end after its parent was killed [s].
ORPHAN_SECONDS = 5
# C code calls the functions of this file, through ctypes.
CALLBACKS = str(Path(__file__).with_name("late_types.py"))
NOT_INSTALLED = (
    "hint: {} is not in the environment of the real ROS 2, which has rclpy, its messages and "
    "numpy. Run the program without --ros, or on a robot.\n"
)
NO_COURSE_LIB = "robots do not have course_lib, so `from course_lib import {}` fails there, too"


class KitPackages(MetaPathFinder, Loader):
    """Finds packages of the kit and types without a wheel, unless an installed package has the same name."""

    def __init__(self, settings: dict[str, Any], program: str) -> None:
        self._kit, self._python, self._program = settings["kit"], settings["python"], program
        self._packages, self._used = set(settings["packages"]), Path(settings["used"])
        self._classes: dict[str, dict[str, type]] = {}

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a package of the kit, a package of types, or its `msg`, `srv` or `action`."""
        package, _, kind = name.partition(".")
        if package in self._packages and kind in KINDS:
            return spec_from_loader(name, self)
        if name not in PACKAGES and name not in self._packages:
            return None
        spec = PathFinder.find_spec(name)
        if spec is not None and spec.loader is not None:
            # The program's own package, or an installed one, with Python code.
            return spec
        if name in PACKAGES:
            self._record_use(name)
            return PathFinder.find_spec(name, [f"{self._kit}/course_lib/ros/standin"])
        # Python would find a folder that contains only interface files as a namespace package.
        return spec_from_loader(name, self, is_package=True)

    def create_module(self, spec: ModuleSpec) -> None:
        """Let Python create the module."""

    def exec_module(self, module: ModuleType) -> None:
        """Fill `package.msg` and the like with classes. The package itself remains empty."""
        package, _, kind = module.__name__.partition(".")
        if not kind:
            return
        if package not in self._classes:
            self._record_use(f"{package} (types)")
            from course_lib.real.child.late_types import create_classes

            command = [self._python, "-P", "-m", "course_lib.real.types", package, self._program]
            environment = os.environ | {"PYTHONPATH": self._kit}
            process = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
            if process.returncode:
                raise ImportError(
                    f"The types of {package} cannot be read: {process.stderr.strip()}", name=package
                )
            self._classes[package] = create_classes(ast.literal_eval(process.stdout))
        for name, created in self._classes[package].items():
            if name.startswith(f"{package}/{kind}/"):
                setattr(module, name.rpartition("/")[2], created)

    def _record_use(self, name: str) -> None:
        with self._used.open("a", encoding="utf-8") as file:
            file.write(f"{name}\n")


def wait(ready: Callable[[], bool], *, until_ns: int, awaited: str) -> None:
    """Wait until `ready()` is true or the monotonic clock reaches a time."""
    while not ready() and time.monotonic_ns() < until_ns:
        time.sleep(WAIT)


def current_graph() -> SimpleNamespace:
    """Return the part of a graph that tf2_ros uses, with the time of the monotonic clock."""
    return SimpleNamespace(notebook=False, now_ns=time.monotonic_ns())


# The interface of the kit's time lock, for threads that need no lock: others run while one waits.
time_lock = SimpleNamespace(is_program_thread=lambda: True, poll=lambda: None, hold=nullcontext, wait=wait)


def add_kit(kit: Path) -> None:
    """Make the kit's modules importable without running `course_lib/__init__.py`, which replaces rclpy."""

    def raise_import_error(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise ImportError(NO_COURSE_LIB.format(name))

    for name in ("course_lib", "course_lib.ros"):
        module = sys.modules[name] = ModuleType(name)
        module.__path__ = [str(kit / name.replace(".", "/"))]
    sys.modules["course_lib"].__getattr__ = raise_import_error  # type: ignore[method-assign]
    # The kit's tf2_ros imports these modules, which belong to robot time. Here, threads wait in
    # real time.
    for name in ("course_lib.ros.time.time_lock", "course_lib.ros.graph.graph"):
        sys.modules[name] = sys.modules[__name__]


def print_error(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None, *, is_timed: bool
) -> None:
    """Print a traceback without the frames of this file. The end of a timed run is not an error."""
    if is_timed and kind is KeyboardInterrupt:
        return
    while trace is not None and trace.tb_frame.f_code.co_filename == __file__:
        trace = trace.tb_next
    last = trace
    while last is not None and last.tb_next is not None:
        if last.tb_next.tb_frame.f_code is interrupt.__code__:
            last.tb_next = None
            break
        last = last.tb_next
    traceback.print_exception(kind, error, trace)
    if isinstance(error, ModuleNotFoundError) and error.name:
        sys.stderr.write(NOT_INSTALLED.format(error.name.partition(".")[0]))


def interrupt(_: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, outside of the callbacks of `late_types`.

    ctypes discards an exception of a callback, so that the program would miss Ctrl+C. There, the
    exception is raised when the C function returns to the Python code that called it.
    """
    if os.getppid() != PARENT:
        # The parent was killed. Nothing else ends a program that continues after the interrupt.
        signal.alarm(ORPHAN_SECONDS)
    caller = None
    while frame is not None:
        if frame.f_code.co_filename == CALLBACKS:
            caller = frame.f_back
        frame = frame.f_back
    if caller is None:
        raise KeyboardInterrupt

    def raise_interrupt(traced: FrameType, event: str, argument: Any) -> None:
        sys.settrace(None)
        traced.f_trace, traced.f_trace_opcodes = None, False
        raise KeyboardInterrupt

    caller.f_trace, caller.f_trace_opcodes = raise_interrupt, True
    sys.settrace(lambda *_: None)


def execute(file: Path, name: str) -> dict[str, Any]:
    """Execute a file as the module `name` and return its globals."""
    module = sys.modules[name] = ModuleType(name)
    module.__file__ = str(file)
    source = file.read_bytes()
    exec(compile(source, str(file), "exec"), vars(module))
    return vars(module)


def spin_subject(make: Any, inputs: Sequence[str]) -> None:
    """Create one or more nodes and spin them. A function that returns None has already spun them.

    Spinning, and with it all timers, begins when the kit is connected to all topics. Otherwise the
    first messages would be lost.
    """
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

    code = getattr(make, "__code__", None)
    if code is None or "init" not in code.co_names:
        rclpy.init(args=[])
    else:
        print_begin()
    subject = make()
    nodes = [subject] if isinstance(subject, rclpy.node.Node) else list(subject or ())
    if not nodes:
        return
    wait_for_connections(nodes, inputs)
    for timer in (timer for node in nodes for timer in node.timers):
        timer.reset()
    print_begin()
    try:
        executor = SingleThreadedExecutor()
        for node in nodes:
            executor.add_node(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


def wait_for_connections(nodes: Sequence[Any], inputs: Sequence[str]) -> None:
    """Wait until each publisher has a subscription and each input has a publisher."""
    publishers = [p for node in nodes for p in node.publishers if p.topic_name not in OWN_TOPICS]
    deadline = time.monotonic() + CONNECT_SECONDS
    while time.monotonic() < deadline:
        are_connected = all(publisher.get_subscription_count() for publisher in publishers)
        if are_connected and all(nodes[0].count_publishers(topic) for topic in inputs):
            return
        time.sleep(0.01)


def print_begin() -> None:
    """Print the time at which the scenario begins, for the kit."""
    sys.stdout.write(f"begin {time.time_ns()}\n")
    sys.stdout.flush()


def main() -> None:
    """Run the program given on the command line."""
    text, subject, program, *arguments = sys.argv[1:]
    settings = ast.literal_eval(text)
    # If the parent process is killed, the program is interrupted as by Ctrl+C.
    ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGINT)
    if settings["parent"] != PARENT or os.getppid() != PARENT:
        # It was killed while Python started.
        sys.exit(128 + signal.SIGKILL)
    for name in ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE"):
        # Only this process needs these variables. They would break other Pythons started by the
        # program.
        os.environ.pop(name, None)
    file = Path(program)
    sys.argv = [program, *arguments]
    sys.path[0] = str(file.resolve().parent)
    add_kit(Path(settings["kit"]))
    sys.meta_path.insert(0, KitPackages(settings, program))
    # The parent has blocked it while Python started. Until the program begins, Ctrl+C ends Python
    # without a traceback of this file.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    signal.signal(signal.SIGINT, interrupt)
    sys.excepthook = partial(print_error, is_timed=settings["is_timed"])
    if subject == "-":
        execute(file, "__main__")
    else:
        spin_subject(execute(file, file.stem)[subject], arguments)


if __name__ == "__main__":
    main()
