"""Callback groups, which decide which callbacks of a node may run at the same time."""

from typing import Any


class CallbackGroup:
    """The base of callback groups; one of your own may answer the three questions below otherwise."""

    def can_execute(self, entity: Any) -> bool:
        """Return whether the entity's callback may be run now."""
        return True

    def beginning_execution(self, entity: Any) -> bool:
        """Note that the entity's callback begins; False if it may not."""
        return self.can_execute(entity)

    def ending_execution(self, entity: Any) -> None:
        """Note that the entity's callback has come to its end."""


class ReentrantCallbackGroup(CallbackGroup):
    """Its callbacks may all run at the same time, each also beside itself."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """Only one of its callbacks runs at a time; a coroutine that awaits something is still running."""

    def __init__(self) -> None:
        self._active: Any = None

    def can_execute(self, entity: Any) -> bool:
        """Return whether none of the callbacks is running."""
        return self._active is None

    def beginning_execution(self, entity: Any) -> bool:
        """Note that the entity's callback begins; False if another one is running."""
        if self._active is not None:
            return False
        self._active = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        """Note that the entity's callback has ended: the next one may run."""
        self._active = None
