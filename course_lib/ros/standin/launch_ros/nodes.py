"""Nodes as actions of a launch."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from launch.entities import Action, BaseEventHandler, LaunchContext, Reaction, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.event_handlers import OnProcessExit
from launch.processes import NO_DIFFERENCE, react_to_exit, tell_missed, unknown_options
from lifecycle_msgs import srv
from lifecycle_msgs.msg import Transition, TransitionEvent

from course_lib.ros.graph import NodesOfProgram, current_graph
from course_lib.ros.messages import deserialize, serialize
from course_lib.ros.qos import Qos
from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS
from launch_ros.events.lifecycle import ChangeState, StateTransition
from launch_ros.parameter_descriptions import words_for
from launch_ros.settings import NAMESPACE, PARAMETERS, REMAPS, joined

_EVENT, _SERVICE = "lifecycle_msgs/msg/TransitionEvent", "lifecycle_msgs/srv/ChangeState"


class LaunchNode:
    """The node of a launch in the graph, one for each launch."""

    def __init__(self) -> None:
        self.id = current_graph().add_node("launch_ros", "/")
        current_graph().part(NodesOfProgram).ids.add(self.id)


class LifecycleLink:
    """A link to the node of a full name; `hear` gets its transitions, `failed` the number of one refused."""

    def __init__(
        self, name: str, hear: Callable[[TransitionEvent], object], failed: Callable[[int], object]
    ) -> None:
        self._graph, self._qos, self._failed = current_graph(), Qos(), failed
        self._asked: list[int] = []  # by the count of requests
        node = self._graph.part(LaunchNode).id

        def note(cdr: bytes, source_ns: int, received_ns: int) -> None:
            hear(deserialize(cdr, TransitionEvent))

        self._graph.add_subscription(node, 0, f"{name}/transition_event", _EVENT, self._qos, note)
        topics = [f"{prefix}{name}/change_state{suffix}" for prefix, suffix in SERVICE_TOPICS]
        self._requests = topics[0]
        self._id = self._graph.add_publisher(node, topics[0], f"{_SERVICE}_Request", self._qos)
        self._graph.add_subscription(node, 0, topics[1], f"{_SERVICE}_Response", self._qos, self._answered)

    def ask(self, transition: int) -> bool:
        """Ask for a transition; False while the node's service is not there."""
        if not any(end.kind == "sub" for end in self._graph.endpoints_on(self._requests)):
            return False
        request = srv.ChangeState.Request(transition=Transition(id=transition))
        self._asked.append(transition)
        self._graph.publish(self._id, SERVICE_HEADER.pack(self._id, len(self._asked)) + serialize(request))
        return True

    def _answered(self, data: bytes, source_ns: int, received_ns: int) -> None:
        client, number = SERVICE_HEADER.unpack_from(data)
        if client != self._id:
            return
        answer = deserialize(data[SERVICE_HEADER.size :], srv.ChangeState.Response)
        if not answer.success:
            self._failed(self._asked[number - 1])


_LOOK = 0.1  # [s] between two looks for a node that is coming up


@dataclass(frozen=True)
class Given:
    """A launch file's names and parameters for a node."""

    name: Some | None
    namespace: Some | None
    parameters: tuple[Any, ...]
    remappings: tuple[tuple[Some, Some], ...]

    def words(self, context: LaunchContext) -> Iterator[str]:
        """Yield the words for them behind --ros-args, with those for all nodes of the group."""
        if self.name is not None:
            yield from ("-r", f"__node:={text_of(context, self.name)}")
        settings, namespace = context.launch_configurations, self.full_namespace(context)
        if namespace:
            yield from ("-r", f"__ns:={namespace}")
        for parameters in (*settings.get(PARAMETERS, ()), *self.parameters):
            yield from words_for(context, parameters)
        for old, new in (*settings.get(REMAPS, ()), *self.remappings):
            yield from ("-r", f"{text_of(context, old)}:={text_of(context, new)}")

    def full_namespace(self, context: LaunchContext) -> str:
        """Return the namespace within that of the group."""
        outer = context.launch_configurations.get(NAMESPACE, "")
        return joined(outer, text_of(context, self.namespace or ""))


class Node(Action):
    """Starts an executable of a package, with names and parameters for its nodes.

    Args:
        package: The executable's package; without one the executable is the path of a Python program.
        executable: Its name, as in setup.py's console_scripts.
        name: Replaces the name of its nodes.
        namespace: Of its nodes, inside the namespaces of PushRosNamespace.
        parameters: Dictionaries, and YAML files; later ones count more.
        remappings: Pairs of names (from, to).
        arguments: Words for the program itself; `ros_arguments` stand behind --ros-args.
        on_exit: A reaction to its end.
        options: `condition`; `output` and others of ExecuteProcess make no difference here.
    """

    goes_on = True

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
        unknown_options("Node", options, NO_DIFFERENCE)
        self._package, self._executable = package, executable
        self._given = Given(name, namespace, tuple(parameters or ()), tuple(remappings or ()))
        self._arguments, self._ros_arguments = list(arguments or ()), list(ros_arguments or ())
        self._on_exit, self._options = on_exit, options

    def _start(self, context: LaunchContext) -> None:
        tell_missed(context, self._options)
        react_to_exit(context, self, self._on_exit)
        executable, given = text_of(context, self._executable), self._given
        words = [text_of(context, word) for word in self._arguments]
        ros_words = [text_of(context, word) for word in self._ros_arguments]
        words = [*words, "--ros-args", *ros_words, *given.words(context)]
        if self._package is None:
            context.runner.start_file(self, Path(executable), words)
        else:
            context.runner.start(self, text_of(context, self._package), executable, words)


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
        self.node_name = f"{self._given.full_namespace(context)}/{text_of(context, self._given_name)}"
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
