"""Actions that start nodes, change the settings of later nodes in a group, or trigger lifecycle transitions.

All of them accept a `condition`.
"""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import lifecycle_msgs.srv
from launch.actions import (
    NO_DIFFERENCE,
    EmitEvent,
    RegisterEventHandler,
    TimerAction,
    react_to_exit,
    unknown_options,
    warn_about_ignored_options,
)
from launch.conditions import as_bool
from launch.entities import Action, BaseEventHandler, Condition, DataAction, LaunchContext, Reaction, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.events import ProcessExited
from lifecycle_msgs.msg import Transition, TransitionEvent

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import ProgramNodes, current_graph
from course_lib.ros.graph.topics import SERVICE_HEADER, Qos, service_topics
from course_lib.ros.messages import deserialize, serialize
from course_lib.ros.programs.packages import NotAvailableError
from launch_ros.events.lifecycle import ChangeState, StateTransition, matches_node_name
from launch_ros.parameter_descriptions import ParameterFile, check_values, evaluate_value, words_for

# Names of the launch configurations that hold the settings.
_NAMESPACE, PARAMETERS, _REMAPS = "ros_namespace", "global_params", "ros_remaps"


@dataclass(eq=False, repr=False)
class PushRosNamespace(DataAction):
    """Adds a namespace to the following nodes of the group."""

    namespace: Some

    def execute(self, context: LaunchContext) -> None:
        """Append the namespace to the namespace of the group."""
        settings = context.launch_configurations
        settings[_NAMESPACE] = _join_namespaces(
            settings.get(_NAMESPACE, ""), text_of(context, self.namespace)
        )


PushROSNamespace = PushRosNamespace


@dataclass(eq=False, repr=False)
class SetParameter(DataAction):
    """Sets a parameter of all following nodes."""

    name: Some
    value: Any

    def execute(self, context: LaunchContext) -> None:
        """Add the parameter to the parameters of the group."""
        _add(context, PARAMETERS, {text_of(context, self.name): evaluate_value(context, self.value)})


@dataclass(eq=False, repr=False)
class SetParametersFromFile(DataAction):
    """Sets the parameters of all following nodes from a file."""

    filename: Some

    def execute(self, context: LaunchContext) -> None:
        """Add the file to the parameters of the group."""
        _add(context, PARAMETERS, ParameterFile(text_of(context, self.filename)))


@dataclass(eq=False, repr=False)
class SetUseSimTime(DataAction):
    """Sets the parameter `use_sim_time` of all following nodes."""

    value: bool | Some

    def execute(self, context: LaunchContext) -> None:
        """Add the parameter to the parameters of the group."""
        _add(context, PARAMETERS, {"use_sim_time": as_bool(context, self.value)})


@dataclass(eq=False, repr=False)
class SetRemap(DataAction):
    """Remaps a topic of all following nodes."""

    src: Some
    dst: Some

    def execute(self, context: LaunchContext) -> None:
        """Add the rule to the remapping rules of the group."""
        _add(context, _REMAPS, (text_of(context, self.src), text_of(context, self.dst)))


@dataclass(eq=False, repr=False)
class SetROSLogDir(DataAction):
    """Sets the log folder in the environment of all following processes."""

    new_log_dir: Some

    def execute(self, context: LaunchContext) -> None:
        """Set the variable ROS_LOG_DIR."""
        os.environ["ROS_LOG_DIR"] = text_of(context, self.new_log_dir)


def _add(context: LaunchContext, setting: str, entry: Any) -> None:
    settings = context.launch_configurations
    # Create a new list, so that the previous one can be restored at the end of the group.
    settings[setting] = [*settings.get(setting, ()), entry]


def _join_namespaces(outer: str, inner: str) -> str:
    """Join a namespace to an outer one. An absolute namespace replaces the outer one."""
    joined = inner if inner.startswith("/") or not outer else f"{outer.rstrip('/')}/{inner}"
    joined = joined.rstrip("/")
    return f"/{joined}" if joined and not joined.startswith("/") else joined


_EVENT, _SERVICE = "lifecycle_msgs/msg/TransitionEvent", "lifecycle_msgs/srv/ChangeState"


class _LaunchNode:
    """The node in the graph that represents the launch. There is one for each launch."""

    def __init__(self) -> None:
        self.id = current_graph().add_node("launch_ros", "/")
        current_graph().state(ProgramNodes).ids.add(self.id)


class _LifecycleLink:
    """A connection to a lifecycle node, given by its full name.

    `on_transition` receives its transitions, `on_rejection` the id of a transition that it
    rejected.
    """

    def __init__(
        self,
        name: str,
        on_transition: Callable[[TransitionEvent], object],
        on_rejection: Callable[[int], object],
    ) -> None:
        self._graph, self._qos = current_graph(), Qos()
        # The requested transitions in the order of their requests.
        self._requested: list[int] = []
        node = self._graph.state(_LaunchNode).id

        def on_event(cdr: bytes, source_ns: int, received_ns: int) -> None:
            on_transition(deserialize(cdr, TransitionEvent))

        def on_response(data: bytes, source_ns: int, received_ns: int) -> None:
            client, number = SERVICE_HEADER.unpack_from(data)
            if client != self._id:
                return
            response = deserialize(data[SERVICE_HEADER.size :], lifecycle_msgs.srv.ChangeState.Response)
            if not response.success:
                on_rejection(self._requested[number - 1])

        self._graph.add_subscription(node, 0, f"{name}/transition_event", _EVENT, self._qos, on_event)
        requests, replies = service_topics(f"{name}/change_state", _SERVICE)
        self._request_topic = requests[0]
        self._id = self._graph.add_publisher(node, *requests, self._qos)
        self._graph.add_subscription(node, 0, *replies, self._qos, on_response)

    def request(self, transition: int) -> bool:
        """Request a transition. Return False if the node's service is not available."""
        if not any(end.kind == "sub" for end in self._graph.endpoints_on(self._request_topic)):
            return False
        request = lifecycle_msgs.srv.ChangeState.Request(transition=Transition(id=transition))
        self._requested.append(transition)
        header = SERVICE_HEADER.pack(self._id, len(self._requested))
        self._graph.publish(self._id, header + serialize(request))
        return True


# Interval between checks whether a starting node is available [s].
_LOOK = 0.1


@dataclass(frozen=True)
class _NodeSettings:
    """The names and parameters that a launch file sets for a node."""

    name: Some | None
    namespace: Some | None
    parameters: tuple[Any, ...]
    remappings: tuple[tuple[Some, Some], ...]

    def words(self, context: LaunchContext) -> Iterator[str]:
        """Yield the arguments after --ros-args, including settings for all nodes of the group."""
        if self.name is not None:
            yield from ("-r", f"__node:={text_of(context, self.name)}")
        settings, namespace = context.launch_configurations, self.full_namespace(context)
        if namespace:
            yield from ("-r", f"__ns:={namespace}")
        for parameters in (*settings.get(PARAMETERS, ()), *self.parameters):
            yield from words_for(context, parameters)
        for old, new in (*settings.get(_REMAPS, ()), *self.remappings):
            yield from ("-r", f"{text_of(context, old)}:={text_of(context, new)}")

    def full_name(self, context: LaunchContext) -> str:
        """Return the node's name within the namespace of the group."""
        return f"{self.full_namespace(context)}/{text_of(context, self.name or '')}"

    def full_namespace(self, context: LaunchContext) -> str:
        """Return the node's namespace within the namespace of the group."""
        outer = context.launch_configurations.get(_NAMESPACE, "")
        return _join_namespaces(outer, text_of(context, self.namespace or ""))


class Node(Action):
    """Starts an executable of a package, with names and parameters for its nodes.

    Args:
        package: The executable's package; without one, the executable is the path of a Python
            program.
        executable: Its name, as in setup.py's console_scripts.
        name: Replaces the name of its nodes.
        namespace: The namespace of its nodes, inside the namespaces of PushRosNamespace.
        parameters: Dictionaries and YAML files; later entries take precedence.
        remappings: Pairs of names (from, to).
        arguments: Arguments for the program itself.
        ros_arguments: Arguments after --ros-args.
        on_exit: Entities to visit when the process exits.
        options: `condition`; other options of ExecuteProcess, such as `output`, have no effect
            here.
    """

    is_asynchronous = True

    def __init__(
        self,
        *,
        executable: Some,
        package: Some | None = None,
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
        if isinstance(arguments, str):
            split_arguments = arguments.split()
            raise TypeError(f"Node: arguments={arguments!r}, expected a list: arguments={split_arguments!r}")
        unknown_options("Node", options, NO_DIFFERENCE)
        check_values(parameters)
        self._package, self._executable = package, executable
        pairs = tuple(remappings or ())
        if any(not isinstance(pair, tuple | list) or len(pair) != 2 for pair in pairs):
            raise TypeError(f"Node: remappings={remappings!r}, expected pairs: remappings=[('from', 'to')]")
        self._settings = _NodeSettings(name, namespace, tuple(parameters or ()), pairs)
        self._arguments, self._ros_arguments = list(arguments or ()), list(ros_arguments or ())
        self._on_exit, self._options = on_exit, options

    def _start(self, context: LaunchContext) -> list[Action] | None:
        warn_about_ignored_options(context, self._options)
        react_to_exit(context, self, self._on_exit)
        executable, common = text_of(context, self._executable), self._settings
        arguments = [text_of(context, word) for word in self._arguments]
        ros_words = [text_of(context, word) for word in self._ros_arguments]
        arguments = [*arguments, "--ros-args", *ros_words, *common.words(context)]
        if self._package is None:
            if not Path(executable).is_file() and not executable.endswith(".py"):
                raise CourseError(
                    f"Node(executable={executable!r}) has no package, so {executable!r} would be the path of "
                    "a Python file. Add the package: Node(package='…', executable='…')."
                )
            context.runner.start_file(self, Path(executable), arguments)
            return None
        try:
            context.runner.start(self, text_of(context, self._package), executable, arguments)
        except NotAvailableError:
            # The executables of ROS usually have the same names as their nodes.
            name = executable if common.name is None else text_of(context, common.name)
            current_graph().left_out_nodes.add(name)
            raise
        return None


class LifecycleNode(Node):
    """Starts a lifecycle node.

    The launch receives its transitions (StateTransition) and requests transitions (ChangeState).

    Args:
        name: The name of the node, which is required because its topic and service contain it.
        namespace: The namespace of the node; may be "".
        autostart: Whether the launch configures and activates the node.
        options: The options of Node.
    """

    def __init__(
        self,
        *,
        name: Some,
        namespace: Some,
        autostart: bool = False,
        **options: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        self._autostart = autostart
        # The fully qualified name, "" before the node is started.
        self.node_name = ""

    def _start(self, context: LaunchContext) -> list[Action]:
        self.node_name = self._settings.full_name(context)
        LifecycleEventManager(self).setup_lifecycle_manager(context)
        super()._start(context)
        return [_activation(self.node_name)] if self._autostart else []


class LifecycleEventManager:
    """Emits a lifecycle node's transitions, and requests the transitions of ChangeState events.

    Args:
        lifecycle_node: The action or the description of the node, whose `node_name` is its full
            name.
    """

    def __init__(self, lifecycle_node: "LifecycleNode | ComposableLifecycleNode") -> None:
        self._lifecycle_node = lifecycle_node
        self._is_running = True

    @property
    def node_name(self) -> str:
        """The full name of the node."""
        return self._lifecycle_node.node_name

    def setup_lifecycle_manager(self, context: LaunchContext) -> None:
        """Connect to the node, which need not exist yet."""
        runner, node = context.runner, self._lifecycle_node

        def on_rejection(number: int) -> None:
            transition = f"'{ChangeState.valid_transitions[number]}' for LifecycleNode '{self.node_name}'"
            runner.log(
                "ERROR", "launch_ros.actions.lifecycle_node", f"Failed to make transition {transition}"
            )

        def on_transition(message: Any) -> None:
            runner.emit(StateTransition(action=node, msg=message))

        def is_own_exit(event: Any) -> bool:
            # A component's process was started by the action that has loaded it.
            starters = (node, getattr(node, "loading_action", None))
            return isinstance(event, ProcessExited) and event.action in starters

        def on_exit(event: Any, context: LaunchContext) -> None:
            self._is_running = False

        def is_addressed(event: Any) -> bool:
            return isinstance(event, ChangeState) and event.lifecycle_node_matcher(node)

        def on_request(event: Any, context: LaunchContext) -> Action:
            return Action(lambda context: self._request(context, link, event.transition_id))

        link = _LifecycleLink(self.node_name, on_transition, on_rejection)
        context.handlers[:0] = [
            BaseEventHandler(matcher=is_own_exit, entities=on_exit),
            BaseEventHandler(matcher=is_addressed, entities=on_request),
        ]

    def _request(self, context: LaunchContext, link: _LifecycleLink, transition: int) -> None:
        """Request a transition. If the node is not available yet, try again later."""
        if self._is_running and not link.request(transition):
            retry = Action(lambda context: self._request(context, link, transition))
            context.runner.later(_LOOK, retry)


def _activation(name: str) -> "LifecycleTransition":
    """Return the action that configures and activates a lifecycle node."""
    transitions = [Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE]
    return LifecycleTransition(lifecycle_node_names=[name], transition_ids=transitions)


class ComposableNode:
    """A component: a plugin of a package, with names and parameters for its node.

    Args:
        package: The component's package.
        plugin: Its class, in the form `package::Class`.
        name: Replaces the name of its node.
        namespace: The namespace of its node.
        parameters: Dictionaries and YAML files.
        remappings: Pairs of names (from, to).
        extra_arguments: Dictionaries for the container; they have no effect here.
        condition: The component is loaded if it is true.
    """

    def __init__(
        self,
        *,
        package: Some,
        plugin: Some,
        name: Some | None = None,
        namespace: Some | None = None,
        parameters: Iterable[Any] | None = None,
        remappings: Iterable[tuple[Some, Some]] | None = None,
        extra_arguments: Iterable[Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        check_values(parameters)
        self._package, self._plugin, self._condition = package, plugin, condition
        self._settings = _NodeSettings(name, namespace, tuple(parameters or ()), tuple(remappings or ()))

    def load(self, context: LaunchContext, action: Action) -> Iterable[Action]:
        """Start the component unless its condition is false. Return the actions that follow."""
        if self._condition is None or self._condition.evaluate(context):
            package, plugin = text_of(context, self._package), text_of(context, self._plugin)
            arguments = ["--ros-args", *self._settings.words(context)]
            if context.runner.start_component(action, package, plugin, arguments):
                return self._on_start(context, action)
            if self._settings.name is not None:
                current_graph().left_out_nodes.add(text_of(context, self._settings.name))
        return ()

    def _on_start(self, context: LaunchContext, action: Action) -> Iterable[Action]:
        """Return the actions that follow when the component was started."""
        return ()


class ComposableLifecycleNode(ComposableNode):
    """A component that is a lifecycle node.

    The launch receives its transitions (StateTransition) and requests transitions (ChangeState).

    Args:
        autostart: Whether the launch configures and activates the node.
        options: The options of ComposableNode. The node's topic and service contain its `name`.

    Raises:
        TypeError: There is no `name`.
    """

    def __init__(self, *, autostart: bool | Some = False, **options: Any) -> None:
        super().__init__(**options)
        if self._settings.name is None:
            raise TypeError("ComposableLifecycleNode: name=None, expected the node's name: name='camera'")
        self._autostart = autostart
        # The fully qualified name and the action that starts the node, once it was started.
        self.node_name = ""
        self.loading_action: Action | None = None

    def init_lifecycle_event_manager(self, context: LaunchContext) -> None:
        """Connect the node to the events of the launch."""
        self.node_name = self._settings.full_name(context)
        LifecycleEventManager(self).setup_lifecycle_manager(context)

    def _on_start(self, context: LaunchContext, action: Action) -> Iterable[Action]:
        self.loading_action = action
        self.init_lifecycle_event_manager(context)
        return [_activation(self.node_name)] if as_bool(context, self._autostart) else []


class LoadComposableNodes(Action):
    """Loads components into a container."""

    def __init__(
        self,
        *,
        composable_node_descriptions: Iterable[ComposableNode],
        target_container: "Some | ComposableNodeContainer",
        **options: Any,
    ) -> None:
        super().__init__(self._load, **options)
        self._components = list(composable_node_descriptions)

    def _load(self, context: LaunchContext) -> list[Action]:
        return [action for component in self._components for action in component.load(context, self)]


class ComposableNodeContainer(Node):
    """Starts a container and then its components. See Node for `options`."""

    def __init__(
        self,
        *,
        name: Some,
        namespace: Some,
        composable_node_descriptions: Iterable[ComposableNode] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        self._components = list(composable_node_descriptions or ())

    def execute(self, context: LaunchContext) -> list[LoadComposableNodes]:
        """Start the container and return the action that loads the components."""
        super().execute(context)
        return [LoadComposableNodes(composable_node_descriptions=self._components, target_container=self)]


class LifecycleTransition(Action):
    """Triggers a sequence of transitions of lifecycle nodes.

    The sequence of a node ends when one of its callbacks fails with an error.
    """

    transition_targets: ClassVar[dict[int, tuple[str, str]]] = {
        Transition.TRANSITION_CONFIGURE: ("configuring", "inactive"),
        Transition.TRANSITION_CLEANUP: ("cleaningup", "unconfigured"),
        Transition.TRANSITION_ACTIVATE: ("activating", "active"),
        Transition.TRANSITION_DEACTIVATE: ("deactivating", "inactive"),
        Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: ("shuttingdown", "finalized"),
        Transition.TRANSITION_INACTIVE_SHUTDOWN: ("shuttingdown", "finalized"),
        Transition.TRANSITION_ACTIVE_SHUTDOWN: ("shuttingdown", "finalized"),
    }

    def __init__(
        self,
        *,
        lifecycle_node_names: Iterable[Some],
        transition_ids: Iterable[int | Some],
        **options: Any,
    ) -> None:
        super().__init__(self._begin, **options)
        self._names, self._ids = list(lifecycle_node_names), list(transition_ids)
        if not self._ids:
            raise ValueError("No transition_ids provided.")
        if not self._names:
            raise ValueError("No lifecycle_node_names provided.")

    def _begin(self, context: LaunchContext) -> list[Action]:
        numbers = []
        for transition_id in self._ids:
            text = str(transition_id) if isinstance(transition_id, int) else text_of(context, transition_id)
            try:
                numbers.append(int(text))
            except ValueError as error:
                raise ValueError(f"expected integer for lifecycle transition, got {text}") from error
        return [
            action
            for name in self._names
            for action in self._transition_actions(text_of(context, name), numbers)
        ]

    def _transition_actions(self, name: str, numbers: list[int]) -> list[Action]:
        """Return the actions for one node.

        They are a request for the first transition, and handlers that request the following ones.
        """
        is_node = matches_node_name(name)
        requests = [
            EmitEvent(event=ChangeState(lifecycle_node_matcher=is_node, transition_id=number))
            for number in numbers
        ]
        handlers = []
        for number, request in zip(numbers, requests[1:], strict=False):
            states = self.transition_targets[number]

            def completes(event: Any, states: tuple[str, str] = states) -> bool:
                is_transition = isinstance(event, StateTransition) and is_node(event.action)
                return is_transition and (event.start_state, event.goal_state) == states

            handlers.append(BaseEventHandler(matcher=completes, entities=[request], handle_once=True))

        def fails(event: Any) -> bool:
            is_transition = isinstance(event, StateTransition) and is_node(event.action)
            return is_transition and event.goal_state == "errorprocessing"

        def unregister(event: Any, context: LaunchContext) -> None:
            for handler in handlers:
                # A handler that has already been used is no longer registered.
                with suppress(ValueError):
                    context.unregister_event_handler(handler)

        at_error = BaseEventHandler(matcher=fails, entities=unregister, handle_once=True)
        return [*(RegisterEventHandler(handler) for handler in (*handlers, at_error)), requests[0]]


class ROSTimer(TimerAction):
    """Visits actions after a period of ROS time, which is robot time here."""


RosTimer = ROSTimer
