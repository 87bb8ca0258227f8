"""Texts that are made when the launch runs."""

import math
import os
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from launch.launch_context import LaunchContext
from launch.substitution import SomeSubstitutionsType, Substitution, perform_substitutions
from launch.substitution import SubstitutionFailure as SubstitutionFailure


class TextSubstitution(Substitution):
    """A text as it is."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        """Give the text."""
        return self.text


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: SomeSubstitutionsType, *, default: Any = None) -> None:
        self.variable_name = variable_name
        self._default = default

    def perform(self, context: LaunchContext) -> str:
        """Give the value, or the default."""
        name = perform_substitutions(context, self.variable_name)
        value = context.launch_configurations.get(name, self._default)
        if value is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        several = isinstance(value, list | tuple | Substitution)
        return perform_substitutions(context, value) if several else str(value)


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined."""

    def __init__(self, substitutions: Sequence[SomeSubstitutionsType]) -> None:
        self.substitutions = substitutions

    def perform(self, context: LaunchContext) -> str:
        """Give the path."""
        return os.path.join(*(perform_substitutions(context, part) for part in self.substitutions))


class PythonExpression(Substitution):
    """What a Python expression gives; it may use `math`, with or without that name."""

    def __init__(self, expression: SomeSubstitutionsType, python_modules: Sequence[str] = ("math",)) -> None:
        self._expression, self._modules = expression, python_modules

    def perform(self, context: LaunchContext) -> str:
        """Evaluate it."""
        names = {name: __import__(name) for name in self._modules}
        return str(eval(perform_substitutions(context, self._expression), {}, vars(math) | names))


class EnvironmentVariable(Substitution):
    """A variable of the environment."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self._name, self._default = name, default_value

    def perform(self, context: LaunchContext) -> str:
        """Give its value, or the default."""
        name = perform_substitutions(context, self._name)
        if name not in context.environment and self._default is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return context.environment.get(name) or perform_substitutions(context, self._default or "")


class FindExecutable(Substitution):
    """The path of a program on the PATH."""

    def __init__(self, *, name: SomeSubstitutionsType) -> None:
        self._name = name

    def perform(self, context: LaunchContext) -> str:
        """Find it; what the kit provides, and xacro, of which Command says more, are there by name."""
        name = perform_substitutions(context, self._name)
        found = shutil.which(name) or (name if name in ("ros2", "rviz2", "xacro") else None)
        if found is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return found


class Command(Substitution):
    """What a program prints."""

    def __init__(self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail") -> None:
        self._command, self._on_stderr = command, on_stderr

    def perform(self, context: LaunchContext) -> str:
        """Run it; without xacro a URDF that needs none is given as it is."""
        words = shlex.split(perform_substitutions(context, self._command))
        if shutil.which(words[0]) is None:
            return _without_xacro(words)
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SubstitutionFailure(
                f"executed command failed. Command: {shlex.join(words)}\n"
                f"Captured stderr output: {done.stderr}"
            )
        if done.stderr and perform_substitutions(context, self._on_stderr) == "fail":
            raise SubstitutionFailure(
                f"executed command showed stderr output. Command: {shlex.join(words)}\n"
                f"Captured stderr output:\n{done.stderr}"
            )
        return done.stdout


class ThisLaunchFile(Substitution):
    """The path of the launch file that is read."""

    def perform(self, context: LaunchContext) -> str:
        """Give the path."""
        return context.file


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that is read."""

    def perform(self, context: LaunchContext) -> str:
        """Give the folder."""
        return str(Path(context.file).parent)


def _without_xacro(words: Sequence[str]) -> str:
    """Give a plain URDF as xacro would; raises SubstitutionFailure for anything else."""
    if words[0] == "xacro" and len(words) == 2 and Path(words[1]).is_file():
        text = Path(words[1]).read_text(encoding="utf-8")
        if "xmlns:xacro" not in text:
            return text
    if words[0] == "xacro":
        raise SubstitutionFailure(
            f"xacro is not available here, so {shlex.join(words)} gives nothing. Expand the file where ROS "
            "is (xacro robot.urdf.xacro > robot.urdf), and read robot.urdf in the launch file."
        )
    raise SubstitutionFailure(f"file not found: {words[0]}")
