"""The parts of launch descriptions: substitutions, conditions, actions, events, and their context."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Protocol, TypeAlias, Union

SomeSubstitutionsType: TypeAlias = Union[str, Path, "Substitution", Iterable["SomeSubstitutionsType"]]
Entities: TypeAlias = Union["LaunchDescriptionEntity", Iterable["LaunchDescriptionEntity"]]
Reaction: TypeAlias = Entities | Callable[[Any, "LaunchContext"], Entities | None] | None


class Event:
    """An event of a launch."""


class Runner(Protocol):
    """The program that runs a launch, as its actions know it."""

    def start(self, action: "Action", package: str, executable: str, words: Iterable[str]) -> None:
        """Start an executable."""

    def later(self, seconds: float, entities: Entities) -> None:
        """Visit entities after so much robot time [s]."""

    def emit(self, event: Event) -> None:
        """Pass an event to the event handlers."""

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line of the launch's own log."""


class LaunchContext:
    """The state of a launch: the values of arguments, the event handlers, the file that is read."""

    def __init__(self, runner: Any = None, *, file: str = "") -> None:
        self.launch_configurations: dict[str, Any] = {}
        self.handlers: list[BaseEventHandler] = []
        self.file = file
        self.runner: Runner = runner

    def perform_substitution(self, substitution: "Substitution") -> str:
        """Return the text of a substitution."""
        return substitution.perform(self)


class SubstitutionFailure(Exception):  # noqa: N818  # ROS's name
    """A substitution cannot be performed."""


class Substitution:
    """A text that is made when the launch runs."""

    def __init__(self, make: Callable[[LaunchContext], str]) -> None:
        self._make = make

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        return self._make(context)


def text_of(context: LaunchContext, parts: SomeSubstitutionsType) -> str:
    """Return the text of one part, or of several joined; strings are themselves."""
    if isinstance(parts, Substitution):
        return parts.perform(context)
    if isinstance(parts, str | Path):
        return str(parts)
    return "".join(text_of(context, part) for part in parts)


class Condition:
    """A predicate that is evaluated when the action is visited."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the action is done."""
        return self._predicate(context)


class LaunchDescriptionEntity:
    """A part of a description."""

    def visit(self, context: LaunchContext) -> Entities | None:
        """Carry the part out; returns the entities to be visited next."""
        raise NotImplementedError(type(self).__name__)


class Action(LaunchDescriptionEntity):
    """An action, done unless its condition is false; `do` returns the entities to be visited next."""

    def __init__(
        self, do: Callable[[LaunchContext], Entities | None], *, condition: Condition | None = None
    ) -> None:
        self._do, self._condition = do, condition

    def visit(self, context: LaunchContext) -> Entities | None:
        """Do the action, unless its condition is false."""
        if self._condition is None or self._condition.evaluate(context):
            return self._do(context)
        return None


class LaunchDescription(LaunchDescriptionEntity):
    """A description of a launch: entities in their order."""

    def __init__(self, initial_entities: Iterable[LaunchDescriptionEntity] | None = None) -> None:
        self.entities = listed(initial_entities)

    def visit(self, context: LaunchContext) -> Entities:
        """Return the entities."""
        return self.entities

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Append an action."""
        self.entities.append(action)

    add_entity = add_action


class BaseEventHandler:
    """A reaction to the events that `matcher` chooses; it may be a function of event and context."""

    def __init__(
        self, *, matcher: Callable[[Event], bool], entities: Reaction = None, handle_once: bool = False
    ) -> None:
        self.matches = matcher
        self.handle_once = handle_once
        self._entities = entities

    def handle(self, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Return the entities to be visited now."""
        return listed(self._entities(event, context) if callable(self._entities) else self._entities)


def listed(entities: Entities | None) -> list[LaunchDescriptionEntity]:
    """Return one entity, several or none as a list."""
    if entities is None:
        return []
    return [entities] if isinstance(entities, LaunchDescriptionEntity) else list(entities)
