"""Substitutions: texts that are made when the launch runs."""

import math
import os
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from course_lib.ros.xacro_program import Finished, run_xacro
from launch.entities import LaunchContext, Substitution, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.entities import SubstitutionFailure as SubstitutionFailure

_PROVIDED = ("ros2", "rviz2", "xacro")  # by the kit, though not on the PATH


class TextSubstitution(Substitution):
    """A text as it is."""

    def __init__(self, *, text: str) -> None:
        super().__init__(lambda context: text)


class LaunchConfiguration(Substitution):
    """The value of a launch argument, or a default."""

    def __init__(self, variable_name: Some, *, default: Any = None) -> None:
        def make(context: LaunchContext) -> str:
            name = text_of(context, variable_name)
            value = context.launch_configurations.get(name, default)
            if value is None:
                raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
            return text_of(context, value if isinstance(value, list | tuple | Substitution) else str(value))

        super().__init__(make)


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined."""

    def __init__(self, substitutions: Sequence[Some]) -> None:
        super().__init__(lambda context: os.path.join(*(text_of(context, part) for part in substitutions)))


class PythonExpression(Substitution):
    """The value of a Python expression, which may use `math`, with or without that name."""

    def __init__(self, expression: Some, python_modules: Sequence[str] = ("math",)) -> None:
        names = vars(math) | {name: __import__(name) for name in python_modules}
        super().__init__(lambda context: str(eval(text_of(context, expression), {}, names)))


class EnvironmentVariable(Substitution):
    """A variable of the environment, or a default."""

    def __init__(self, name: Some, *, default_value: Some | None = None) -> None:
        def make(context: LaunchContext) -> str:
            key = text_of(context, name)
            if key not in os.environ and default_value is None:
                raise SubstitutionFailure(f"environment variable '{key}' does not exist")
            return os.environ.get(key) or text_of(context, default_value or "")

        super().__init__(make)


class FindExecutable(Substitution):
    """The path of a program on the PATH."""

    def __init__(self, *, name: Some) -> None:
        def make(context: LaunchContext) -> str:
            program = text_of(context, name)
            found = shutil.which(program) or (program if program in _PROVIDED else None)
            if found is None:
                raise SubstitutionFailure(f"executable '{program}' not found on the PATH")
            return found

        super().__init__(make)


class Command(Substitution):
    """The output of a program; xacro runs in this process, whose packages it then finds."""

    def __init__(self, command: Some, *, on_stderr: Some = "fail") -> None:
        def make(context: LaunchContext) -> str:
            words = shlex.split(text_of(context, command))
            done = _finished(words)
            if done.code or (done.errors and text_of(context, on_stderr) == "fail"):
                what = "failed" if done.code else "showed stderr output"
                raise SubstitutionFailure(
                    f"executed command {what}. Command: {shlex.join(words)}\n"
                    f"Captured stderr output: {done.errors}"
                )
            return done.output

        super().__init__(make)


class ThisLaunchFile(Substitution):
    """The path of the launch file that is read."""

    def __init__(self) -> None:
        super().__init__(lambda context: context.file)


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that is read."""

    def __init__(self) -> None:
        super().__init__(lambda context: str(Path(context.file).parent))


def _finished(words: Sequence[str]) -> Finished:
    if Path(words[0]).name == "xacro":
        return run_xacro(words[1:])
    if shutil.which(words[0]) is None:
        raise SubstitutionFailure(f"file not found: {words[0]}")
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return Finished(done.stdout, done.stderr, done.returncode)
