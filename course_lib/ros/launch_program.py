"""A launch file run as a program: its nodes are processes of one graph, by one clock."""

import signal
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError
from launch.actions import declared
from launch.conditions import InvalidConditionExpressionError
from launch.entities import Action, Entities, Event, LaunchContext, listed, text_of
from launch.event_handlers import OnProcessIO
from launch.events import ProcessExited, ProcessIO, ProcessStarted, Shutdown, ShutdownProcess, SignalProcess
from launch.launch_description_sources import LaunchDescriptionSource

from course_lib.errors import CourseError
from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.clock import THREADS
from course_lib.ros.graph import current_graph
from course_lib.ros.package_programs import (
    Executables,
    find_component,
    find_executable,
    forget_imported,
    put_first,
)
from course_lib.ros.packages import python_path, source
from course_lib.ros.prefixed import Prefixes
from course_lib.ros.process import INTERRUPTED, Function, Process, Processes, Program

_COMPLAINTS = (CourseError, RuntimeError, OSError, PackageNotFoundError, InvalidConditionExpressionError)
_ENDS = ("SIGINT", "SIGTERM", "SIGKILL", "SIGQUIT")


class LaunchProgram(Process):
    """A launch file: XML, YAML, or Python with `generate_launch_description`.

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
        self._prefixes = Prefixes(self._hear)
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
        is_over = False
        try:
            self._due.append(self._begin)
            self._go_on()
            is_over = True
        finally:
            if not is_over:  # by an error of the launch file: its processes must not go on without it
                self._shut_down()

    def _begin(self) -> None:
        description = self.describe()
        self._context.launch_configurations |= self._settings
        self._visit(description)

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
        self.start_function(action, executable, find_executable(package, executable, self._own), words)

    def start_file(self, action: Action, file: Path, words: Iterable[str]) -> None:
        """Start a Python program by its path; raises a CourseError if it cannot be run."""
        self.start_function(action, file.name, Program(file, ()).work, words)

    def start_component(self, action: Action, package: str, plugin: str, words: Iterable[str]) -> None:
        """Start a component, or log why it is left out."""
        try:
            function = find_component(package, plugin, self._own)
        except CourseError as error:
            self.log("ERROR", "launch_ros.actions.load_composable_nodes", str(error))
        else:
            self.start_function(action, plugin, function, words)

    def start_function(
        self, action: Action, name: str, function: Callable[[], object], words: Iterable[str]
    ) -> None:
        """Start a function as a process; the words are its command line."""
        if self._stopping:
            return
        pid = len(self._started) + 1
        name = f"{name}-{pid}"
        for_all = ["--", *self._for_nodes] if self._for_nodes else []
        process = _Launched(name, function, [*words, *for_all], self._prefixes)
        self._started.append((action, process))
        self._processes.start(process)
        self.log("INFO", name, f"process started with pid [{pid}]")
        self.emit(ProcessStarted(action, name, pid, process.argv))

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
                self._context.unregister_event_handler(handler)
            self._context.locals.event = event
            self._visit(handler.handle(event, self._context))
            del self._context.locals.event
        if isinstance(event, Shutdown):
            self._shut_down()
        elif isinstance(event, ShutdownProcess) and _is_end(event):
            matching = [n for n, (action, _) in enumerate(self._started) if event.process_matcher(action)]
            self._processes.interrupt(matching)

    def _hear(self, name: str, stream: int, text: str) -> None:
        """Emit what a process wrote, where a handler of such events was registered."""
        if any(isinstance(handler, OnProcessIO) for handler in self._context.handlers):
            number = int(name.rpartition("-")[2])
            action, process = self._started[number - 1]
            self.emit(ProcessIO(action, name, number, process.argv, text.encode(), stream))

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line of the launch's own log."""
        sys.stdout.write(f"[{level}] [{name}]: {text}\n")

    def describe(self) -> Entities:
        """Return the description of the launch."""
        prepare_imports(self.file)
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
            except _COMPLAINTS as error:
                self.log("ERROR", "launch", f"Caught exception in launch (see debug for traceback): {error}")
                self.exit_code = 1
                self._shut_down()
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
        self.emit(ProcessExited(action, name, pid, process.argv, code))
        self._due.append(partial(self._context.complete, action))


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


def prepare_imports(file: Path) -> None:
    """Add the packages of a launch file's workspace to the paths, also for what it imports."""
    source(file)
    put_first(python_path(file))


def arguments_of(file: Path) -> str:
    """Describe the arguments that a launch file declares; raises a CourseError for any other file."""
    try:
        return LaunchProgram(file, (), {}).arguments()
    except _COMPLAINTS as error:
        raise CourseError(f"{file}: {error}") from error


def _is_end(event: ShutdownProcess) -> bool:
    """Return whether an event ends processes: a signal may be another one."""
    if not isinstance(event, SignalProcess):
        return True
    given = event.signal_number
    return (given if isinstance(given, str) else signal.Signals(given).name) in _ENDS
