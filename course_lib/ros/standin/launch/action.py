"""What descriptions are made of."""

from collections.abc import Iterable
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


class Action(LaunchDescriptionEntity):
    """Something to be done, unless its condition is false."""

    def __init__(self, *, condition: Optional["Condition"] = None) -> None:
        self.condition = condition

    def visit(self, context: "LaunchContext") -> Entities | None:
        """Do it, unless the condition is false."""
        if self.condition is None or self.condition.evaluate(context):
            return self.execute(context)
        return None

    def execute(self, context: "LaunchContext") -> Entities | None:
        """Do it; returns what is to be done next."""
        raise NotImplementedError(type(self).__name__)


def listed(entities: Entities | None) -> list[LaunchDescriptionEntity]:
    """Give one entity, several or none as a list."""
    if entities is None:
        return []
    return [entities] if isinstance(entities, LaunchDescriptionEntity) else list(entities)
