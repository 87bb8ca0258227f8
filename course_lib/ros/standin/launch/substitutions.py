"""Substitutions: strings that are computed while the launch runs."""

import math
import os
import random
import re
import shlex
import shutil
import socket
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

from course_lib.ros.programs.xacro_program import ProgramResult, run_xacro
from course_lib.third_party import read_text
from launch.conditions import as_bool
from launch.entities import LaunchContext, Substitution, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.entities import SubstitutionFailure as SubstitutionFailure
from launch.logging import get_logger

# Share folders are source folders here, whose names have spaces more often than installed ones.
_SPLIT_PATH = (
    "\nhint: a command is split at its spaces, on a robot as well, and a folder in this path has one in its "
    "name. Rename the folder, or write quotes around the path: Command(['xacro ', '\"', path, '\"'])"
)
_ON_STDERR = ("fail", "ignore", "warn", "capture")
# Programs of the kit, which are available although they are not on the PATH.
_PROVIDED = ("ros2", "rviz2", "xacro")


class TextSubstitution(Substitution):
    """A literal string."""

    def __init__(self, *, text: str) -> None:
        super().__init__(lambda context: text)
        self.text = text


@dataclass(eq=False, repr=False)
class LaunchConfiguration(Substitution):
    """The value of a launch configuration, or a default."""

    variable_name: Some
    _: KW_ONLY
    default: Any = None

    def perform(self, context: LaunchContext) -> str:
        """Return the value of the configuration, or the default."""
        name = text_of(context, self.variable_name)
        value = context.launch_configurations.get(name, self.default)
        if value is None:
            raise SubstitutionFailure(
                f"launch configuration '{name}' does not exist: is there a"
                f" DeclareLaunchArgument('{name}') before this line?"
            )
        return text_of(context, value if isinstance(value, list | tuple | Substitution) else str(value))


class PathJoinSubstitution(Substitution):
    """A path joined from parts."""

    def __init__(self, substitutions: Sequence[Some]) -> None:
        super().__init__(lambda context: os.path.join(*(text_of(context, part) for part in substitutions)))


class PathSubstitution(PathJoinSubstitution):
    """A path that `/` extends: `PathSubstitution(FindPackageShare("arm")) / "urdf" / "arm.urdf"`."""

    def __init__(self, path: Some | Sequence[Some]) -> None:
        single = isinstance(path, str | Path | Substitution)
        self._parts: list[Any] = [path] if single else list(path)  # type: ignore[arg-type]  # not a single one
        super().__init__(self._parts)

    def __truediv__(self, part: Some) -> "PathSubstitution":
        """Return the path extended by one part."""
        return PathSubstitution([*self._parts, part])


@dataclass(eq=False, repr=False)
class PythonExpression(Substitution):
    """The value of a Python expression.

    The names of `math` can be used with and without their module.
    """

    expression: Some
    python_modules: Sequence[str] = ("math",)

    def perform(self, context: LaunchContext) -> str:
        """Evaluate the expression."""
        text = text_of(context, self.expression)
        names = vars(math) | {name: __import__(name) for name in self.python_modules}
        try:
            return str(eval(text, {}, names))
        except Exception as error:
            # The error has no line of a file, so that the line of the action is reported.
            raise SubstitutionFailure(f"{type(error).__name__}: {error}, in `{text}`") from None


@dataclass(eq=False, repr=False)
class EnvironmentVariable(Substitution):
    """The value of an environment variable, or a default."""

    name: Some
    _: KW_ONLY
    default_value: Some | None = None

    def perform(self, context: LaunchContext) -> str:
        """Return the value of the variable, or the default."""
        key = text_of(context, self.name)
        if key not in os.environ and self.default_value is None:
            raise SubstitutionFailure(f"environment variable '{key}' does not exist")
        return os.environ[key] if key in os.environ else text_of(context, self.default_value or "")


@dataclass(eq=False, repr=False)
class FindExecutable(Substitution):
    """The path of a program on the PATH."""

    _: KW_ONLY
    name: Some

    def perform(self, context: LaunchContext) -> str:
        """Return the path of the program."""
        program = text_of(context, self.name)
        location = shutil.which(program) or (program if program in _PROVIDED else None)
        if location is None:
            raise SubstitutionFailure(f"executable '{program}' not found on the PATH")
        return location


@dataclass(eq=False, repr=False)
class Command(Substitution):
    """The output of a program. xacro runs in this process, where it finds the kit's packages."""

    command: Some
    _: KW_ONLY
    on_stderr: Some = "fail"

    def perform(self, context: LaunchContext) -> str:
        """Run the program and return its output."""
        arguments, on_stderr_text = (
            shlex.split(text_of(context, self.command)),
            text_of(context, self.on_stderr),
        )
        if on_stderr_text not in _ON_STDERR:
            raise SubstitutionFailure(
                "expected 'on_stderr' to be one of: 'fail', 'ignore', 'warn' or 'capture'"
            )
        result = _run_command(arguments)
        outcome = "failed" if result.code else "showed stderr output"
        text = f"executed command {outcome}. Command: {shlex.join(arguments)}"
        text += f"\nCaptured stderr output: {result.errors}"
        if "expected exactly one input file" in result.errors and len(arguments) > 2:
            text += _SPLIT_PATH
        if result.code or (result.errors and on_stderr_text == "fail"):
            raise SubstitutionFailure(text)
        if result.errors and on_stderr_text == "warn":
            get_logger().warning(text)
        return result.output + (result.errors if on_stderr_text == "capture" else "")


@dataclass(eq=False, repr=False)
class FileContent(Substitution):
    """The content of a text file."""

    path: Some

    def perform(self, context: LaunchContext) -> str:
        """Read the file."""
        file = Path(text_of(context, self.path))
        if not file.is_file():
            raise SubstitutionFailure(f"File not found: {file}")
        return read_text(file)


@dataclass(eq=False, repr=False)
class AnonName(Substitution):
    """A unique name. Within a launch it is the same for equal values of `name`."""

    name: Some

    def perform(self, context: LaunchContext) -> str:
        """Return the name, which is created when it is used first."""
        base = text_of(context, self.name)
        raw_name = f"{base}_{socket.gethostname()}_{os.getpid()}_{random.randint(0, sys.maxsize)}"
        unique = re.sub("[.:-]", "_", raw_name)
        return str(context.launch_configurations.setdefault(f"anon{base}", unique))


class LaunchLogDir(Substitution):
    """The log folder: $ROS_LOG_DIR, or .ros/log in the home folder."""

    def __init__(self) -> None:
        super().__init__(lambda context: os.environ.get("ROS_LOG_DIR") or os.path.expanduser("~/.ros/log"))


class LocalSubstitution(Substitution):
    """An attribute of the context's `locals`, such as `event.returncode` in an event handler."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        super().__init__(lambda context: str(attrgetter(expression)(context.locals)))


class ThisLaunchFile(Substitution):
    """The path of the current launch file."""

    def __init__(self) -> None:
        super().__init__(lambda context: context.file)


class ThisLaunchFileDir(Substitution):
    """The folder of the current launch file."""

    def __init__(self) -> None:
        super().__init__(lambda context: str(Path(context.file).parent))


def _run_command(arguments: Sequence[str]) -> ProgramResult:
    if Path(arguments[0]).name == "xacro":
        return run_xacro(arguments[1:])
    if Path(arguments[0]).name == "ros2" and arguments[1:2] in (["pkg"], ["interface"]):
        # These commands need no nodes, so they can run in a separate process.
        arguments = [sys.executable, "-P", "-m", "course_lib", "ros2", *arguments[1:]]
    elif Path(arguments[0]).name == "ros2":
        raise SubstitutionFailure(
            f"`{shlex.join(arguments)}` cannot run here while the launch file is read. Write its "
            "output into the "
            "file, or run it with ExecuteProcess"
        )
    if shutil.which(arguments[0]) is None:
        is_joined = arguments[0].startswith("xacro/")
        space = ". A space is missing after xacro: Command(['xacro ', path])" if is_joined else ""
        raise SubstitutionFailure(f"file not found: {arguments[0]}{space}")
    process = subprocess.run(arguments, capture_output=True, text=True, check=False)
    return ProgramResult(process.stdout, process.stderr, process.returncode)


_TRUE, _FALSE = ("true", "1"), ("false", "0")


class NotSubstitution(Substitution):
    """The negation of a boolean."""

    def __init__(self, value: Some) -> None:
        super().__init__(lambda context: _word(not as_bool(context, value)))


class AnySubstitution(Substitution):
    """True if at least one argument is true."""

    def __init__(self, *args: Some) -> None:
        super().__init__(lambda context: _word(any(as_bool(context, value) for value in args)))


class AllSubstitution(Substitution):
    """True if all arguments are true."""

    def __init__(self, *args: Some) -> None:
        super().__init__(lambda context: _word(all(as_bool(context, value) for value in args)))


class AndSubstitution(AllSubstitution):
    """True if both arguments are true."""

    def __init__(self, left: Some, right: Some) -> None:
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """True if one of two arguments is true."""

    def __init__(self, left: Some, right: Some) -> None:
        super().__init__(left, right)


class EqualsSubstitution(Substitution):
    """True if two strings are equal, the same boolean, or nearly equal numbers."""

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(lambda context: _word(_are_equal(context, left, right)))


class NotEqualsSubstitution(Substitution):
    """True if EqualsSubstitution is false."""

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(lambda context: _word(not _are_equal(context, left, right)))


class IfElseSubstitution(Substitution):
    """One of two strings, selected by a condition."""

    def __init__(self, condition: Some, if_value: Some = "", else_value: Some = "") -> None:
        super().__init__(
            lambda context: text_of(context, if_value if as_bool(context, condition) else else_value)
        )


def _word(truth: bool) -> str:
    return "true" if truth else "false"


def _are_equal(context: LaunchContext, left: Any, right: Any) -> bool:
    first, second = _text(context, left), _text(context, right)
    lower = first.lower(), second.lower()
    if all(text in (*_TRUE, *_FALSE) for text in lower):
        return (lower[0] in _TRUE) == (lower[1] in _TRUE)
    try:
        return math.isclose(float(first), float(second))
    except ValueError:
        return first == second


def _text(context: LaunchContext, value: Any) -> str:
    """Convert a value to a string. Values that are not substitutions are formatted as in launch."""
    is_list = isinstance(value, list | tuple) and any(isinstance(part, Substitution) for part in value)
    if is_list or isinstance(value, Substitution):
        return text_of(context, value)
    return "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
