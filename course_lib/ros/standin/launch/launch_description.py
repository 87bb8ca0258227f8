"""What a launch file describes."""

from collections.abc import Iterable

from launch.action import Entities, LaunchDescriptionEntity, listed
from launch.launch_context import LaunchContext


class LaunchDescription(LaunchDescriptionEntity):
    """Entities in their order."""

    def __init__(self, initial_entities: Iterable[LaunchDescriptionEntity] | None = None) -> None:
        self.entities = listed(initial_entities)

    def visit(self, context: LaunchContext) -> Entities:
        """Give the entities."""
        return self.entities

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Append an action."""
        self.entities.append(action)

    add_entity = add_action
