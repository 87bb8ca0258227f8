"""Building blocks of launch descriptions: substitutions, conditions, actions, events, context."""

import os
import sys
from collections.abc import Callable, Iterable, MutableMapping
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType, SimpleNamespace
from typing import Any, Protocol, TypeAlias, Union

from course_lib.errors import CourseError
from course_lib.ros.student_code import KIT, is_student_file

SomeSubstitutionsType: TypeAlias = Union[str, Path, "Substitution", Iterable["SomeSubstitutionsType"]]
SomeEntitiesType: TypeAlias = Union["LaunchDescriptionEntity", Iterable["LaunchDescriptionEntity"]]
Entities = SomeEntitiesType
SHIPPED = os.path.join(KIT, "ros", "share", "")
Reaction: TypeAlias = Entities | Callable[[Any, "LaunchContext"], Entities | None] | None


class InvalidLaunchFileError(CourseError):
    """A file is not a valid launch file."""


class Event:
    """An event of a launch."""


@dataclass(kw_only=True)
class ExecutionComplete(Event):
    """The completion of an action: the exit of its process, or the return of `execute` without one."""

    action: "Action"


class Runner(Protocol):
    """The interface that actions use to the program that runs the launch."""

    def start(
        self,
        action: "Action",
        package: str,
        executable: str,
        arguments: Iterable[str],
    ) -> None:
        """Start an executable."""

    def has_executable(self, package: str, executable: str) -> bool:
        """Return whether the executable is provided by the kit itself."""
        ...

    def start_file(self, action: "Action", file: Path, arguments: Iterable[str]) -> None:
        """Start a Python program by its path."""

    def start_component(
        self,
        action: "Action",
        package: str,
        plugin: str,
        arguments: Iterable[str],
    ) -> bool:
        """Start a component that is written in Python. Return whether it was started."""

    def start_function(
        self, action: "Action", name: str, function: Callable[[], object], arguments: Iterable[str]
    ) -> None:
        """Start a function as a process with command-line arguments."""

    def later(self, seconds: float, entities: Entities) -> None:
        """Visit entities after `seconds` of robot time [s]."""

    def emit(self, event: Event) -> None:
        """Pass an event to the event handlers."""

    def log(self, level: str, name: str, text: str) -> None:
        """Write a line to the log of the launch itself."""


class LaunchContext:
    """The state of a launch: launch configurations, event handlers and the current launch file.

    `locals` has the `event` that is being handled. `kept` has the stacks of states that Push…
    actions save, by kind. The program that runs the launch sets `runner` and `file`.
    """

    # A launch that only performs substitutions has no runner.
    runner: Runner = None  # type: ignore[assignment]
    file = ""

    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False) -> None:
        self.argv, self.noninteractive = argv if argv is not None else [], noninteractive
        self.launch_configurations: dict[str, Any] = {}
        self.handlers: list[BaseEventHandler] = []
        self.locals = SimpleNamespace()
        self.kept: dict[str, list[dict[str, Any]]] = {}
        self.environment_at_start = dict(os.environ)

    @property
    def environment(self) -> MutableMapping[str, str]:
        """The variables of the environment."""
        return os.environ

    def register_event_handler(self, event_handler: "BaseEventHandler", append: bool = False) -> None:
        """Add a handler, which is called before the others, or after them with `append`."""
        self.handlers.insert(len(self.handlers) if append else 0, event_handler)

    def unregister_event_handler(self, event_handler: "BaseEventHandler") -> None:
        """Remove a handler. Raise ValueError if it was not registered."""
        self.handlers.remove(event_handler)

    def complete(self, action: "Action") -> None:
        """Emit the completion of an action if a handler waits for it."""
        event = ExecutionComplete(action=action)
        if any(handler.matches(event) for handler in self.handlers):
            self.runner.emit(event)

    def perform_substitution(self, substitution: "Substitution") -> str:
        """Return the text of a substitution."""
        return substitution.perform(self)


class SubstitutionFailure(RuntimeError):  # noqa: N818  # ROS's name
    """A substitution cannot be performed."""


class Substitution:
    """A string that is computed while the launch runs.

    Either `make` computes it, or the `perform` method of a subclass.
    """

    def __init__(self, make: Callable[[LaunchContext], str] | None = None) -> None:
        self._make = make

    def perform(self, context: LaunchContext) -> str:
        """Compute the string."""
        if self._make is None:
            raise NotImplementedError(f"{type(self).__name__}.perform(context)")
        return self._make(context)


def text_of(context: LaunchContext, parts: SomeSubstitutionsType) -> str:
    """Perform one substitution, or join the results of several. Strings are returned unchanged."""
    if isinstance(parts, Substitution):
        return parts.perform(context)
    if isinstance(parts, str | Path):
        return str(parts)
    if not isinstance(parts, Iterable):
        # The message begins like the one of ROS.
        kind = type(parts).__name__
        is_value = isinstance(parts, bool | int | float)
        in_quotes = f"; write it in quotes, '{str(parts).lower()}'" if is_value else ""
        raise TypeError(
            f"'{kind}' object is not iterable: expected a string or a substitution, not {parts!r}{in_quotes}"
        )
    return "".join(text_of(context, part) for part in parts)


class Condition:
    """A predicate that is evaluated when its action is visited."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the action is executed."""
        return self._predicate is not None and self._predicate(context)


class LaunchDescriptionEntity:
    """A part of a launch description."""

    def visit(self, context: LaunchContext) -> Entities | None:
        """Execute the entity and return the entities to visit next."""
        raise NotImplementedError(type(self).__name__)


class Action(LaunchDescriptionEntity):
    """An action, executed unless its condition is false.

    Either `do` executes it, or the `execute` method of a subclass. Both return the entities to
    visit next.
    """

    # Whether the action is still running after `execute` returns.
    is_asynchronous = False
    # The name, pid and cmd of its last process, or None.
    process_details: dict[str, Any] | None = None

    def __init__(
        self,
        do: Callable[[LaunchContext], Entities | None] | None = None,
        *,
        condition: Condition | None = None,
    ) -> None:
        self._do, self.condition = do, condition
        # The (file, line) of the launch file that creates the action, for error messages.
        self._course_location = _location_in_launch_file()

    def visit(self, context: LaunchContext) -> Entities | None:
        """Execute the action unless its condition is false."""
        if self.condition is not None and not hasattr(self.condition, "evaluate"):
            # The message begins like the one of ROS.
            raise AttributeError(
                f"'{type(self.condition).__name__}' object has no attribute 'evaluate': condition "
                f"takes a condition such as IfCondition(…), not {self.condition!r:.60}"
            )
        if self.condition is not None and not self.condition.evaluate(context):
            return None
        entities = self.execute(context)
        if not self.is_asynchronous:
            context.complete(self)
        return entities

    def execute(self, context: LaunchContext) -> Entities | None:
        """Execute the action and return the entities to visit next."""
        return None if self._do is None else self._do(context)


@dataclass(eq=False, repr=False)
class DataAction(Action):
    """An action with its arguments as fields. A subclass has the method `execute`."""

    condition: Condition | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        super().__init__(condition=self.condition)


def _location_in_launch_file() -> tuple[str, int] | None:
    """Return the innermost call site in a launch file, or None.

    That is code outside of the kit, Python and its libraries, or a launch file that the kit ships.
    """
    frame: FrameType | None = sys._getframe(2)
    while frame is not None:
        name = frame.f_code.co_filename
        # Constructors of dataclasses have this name in place of a file.
        if name != "<string>" and (name.startswith(SHIPPED) or is_student_file(name)):
            return name, frame.f_lineno
        frame = frame.f_back
    return None


class LaunchDescription(LaunchDescriptionEntity):
    """A launch description: a sequence of entities."""

    def __init__(
        self,
        initial_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self.entities = require_entity_list("LaunchDescription", initial_entities)
        self.deprecated_reason = deprecated_reason
        self._course_location = _location_in_launch_file()

    def visit(self, context: LaunchContext) -> Entities:
        """Return the entities. Log a warning if the description is deprecated."""
        if self.deprecated_reason is not None:
            text = f"launch file [{context.file}] is deprecated: {self.deprecated_reason}"
            context.runner.log("WARNING", "launch", text)
        return self.entities

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Append an entity."""
        self.entities.append(entity)

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Append an action."""
        self.entities.append(action)


class BaseEventHandler:
    """Visits entities at events that `matcher` accepts.

    The entities may be a function of event and context.
    """

    def __init__(
        self,
        *,
        matcher: Callable[[Event], bool],
        entities: Reaction = None,
        handle_once: bool = False,
    ) -> None:
        self.matches = matcher
        self.handle_once = handle_once
        self._entities = entities

    def handle(self, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Return the entities to visit."""
        return as_entity_list(self._entities(event, context) if callable(self._entities) else self._entities)


def require_entity_list(
    name: str, entities: Iterable[LaunchDescriptionEntity] | None
) -> list[LaunchDescriptionEntity]:
    """Return entities that were passed to `name` as a list.

    Raise Python's TypeError for a single one.
    """
    if isinstance(entities, LaunchDescriptionEntity):
        kind = type(entities).__name__
        raise TypeError(f"'{kind}' object is not iterable: {name} takes a list, as in {name}([{kind}(…)])")
    return list(entities or ())


def as_entity_list(entities: Entities | None) -> list[LaunchDescriptionEntity]:
    """Return one entity, several or None as a list.

    A list is not copied: as in ROS, an action may add entities to the description that is visited.
    """
    if entities is None:
        return []
    if isinstance(entities, LaunchDescriptionEntity):
        return [entities]
    if not isinstance(entities, Iterable):
        kind = type(entities).__name__
        raise TypeError(
            f"'{kind}' object has no attribute 'visit': pass an action such as Shutdown(), or a list"
        )
    return entities if isinstance(entities, list) else list(entities)


class LaunchService:
    """A launch that a program starts. Not supported by the kit, which runs launch files only."""

    def __init__(self, *, argv: Iterable[str] | None = None, **options: Any) -> None:
        self.descriptions: list[LaunchDescription] = []

    def include_launch_description(self, launch_description: LaunchDescription) -> None:
        """Add a launch description."""
        self.descriptions.append(launch_description)

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Raise a CourseError that explains how to run the file instead."""
        raise CourseError(
            "LaunchService cannot run inside a program here. Return the LaunchDescription from "
            "generate_launch_description(), and run the file: course run FILE.launch.py"
        )


class LaunchIntrospector:
    """Formats launch descriptions as text."""

    def format_launch_description(self, launch_description: LaunchDescription) -> str:
        """Return the types of a description's entities as a tree."""
        kinds = [type(entity).__name__ for entity in launch_description.entities]
        marks = ["├──"] * (len(kinds) - 1) + ["└──"]
        return "\n".join(
            [f"{launch_description}", *(f"{mark} {kind}" for mark, kind in zip(marks, kinds, strict=False))]
        )
