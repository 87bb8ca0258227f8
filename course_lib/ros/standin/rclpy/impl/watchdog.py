"""Deadlines of publishers and subscriptions."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.impl.node_handle import NodeHandle

if TYPE_CHECKING:
    from course_lib.ros.clock import Alarm


class Watchdog:
    """Barks whenever it was not fed for a while, [ns], after its first meal."""

    def __init__(self, node: NodeHandle, limit_ns: int, bark: Callable[[], object]) -> None:
        self._node, self._limit_ns, self._bark = node, limit_ns, bark
        self._entity = node.next_entity()
        self._alarm: Alarm | None = None

    def feed(self) -> None:
        """Begin the time anew."""
        self.stop()
        graph = self._node.graph
        due_ns = graph.now_ns + self._limit_ns
        self._alarm = graph.call_at(due_ns, self._ring, node=self._node.id, entity=self._entity)

    def stop(self) -> None:
        """Bark no more until it is fed."""
        if self._alarm is not None:
            self._alarm.cancel()

    def _ring(self) -> None:
        self.feed()
        self._bark()
