"""The parts of launch descriptions: substitutions, conditions, actions, events, and their context."""

import os
from collections.abc import Callable, Iterable, MutableMapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Protocol, TypeAlias, Union

from course_lib.errors import CourseError

SomeSubstitutionsType: TypeAlias = Union[str, Path, "Substitution", Iterable["SomeSubstitutionsType"]]
Entities: TypeAlias = Union["LaunchDescriptionEntity", Iterable["LaunchDescriptionEntity"]]
Reaction: TypeAlias = Entities | Callable[[Any, "LaunchContext"], Entities | None] | None


class InvalidLaunchFileError(CourseError):
    """A file does not describe a launch."""


class Event:
    """An event of a launch."""


@dataclass
class ExecutionComplete(Event):
    """The end of an action: of its process where it has one, else of what it does."""

    action: "Action"


class Runner(Protocol):
    """The program that runs a launch, as its actions know it."""

    def start(self, action: "Action", package: str, executable: str, words: Iterable[str]) -> None:
        """Start an executable."""

    def start_file(self, action: "Action", file: Path, words: Iterable[str]) -> None:
        """Start a Python program by its path."""

    def start_component(self, action: "Action", package: str, plugin: str, words: Iterable[str]) -> None:
        """Start a component that is in Python."""

    def start_function(
        self, action: "Action", name: str, function: Callable[[], object], words: Iterable[str]
    ) -> None:
        """Start a function as a process; the words are its command line."""

    def later(self, seconds: float, entities: Entities) -> None:
        """Visit entities after so much robot time [s]."""

    def emit(self, event: Event) -> None:
        """Pass an event to the event handlers."""

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line of the launch's own log."""


class LaunchContext:
    """The state of a launch: the values of arguments, the event handlers, the file that is read.

    `locals` has the `event` that is handled; `kept` are states that Push… actions keep, by their kind.
    """

    def __init__(self, runner: Any = None, *, file: str = "") -> None:
        self.launch_configurations: dict[str, Any] = {}
        self.handlers: list[BaseEventHandler] = []
        self.locals = SimpleNamespace()
        self.kept: dict[str, list[dict[str, Any]]] = {}
        self.environment_at_start = dict(os.environ)
        self.file = file
        self.runner: Runner = runner

    @property
    def environment(self) -> MutableMapping[str, str]:
        """The variables of the environment."""
        return os.environ

    def register_event_handler(self, event_handler: "BaseEventHandler") -> None:
        """Add a handler; as in ROS the newest one comes first."""
        self.handlers.insert(0, event_handler)

    def unregister_event_handler(self, event_handler: "BaseEventHandler") -> None:
        """Remove a handler; raises ValueError if it was not registered."""
        self.handlers.remove(event_handler)

    def complete(self, action: "Action") -> None:
        """Emit the end of an action, where a handler waits for it."""
        event = ExecutionComplete(action)
        if any(handler.matches(event) for handler in self.handlers):
            self.runner.emit(event)

    def perform_substitution(self, substitution: "Substitution") -> str:
        """Return the text of a substitution."""
        return substitution.perform(self)


class SubstitutionFailure(RuntimeError):  # noqa: N818  # ROS's name
    """A substitution cannot be performed."""


class Substitution:
    """A text that is made when the launch runs: by `make`, or by the `perform` of a class of your own."""

    def __init__(self, make: Callable[[LaunchContext], str] | None = None) -> None:
        self._make = make

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        if self._make is None:
            raise NotImplementedError(f"{type(self).__name__}.perform(context)")
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
    """An action, done unless its condition is false: by `do`, or by the `execute` of a class of your own.

    Both return the entities to be visited next.
    """

    goes_on = False  # after `execute`; else it is complete then

    def __init__(
        self,
        do: Callable[[LaunchContext], Entities | None] | None = None,
        *,
        condition: Condition | None = None,
    ) -> None:
        self._do, self.condition = do, condition

    def visit(self, context: LaunchContext) -> Entities | None:
        """Do the action, unless its condition is false."""
        if self.condition is not None and not self.condition.evaluate(context):
            return None
        entities = self.execute(context)
        if not self.goes_on:
            context.complete(self)
        return entities

    def execute(self, context: LaunchContext) -> Entities | None:
        """Do the action."""
        return None if self._do is None else self._do(context)


class LaunchDescription(LaunchDescriptionEntity):
    """A description of a launch: entities in their order."""

    def __init__(
        self,
        initial_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self.entities = listed(initial_entities)
        self.deprecated_reason = deprecated_reason

    def visit(self, context: LaunchContext) -> Entities:
        """Return the entities; logs the reason not to use the description any more, if it has one."""
        if self.deprecated_reason is not None:
            text = f"launch file [{context.file}] is deprecated: {self.deprecated_reason}"
            context.runner.log("WARNING", "launch", text)
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
