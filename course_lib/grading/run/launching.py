"""The student's side of a launch task: run the file like `ros2 launch`, and record its nodes.

A check must not rely on the source of a launch file: without an import the source looks right, but
`ros2 launch` fails. Therefore the file runs on the graph of the scenario, and its nodes publish
there. Whether an option of a node is taken from a launch argument shows only if the argument has
another value. So the file is evaluated once more for each argument, with another value and without
starting anything.
"""

import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from launch.actions import DeclareLaunchArgument, find_declarations
from launch.entities import Action, Entities, text_of

from course_lib.grading.evidence import LaunchRecord, OtherValue, StartedNode
from course_lib.grading.run.outcome import MAX_LENGTH, describe
from course_lib.ros.programs.launch_program import LaunchProgram
from course_lib.ros.programs.package_programs import Executables, find_executable
from course_lib.tools.executables import run_with_rclpy, spin
from course_lib.tools.ros2 import EXECUTABLES

FILE_NAME = "your.launch"  # without the suffix, which depends on the file's language
MAX_STARTED = 100  # limit on started nodes
MAX_ARGUMENTS = 20
OPPOSITES = {"true": "false", "false": "true", "True": "False", "False": "True"}
# A check needs no windows, and a launch file may refer to a layout that does not exist yet.
WITHOUT_WINDOWS: Executables = {**EXECUTABLES, ("rviz2", "rviz2"): lambda: run_with_rclpy(spin)}


class RecordedLaunch(LaunchProgram):
    """A launch that records the nodes it starts and the errors it logs.

    Args:
        file: The launch file.
        args: Launch arguments, `name:=value`.
        starts: Whether nodes are started; otherwise nothing runs and timers expire immediately.
    """

    def __init__(self, file: Path, args: Iterable[str] = (), *, starts: bool = True) -> None:
        super().__init__(file, list(args), WITHOUT_WINDOWS, is_strict=True)
        self.nodes: list[StartedNode] = []
        self.errors: list[str] = []  # errors of the launch itself
        self._process_errors: dict[str, str] = {}  # error messages by process
        self._processes_of_nodes: dict[str, int] = {}
        self._starts_nodes = starts

    def start(
        self,
        action: Action,
        package: str,
        executable: str,
        arguments: Iterable[str],
    ) -> None:
        """Record the node and start it."""
        arguments = list(arguments)
        if len(self.nodes) < MAX_STARTED:
            self.nodes.append(StartedNode(package, executable, tuple(arguments)))
        if self._starts_nodes:
            before = len(self._started)
            super().start(action, package, executable, arguments)
            for _, process in self._started[before:]:
                self._processes_of_nodes[process.file.name] = len(self.nodes) - 1
        else:
            find_executable(package, executable, WITHOUT_WINDOWS)

    def start_function(
        self, action: Action, name: str, function: Callable[[], object], words: Iterable[str]
    ) -> None:
        """Start a process if this launch starts nodes."""
        if self._starts_nodes:
            super().start_function(action, name, function, words)

    def later(self, seconds: float, entities: Entities) -> None:
        """Visit entities after a delay, or immediately if this launch starts no nodes."""
        if self._starts_nodes:
            super().later(seconds, entities)
        else:
            self._visit(entities)

    def log(self, level: str, name: str, text: str) -> None:
        """Write a log line, and record the errors of the launch and of failed processes."""
        if level == "ERROR" and name in self._processes_of_nodes:
            self._process_errors[name] = f"[{name}]: {text}"
        elif level == "ERROR":
            self.errors.append(text)
        if self._starts_nodes:
            super().log(level, name, text)

    def declared_arguments(self) -> Iterator[tuple[DeclareLaunchArgument, str | None]]:
        """Yield the declared launch arguments with their defaults."""
        for argument in find_declarations(self.describe(), self._context)[:MAX_ARGUMENTS]:
            default = None
            if argument.default_value is not None:
                default = text_of(self._context, argument.default_value)
                # The defaults of later arguments may refer to it.
                self._context.launch_configurations.setdefault(argument.name, default)
            yield argument, default

    def run_to_end(self) -> str:
        """Run the launch to its end and return its first error, or ""."""
        try:
            self.work()
        except Exception as error:
            # The launch file is student code and may raise any exception.
            self.errors.insert(0, describe(error))
            # The interrupted processes must not outlive this run.
            self._processes.wait()
        for process, message in self._process_errors.items():
            number = self._processes_of_nodes[process]
            self.nodes[number] = replace(self.nodes[number], death=message[:MAX_LENGTH])
        return self.errors[0][:MAX_LENGTH] if self.errors else ""


def launch(text: Any) -> LaunchRecord:
    """Run the text of a launch file on the current graph until the scenario ends, and return its record."""
    with tempfile.TemporaryDirectory(prefix="launch_") as folder, _restore_process():
        # launch chooses the language of a launch file by its suffix.
        begin = text.lstrip()
        is_yaml = begin.startswith(("launch:", "---", "%YAML"))
        file = Path(folder, FILE_NAME + (".xml" if begin[:1] == "<" else ".yaml" if is_yaml else ".py"))
        file.write_text(text, encoding="utf-8")
        try:
            arguments = list(RecordedLaunch(file, starts=False).declared_arguments())
        except Exception as error:
            # The launch file is student code and may raise any exception.
            return LaunchRecord(error=_strip_folder(folder, describe(error)))
        other_values = []
        for argument, default in arguments:
            value = _other_value(default, [str(choice) for choice in argument.choices or ()])
            other_run = RecordedLaunch(file, [f"{argument.name}:={value}"], starts=False)
            other_run.run_to_end()
            other_values.append(OtherValue(argument.name, value, tuple(other_run.nodes)))
        run = RecordedLaunch(file)
        output = _strip_folder(folder, run.run_to_end())
        defaults = {argument.name: default for argument, default in arguments}
        return LaunchRecord(defaults, tuple(run.nodes), tuple(other_values), output)


@contextmanager
def _restore_process() -> Iterator[None]:
    """Undo the changes that launch files make in this process, which may be a student's kernel."""
    argv, path, main, environment = sys.argv, sys.path[:], sys.modules["__main__"], dict(os.environ)
    try:
        yield
    finally:
        sys.argv, sys.path[:], sys.modules["__main__"] = argv, path, main
        os.environ.clear()
        os.environ.update(environment)


def _strip_folder(folder: str, text: str) -> str:
    """Remove the names of this folder and the current one, which differ from run to run, from a string."""
    return text.replace(f"{folder}{os.sep}", "").replace(os.getcwd(), ".")


def _other_value(default: str | None, choices: list[str]) -> str:
    """Return a value that differs from the default, but has the same type."""
    if choices:
        return next((choice for choice in choices if choice != default), choices[0])
    if default in OPPOSITES:
        return OPPOSITES[default]
    try:
        return f"{float(default or '') + 1:g}"
    except ValueError:
        return f"another_{default or 'value'}"
