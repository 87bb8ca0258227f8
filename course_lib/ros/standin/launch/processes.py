"""Actions that start a program by its command line."""

import shlex
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from course_lib.ros.not_offered import not_offered
from launch.entities import Action, LaunchContext, Reaction, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.event_handlers import OnProcessExit

_PACKAGES = {"ros2": "ros2cli", "rviz2": "rviz2", "xacro": "xacro"}  # the kit has these


def _echo(words: Sequence[str]) -> None:
    sys.stdout.write(" ".join(words) + "\n")


def _sleep(words: Sequence[str]) -> None:
    """Sleep on robot time."""
    time.sleep(float(words[0]))


_COMMANDS: Mapping[str, Callable[[Sequence[str]], None]] = {"echo": _echo, "sleep": _sleep}
_PYTHON = ("python", "python3")
_PROJECTS = {"gazebo": "gazebo_ros", "gzserver": "gazebo_ros", "gzclient": "gazebo_ros", "gz": "ros_gz_sim"}
_PROJECTS |= {"ign": "ros_gz_sim", "webots": "webots_ros2"}
NO_DIFFERENCE = {  # options of processes; all processes of a launch share one environment and folder here
    *("additional_env", "cached_output", "cwd", "emulate_tty", "env", "exec_name", "log_cmd", "output"),
    *("output_format", "prefix", "respawn", "respawn_delay", "respawn_max_retries", "shell"),
    *("sigkill_timeout", "sigterm_timeout"),
}
_MISSED = ("additional_env", "cwd", "env", "respawn")  # of them; what a program does may rest on these


class Executable:
    """A command line; the other options of launch's own class make no difference here."""

    def __init__(self, *, cmd: Iterable[Some], arguments: Iterable[Some] = (), **options: Any) -> None:
        unknown_options("Executable", options, NO_DIFFERENCE | {"name"})
        self.cmd = [*cmd, *arguments]


class ExecuteLocal(Action):
    """Runs `ros2 …`, `rviz2 …`, `python3 FILE …`, `echo` or `sleep`; others would not be on robot time.

    Args:
        process_description: The command line.
        on_exit: A reaction to its end.
        options: `condition`; `output` and others make no difference here.
    """

    goes_on = True

    def __init__(self, *, process_description: Executable, on_exit: Reaction = None, **options: Any) -> None:
        super().__init__(self._start, condition=options.pop("condition", None))
        unknown_options(type(self).__name__, options, NO_DIFFERENCE)
        self.process_description, self._on_exit, self._options = process_description, on_exit, options

    def _start(self, context: LaunchContext) -> None:
        tell_missed(context, self._options)
        react_to_exit(context, self, self._on_exit)
        words = [text_of(context, part) for part in self.process_description.cmd]
        program, *rest = shlex.split(words[0]) if len(words) == 1 else words
        name = Path(program).name
        package = name if name.startswith("rqt_") else _PACKAGES.get(name)
        if name == "ros2" and rest[:1] == ["run"] and len(rest) > 2:
            context.runner.start(self, rest[1], rest[2], rest[3:])
        elif package is not None:
            context.runner.start(self, package, name, [*rest, "--ros-args"])
        elif name in _COMMANDS:
            context.runner.start_function(self, name, partial(_COMMANDS[name], rest), rest)
        elif Path(program).parts[-3:-2] == ("lib",):  # as ExecutableInPackage has it
            context.runner.start(self, Path(program).parent.name, name, rest)
        elif name in _PYTHON and rest and not rest[0].startswith("-"):
            context.runner.start_file(self, Path(rest[0]), rest[1:])
        else:
            raise RuntimeError(_refusal(name, shlex.join([program, *rest])))


class ExecuteProcess(ExecuteLocal):
    """An ExecuteLocal of the command line `cmd`."""

    def __init__(self, *, cmd: Iterable[Some], name: Some | None = None, **options: Any) -> None:
        super().__init__(process_description=Executable(cmd=cmd), **options)


def unknown_options(cls: str, options: Mapping[str, Any], known: set[str]) -> None:
    """Raise Python's TypeError for an option that is not known."""
    for unknown in sorted(set(options) - known):
        raise TypeError(f"{cls}.__init__() got an unexpected keyword argument {unknown!r}")


def tell_missed(context: LaunchContext, options: Mapping[str, Any]) -> None:
    """Log the options of a process that have an effect in ROS 2 and none here."""
    missed = [name for name in _MISSED if _is_set(context, options.get(name))]
    if missed:
        text = (
            "no effect here, where the processes of a launch share an environment and a folder, and run once"
        )
        context.runner.log("WARNING", "launch", f"{', '.join(missed)}: {text}")


def _is_set(context: LaunchContext, option: Any) -> bool:
    if option is None or isinstance(option, bool | Mapping):
        return bool(option)
    return text_of(context, option).lower() not in ("", "false")


def react_to_exit(context: LaunchContext, action: Action, on_exit: Reaction) -> None:
    """Register an action's `on_exit`."""
    if on_exit is not None:
        context.register_event_handler(OnProcessExit(target_action=action, on_exit=on_exit))


def _refusal(name: str, command: str) -> str:
    reason = not_offered(_PROJECTS.get(name, name))
    if reason:
        return f"`{command}` cannot run here: {reason}"
    return (
        f"ExecuteProcess is not available here: `{command}` would run outside robot time. Start nodes with "
        "launch_ros.actions.Node; run other commands beside the launch."
    )
