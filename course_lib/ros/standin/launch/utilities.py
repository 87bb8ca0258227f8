"""Functions for custom actions and substitutions."""

from collections.abc import Iterable
from typing import Any

from launch.entities import (
    LaunchContext,
    LaunchDescriptionEntity,
    SomeEntitiesType,
    SomeSubstitutionsType,
    Substitution,
    as_entity_list,
    text_of,
)
from launch.substitutions import TextSubstitution


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Convert a string, a substitution or an iterable of both to a list of substitutions."""
    if isinstance(subs, Substitution):
        return [subs]
    if isinstance(subs, Iterable) and not isinstance(subs, str):
        return [sub for part in subs for sub in normalize_to_list_of_substitutions(part)]
    return [TextSubstitution(text=str(subs))]


def normalize_to_list_of_entities(
    entities: Iterable[SomeEntitiesType],
) -> list[LaunchDescriptionEntity]:
    """Return entities, and lists of them, as one list."""
    return [entity for part in entities for entity in as_entity_list(part)]


def is_a(obj: object, entity_type: type) -> bool:
    """Return whether an object is an instance of a class."""
    return isinstance(obj, entity_type)


def is_a_subclass(obj: Any, entity_type: type) -> bool:
    """Return whether an object is an instance or a subclass of a class."""
    return isinstance(obj, entity_type) or (isinstance(obj, type) and issubclass(obj, entity_type))


def perform_substitutions(context: LaunchContext, subs: Iterable[Any]) -> str:
    """Perform substitutions and join the results."""
    return text_of(context, subs)


def ensure_argument_type(
    argument: object, types: type | Iterable[type], argument_name: str, caller: str | None = None
) -> None:
    """Raise a TypeError with ROS's text if an argument is not an instance of one of the types."""
    allowed = [types] if isinstance(types, type) else list(types)
    if not isinstance(argument, tuple(allowed)):
        start = "E" if caller is None else f"'{caller}' e"
        raise TypeError(
            f"{start}xpected '{argument_name}' to be one of [{', '.join(map(str, allowed))}], but "
            f"got '{argument}' of type '{type(argument)}'"
        )
