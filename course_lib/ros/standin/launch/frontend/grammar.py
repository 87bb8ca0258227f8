"""XML and YAML launch files: the grammar of `$(name argument 'another argument')`, and their elements.

Each element has an action that it creates, and readers of its attributes.
"""

import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn, TypeAlias, cast

from course_lib.errors import did_you_mean
from course_lib.ros.programs.packages import NotAvailableError, not_found_reason
from launch.conditions import IfCondition, UnlessCondition
from launch.entities import (
    Action,
    Condition,
    InvalidLaunchFileError,
    LaunchContext,
    LaunchDescription,
    Substitution,
)
from launch.frontend.entity import NAMES_IN_PYTHON, Entity, EntityError, read_entity
from launch.substitutions import TextSubstitution

Parts = list[Substitution]
# Limit on the nesting of substitutions.
_DEEPEST = 50
_NAME = re.compile(r"[A-Za-z][\w-]*")
# By the surrounding quote: the pattern of plain text there, and in an unquoted argument.
_STRING = {quote: re.compile(rf"(?:\\.|[^$\\{quote}]|\\|\$(?!\())+", re.DOTALL) for quote in ("", "'", '"')}
_WORD = {
    "": re.compile(r"(?:\\[()$'\"\\]|\\|[^ '\"\\$()]|\$(?!\())+"),
    "'": re.compile(r"(?:\\[()$'\\]|\\|[^ '\\$()]|\$(?!\())+"),
    '"': re.compile(r"(?:\\[()$\"\\]|\\|[^ \"\\$()]|\$(?!\())+"),
}
_SUBSTITUTIONS_OF_ROS_1 = {"arg": "var", "find": "find-pkg-share", "optenv": "env"}


@dataclass(frozen=True)
class Form:
    """A substitution of launch files: the function that creates it, and its numbers of arguments."""

    make: Callable[..., Substitution]
    least: int = 0
    most: int | None = 0


SUBSTITUTIONS: dict[str, Form] = {}


def register_elements() -> None:
    """Register all elements and substitutions. Their module imports this one."""
    import_module("launch.frontend.elements")


def parse_substitution(string_value: str) -> Parts:
    """Parse a string with `$(…)`. Raise a ValueError that shows the position of an error."""
    if "$(" in string_value:
        # A Python launch file does not register them, but its parameter files may need them.
        register_elements()
    if not string_value:
        return [TextSubstitution(text="")]
    reader = _Reader(string_value)
    parts = reader.read_parts(_STRING, "")
    if reader.at < len(string_value):
        reader.fail("the end")
    return parts


def expose_substitution(name: str) -> Callable[[Any], Any]:
    """Return a decorator that registers a class, or a function that parses its arguments.

    In launch files and parameter files that are read later, `$(name …)` is that substitution.
    """

    def register(exposed: Any) -> Any:
        parse = getattr(exposed, "parse", exposed)

        def make(*arguments: Parts) -> Substitution:
            substitution, parameters = parse(list(arguments))
            return cast(Substitution, substitution(**parameters))

        SUBSTITUTIONS[name] = Form(make, 0, None)
        return exposed

    return register


def unescape(text: str) -> str:
    r"""Replace escaped characters such as `\(` with the characters themselves."""
    return re.sub(r"\\(.)", r"\1", text)


class _Reader:
    """Parses a string from position `at`."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self._depth = 0

    def fail(self, expected: str) -> NoReturn:
        """Raise a ValueError for the current position."""
        excerpt = self.text[self.at : self.at + 20]
        found_text = f"found {excerpt!r}" if excerpt else "the text ends"
        raise ValueError(f"{self.text!r}, character {self.at + 1}: expected {expected}, {found_text}")

    def read_parts(self, patterns: Mapping[str, re.Pattern[str]], quote: str) -> Parts:
        """Parse substitutions and the text that `patterns` accepts inside of this quote."""
        parts: Parts = []
        while True:
            if self.text.startswith("$(", self.at):
                parts.append(self._substitution(quote))
            elif match := patterns[quote].match(self.text, self.at):
                self.at = match.end()
                parts.append(TextSubstitution(text=unescape(match[0])))
            else:
                return parts

    def _substitution(self, quote: str) -> Substitution:
        begin = self.at
        self.at += 2
        name = _NAME.match(self.text, self.at)
        if name is None:
            self.fail("the name of a substitution, as in $(var x)")
        self.at = name.end()
        arguments: list[Parts] = []
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ValueError(f"more than {_DEEPEST} substitutions are nested in {self.text[:40]!r}…")
        while self._skip(" "):
            arguments.append(self._argument(quote))
        self._depth -= 1
        if not self._skip(")"):
            self.fail("')', or one space and an argument; put quotes around one with spaces")
        return _make_substitution(name[0], arguments, self.text[begin : self.at])

    def _argument(self, quote: str) -> Parts:
        opening = self.text[self.at : self.at + 1]
        if not quote and opening and opening in "'\"":
            self.at += 1
            parts = self.read_parts(_STRING, opening)
            if not self._skip(opening):
                self.fail(f"the quote {opening} that ends the argument")
            return parts
        parts = self.read_parts(_WORD, quote)
        if not parts:
            self.fail("an argument; between two there is one space")
        return parts

    def _skip(self, character: str) -> bool:
        is_next = self.text.startswith(character, self.at)
        self.at += is_next
        return is_next


def _make_substitution(name: str, arguments: Sequence[Parts], text: str) -> Substitution:
    form = SUBSTITUTIONS.get(name)
    if form is None:
        names = [*SUBSTITUTIONS]
        hint = did_you_mean(name, names) or f". There are: {', '.join(sorted(names))}"
        if name in _SUBSTITUTIONS_OF_ROS_1:
            hint = f". In ROS 2 write $({_SUBSTITUTIONS_OF_ROS_1[name]} …)"
        raise ValueError(f"{text}: there is no substitution '{name}'{hint}")
    if len(arguments) < form.least or (form.most is not None and len(arguments) > form.most):
        max_text = "more" if form.most is None else form.most
        expected = form.least if form.least == form.most else f"{form.least} to {max_text}"
        raise ValueError(
            f"{text}: {name} has {len(arguments)} arguments, expected {expected}. Arguments with "
            "spaces stand in quotes"
        )
    return form.make(*arguments)


# Reads an attribute of an entity; None if it is missing.
Reader: TypeAlias = Callable[[Entity, str], Any]
# Elements of ROS 1, with their replacements in ROS 2.
_ELEMENTS_OF_ROS_1 = {
    "machine": "start the launch on each computer",
    "param": "it stands in a node, or it is set_parameter",
    "remap": "it stands in a node, or it is set_remap",
    "rosparam": "it is <param from=…/> in a node",
}
# Elements of simulator packages, which cannot run here.
_OF_SIMULATOR = {"ros_gz_bridge": "ros_gz_bridge", "gz_server": "ros_gz_sim", "gz_spawn_model": "ros_gz_sim"}


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """An XML or YAML file is not a valid launch file. The message has the file and the line."""


@dataclass(frozen=True)
class Attribute:
    """An attribute or child tag of an element: name, reader, and the argument that it becomes."""

    name: str
    read: Reader
    argument: str = ""
    needed: bool = False


@dataclass(frozen=True)
class Element:
    """An element: the function that creates an action or part of one, and the attributes."""

    make: Callable[..., Any]
    attributes: Sequence[Attribute] = ()
    conditional: bool = True


# The elements that create actions, by tag.
ELEMENTS: dict[str, Element] = {}
# The file that is being read, which actions store for error messages.
_file: ContextVar[Path] = ContextVar("file", default=Path())


def description_of(file: Path) -> LaunchDescription:
    """Parse an XML or YAML launch file. Raise a CourseError with the line of an error."""
    register_elements()
    try:
        root = read_entity(file)
        if root.type_name != "launch":
            raise EntityError(root.line, f"the root is '{root.type_name}', expected 'launch'")
        reason = root.get("deprecated")
        token = _file.set(file)
        try:
            description = LaunchDescription(actions(root), deprecated_reason=reason)
        finally:
            _file.reset(token)
        # As in ROS, other attributes of the root are ignored:
        # many files have <launch version="0.1.1">.
    except EntityError as error:
        text = str(error) if str(error).endswith((".", "?")) else f"{error}."
        raise InvalidFrontendLaunchFileError(f"{file}, line {error.line}: {text}") from error
    return description


def actions(entity: Entity, name: str = "") -> list[Action]:
    """Read the child elements as actions, except elements with the tag `name`."""
    return [_action(child) for child in entity.children if child.type_name != name]


def _leave_out(reason: str, context: LaunchContext) -> NoReturn:
    raise NotAvailableError(reason)


def _action(entity: Entity) -> Action:
    element = ELEMENTS.get(entity.type_name)
    action: Action
    if element is not None:
        action = build_element(entity, element)
    elif entity.type_name in _OF_SIMULATOR:
        action = Action(partial(_leave_out, not_found_reason(_OF_SIMULATOR[entity.type_name])))
    else:
        name = entity.type_name
        is_of_ros_1 = name in _ELEMENTS_OF_ROS_1
        other = f" in ROS 2: {_ELEMENTS_OF_ROS_1[name]}" if is_of_ros_1 else did_you_mean(name, ELEMENTS)
        other = other or f". There are: {', '.join(sorted(ELEMENTS))}"
        raise entity.error(f"there is no such element{other}")
    assert isinstance(action, Action)
    action._course_location = (str(_file.get()), entity.line)
    return action


def build_element(entity: Entity, element: Element) -> Any:
    """Create the action or part that an element describes.

    Raise an EntityError if it is invalid.
    """
    try:
        arguments: dict[str, Any] = {}
        for attribute in element.attributes:
            value = attribute.read(entity, attribute.name)
            if value is not None:
                arguments[attribute.argument or attribute.name] = value
            elif attribute.needed:
                is_of_ros_1 = attribute.name == "exec" and entity.get("type") is not None
                more = ". This is a file of ROS 1: in ROS 2 the executable is exec, not type" * is_of_ros_1
                for in_python, name in NAMES_IN_PYTHON.items():
                    if name == attribute.name and entity.get(in_python) is not None:
                        more = f". Here it is {name}, and not {in_python} as in Python"
                raise entity.error(f"it needs '{attribute.name}'{more}")
        if element.conditional and (condition := _condition(entity)) is not None:
            arguments["condition"] = condition
        names = {attribute.name for attribute in element.attributes if attribute.name}
        entity.reject_rest(sorted(names | {"if", "unless"} if element.conditional else names))
        return element.make(**arguments)
    except EntityError:
        raise
    except (ValueError, RuntimeError, TypeError) as error:
        raise entity.error(str(error)) from error


def _condition(entity: Entity) -> Condition | None:
    conditions = {name: entity.get(name) for name in ("if", "unless")}
    if None not in conditions.values():
        raise entity.error("if and unless conditions can't be used simultaneously")
    if conditions["if"] is not None:
        return IfCondition(parse_substitution(conditions["if"]))
    return None if conditions["unless"] is None else UnlessCondition(parse_substitution(conditions["unless"]))


def text(entity: Entity, name: str) -> Parts | None:
    """Read an attribute as a string with substitutions."""
    value = entity.get(name)
    return None if value is None else parse_substitution(value)


def word(entity: Entity, name: str) -> str | None:
    """Read an attribute as a string without substitutions."""
    value = entity.get(name)
    return None if value is None else unescape(value)


def reader_of(kind: type) -> Reader:
    """Return a reader for values of a type, or for strings with substitutions in their place."""

    def read(entity: Entity, name: str) -> Any:
        value = entity.get(name, kind)
        return parse_substitution(value) if isinstance(value, str) else value

    return read


def pairs(first: str, second: str) -> Reader:
    """Return a reader for child elements with two attributes."""
    attributes = (Attribute(first, text, "first", True), Attribute(second, text, "second", True))
    return list_reader(Element(lambda first, second: (tuple(first), second), attributes, conditional=False))


def launch_arguments(entity: Entity, name: str) -> list[Any] | None:
    """Read an included file's arguments: `let` elements, or `arg` elements as in older files."""
    argument_pairs = [pair for tag in ("arg", "let") for pair in pairs("name", "value")(entity, tag) or ()]
    return argument_pairs or None


def mapping(entity: Entity, name: str) -> dict[Any, Any] | None:
    """Read child elements with a name and a value as a dictionary."""
    item_pairs = pairs("name", "value")(entity, name)
    return None if item_pairs is None else dict(item_pairs)


def list_reader(element: Element) -> Reader:
    """Return a reader for all child elements of a tag, as a list."""

    def read(entity: Entity, name: str) -> list[Any] | None:
        return [build_element(child, element) for child in entity.named(name)] or None

    return read


def on_exit(entity: Entity, name: str) -> Any:
    """Read the action at the exit of a process. `shutdown` is the only one."""
    value = entity.get(name)
    if value not in (None, "shutdown"):
        raise entity.error(f"{name} is '{value}', expected shutdown")
    return None if value is None else ELEMENTS["shutdown"].make()


def command_line(entity: Entity, name: str) -> list[Parts] | None:
    """Read a command line as a list of words. A substitution is never split."""
    value = entity.get(name)
    if value is None:
        return None
    arguments: list[Parts] = []
    # Whether the next part continues the last word.
    joins = False
    for part in parse_substitution(value):
        if not isinstance(part, TextSubstitution):
            arguments = [*arguments[:-1], [*arguments[-1], part]] if joins else [*arguments, [part]]
            joins = True
            continue
        pieces = [TextSubstitution(text=piece) for piece in shlex.split(part.text)]
        if pieces and joins and not part.text[0].isspace():
            arguments[-1] = [*arguments[-1], pieces.pop(0)]
        arguments += [[piece] for piece in pieces]
        joins = not part.text[-1:].isspace()
    return arguments
