"""A node as the graph knows it, and what is ready in it."""

import itertools
import weakref
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from rclpy.impl import names

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.impl.arguments import Arguments

_order = itertools.count()  # in which entities become ready


class Turn(NamedTuple):
    """An entity that waits for an executor: its place in the order, and since when it waits, [ns]."""

    order: int
    entity: "Entity"
    since_ns: int


class NodeHandle:
    """A node of the graph: its names, the order of its entities, and those that wait for an executor."""

    def __init__(self, context: "Context", name: str, namespace: str, arguments: "Arguments") -> None:
        self.context = context
        self.graph = context.graph
        self.name = name
        self.namespace = namespace
        self.arguments = arguments
        self.id = self.graph.add_node(name, namespace)
        self._executor: weakref.ref[Executor] | None = None
        self.has_left = False  # the graph: destroyed, replaced, or its context shut down
        self._entities = 0
        self._ready: deque[Turn] = deque()

    @property
    def executor(self) -> "Executor | None":
        """The executor that it was added to last."""
        return self._executor() if self._executor else None

    @executor.setter
    def executor(self, executor: "Executor | None") -> None:
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
        self._ready.clear()

    def next_entity(self) -> int:
        """Give the next entity its place in the order of events."""
        self._entities += 1
        return self._entities

    def mark_ready(self, entity: "Entity") -> None:
        """Let an entity wait for an executor, behind all that became ready before it, in any node."""
        self._ready.append(Turn(next(_order), entity, self.graph.now_ns))

    def first_ready(self) -> Turn | None:
        """Return the first entity whose callback group lets it run."""
        return next((turn for turn in self._ready if turn[1].callback_group.can_execute(turn[1])), None)

    def take(self, turn: Turn) -> Callable[[], object] | None:
        """Take an entity out; returns what it has to call, None if that has been settled meanwhile."""
        self._ready.remove(turn)
        return turn.entity.take()


class Entity:
    """Something in a node that has a callback: a timer, a subscription and so on."""

    def __init__(self, node: NodeHandle, callback_group: "CallbackGroup") -> None:
        self.node_handle = node
        self.callback_group = callback_group
        self.entity = node.next_entity()

    def take(self) -> Callable[[], object] | None:
        """Take what made it ready; returns the call to make, None if there is nothing any more."""
        raise NotImplementedError

    def note_time_taken(self, span_ns: int) -> None:
        """Note that its callback took robot time, [ns]: it slept, or waited."""
