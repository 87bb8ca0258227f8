"""What a launch can do with nodes."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from launch.action import Action
from launch.conditions import Condition
from launch.event_handlers import OnProcessExit, Reaction
from launch.launch_context import LaunchContext
from launch.substitution import SomeSubstitutionsType, perform_substitutions

from launch_ros.parameter_descriptions import words_for

_NAMESPACE, _PARAMETERS, _REMAPS = "ros_namespace", "global_params", "ros_remaps"  # launch configurations
_NO_DIFFERENCE = {
    *(
        "additional_env",
        "cwd",
        "emulate_tty",
        "env",
        "exec_name",
        "log_cmd",
        "output",
        "output_format",
        "prefix",
    ),
    *("respawn", "respawn_delay", "respawn_max_retries", "shell", "sigkill_timeout", "sigterm_timeout"),
}


class Node(Action):
    """Starts an executable of a package, with what its nodes are to know.

    Args:
        package: The executable's package.
        executable: Its name, as in setup.py's console_scripts.
        name: Takes the place of its nodes' own name.
        namespace: Of its nodes, inside the namespaces of PushRosNamespace.
        parameters: Dictionaries, and YAML files; later ones count more.
        remappings: Pairs of names (from, to).
        arguments: Words for the program itself.
        ros_arguments: More words behind --ros-args.
        on_exit: What is done when it has ended.
        options: `output` and others of ExecuteProcess, which make no difference here.
    """

    def __init__(
        self,
        *,
        executable: SomeSubstitutionsType,
        package: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: Iterable[Any] = (),
        remappings: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] = (),
        arguments: Iterable[SomeSubstitutionsType] = (),
        ros_arguments: Iterable[SomeSubstitutionsType] = (),
        on_exit: Reaction = None,
        condition: Condition | None = None,
        **options: Any,
    ) -> None:
        super().__init__(condition=condition)
        if isinstance(parameters, Mapping | str):
            raise TypeError(f"Node: parameters={parameters!r}, expected a list: parameters=[{parameters!r}]")
        unknown = sorted(set(options) - _NO_DIFFERENCE)
        if unknown:
            raise TypeError(f"Node.__init__() got an unexpected keyword argument {unknown[0]!r}")
        self._package, self._executable, self._name, self._namespace = package, executable, name, namespace
        self._parameters, self._remappings = list(parameters or ()), list(remappings or ())
        self._arguments, self._ros_arguments = list(arguments or ()), list(ros_arguments or ())
        self._on_exit = on_exit

    def execute(self, context: LaunchContext) -> None:
        """Start it."""
        package, executable = (
            perform_substitutions(context, text) for text in (self._package, self._executable)
        )
        if self._on_exit is not None:
            context.handlers.insert(0, OnProcessExit(target_action=self, on_exit=self._on_exit))
        arguments = [perform_substitutions(context, word) for word in self._arguments]
        context.runner.start(self, package, executable, [*arguments, "--ros-args", *self._for_ros(context)])

    def _for_ros(self, context: LaunchContext) -> Iterator[str]:
        yield from (perform_substitutions(context, word) for word in self._ros_arguments)
        if self._name is not None:
            yield from ("-r", f"__node:={perform_substitutions(context, self._name)}")
        own = perform_substitutions(context, self._namespace or "")
        namespace = _joined(context.launch_configurations.get(_NAMESPACE, ""), own)
        if namespace:
            yield from ("-r", f"__ns:={namespace}")
        for parameters in (*context.launch_configurations.get(_PARAMETERS, ()), *self._parameters):
            yield from words_for(context, parameters)
        for pair in (*context.launch_configurations.get(_REMAPS, ()), *self._remappings):
            old, new = (perform_substitutions(context, name) for name in pair)
            yield from ("-r", f"{old}:={new}")


class PushRosNamespace(Action):
    """Puts the nodes that follow in the group into a namespace."""

    def __init__(self, namespace: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        """Push it."""
        settings = context.launch_configurations
        pushed = perform_substitutions(context, self._namespace)
        settings[_NAMESPACE] = _joined(settings.get(_NAMESPACE, ""), pushed)


PushROSNamespace = PushRosNamespace


class _Setting(Action):
    """Something that all nodes that follow in the group get."""

    setting = ""

    def __init__(self, entry: Any, condition: Condition | None) -> None:
        super().__init__(condition=condition)
        self._entry = entry

    def execute(self, context: LaunchContext) -> None:
        """Append it; a new list, so that the end of a group ends it."""
        settings = context.launch_configurations
        settings[self.setting] = [*settings.get(self.setting, ()), self._entry]


class SetParameter(_Setting):
    """A parameter for all nodes that follow."""

    setting = _PARAMETERS

    def __init__(
        self, name: SomeSubstitutionsType, value: Any, *, condition: Condition | None = None
    ) -> None:
        super().__init__({name: value}, condition)


class SetUseSimTime(SetParameter):
    """use_sim_time for all nodes that follow."""

    def __init__(self, value: Any, *, condition: Condition | None = None) -> None:
        super().__init__("use_sim_time", value, condition=condition)


class SetParametersFromFile(_Setting):
    """A file of parameters for all nodes that follow."""

    setting = _PARAMETERS

    def __init__(self, filename: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(filename, condition)


class SetRemap(_Setting):
    """Another name for a topic of all nodes that follow."""

    setting = _REMAPS

    def __init__(
        self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, *, condition: Condition | None = None
    ) -> None:
        super().__init__((src, dst), condition)


def _joined(outer: str, inner: str) -> str:
    """Give a namespace inside another one, absolute; an absolute one stands for itself."""
    whole = inner if inner.startswith("/") or not outer else f"{outer.rstrip('/')}/{inner}"
    whole = whole.rstrip("/")
    return f"/{whole}" if whole and not whole.startswith("/") else whole
