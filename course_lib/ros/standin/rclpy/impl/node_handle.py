"""The handle of a node in the graph, with the entities that are ready for an executor."""

import weakref
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

from rcl_interfaces.msg import ListParametersResult, ParameterDescriptor, SetParametersResult

from course_lib.ros.graph.graph import ProgramNodes
from course_lib.ros.mistakes import Mistake, marked
from rclpy.callback_groups import CallbackGroup
from rclpy.context import Context, get_default_context, require_context
from rclpy.exceptions import InvalidHandle
from rclpy.impl import names
from rclpy.impl.arguments import Arguments
from rclpy.impl.implementation_singleton import INVALID_CONTEXT, RCLError
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.task import TaskRunner, order


class HandledNode(Protocol):
    """The part of a node that executors use."""

    @property
    def handle(self) -> "NodeHandle":
        """The node's handle in the graph."""


class AnyNode(HandledNode, Protocol):
    """The methods of `Node` that are called by modules below `rclpy.node`, which it imports itself."""

    def get_name(self) -> str:
        """Return the name of the node."""
        ...

    def create_service(
        self, kind: Any, name: str, callback: Callable[[Any, Any], Any], /, *, qos_profile: QoSProfile = ...
    ) -> object:
        """Create a service."""

    def create_subscription(
        self, kind: Any, topic: str, callback: Callable[[Any], Any], qos: QoSProfile, /
    ) -> Any:
        """Create a subscription."""

    def destroy_subscription(self, subscription: Any, /) -> bool:
        """Destroy a subscription. Return False if the node did not create it."""
        ...

    def add_on_set_parameters_callback(
        self, callback: Callable[[list[Parameter]], SetParametersResult], /
    ) -> None:
        """Add a callback that accepts or rejects a change."""

    def has_parameter(self, name: str, /) -> bool:
        """Return whether a parameter is declared."""
        ...

    def declare_parameter(
        self, name: str, value: Any, descriptor: ParameterDescriptor | None = None, /
    ) -> Parameter:
        """Declare a parameter with a default value."""
        ...

    def get_parameter(self, name: str, /) -> Parameter:
        """Return a parameter."""
        ...

    def get_parameters(self, names: Sequence[str], /) -> list[Parameter]:
        """Return several parameters."""
        ...

    def get_parameter_types(self, names: Sequence[str], /) -> list[int]:
        """Return the types of several parameters."""
        ...

    def describe_parameters(self, names: Sequence[str], /) -> list[ParameterDescriptor]:
        """Return the descriptors of several parameters."""
        ...

    def list_parameters(self, prefixes: list[str], depth: int, /) -> ListParametersResult:
        """List the declared parameters with one of the prefixes."""
        ...

    def set_parameters_atomically(self, parameters: list[Parameter], /) -> SetParametersResult:
        """Set all parameters or none of them."""
        ...


class NodeExecutor(TaskRunner, Protocol):
    """The part of an executor that nodes and their entities use."""

    def get_nodes(self) -> "list[HandledNode]":
        """List the nodes whose callbacks the executor runs."""

    def remove_node(self, node: HandledNode) -> None:
        """Stop running the callbacks of a node."""

    def _course_holds_up(self, entity: "Entity") -> bool:
        """Return whether an entity's callback cannot run before the calling callback has ended."""

    def _course_runs(self, node: "NodeHandle") -> bool:
        """Return whether a thread runs the callbacks of a node at this moment."""


class Turn(NamedTuple):
    """A ready entity in an executor's queue: its position, and since when it is ready [ns]."""

    order: int
    entity: "Entity"
    since_ns: int


class NodeHandle:
    """A node in the graph: its names, the numbers of its entities, and its ready entities."""

    def __init__(self, context: Context, name: str, namespace: str, arguments: Arguments) -> None:
        self.context = context
        self.graph = context.graph
        self.name = name
        self.namespace = namespace
        self.arguments = arguments
        self.id = self.graph.add_node(name, namespace)
        self.graph.state(ProgramNodes).ids.add(self.id)
        self._executor: weakref.ref[NodeExecutor] | None = None
        self._was_added = False
        self.is_destroyed = False
        # Whether the node has left the graph: it was destroyed or replaced, or its context was shut
        # down.
        self.has_left = False
        self._entities = 0
        # Publishers and subscriptions that were destroyed, but not by the node. As in rclpy, the
        # node still lists them, and an executor fails.
        self.destroyed_ends = set[int]()
        self._ready: deque[Turn] = deque()

    @property
    def executor(self) -> NodeExecutor | None:
        """The executor that the node was added to last."""
        return self._executor() if self._executor else None

    @executor.setter
    def executor(self, executor: NodeExecutor | None) -> None:
        self._executor = None if executor is None else weakref.ref(executor)
        self.graph.state(ProgramNodes).unspun_nodes.pop(self.id, None)
        if executor is not None:
            self.graph.state(ProgramNodes).forget_error(self.full_name)
            self._was_added = True
            self.graph.state(ProgramNodes).callbacks.pop(self.full_name, None)

    @property
    def full_name(self) -> str:
        """The fully qualified node name."""
        return names.join(self.namespace, self.name)

    @property
    def logger_name(self) -> str:
        """The name of the node's logger: the full name with dots instead of slashes."""
        return self.full_name[1:].replace("/", ".")

    def require(self, failed: str = "") -> "NodeHandle":
        """Return the handle itself. Checks, before an rcl call, that the node is usable.

        Raises:
            InvalidHandle: The node was destroyed.
            RCLError: The node's context was shut down; `failed` begins the message.
        """
        if self.is_destroyed:
            raise InvalidHandle
        if failed and not self.context.is_valid:
            raise RCLError(f"{failed}: rcl node's context is invalid")
        return self

    def leave(self) -> None:
        """Remove the node from the graph and discard its ready entities."""
        self.has_left = True
        self.graph.remove_node(self.id)
        self.graph.state(ProgramNodes).ids.discard(self.id)
        self.graph.state(ProgramNodes).unspun_nodes.pop(self.id, None)
        self._ready.clear()
        self.destroyed_ends.clear()

    def record_work(self) -> None:
        """Record, for a warning, a ready timer or message while no executor spins the node."""
        if self._executor is None and not self.has_left:
            self.graph.state(ProgramNodes).unspun_nodes[self.id] = self.full_name

    def count_callbacks(self, change: int) -> None:
        """Record new or destroyed timers and subscriptions of a node that no executor has spun."""
        if not self._was_added:
            callbacks = self.graph.state(ProgramNodes).callbacks
            callbacks[self.full_name] = callbacks.get(self.full_name, 0) + change

    def next_entity(self) -> int:
        """Return the number of the next entity of the node, which orders simultaneous events."""
        self._entities += 1
        return self._entities

    def mark_ready(self, entity: "Entity") -> None:
        """Queue an entity for an executor, after all that became ready earlier, in any node."""
        self._ready.append(Turn(next(order), entity, self.graph.now_ns))

    def first_ready(self) -> Turn | None:
        """Return the first entity that its callback group allows to run."""
        for turn in self._ready:
            if turn[1].callback_group.can_execute(turn[1]):
                return turn
        return None

    def turns(self) -> list[Turn]:
        """List the ready entities in the order in which they became ready."""
        return list(self._ready)

    def take(self, turn: Turn) -> Callable[[], object] | None:
        """Remove an entity from the queue.

        Return the call to make, or None if it is no longer ready.
        """
        if self._ready and self._ready[0] is turn:
            self._ready.popleft()
        elif turn in self._ready:
            self._ready.remove(turn)
        else:
            return None
        return turn.entity._course_take()


@dataclass
class NodesById:
    """The nodes that one program has created in a run and not destroyed, by their ids in the graph."""

    nodes: dict[int, Any] = field(default_factory=dict)


def enter_graph(context: Context, name: str, namespace: str, arguments: Arguments) -> NodeHandle:
    """Validate a node's names, after the remappings of its arguments, and add it to the graph.

    The namespace may lack its leading slash.

    Raises:
        TypeError: A name is not a string.
        RCLError: There is no name, or a remapped namespace ends with a slash.
        InvalidNodeNameException: The name is invalid.
        InvalidNamespaceException: The namespace is invalid.
    """
    if name is None:
        raise RCLError("error creating node: name argument is null")
    if not isinstance(name, str) or not isinstance(namespace, str):
        raise TypeError("__init__(): incompatible constructor arguments.")
    names.validate_node_name(name)
    name = arguments.remap_node(name, "__node", name)
    remapped = arguments.remap_node(name, "__ns", "")
    if remapped.endswith("/") and remapped != "/":
        # The message is from rcl.
        text = "invalid node namespace: node name must not start with a number"
        raise RCLError(f"error creating node: {text}")
    namespace = remapped or namespace
    absolute = namespace if namespace.startswith("/") else f"/{namespace}"
    names.validate_namespace(absolute)
    return NodeHandle(context, name, absolute, arguments)


def require_bool(value: object, text: str = "__init__(): incompatible constructor arguments.") -> None:
    """Raise pybind11's error for an argument that it cannot convert to a bool."""
    if value is not None and not hasattr(type(value), "__bool__"):
        raise TypeError(text)


def require_node(node: NodeHandle, failed: str) -> None:
    """Check the node of an action client or server. Errors are ValueErrors, as in rcl_action."""
    try:
        node.require(failed)
    except RCLError as error:
        raise ValueError(str(error)) from None


class Entity:
    """A part of a node that has a callback, for example a timer or a subscription."""

    # The mistake that marks the error of a callback that does not accept its arguments.
    _course_mistake: Mistake | None = None

    def __init__(self, node: NodeHandle, callback_group: CallbackGroup) -> None:
        self._course_node = node
        self.callback_group = callback_group
        callback_group.add_entity(self)
        self._course_entity = node.next_entity()

    def _course_take(self) -> Callable[[], object] | None:
        """Remove the event that made the entity ready.

        Return the call to make, or None if there is none.
        """
        raise NotImplementedError

    def _course_record_time_taken(self, span_ns: int) -> None:
        """Record that the callback took robot time [ns], because it slept or waited."""


class GuardCondition(Entity):
    """A callback that runs after `trigger`, created by `Node.create_guard_condition`.

    As in rclpy, no executor runs the callback of a condition without a node.
    """

    def __init__(
        self,
        callback: Callable[[], object] | None,
        callback_group: CallbackGroup | None,
        context: Context | None = None,
    ) -> None:
        context = context or get_default_context()
        require_context(context, "handle")
        if not context.is_valid:
            raise RCLError(f"failed to create guard_condition: {INVALID_CONTEXT}")
        self.callback = callback
        self.callback_group = callback_group  # type: ignore[assignment]  # None without a node
        self.__has_node = self.__triggered = self.__destroyed = False

    def _course_join(self, node: NodeHandle) -> None:
        """Let the executor of a node run the callback."""
        super().__init__(node, self.callback_group)
        self.__has_node = True

    def trigger(self) -> None:
        """Request a call of the callback. May be called from any thread."""
        if self.__destroyed:
            raise InvalidHandle
        if self.__has_node and not self.__triggered:
            self.__triggered = True
            self._course_node.mark_ready(self)

    def _course_take(self) -> Callable[[], object] | None:
        """Return the callback, unless the condition has been destroyed since it was triggered."""
        self.__triggered = False
        if self.callback is None and not self.__destroyed:
            raise marked(TypeError("'NoneType' object is not callable"), Mistake.NO_CALLBACK)
        return None if self.__destroyed else self.callback

    def destroy(self) -> None:
        """Disable the condition. Call `Node.destroy_guard_condition` instead."""
        self.__destroyed = True


# rclpy defines it in a module of this name.
GuardCondition.__module__ = "rclpy.guard_condition"
