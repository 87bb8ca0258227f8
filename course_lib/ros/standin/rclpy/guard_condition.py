"""Guard conditions: callbacks that the program itself calls for."""

from collections.abc import Callable

from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.impl.node_handle import Entity, NodeHandle


class GuardCondition(Entity):
    """Has an executor call back after `trigger`; made by `Node.create_guard_condition`."""

    def __init__(
        self, node: NodeHandle, callback: Callable[[], object], callback_group: CallbackGroup
    ) -> None:
        super().__init__(node, callback_group)
        self.callback = callback
        self._triggered = self._destroyed = False

    def trigger(self) -> None:
        """Have the callback called; also from another thread."""
        if self._destroyed:
            raise InvalidHandle
        if not self._triggered:
            self._triggered = True
            self.node_handle.mark_ready(self)

    def take(self) -> Callable[[], object] | None:
        """Take the call, unless it was destroyed meanwhile."""
        self._triggered = False
        return None if self._destroyed else self.callback

    def destroy(self) -> None:
        """End it; call `Node.destroy_guard_condition` instead."""
        self._destroyed = True
