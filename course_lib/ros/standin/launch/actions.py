"""Actions of a launch description. All of them accept a `condition`."""

import asyncio
import os
import shlex
import sys
import time
from collections.abc import Callable, Coroutine, Iterable, Mapping, MutableMapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from ament_index_python.packages import PackageNotFoundError

from course_lib.ros.programs.packages import NotAvailableError, unavailable_reason
from launch.conditions import as_bool
from launch.entities import (
    Action,
    BaseEventHandler,
    DataAction,
    Entities,
    Event,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    Reaction,
    SubstitutionFailure,
    as_entity_list,
    require_entity_list,
    text_of,
)
from launch.entities import SomeSubstitutionsType as Some
from launch.event_handlers import OnProcessExit
from launch.events import ProcessExited
from launch.events import Shutdown as ShutdownEvent
from launch.launch_description_sources import AnyLaunchDescriptionSource, LaunchDescriptionSource

_STATES: Mapping[str, Callable[[LaunchContext], MutableMapping[str, Any]]] = {
    "environment": lambda context: context.environment,
    "launch configurations": lambda context: context.launch_configurations,
}


class DeclareLaunchArgument(Action):
    """Declares an argument, which is set by `name:=value` after the name of the launch file."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Some | None = None,
        description: str | None = None,
        choices: list[str] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(self._declare, **options)
        self.name, self.default_value, self.choices = name, default_value, choices
        if choices is not None and isinstance(default_value, str) and default_value not in choices:
            raise RuntimeError(
                f'Provided default_value "{default_value}" is not in provided choices "{choices}".'
            )
        self.description = description or (f"One of: {choices}" if choices else "no description given")
        if description and choices:
            self.description = f"{description.removesuffix('.')}. Valid choices are: {choices}"

    def _declare(self, context: LaunchContext) -> None:
        """Set the default value if no value is set. Raise RuntimeError with launch's messages."""
        configurations = context.launch_configurations
        if self.name not in configurations:
            if self.default_value is None:
                raise RuntimeError(
                    f'Required launch argument "{self.name}" was not provided. '
                    f"Give it a default_value, or add to the command: {self.name}:=VALUE"
                )
            configurations[self.name] = text_of(context, self.default_value)
        value = configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {self.choices}"
            )


@dataclass(eq=False, repr=False)
class SetLaunchConfiguration(DataAction):
    """Sets a launch configuration."""

    name: Some
    value: Some

    def execute(self, context: LaunchContext) -> None:
        """Set the configuration for all following entities."""
        context.launch_configurations[text_of(context, self.name)] = text_of(context, self.value)


@dataclass(eq=False, repr=False)
class UnsetLaunchConfiguration(DataAction):
    """Removes a launch configuration."""

    name: Some

    def execute(self, context: LaunchContext) -> None:
        """Remove the configuration if it is set."""
        context.launch_configurations.pop(text_of(context, self.name), None)


@dataclass(eq=False, repr=False)
class ResetLaunchConfigurations(DataAction):
    """Removes all launch configurations except the given ones."""

    launch_configurations: Mapping[Any, Some] | None = None

    def execute(self, context: LaunchContext) -> None:
        """Replace the launch configurations by the given ones."""
        pairs = (self.launch_configurations or {}).items()
        kept = {text_of(context, name): text_of(context, value) for name, value in pairs}
        _replace(context.launch_configurations, kept)


@dataclass(eq=False, repr=False)
class SetEnvironmentVariable(DataAction):
    """Sets an environment variable."""

    name: Some
    value: Some

    def execute(self, context: LaunchContext) -> None:
        """Set the variable for all following processes."""
        os.environ[text_of(context, self.name)] = text_of(context, self.value)


@dataclass(eq=False, repr=False)
class UnsetEnvironmentVariable(DataAction):
    """Removes an environment variable."""

    name: Some

    def execute(self, context: LaunchContext) -> None:
        """Remove the variable if it is set."""
        os.environ.pop(text_of(context, self.name), None)


@dataclass(eq=False, repr=False)
class AppendEnvironmentVariable(DataAction):
    """Sets an environment variable or appends to its value; with `prepend`, inserts before it."""

    name: Some
    value: Some
    prepend: bool | Some = False
    separator: Some = os.pathsep

    def execute(self, context: LaunchContext) -> None:
        """Join the value to the variable's value in the environment."""
        key, parts = text_of(context, self.name), [text_of(context, self.value)]
        before = as_bool(context, self.prepend)
        if key in os.environ:
            parts.insert(1 if before else 0, os.environ[key])
        os.environ[key] = text_of(context, self.separator).join(parts)


class ResetEnvironment(Action):
    """Restores the environment that the launch started with."""

    def __init__(self, **options: Any) -> None:
        super().__init__(lambda context: _replace(os.environ, context.environment_at_start), **options)


class _PushOrPop(Action):
    """Pushes a state of the launch onto a stack, or restores the last pushed state."""

    kind = ""
    is_pop = False

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)

    def execute(self, context: LaunchContext) -> None:
        """Push or restore the state."""
        state, stack = _STATES[self.kind](context), context.kept.setdefault(self.kind, [])
        if not self.is_pop:
            stack.append(dict(state))
        elif not stack:
            raise RuntimeError(f"no {self.kind} to bring back: push them before they are popped")
        else:
            _replace(state, stack.pop())


class PushLaunchConfigurations(_PushOrPop):
    """Pushes the launch configurations onto a stack. PopLaunchConfigurations restores them."""

    kind = "launch configurations"


class PopLaunchConfigurations(_PushOrPop):
    """Restores the launch configurations that were pushed last."""

    kind, is_pop = "launch configurations", True


class PushEnvironment(_PushOrPop):
    """Pushes the environment onto a stack. PopEnvironment restores it."""

    kind = "environment"


class PopEnvironment(_PushOrPop):
    """Restores the environment that was pushed last."""

    kind, is_pop = "environment", True


def _replace(state: MutableMapping[str, Any], former: Mapping[str, Any]) -> None:
    state.clear()
    state.update(former)


# Programs that the kit provides, with the packages that they belong to.
_PACKAGES = {"ros2": "ros2cli", "rviz2": "rviz2", "xacro": "xacro"}


def _echo(arguments: Sequence[str]) -> None:
    sys.stdout.write(" ".join(arguments) + "\n")


# Commands that run here, in robot time. They return None, because another value would be the exit
# code.
_COMMANDS: Mapping[str, Callable[[Sequence[str]], None]] = {
    "echo": _echo,
    "sleep": lambda words: time.sleep(float(words[0])),
}
_PYTHON = ("python", "python3")
_PROJECTS = {"gazebo": "gazebo_ros", "gzserver": "gazebo_ros", "gzclient": "gazebo_ros", "gz": "ros_gz_sim"}
_PROJECTS |= {"ign": "ros_gz_sim", "webots": "webots_ros2"}
# Options without an effect here, because all processes of a launch share one environment and
# folder.
NO_DIFFERENCE = {
    *("additional_env", "cached_output", "cwd", "emulate_tty", "env", "exec_name", "log_cmd", "output"),
    *("output_format", "prefix", "respawn", "respawn_delay", "respawn_max_retries", "shell"),
    *("sigkill_timeout", "sigterm_timeout"),
}
# Ignored options on which the behavior of a program may depend.
_MISSED = ("additional_env", "cwd", "env", "respawn")


class Executable:
    """A command line. The other options of launch's Executable have no effect here."""

    def __init__(
        self,
        *,
        cmd: Iterable[Some],
        arguments: Iterable[Some] | None = None,
        **options: Any,
    ) -> None:
        unknown_options("Executable", options, NO_DIFFERENCE | {"name"})
        if isinstance(cmd, str):
            raise TypeError(f"ExecuteProcess: cmd={cmd!r}, expected a list of words: cmd={cmd.split()!r}")
        self.cmd = [*cmd, *(arguments or ())]


class ExecuteLocal(Action):
    """Runs `ros2 …`, `rviz2 …`, `python3 FILE …`, `echo` or `sleep`.

    Other programs would not run in robot time.

    Args:
        process_description: The command line.
        on_exit: Entities to visit when the process exits.
        options: `condition`; other options, such as `output`, have no effect here.
    """

    is_asynchronous = True

    def __init__(
        self,
        *,
        process_description: Executable,
        on_exit: Reaction = None,
        **options: Any,
    ) -> None:
        super().__init__(self._start, condition=options.pop("condition", None))
        unknown_options(type(self).__name__, options, NO_DIFFERENCE)
        self.process_description, self._on_exit, self._options = process_description, on_exit, options

    def _start(self, context: LaunchContext) -> None:
        warn_about_ignored_options(context, self._options)
        react_to_exit(context, self, self._on_exit)
        command_texts = [text_of(context, part) for part in self.process_description.cmd]
        program, *program_arguments = (
            shlex.split(command_texts[0]) if len(command_texts) == 1 else command_texts
        )
        name = Path(program).name
        package = name if name.startswith("rqt_") else _PACKAGES.get(name)
        if name == "ros2" and program_arguments[:1] == ["control"]:
            # Only ros2_control provides this command, which launch files use to start its
            # controllers.
            raise NotAvailableError(f"`ros2 control` cannot run here: {unavailable_reason('ros2_control')}")
        if name == "ros2" and program_arguments[:1] == ["component"]:
            raise NotAvailableError(
                f"`{shlex.join([name, *program_arguments])}` cannot run here: there are no "
                "containers. List the components in composable_node_descriptions of a "
                "ComposableNodeContainer."
            )
        if name == "ros2" and program_arguments[:1] == ["run"] and len(program_arguments) > 2:
            context.runner.start(self, program_arguments[1], program_arguments[2], program_arguments[3:])
        elif package is not None:
            context.runner.start(self, package, name, [*program_arguments, "--ros-args"])
        elif name in _COMMANDS:
            context.runner.start_function(
                self, name, partial(_COMMANDS[name], program_arguments), program_arguments
            )
        # A path in the form of ExecutableInPackage.
        elif Path(program).parts[-3:-2] == ("lib",):
            context.runner.start(self, Path(program).parent.name, name, program_arguments)
        elif name in _PYTHON and program_arguments and not program_arguments[0].startswith("-"):
            context.runner.start_file(self, Path(program_arguments[0]), program_arguments[1:])
        else:
            command = shlex.join([program, *program_arguments])
            if reason := unavailable_reason(_PROJECTS.get(name, name)):
                raise NotAvailableError(f"`{command}` cannot run here: {reason}")
            raise NotAvailableError(
                f"ExecuteProcess is not available here: `{command}` would run outside robot time. "
                "Start nodes with launch_ros.actions.Node; run other commands separately."
            )


class ExecuteProcess(ExecuteLocal):
    """An ExecuteLocal with the command line `cmd`."""

    def __init__(self, *, cmd: Iterable[Some], name: Some | None = None, **options: Any) -> None:
        super().__init__(process_description=Executable(cmd=cmd), **options)


def unknown_options(cls: str, options: Mapping[str, Any], known_names: set[str]) -> None:
    """Raise Python's TypeError for an unknown option."""
    for unknown in sorted(set(options) - known_names):
        raise TypeError(f"{cls}.__init__() got an unexpected keyword argument {unknown!r}")


def warn_about_ignored_options(context: LaunchContext, options: Mapping[str, Any]) -> None:
    """Log a warning about options of a process that have an effect in ROS 2 but not here."""
    missed = []
    for name in _MISSED:
        option = options.get(name)
        if option is None or isinstance(option, bool | Mapping):
            is_set = bool(option)
        else:
            is_set = text_of(context, option).lower() not in ("", "false")
        if is_set:
            missed.append(name)
    if missed:
        text = (
            "no effect here, where the processes of a launch share an environment and a folder, and run once"
        )
        context.runner.log("WARNING", "launch", f"{', '.join(missed)}: {text}")


def react_to_exit(context: LaunchContext, action: Action, on_exit: Reaction) -> None:
    """Register the `on_exit` handler of an action."""
    if on_exit is not None:
        context.register_event_handler(OnProcessExit(target_action=action, on_exit=on_exit))


class OpaqueFunction(Action):
    """Calls a function with the context and visits the entities that it returns."""

    def __init__(
        self,
        *,
        function: Callable[..., Entities | None],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(lambda context: function(context, *(args or ()), **(kwargs or {})), **options)


@dataclass(eq=False, repr=False, kw_only=True)
class OpaqueCoroutine(DataAction):
    """Runs a coroutine concurrently with the processes.

    It receives the context unless `ignore_context`.
    """

    is_asynchronous = True
    coroutine: Callable[..., Coroutine[Any, Any, None]]
    args: Iterable[Any] | None = None
    kwargs: Mapping[str, Any] | None = None
    ignore_context: bool = False

    def execute(self, context: LaunchContext) -> None:
        """Start the coroutine in an event loop of its own."""
        first = () if self.ignore_context else (context,)
        start = partial(self.coroutine, *first, *(self.args or ()), **(self.kwargs or {}))
        context.runner.start_function(self, "coroutine", lambda: asyncio.run(start()), ())


class GroupAction(Action):
    """A group of actions.

    If it is scoped, its settings, namespaces and variables end with the group.
    """

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Some] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(self._open, **options)
        self.actions = require_entity_list("GroupAction", actions)
        self._own = dict(launch_configurations or {})
        self._scoped, self._forwarding = scoped, forwarding

    def _open(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        own_settings = [SetLaunchConfiguration(*pair) for pair in self._own.items()]
        if not self._scoped:
            return [*own_settings, *self.actions]
        only_own = [ResetEnvironment(), ResetLaunchConfigurations(self._own)]
        return [
            *(PushLaunchConfigurations(), PushEnvironment()),
            *(own_settings if self._forwarding else only_own),
            *self.actions,
            *(PopEnvironment(), PopLaunchConfigurations()),
        ]


class IncludeLaunchDescription(Action):
    """Includes another launch file.

    As in ROS, its arguments stay set unless a group is around it.
    """

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | Some,
        *,
        launch_arguments: Iterable[tuple[Some, Some]] | None = None,
        **options: Any,
    ) -> None:
        source = launch_description_source
        if not isinstance(source, LaunchDescriptionSource):
            source = AnyLaunchDescriptionSource(source)
        self.source = source
        if isinstance(launch_arguments, Mapping):
            raise TypeError(
                f"IncludeLaunchDescription: launch_arguments={launch_arguments!r}, expected pairs: "
                f"launch_arguments={launch_arguments!r}.items()"
            )
        arguments = [SetLaunchConfiguration(*pair) for pair in launch_arguments or ()]

        def do(context: LaunchContext) -> list[LaunchDescriptionEntity]:
            outer, file = context.file, source.expand_location(context)
            if not Path(file).exists() and Path(f"{file}.in").is_file():
                raise NotAvailableError(
                    f"{file} is made from {Path(file).name}.in when its package is built by CMake."
                )
            description = source.get_launch_description(context)
            context.file = file
            leave = Action(lambda context: setattr(context, "file", outer))
            return [*arguments, description, leave]

        super().__init__(do, **options)


class TimerAction(Action):
    """Visits actions after a period of robot time.

    `cancel_on_shutdown` has no effect here: a shutdown of the launch always cancels the timer.
    """

    is_asynchronous = True

    def __init__(
        self,
        *,
        period: float | Some,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: bool | Some = True,
        **options: Any,
    ) -> None:
        super().__init__(self._begin, **options)
        self.period, self.actions = period, require_entity_list("TimerAction", actions)
        self._is_canceled = False

    def cancel(self) -> None:
        """Cancel the timer, so that its actions are not visited."""
        self._is_canceled = True

    def _begin(self, context: LaunchContext) -> None:
        period = self.period
        seconds = float(period if isinstance(period, int | float) else text_of(context, period))
        context.runner.later(seconds, Action(self._end))

    def _end(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        context.complete(self)
        return [] if self._is_canceled else self.actions


class LogInfo(Action):
    """Writes a line to the log of the launch."""

    def __init__(self, *, msg: Some, **options: Any) -> None:
        super().__init__(
            lambda context: context.runner.log("INFO", "launch.user", text_of(context, msg)), **options
        )


class RegisterEventHandler(Action):
    """Registers an event handler. As in ROS, the newest handler is called first."""

    def __init__(self, event_handler: BaseEventHandler, **options: Any) -> None:
        super().__init__(lambda context: context.register_event_handler(event_handler), **options)
        self.event_handler = event_handler


class UnregisterEventHandler(Action):
    """Removes an event handler. Raises ValueError if it was not registered."""

    def __init__(self, event_handler: BaseEventHandler, **options: Any) -> None:
        super().__init__(lambda context: context.unregister_event_handler(event_handler), **options)


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Event, **options: Any) -> None:
        super().__init__(lambda context: context.runner.emit(event), **options)


@dataclass(eq=False, repr=False, kw_only=True)
class Shutdown(DataAction):
    """Shuts the launch down. A Node accepts it as `on_exit`."""

    reason: Some = "reason not given"

    def execute(self, context: LaunchContext) -> None:
        """Emit the event of a shutdown."""
        event = getattr(context.locals, "event", None)
        if isinstance(event, ProcessExited) and event.pid:
            text = f"process[{event.process_name}] was required: shutting down launched system"
            context.runner.log("INFO", "launch", text)
        context.runner.emit(ShutdownEvent(reason=text_of(context, self.reason)))


def find_declarations(entities: Entities, context: LaunchContext) -> list[DeclareLaunchArgument]:
    """List the arguments that entities declare, including groups, timers and included files.

    As in ROS, an included file whose path is unknown before the launch is left out.
    """
    declarations: list[DeclareLaunchArgument] = []
    for entity in as_entity_list(entities):
        if isinstance(entity, DeclareLaunchArgument):
            declarations.append(entity)
        elif isinstance(entity, LaunchDescription):
            declarations += find_declarations(entity.entities, context)
        elif isinstance(entity, GroupAction | TimerAction):
            declarations += find_declarations(entity.actions, context)
        elif isinstance(entity, IncludeLaunchDescription):
            with suppress(SubstitutionFailure, PackageNotFoundError):
                declarations += find_declarations(entity.source.get_launch_description(context), context)
    return declarations
