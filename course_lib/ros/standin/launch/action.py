"""What descriptions are made of."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Optional, TypeAlias

if TYPE_CHECKING:
    from launch.conditions import Condition
    from launch.launch_context import LaunchContext


class LaunchDescriptionEntity:
    """Something in a description."""

    def visit(self, context: "LaunchContext") -> "Entities | None":
        """Do what is described; returns what is to be visited next."""
        raise NotImplementedError(type(self).__name__)


Entities: TypeAlias = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity]
Do: TypeAlias = Callable[["LaunchContext"], Entities | None]


class Action(LaunchDescriptionEntity):
    """Something to be done, unless its condition is false; `do` returns what is to be done next."""

    def __init__(self, do: Do, *, condition: Optional["Condition"] = None) -> None:
        self._do, self._condition = do, condition

    def visit(self, context: "LaunchContext") -> Entities | None:
        """Do it, unless the condition is false."""
        if self._condition is None or self._condition.evaluate(context):
            return self._do(context)
        return None


def listed(entities: Entities | None) -> list[LaunchDescriptionEntity]:
    """Give one entity, several or none as a list."""
    if entities is None:
        return []
    return [entities] if isinstance(entities, LaunchDescriptionEntity) else list(entities)
