"""A launch file run as a program: its nodes are processes of one graph, by one clock."""

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError
from launch.actions import declared
from launch.conditions import InvalidConditionExpressionError
from launch.entities import (
    Action,
    Entities,
    Event,
    LaunchContext,
    SubstitutionFailure,
    listed,
    text_of,
)
from launch.events import ProcessExited, ProcessStarted, Shutdown
from launch.launch_description_sources import InvalidPythonLaunchFileError, LaunchDescriptionSource

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.clock import THREADS
from course_lib.ros.graph import current_graph
from course_lib.ros.packages import Package, find_package, is_compiled, python_path, source, why_not_found
from course_lib.ros.prefixed import Prefixes
from course_lib.ros.process import INTERRUPTED, Function, Process, Processes, Program

Executables = Mapping[tuple[str, str], Callable[[], object]]  # by package and name
_COMPLAINTS = (
    CourseError,
    RuntimeError,
    OSError,
    PackageNotFoundError,
    SubstitutionFailure,
    InvalidConditionExpressionError,
    InvalidPythonLaunchFileError,
)
_imported: set[str] = set()  # packages of processes; another launch reads their files again


class LaunchProgram(Process):
    """A launch file: Python with `generate_launch_description`.

    `args` hold `name:=value` for its arguments, and what goes to all nodes; `own` are executables of the kit.
    """

    def __init__(self, file: Path, args: Sequence[str], own: Executables) -> None:
        super().__init__(file, args)
        self._own = own
        self._settings: dict[str, str] = {}
        self._for_nodes: list[str] = []
        for_ros = False
        for word in args:
            for_ros = word == "--ros-args" or (for_ros and word != "--")
            if ":=" in word and not for_ros:
                name, _, value = word.partition(":=")
                self._settings[name] = value
            else:
                self._for_nodes.append(word)
        self._context = LaunchContext(self, file=str(file.absolute()))
        self._processes = Processes()
        self._prefixes = Prefixes()
        self._started: list[tuple[Action, Process]] = []
        self._told = 0  # how many ends were told of
        self._due: list[Callable[[], None]] = []  # events to handle, and what timers do
        self._to_come = 0  # timers
        self._stopping = False

    def work(self) -> None:
        """Start what the file describes, then do what it says when things happen, until all have ended."""
        forget_imported()
        self.log("INFO", "launch", "Default logging verbosity is set to INFO")
        with self._prefixes.shown():
            self._launch()

    def _launch(self) -> None:
        try:
            description = self.describe()
            self._context.launch_configurations |= self._settings
            self._visit(description)
        except _COMPLAINTS as error:
            self.log("ERROR", "launch", f"Caught exception in launch (see debug for traceback): {error}")
            self.exit_code = 1
            self._shut_down()
        self._go_on()

    def arguments(self) -> str:
        """Describe the arguments as `ros2 launch --show-args` does."""
        lines = ["Arguments (pass arguments as '<name>:=<value>'):"]
        for argument in declared(self.describe(), self._context):
            lines += ["", f"    '{argument.name}':", f"        {argument.description}"]
            if argument.default_value is not None:
                default = text_of(self._context, argument.default_value)
                self._context.launch_configurations.setdefault(argument.name, default)
                lines.append(f"        (default: {default!r})")
        return "\n".join(lines if len(lines) > 1 else [*lines, "", "    No arguments."])

    def start(self, action: Action, package: str, executable: str, words: Iterable[str]) -> None:
        """Start an executable; raises a CourseError if there is none."""
        if self._stopping:
            return
        function = find_executable(package, executable, self._own)
        pid = len(self._started) + 1
        name = f"{executable}-{pid}"
        for_all = ["--", *self._for_nodes] if self._for_nodes else []
        process = _Launched(name, function, [*words, *for_all], self._prefixes)
        self._started.append((action, process))
        self._processes.start(process)
        self.log("INFO", name, f"process started with pid [{pid}]")
        self.emit(ProcessStarted(action, name))

    def later(self, seconds: float, entities: Entities) -> None:
        """Visit entities when so much robot time [s] is over."""
        if self._stopping:
            return
        graph = current_graph()

        def come() -> None:
            self._to_come -= 1
            self._due.append(partial(self._visit, entities))

        self._to_come += 1
        graph.call_at(graph.now_ns + round(seconds * 1e9), come, node=THREADS, entity=0)

    def emit(self, event: Event) -> None:
        """Queue an event for the event handlers; a Shutdown then ends all processes."""
        self._due.append(partial(self._handle, event))

    def _handle(self, event: Event) -> None:
        for handler in [one for one in self._context.handlers if one.matches(event)]:
            if handler.handle_once:
                self._context.handlers.remove(handler)
            self._visit(handler.handle(event, self._context))
        if isinstance(event, Shutdown):
            self._shut_down()

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line of the launch's own log."""
        sys.stdout.write(f"[{level}] [{name}]: {text}\n")

    def describe(self) -> Entities:
        """Return the description of the launch."""
        source(self.file)
        return LaunchDescriptionSource(self.file).get_launch_description(self._context)

    def _visit(self, entities: Entities | None) -> None:
        for entity in listed(entities):
            self._visit(entity.visit(self._context))

    def _go_on(self) -> None:
        while True:
            try:
                while self._note_ends() or self._due or (self._to_come and not current_graph().ended):
                    baton.wait(self._has_news, until_ns=None, what="the processes of the launch")
                    while self._due:
                        self._due.pop(0)()
                return
            except KeyboardInterrupt:
                self.emit(Shutdown("ctrl-c (SIGINT)", due_to_sigint=True))
            except DeadlockError:
                self._shut_down()
                self._go_on()
                raise

    def _shut_down(self) -> None:
        self._stopping, self._to_come = True, 0
        self._processes.interrupt()

    def _has_news(self) -> bool:
        return bool(self._due) or len(self._processes.ended) > self._told

    def _note_ends(self) -> bool:
        """Report processes that have ended; returns whether others are still running."""
        while self._told < len(self._processes.ended):
            self._told += 1
            self._tell_end(self._processes.ended[self._told - 1])
        return self._told < len(self._started)

    def _tell_end(self, number: int) -> None:
        action, process = self._started[number]
        name, pid = process.file.name, number + 1
        code = 0 if self._stopping and process.exit_code == INTERRUPTED else process.exit_code
        if code:
            command = " ".join(process.argv)
            self.log("ERROR", name, f"process has died [pid {pid}, exit code {code}, cmd '{command}'].")
        else:
            self.log("INFO", name, f"process has finished cleanly [pid {pid}]")
        self.exit_code = self.exit_code or code
        self.emit(ProcessExited(action, name, code))


class _Launched(Function):
    """A process of a launch, whose output stands behind its name."""

    def __init__(
        self, name: str, function: Callable[[], object], args: Sequence[str], prefixes: Prefixes
    ) -> None:
        super().__init__(name, function, args)
        self._prefixes = prefixes

    def run(self) -> None:
        """Run it to its end."""
        with self._prefixes.behind(self.file.name):
            super().run()


class RunProgram(Function):
    """One executable of a package with its words, as `ros2 run` starts it."""

    def __init__(self, package: str, executable: str, words: Sequence[str], own: Executables) -> None:
        super().__init__(executable, find_executable(package, executable, own), words)

    def run(self) -> None:
        """Run it to its end, with ros2cli's line for a failure."""
        forget_imported()
        super().run()
        if self.exit_code:
            sys.stdout.write(f"[ros2run]: Process exited with failure {self.exit_code}\n")


def find_executable(package: str, executable: str, own: Executables) -> Callable[[], object]:
    """Find an executable of a package or of the kit; raises a CourseError that says what there is."""
    found = find_package(package)
    if found is not None and executable in found.executables:
        return partial(_call, found, executable)
    if (package, executable) in own:
        return own[package, executable]
    if found is not None and is_compiled(found, executable):
        raise CourseError(
            f"'{executable}' of package '{package}' is a compiled program, and this kit runs Python only. "
            "Build it with colcon on a computer with ROS 2, or write the node in Python."
        )
    names = [*found.executables] if found else [name for place, name in own if place == package]
    if not names and found is None:
        raise CourseError(why_not_found(package))
    where = " Executables are named in console_scripts in setup.py." if found else ""
    raise CourseError(
        f"executable '{executable}' not found in package '{package}', which has: "
        f"{', '.join(names) or 'none'}{did_you_mean(executable, names) or '.'}{where}"
    )


def arguments_of(file: Path) -> str:
    """Describe the arguments that a launch file declares; raises a CourseError for any other file."""
    try:
        return LaunchProgram(file, (), {}).arguments()
    except _COMPLAINTS as error:
        raise CourseError(f"{file}: {error}") from error


def forget_imported() -> None:
    """Unload the packages of earlier processes: their files may have changed."""
    for name in [name for name in sys.modules if name.partition(".")[0] in _imported]:
        del sys.modules[name]
    _imported.clear()


def _call(package: Package, executable: str) -> object:
    folders = [str(folder) for folder in package.python]
    sys.path[1:] = [
        *folders,
        *(entry for entry in sys.path[1:] if entry not in folders),
    ]  # behind the stand-in
    sys.path += [place for place in python_path(package.share / "package.xml") if place not in sys.path]
    target = package.executables[executable]
    if isinstance(target, Path):
        Program(target, ()).work()
        return None
    module, function = target
    _imported.add(module.partition(".")[0])
    return getattr(import_module(module), function)()
