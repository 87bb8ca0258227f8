"""Callback groups, which control which callbacks of a node may run at the same time."""

import weakref
from typing import Any


class CallbackGroup:
    """Base class of callback groups. Subclasses implement the three methods below."""

    def __init__(self) -> None:
        super().__init__()
        self.entities: set[weakref.ref[Any]] = set()

    def add_entity(self, entity: Any) -> None:
        """Add an entity whose callback belongs to the group."""
        self.entities.add(weakref.ref(entity))

    def has_entity(self, entity: Any) -> bool:
        """Return whether an entity is in the group."""
        return weakref.ref(entity) in self.entities

    def can_execute(self, entity: Any) -> bool:
        """Return whether the entity's callback may run now."""
        raise NotImplementedError

    def beginning_execution(self, entity: Any) -> bool:
        """Mark the entity's callback as started. Return False if it may not start now."""
        raise NotImplementedError

    def ending_execution(self, entity: Any) -> None:
        """Mark the entity's callback as finished."""
        raise NotImplementedError


class ReentrantCallbackGroup(CallbackGroup):
    """A group whose callbacks may all run at the same time, even several runs of one callback."""

    def can_execute(self, entity: Any) -> bool:
        """Return True."""
        return True

    def beginning_execution(self, entity: Any) -> bool:
        """Return True."""
        return True

    def ending_execution(self, entity: Any) -> None:
        """Do nothing."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """A group of which one callback runs at a time.

    A coroutine that awaits something is still running.
    """

    def __init__(self) -> None:
        super().__init__()
        self._active_entity: Any = None

    def can_execute(self, entity: Any) -> bool:
        """Return whether no callback of the group is running."""
        if weakref.ref(entity) not in self.entities:
            raise AssertionError
        return self._active_entity is None

    def beginning_execution(self, entity: Any) -> bool:
        """Mark the entity's callback as started. Return False if another callback is running."""
        if weakref.ref(entity) not in self.entities:
            raise AssertionError
        if self._active_entity is not None:
            return False
        self._active_entity = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        """Mark the entity's callback as finished, so that the next one may run."""
        if self._active_entity is not entity:
            raise AssertionError
        self._active_entity = None
