"""The actions of a launch with nodes; each takes a `condition`."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from launch.entities import Action, BaseEventHandler, LaunchContext, Reaction, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.event_handlers import OnProcessExit

from launch_ros.events.lifecycle import ChangeState, StateTransition
from launch_ros.lifecycle_link import LifecycleLink
from launch_ros.parameter_descriptions import words_for

_NAMESPACE, _PARAMETERS, _REMAPS = "ros_namespace", "global_params", "ros_remaps"  # launch configurations
_LOOK = 0.1  # [s] between two looks for a node that is coming up
_NO_DIFFERENCE = {
    *("additional_env", "cwd", "emulate_tty", "env", "exec_name", "log_cmd", "output", "output_format"),
    *("prefix", "respawn", "respawn_delay", "respawn_max_retries", "shell", "sigkill_timeout"),
    "sigterm_timeout",
}


class Node(Action):
    """Starts an executable of a package, with names and parameters for its nodes.

    Args:
        package: The executable's package.
        executable: Its name, as in setup.py's console_scripts.
        name: Replaces the name of its nodes.
        namespace: Of its nodes, inside the namespaces of PushRosNamespace.
        parameters: Dictionaries, and YAML files; later ones count more.
        remappings: Pairs of names (from, to).
        arguments: Words for the program itself; `ros_arguments` stand behind --ros-args.
        on_exit: A reaction to its end.
        options: `condition`; `output` and others of ExecuteProcess make no difference here.
    """

    def __init__(
        self,
        *,
        executable: Some,
        package: Some,
        name: Some | None = None,
        namespace: Some | None = None,
        parameters: Iterable[Any] | None = None,
        remappings: Iterable[tuple[Some, Some]] | None = None,
        arguments: Iterable[Some] | None = None,
        ros_arguments: Iterable[Some] | None = None,
        on_exit: Reaction = None,
        **options: Any,
    ) -> None:
        super().__init__(self._start, condition=options.pop("condition", None))
        if isinstance(parameters, Mapping | str):
            raise TypeError(f"Node: parameters={parameters!r}, expected a list: parameters=[{parameters!r}]")
        for unknown in sorted(set(options) - _NO_DIFFERENCE):
            raise TypeError(f"Node.__init__() got an unexpected keyword argument {unknown!r}")
        self._package, self._executable, self._name, self._namespace = package, executable, name, namespace
        self._parameters, self._remappings = list(parameters or ()), list(remappings or ())
        self._arguments, self._ros_arguments = list(arguments or ()), list(ros_arguments or ())
        self._on_exit = on_exit

    def _start(self, context: LaunchContext) -> None:
        if self._on_exit is not None:
            context.handlers.insert(0, OnProcessExit(target_action=self, on_exit=self._on_exit))
        package, executable = text_of(context, self._package), text_of(context, self._executable)
        words = [text_of(context, word) for word in self._arguments]
        context.runner.start(self, package, executable, [*words, "--ros-args", *self._for_ros(context)])

    def _for_ros(self, context: LaunchContext) -> Iterator[str]:
        yield from (text_of(context, word) for word in self._ros_arguments)
        if self._name is not None:
            yield from ("-r", f"__node:={text_of(context, self._name)}")
        settings, namespace = context.launch_configurations, self._full_namespace(context)
        if namespace:
            yield from ("-r", f"__ns:={namespace}")
        for parameters in (*settings.get(_PARAMETERS, ()), *self._parameters):
            yield from words_for(context, parameters)
        for old, new in (*settings.get(_REMAPS, ()), *self._remappings):
            yield from ("-r", f"{text_of(context, old)}:={text_of(context, new)}")

    def _full_namespace(self, context: LaunchContext) -> str:
        outer = context.launch_configurations.get(_NAMESPACE, "")
        return _joined(outer, text_of(context, self._namespace or ""))


class LifecycleNode(Node):
    """Starts a node whose state the launch follows (StateTransition) and changes (ChangeState).

    Args:
        name: Its name; needed, because its topic and its service are named for it.
        namespace: Its namespace, maybe "".
        options: Those of Node.
    """

    def __init__(self, *, name: Some, namespace: Some, **options: Any) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        self.node_name = ""  # with its namespace, once it was started
        self._given_name = name

    def _start(self, context: LaunchContext) -> None:
        runner, ended = context.runner, OnProcessExit(target_action=self, on_exit=self._end)
        self.node_name = f"{self._full_namespace(context)}/{text_of(context, self._given_name)}"
        self._runs = True

        def failed(number: int) -> None:
            transition = f"'{ChangeState.valid_transitions[number]}' for LifecycleNode '{self.node_name}'"
            runner.log(
                "ERROR", "launch_ros.actions.lifecycle_node", f"Failed to make transition {transition}"
            )

        def hear(message: Any) -> None:
            runner.emit(StateTransition(action=self, msg=message))

        link = LifecycleLink(self.node_name, hear, failed)

        def asked(event: Any, context: LaunchContext) -> Action:
            return Action(lambda context: self._ask(context, link, event.transition_id))

        context.handlers[:0] = [ended, BaseEventHandler(matcher=self._is_meant, entities=asked)]
        super()._start(context)

    def _is_meant(self, event: Any) -> bool:
        return isinstance(event, ChangeState) and event.lifecycle_node_matcher(self)

    def _ask(self, context: LaunchContext, link: LifecycleLink, transition: int) -> None:
        """Ask for a transition, as soon as the node is there."""
        if self._runs and not link.ask(transition):
            again = Action(lambda context: self._ask(context, link, transition))
            context.runner.later(_LOOK, again)

    def _end(self, event: Any, context: LaunchContext) -> None:
        self._runs = False


class PushRosNamespace(Action):
    """Puts the nodes that follow in the group into a namespace."""

    def __init__(self, namespace: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            settings = context.launch_configurations
            settings[_NAMESPACE] = _joined(settings.get(_NAMESPACE, ""), text_of(context, namespace))

        super().__init__(do, **options)


PushROSNamespace = PushRosNamespace


class _ForAll(Action):
    """A setting for all nodes that follow in the group."""

    def __init__(self, setting: str, entry: Any, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            settings = context.launch_configurations
            settings[setting] = [*settings.get(setting, ()), entry]  # a new list: the group's end ends it

        super().__init__(do, **options)


class SetParameter(_ForAll):
    """A parameter for all nodes that follow."""

    def __init__(self, name: Some, value: Any, **options: Any) -> None:
        super().__init__(_PARAMETERS, {name: value}, **options)


class SetRemap(_ForAll):
    """Another name for a topic of all nodes that follow."""

    def __init__(self, src: Some, dst: Some, **options: Any) -> None:
        super().__init__(_REMAPS, (src, dst), **options)


def _joined(outer: str, inner: str) -> str:
    """Join a namespace to an outer one, absolute; an absolute one stands for itself."""
    whole = inner if inner.startswith("/") or not outer else f"{outer.rstrip('/')}/{inner}"
    whole = whole.rstrip("/")
    return f"/{whole}" if whole and not whole.startswith("/") else whole
