"""Execution of launch files, with the process name before each line of output: `[talker-1] `.

Actions that cannot run here, such as a simulator, are skipped with one line in the log.

A launch file that imports a helper module of MoveIt or Webots starts other programs, too.
Everything it creates with such a module is a placeholder: the action that uses it is skipped in the
same way, and all other actions start.
"""

import os
import re
import signal
import sys
import sysconfig
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn, cast

from ament_index_python.packages import PackageNotFoundError
from launch import events
from launch.actions import IncludeLaunchDescription, find_declarations
from launch.conditions import InvalidConditionExpressionError
from launch.entities import Action, Entities, Event, LaunchContext, Substitution, as_entity_list, text_of
from launch.event_handlers import OnProcessIO
from launch.launch_description_sources import AnyLaunchDescriptionSource

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import THREADS, current_graph, program
from course_lib.ros.hints import hint
from course_lib.ros.programs import import_path, packages
from course_lib.ros.programs.package_programs import (
    Executables,
    find_component,
    find_executable,
    prepend_to_path,
    unload_packages,
)
from course_lib.ros.programs.process import INTERRUPTED, FunctionProcess, Process, Processes, Program
from course_lib.ros.time.time_lock import DeadlockError, ShutDown, time_lock
from course_lib.ros.tracebacks import format_location, line_of_traceback


class AbsentModules(Loader):
    """Finds modules that a launch file imports and that no other finder provides.

    It is the last finder.
    """

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """While a launch file is read, find a module of a package that is known not to run here."""
        package = name.partition(".")[0]
        reason = packages.unavailable_reason(package) if packages.is_tolerant() else ""
        if not reason:
            return None
        packages.missing_share_folder(package, f"package '{package}' not found: {reason}")
        return ModuleSpec(name, cls(), is_package=True)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return a module that has a placeholder for every name."""
        return _AbsentModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing, because the module has no code."""


class _AbsentModule(ModuleType):
    def __getattr__(self, name: str) -> "Placeholder":
        if name.startswith("__"):
            raise AttributeError(name)
        return Placeholder(f"{self.__name__}.{name}")


class Placeholder(Action, Substitution):
    """An object of an absent module, or an object created with one.

    `origin` is its name in the module.
    """

    is_asynchronous = True

    def __init__(self, origin: str) -> None:
        Action.__init__(self)
        self.origin = origin

    def visit(self, context: LaunchContext) -> NoReturn:
        """Raise the error that makes the launch skip the action."""
        package = self.origin.partition(".")[0]
        raise packages.NotAvailableError(
            f"package '{package}' not found: {packages.unavailable_reason(package)}"
        )

    def perform(self, context: LaunchContext) -> NoReturn:
        """Raise the error that makes the launch skip the action that uses the placeholder."""
        self.visit(context)

    def __getattr__(self, name: str) -> "Placeholder":
        if name.startswith("__"):
            raise AttributeError(name)
        return Placeholder(f"{self.origin}.{name}")

    def __call__(self, *args: Any, **kwargs: Any) -> "Placeholder":
        """Return a placeholder for the result."""
        return Placeholder(self.origin)

    def __getitem__(self, key: Any) -> "Placeholder":
        return Placeholder(self.origin)

    def __setitem__(self, key: Any, value: Any) -> None:
        """Ignore the value."""

    def __iter__(self) -> Iterator["Placeholder"]:
        yield Placeholder(self.origin)

    def __add__(self, other: Any) -> "Placeholder":
        return Placeholder(self.origin)

    __radd__ = __truediv__ = __rtruediv__ = __or__ = __ror__ = __add__

    def __fspath__(self) -> str:
        return str(packages.INSTALLED / self.origin.partition(".")[0])

    __str__ = __fspath__


# Receives the name of a process, its stream (1: standard output, 2: standard error), and lines.
OutputCallback = Callable[[str, int, str], object]


@dataclass(eq=False, repr=False)
class OutputPrefixes:
    """Prefixes the output of each process with its name from `by_program`.

    `on_output` receives the output in whole lines.
    """

    on_output: OutputCallback
    by_program: dict[str, str] = field(default_factory=dict)
    _streams: "list[_PrefixedStream]" = field(default_factory=list)

    @contextmanager
    def prefix_output(self) -> Iterator[None]:
        """Prefix the output of the processes within a `with` block."""
        original_streams = sys.stdout, sys.stderr
        self._streams = [
            _PrefixedStream(stream, number, self.by_program, self.on_output)
            for number, stream in enumerate(original_streams, 1)
        ]
        sys.stdout, sys.stderr = self._streams
        try:
            yield
        finally:
            # If another launch has replaced the streams, leave its own in place.
            if [sys.stdout, sys.stderr] == self._streams:
                sys.stdout, sys.stderr = original_streams

    @contextmanager
    def of_process(self, process: str) -> Iterator[None]:
        """Prefix the output of the calling program within a `with` block."""
        self.by_program[program.name] = process
        try:
            yield
        finally:
            for stream in self._streams:
                stream.end(program.name)


@dataclass(eq=False, repr=False)
class _PrefixedStream:
    """A stream that buffers the output of processes until a line is complete, as launch does."""

    _stream: Any
    _number: int
    _by_program: dict[str, str]
    _on_output: OutputCallback
    # The incomplete last lines by program.
    _incomplete_lines: dict[str, str] = field(default_factory=dict)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text. The output of a process is written line by line after its name."""
        if program.name not in self._by_program:
            return int(self._stream.write(text))
        *lines, incomplete = (self._incomplete_lines.get(program.name, "") + text).split("\n")
        self._incomplete_lines[program.name] = incomplete
        if lines:
            self._write_lines(program.name, lines)
        return len(text)

    def _write_lines(self, name: str, lines: list[str]) -> None:
        process = self._by_program[name]
        self._stream.write("".join(f"[{process}] {line}\n" for line in lines))
        self._on_output(process, self._number, "".join(f"{line}\n" for line in lines))

    def writelines(self, lines: list[str]) -> None:
        """Write lines."""
        self.write("".join(lines))

    def end(self, name: str) -> None:
        """Write the incomplete last line of a program."""
        incomplete = self._incomplete_lines.pop(name, "")
        if incomplete:
            self._write_lines(name, [incomplete])


_COMPLAINTS = (CourseError, RuntimeError, OSError, PackageNotFoundError, InvalidConditionExpressionError)
# Limit on skipped actions, because an exit handler may start the same action again and again.
_MAX_SKIPPED = 100
# Variables that the setup of ROS or a simulator defines and to which launch files prepend folders.
_SET_BY_SETUP = (
    *("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH"),
    *("GZ_SIM_RESOURCE_PATH", "GZ_SIM_SYSTEM_PLUGIN_PATH", "IGN_GAZEBO_RESOURCE_PATH"),
    *("GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH", "GAZEBO_PLUGIN_PATH"),
)
# The representation of a substitution or an action, and its maximum length in a warning.
_OBJECT = re.compile(r"<launch(?:_ros)?\.[\w.]*?(\w+) object at 0x\w+>")
_MAX_SHOWN = 80
_ENDS = ("SIGINT", "SIGTERM", "SIGKILL", "SIGQUIT")


class LaunchProgram(Process):
    """A launch file: XML, YAML, or Python with `generate_launch_description`.

    Actions that cannot run here, such as a simulator, are skipped with one line in the log.

    Args:
        file: The launch file.
        args: `name:=value` for its arguments, and arguments for all nodes.
        kit_executables: The kit's executables.
        is_strict: Whether the launch ends, as in ROS, if something cannot run here.
    """

    def __init__(
        self,
        file: Path,
        args: Sequence[str],
        kit_executables: Executables,
        *,
        is_strict: bool = False,
    ) -> None:
        super().__init__(file, args)
        self._kit_executables, self._is_strict = kit_executables, is_strict
        # Missing packages, with the reasons.
        self._absent: dict[str, str] = {}
        # Skipped actions, with the reasons.
        self._skipped: dict[Action | None, str] = {}
        self._settings: dict[str, str] = {}
        self._node_arguments: list[str] = []
        is_for_nodes = False
        for argument in args:
            is_for_nodes = argument == "--ros-args" or (is_for_nodes and argument != "--")
            if ":=" in argument and not is_for_nodes:
                name, _, value = argument.partition(":=")
                self._settings[name] = value
            else:
                self._node_arguments.append(argument)
        self._context = LaunchContext(argv=args)
        self._context.runner, self._context.file = self, str(file.absolute())
        self._processes = Processes()
        self._prefixes = OutputPrefixes(self._on_output)
        self._started: list[tuple[Action, Process]] = []
        # Number of process exits that were reported.
        self._reported_ends = 0
        # Events to handle and timer actions to execute.
        self._due_actions: list[Callable[[], None]] = []
        # Number of pending timers.
        self._pending_timers = 0
        self._is_stopping = False

    def work(self) -> None:
        """Execute the launch description and handle its events until all processes have ended."""
        unload_packages()
        self.log("INFO", "launch", "Default logging verbosity is set to INFO")
        with (
            self._prefixes.prefix_output(),
            packages.tolerate_missing(None if self._is_strict else self._absent),
        ):
            is_over = False
            try:
                self._due_actions.append(self._begin)
                self._run_until_done()
                is_over = True
            finally:
                # An error of the launch file: its processes must not continue without it.
                if not is_over:
                    self._shut_down()
        if self._skipped and not self._started:
            self.exit_code = self.exit_code or 1

    def _begin(self) -> None:
        description = self.describe()
        self._context.launch_configurations |= self._settings
        self._visit(description)
        reasons = " ".join(self._skipped.values())
        for package, reason in self._absent.items():
            # A launch file may look up the folder of a simulator that it then does not start.
            is_of_kit = any(package == owner for owner, _ in self._kit_executables)
            if reason not in reasons and not is_of_kit and not packages.unavailable_reason(package):
                self.log("WARNING", "launch", f"{reason} Nothing of '{package}' is used.")
                self._skipped[None] = reason

    def arguments(self) -> str:
        """Describe the arguments as `ros2 launch --show-args` does."""
        lines = ["Arguments (pass arguments as '<name>:=<value>'):"]
        for argument in find_declarations(self.describe(), self._context):
            lines += ["", f"    '{argument.name}':", f"        {argument.description}"]
            if argument.default_value is not None:
                default = text_of(self._context, argument.default_value)
                self._context.launch_configurations.setdefault(argument.name, default)
                lines.append(f"        (default: {default!r})")
        return "\n".join(lines if len(lines) > 1 else [*lines, "", "    No arguments."])

    def start(
        self,
        action: Action,
        package: str,
        executable: str,
        arguments: Iterable[str],
    ) -> None:
        """Start an executable. Raise a CourseError if there is none."""
        arguments = list(arguments)
        if reason := packages.reason_in(" ".join(arguments)):
            raise packages.NotAvailableError(reason)
        for argument in arguments:
            if match := _OBJECT.search(argument):
                # An f-string with a substitution; ROS passes this string without a warning.
                text = (
                    f"'{argument[:_MAX_SHOWN]}' contains a {match[1]} that has no value yet where "
                    "the string is made. Pass a list of its parts instead of an f-string: "
                    f"['robot_', {match[1]}(…)]"
                )
                self.log("WARNING", "launch", text)
        function = find_executable(package, executable, self._kit_executables)
        self.start_function(action, executable, function, arguments)

    def has_executable(self, package: str, executable: str) -> bool:
        """Return whether the kit itself provides the executable."""
        return (package, executable) in self._kit_executables

    def start_file(self, action: Action, file: Path, arguments: Iterable[str]) -> None:
        """Start a Python program by its path. Raise a CourseError if it cannot be run."""
        self.start_function(action, file.name, Program(file, ()).work, arguments)

    def start_component(
        self,
        action: Action,
        package: str,
        plugin: str,
        arguments: Iterable[str],
    ) -> bool:
        """Start a component, or log why it is skipped. Return whether it was started."""
        try:
            function = find_component(package, plugin, self._kit_executables)
        except CourseError as error:
            self.log("ERROR", "launch_ros.actions.load_composable_nodes", str(error))
            return False
        self.start_function(action, plugin, function, arguments)
        return True

    def start_function(
        self, action: Action, name: str, function: Callable[[], object], arguments: Iterable[str]
    ) -> None:
        """Start a function as a process with command-line arguments."""
        if self._is_stopping:
            return
        pid = len(self._started) + 1
        name = f"{name}-{pid}"
        node_arguments = ["--", *self._node_arguments] if self._node_arguments else []
        process = _LaunchedProcess(name, function, [*arguments, *node_arguments], self._prefixes)
        self._started.append((action, process))
        action.process_details = self._process_details(pid)
        self._processes.start(process)
        self.log("INFO", name, f"process started with pid [{pid}]")
        self.emit(events.ProcessStarted(**action.process_details))

    def _process_details(self, pid: int) -> dict[str, Any]:
        """Return the details of a process as in launch. Here none has its own folder or environment."""
        action, process = self._started[pid - 1]
        command = {"name": process.file.name, "cmd": process.argv, "cwd": None, "env": None}
        return {"action": action, "pid": pid, **command}

    def later(self, seconds: float, entities: Entities) -> None:
        """Visit entities after `seconds` of robot time [s]."""
        if self._is_stopping:
            return
        graph = current_graph()

        def fire() -> None:
            self._pending_timers -= 1
            self._due_actions.append(partial(self._visit, entities))

        self._pending_timers += 1
        graph.call_at(graph.now_ns + round(seconds * 1e9), fire, node=THREADS, entity=0)

    def emit(self, event: Event) -> None:
        """Queue an event for the event handlers. A Shutdown then ends all processes."""
        cause = getattr(self._context.locals, "event", None)
        if (
            isinstance(event, events.Shutdown)
            and isinstance(cause, events.ProcessExited)
            and cause.action in self._skipped
        ):
            # The process has not exited, because it was never started.
            return
        self._due_actions.append(partial(self._handle, event))

    def _handle(self, event: Event) -> None:
        for handler in [handler for handler in self._context.handlers if handler.matches(event)]:
            if handler.handle_once:
                self._context.unregister_event_handler(handler)
            self._context.locals.event = event
            self._visit(handler.handle(event, self._context))
            del self._context.locals.event
        if isinstance(event, events.Shutdown):
            self._shut_down()
        elif isinstance(event, events.ShutdownProcess | events.SignalProcess):
            # A SignalProcess may send a signal that does not end the process.
            number = event.signal_number if isinstance(event, events.SignalProcess) else signal.SIGINT
            if (number if isinstance(number, str) else signal.Signals(number).name) in _ENDS:
                matching = [n for n, (action, _) in enumerate(self._started) if event.process_matcher(action)]
                self._processes.interrupt(matching)

    def _on_output(self, name: str, number: int, text: str) -> None:
        """Emit the output of a process if there is a handler for such events."""
        if any(isinstance(handler, OnProcessIO) for handler in self._context.handlers):
            details = self._process_details(int(name.rpartition("-")[2]))
            kind = events.ProcessStderr if number == 2 else events.ProcessStdout
            self.emit(kind(text=text.encode(), **details))

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line to the log of the launch itself."""
        sys.stdout.write(f"[{level}] [{name}]: {text}\n")

    def describe(self) -> Entities:
        """Return the launch description of the file."""
        prepare_imports(self.file)
        return AnyLaunchDescriptionSource(self.file).get_launch_description(self._context)

    def _visit(self, entities: Entities | None, parent: object = None) -> None:
        for entity in as_entity_list(entities):
            try:
                if not hasattr(entity, "visit"):
                    kind = type(entity).__name__
                    # The class of an object is more informative than its repr.
                    what = repr(entity) if isinstance(entity, str | int | float) else f"a {kind}"
                    raise AttributeError(
                        f"'{kind}' object has no attribute 'visit': expected an action such as "
                        f"Node(…), not {what:.60}"
                    )
                inner = entity.visit(self._context)
            except Exception as error:
                # The reason to continue without the entity; "" if the launch file is wrong.
                if self._is_strict:
                    reason = ""
                elif isinstance(error, packages.NotAvailableError | PackageNotFoundError):
                    reason = str(error)
                elif isinstance(entity, IncludeLaunchDescription) and isinstance(error, ModuleNotFoundError):
                    reason = hint(error) or str(error)
                else:
                    reason = packages.reason_in(str(error))
                if not reason:
                    # The location at which the innermost failing action was created.
                    location = getattr(entity, "_course_location", None) or getattr(
                        parent, "_course_location", None
                    )
                    if location is not None and not hasattr(error, "launch_place"):
                        error.launch_place = location  # type: ignore[attr-defined]
                    raise
                self._skip(cast("Action", entity), reason)
            else:
                self._visit(inner, entity)

    def _skip(self, action: Action, reason: str) -> None:
        """Log that an action is skipped.

        Handlers of its process run as if it had exited successfully.
        """
        text = " ".join(reason.split())
        if reason in self._skipped.values():
            text = f"{re.split('[:.,] ', text, maxsplit=1)[0]} (see above)."
        # The location and the type of the action, as the launch file writes it.
        name = action.origin if isinstance(action, Placeholder) else type(action).__name__
        if action._course_location is not None:
            file, line = action._course_location
            name = f"{Path(file).name}, line {line}: {name}"
        self.log("WARNING", "launch", f"{name} is left out: {text}")
        is_known = action in self._skipped or len(self._skipped) > _MAX_SKIPPED
        self._skipped[action] = reason
        if action.is_asynchronous and not is_known:
            details: Any = {"action": action, "name": "", "cmd": [], "cwd": None, "env": None, "pid": 0}
            self.emit(events.ProcessStarted(**details))
            self.emit(events.ProcessExited(returncode=0, **details))
            self._due_actions.append(partial(self._context.complete, action))

    def _run_until_done(self) -> None:
        """Handle events until all processes and timers have ended.

        An error of the launch file ends them.
        """

        def has_events() -> bool:
            return bool(self._due_actions) or len(self._processes.ended) > self._reported_ends

        while True:
            try:
                while (
                    self._report_ends()
                    or self._due_actions
                    or (self._pending_timers and not current_graph().ended)
                ):
                    time_lock.wait(has_events, until_ns=None, awaited="the processes of the launch")
                    while self._due_actions:
                        self._due_actions.pop(0)()
                return
            except KeyboardInterrupt:
                self.emit(events.Shutdown(reason="ctrl-c (SIGINT)", due_to_sigint=True))
            except DeadlockError:
                self._shut_down()
                self._run_until_done()
                raise
            except ShutDown:
                raise
            except Exception as error:
                if not isinstance(error, _COMPLAINTS) and line_of_traceback(error.__traceback__):
                    # A line of the launch file, which the traceback shows, raised the error.
                    if reason := packages.reason_in(str(error)):
                        error.add_note(f"hint: {reason}")
                    raise
                has_own_text = isinstance(error, (*_COMPLAINTS, TypeError, ValueError))
                text = str(error) if has_own_text else f"{type(error).__name__}: {error}"
                # The launch file itself reads a file of a missing package.
                if isinstance(error, OSError) and (reason := packages.reason_in(text)):
                    text = f"{text}: {reason}"
                location = getattr(error, "launch_place", None)
                # An action that rejects its arguments has no location yet: its line is in the
                # traceback.
                if location is None:
                    line = line_of_traceback(error.__traceback__)
                else:
                    line = format_location(*location)
                if line and line.partition(":")[0] not in text:
                    text = f"{text} ({line})"
                self.log("ERROR", "launch", f"Caught exception in launch (see debug for traceback): {text}")
                self.exit_code = 1
                self._shut_down()

    def _shut_down(self) -> None:
        self._is_stopping, self._pending_timers = True, 0
        self._processes.interrupt()

    def _report_ends(self) -> bool:
        """Report processes that have exited. Return whether others are still running."""
        while self._reported_ends < len(self._processes.ended):
            self._reported_ends += 1
            number = self._processes.ended[self._reported_ends - 1]
            action, process = self._started[number]
            name, pid = process.file.name, number + 1
            code = 0 if self._is_stopping and process.exit_code == INTERRUPTED else process.exit_code
            if code:
                command = " ".join(process.argv)
                self.log("ERROR", name, f"process has died [pid {pid}, exit code {code}, cmd '{command}'].")
            else:
                self.log("INFO", name, f"process has finished cleanly [pid {pid}]")
            self.exit_code = self.exit_code or code
            self.emit(events.ProcessExited(returncode=code, **self._process_details(pid)))
            self._due_actions.append(partial(self._context.complete, action))
        return self._reported_ends < len(self._started)


class _LaunchedProcess(FunctionProcess):
    """A process of a launch, whose output is prefixed with its name."""

    def __init__(
        self,
        name: str,
        function: Callable[[], object],
        args: Sequence[str],
        prefixes: OutputPrefixes,
    ) -> None:
        super().__init__(name, function, args)
        self._prefixes = prefixes

    def run(self) -> None:
        """Run the process to its end. A missing package is an error here."""
        # A placeholder module would hide from the nodes of a launch that a package is missing.
        for name in [name for name, module in sys.modules.items() if isinstance(module, _AbsentModule)]:
            del sys.modules[name]
        with self._prefixes.of_process(self.file.name), packages.tolerate_missing(None):
            super().run()


def prepare_imports(file: Path) -> None:
    """Add the packages of a launch file's workspace to the paths, and prepare its imports."""
    packages.source(file)
    prepend_to_path(packages.python_path(file))
    if AbsentModules not in sys.meta_path:
        sys.meta_path.append(AbsentModules)
    for name in _SET_BY_SETUP:
        os.environ.setdefault(name, "")
    # For launch files that run xacro as a subprocess: its command, and the packages of $(find …).
    packages.prepend_paths("PATH", [Path(sysconfig.get_path("scripts"))])
    packages.prepend_paths("PYTHONPATH", [import_path.STANDIN])


def arguments_of(file: Path) -> str:
    """Describe the arguments that a launch file declares.

    Raise a CourseError for any other file.
    """
    try:
        with packages.tolerate_missing({}):
            return LaunchProgram(file, (), {}).arguments()
    except _COMPLAINTS as error:
        raise CourseError(f"{file}: {error}") from error
