"""A node as the graph knows it, and the entities in it that wait for an executor."""

import itertools
import weakref
from collections import deque
from collections.abc import Callable
from typing import NamedTuple, Protocol

from course_lib.ros.graph import NodesOfProgram
from course_lib.ros.mistakes import Mistake
from rclpy.callback_groups import CallbackGroup
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.impl import names
from rclpy.impl.arguments import Arguments
from rclpy.task import TaskRunner

_order = itertools.count()  # in which entities become ready


class HandledNode(Protocol):
    """A node, as an executor knows it."""

    @property
    def handle(self) -> "NodeHandle":
        """The node in the graph."""


class NodeExecutor(TaskRunner, Protocol):
    """An executor, as its nodes and their entities know it."""

    def get_nodes(self) -> "list[HandledNode]":
        """List the nodes whose callbacks it runs."""

    def remove_node(self, node: HandledNode) -> None:
        """Stop running the callbacks of a node."""

    def is_held_up(self, entity: "Entity") -> bool:
        """Return whether an entity's callback cannot run before the calling one has ended."""


class Turn(NamedTuple):
    """An entity that waits for an executor: its place in the order, and since when it waits, [ns]."""

    order: int
    entity: "Entity"
    since_ns: int


class NodeHandle:
    """A node of the graph: its names, the order of its entities, and those that wait for an executor."""

    def __init__(self, context: Context, name: str, namespace: str, arguments: Arguments) -> None:
        self.context = context
        self.graph = context.graph
        self.name = name
        self.namespace = namespace
        self.arguments = arguments
        self.id = self.graph.add_node(name, namespace)
        self.graph.part(NodesOfProgram).ids.add(self.id)
        self._executor: weakref.ref[NodeExecutor] | None = None
        self.has_left = False  # the graph: destroyed, replaced, or its context shut down
        self._entities = 0
        self._ready: deque[Turn] = deque()

    @property
    def executor(self) -> NodeExecutor | None:
        """The executor that it was added to last."""
        return self._executor() if self._executor else None

    @executor.setter
    def executor(self, executor: NodeExecutor | None) -> None:
        self._executor = None if executor is None else weakref.ref(executor)

    @property
    def full_name(self) -> str:
        """The fully qualified name."""
        return names.join(self.namespace, self.name)

    @property
    def logger_name(self) -> str:
        """The name of its logger: the full name with dots."""
        return self.full_name[1:].replace("/", ".")

    def leave(self) -> None:
        """Leave the graph; nothing happens in it any more."""
        self.has_left = True
        self.graph.remove_node(self.id)
        self.graph.part(NodesOfProgram).ids.discard(self.id)
        self._ready.clear()

    def next_entity(self) -> int:
        """Return the place of the next entity in the order of events."""
        self._entities += 1
        return self._entities

    def mark_ready(self, entity: "Entity") -> None:
        """Queue an entity for an executor, behind all that became ready before it, in any node."""
        self._ready.append(Turn(next(_order), entity, self.graph.now_ns))

    def first_ready(self) -> Turn | None:
        """Return the first entity whose callback group lets it run."""
        for turn in self._ready:
            if turn[1].callback_group.can_execute(turn[1]):
                return turn
        return None

    def take(self, turn: Turn) -> Callable[[], object] | None:
        """Remove an entity from the queue; returns the call to make, None if there is none any more."""
        self._ready.remove(turn)
        return turn.entity.take()


class Entity:
    """A part of a node that has a callback: a timer, a subscription and so on."""

    mistake: Mistake | None = None  # of a callback that cannot be called with its arguments

    def __init__(self, node: NodeHandle, callback_group: CallbackGroup) -> None:
        self.node_handle = node
        self.callback_group = callback_group
        self.entity = node.next_entity()

    def take(self) -> Callable[[], object] | None:
        """Consume the event that made it ready; returns the call to make, None if there is none any more."""
        raise NotImplementedError

    def note_time_taken(self, span_ns: int) -> None:
        """Note that its callback took robot time, [ns]: it slept, or waited."""


class GuardCondition(Entity):
    """A callback that runs after `trigger`; made by `Node.create_guard_condition`."""

    def __init__(
        self, node: NodeHandle, callback: Callable[[], object], callback_group: CallbackGroup
    ) -> None:
        super().__init__(node, callback_group)
        self.callback = callback
        self._triggered = self._destroyed = False

    def trigger(self) -> None:
        """Request a call of the callback; also from another thread."""
        if self._destroyed:
            raise InvalidHandle
        if not self._triggered:
            self._triggered = True
            self.node_handle.mark_ready(self)

    def take(self) -> Callable[[], object] | None:
        """Return the callback, unless the condition was destroyed meanwhile."""
        self._triggered = False
        return None if self._destroyed else self.callback

    def destroy(self) -> None:
        """Disable the condition; call `Node.destroy_guard_condition` instead."""
        self._destroyed = True
