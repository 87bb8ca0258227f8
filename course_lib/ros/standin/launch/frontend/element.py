"""The elements of XML and YAML launch files: what each stands for, and how its attributes are read."""

import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

from course_lib.errors import did_you_mean
from launch.conditions import IfCondition, UnlessCondition
from launch.entities import Action, Condition, InvalidLaunchFileError, LaunchDescription
from launch.frontend.entity import Entity, EntityError
from launch.frontend.grammar import Parts, parse_substitution, unescaped
from launch.frontend.reading import read_entity
from launch.substitutions import TextSubstitution

Reader: TypeAlias = Callable[[Entity, str], Any]  # of an attribute; None where it is not there
_OF_ROS_1 = {  # elements, and what stands for them
    "machine": "start the launch on each computer",
    "param": "it stands in a node, or it is set_parameter",
    "remap": "it stands in a node, or it is set_remap",
    "rosparam": "it is <param from=…/> in a node",
}
_EXTENSIONS = ("launch.frontend.elements", "launch_ros.frontend")  # ROS finds them by entry points


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """An XML or YAML file does not describe a launch; the text names the file and the line."""


@dataclass(frozen=True)
class Attribute:
    """An attribute, or elements of a tag: its name, how it is read, and the argument that it becomes."""

    name: str
    read: Reader
    argument: str = ""
    needed: bool = False


@dataclass(frozen=True)
class Element:
    """One element: what makes an action, or a part of one, of its attributes; it may have a condition."""

    make: Callable[..., Any]
    attributes: Sequence[Attribute] = ()
    conditional: bool = True


ELEMENTS: dict[str, Element] = {}  # of actions


def description_of(file: Path) -> LaunchDescription:
    """Return what an XML or YAML file describes; raises a CourseError with the line of a mistake."""
    for extension in _EXTENSIONS:
        import_module(extension)
    try:
        root = read_entity(file)
        if root.type_name != "launch":
            raise EntityError(root.line, f"the root is '{root.type_name}', expected 'launch'")
        reason = root.get("deprecated")
        description = LaunchDescription(inner_actions(root), deprecated_reason=reason)
        root.refuse_rest(["deprecated"])
    except EntityError as error:
        raise InvalidFrontendLaunchFileError(f"{file}, line {error.line}: {error}.") from error
    return description


def inner_actions(entity: Entity, but: str = "") -> list[Action]:
    """Return the actions that the elements in an entity stand for, without those of one tag."""
    return [_action(child) for child in entity.children if child.type_name != but]


def _action(entity: Entity) -> Action:
    element = ELEMENTS.get(entity.type_name)
    if element is None:
        raise entity.error(f"there is no such element{_other_element(entity.type_name)}")
    action = built(entity, element)
    assert isinstance(action, Action)
    return action


def _other_element(name: str) -> str:
    if name in _OF_ROS_1:
        return f" in ROS 2: {_OF_ROS_1[name]}"
    return did_you_mean(name, ELEMENTS) or f". There are: {', '.join(sorted(ELEMENTS))}"


def built(entity: Entity, element: Element) -> Any:
    """Return what an element stands for; raises an EntityError for any mistake in it."""
    try:
        arguments: dict[str, Any] = {}
        for attribute in element.attributes:
            value = attribute.read(entity, attribute.name)
            if value is not None:
                arguments[attribute.argument or attribute.name] = value
            elif attribute.needed:
                raise entity.error(f"it needs '{attribute.name}'{_of_ros_1(entity, attribute.name)}")
        if element.conditional and (condition := _condition(entity)) is not None:
            arguments["condition"] = condition
        names = {attribute.name for attribute in element.attributes if attribute.name}
        entity.refuse_rest(sorted(names | {"if", "unless"} if element.conditional else names))
        return element.make(**arguments)
    except EntityError:
        raise
    except (ValueError, RuntimeError, TypeError) as error:
        raise entity.error(str(error)) from error


def _of_ros_1(entity: Entity, name: str) -> str:
    is_old = name == "exec" and entity.get("type") is not None
    return ". This is a file of ROS 1: in ROS 2 the executable is exec, not type" if is_old else ""


def _condition(entity: Entity) -> Condition | None:
    chosen = {name: entity.get(name) for name in ("if", "unless")}
    if None not in chosen.values():
        raise entity.error("if and unless conditions can't be used simultaneously")
    if chosen["if"] is not None:
        return IfCondition(parse_substitution(chosen["if"]))
    return None if chosen["unless"] is None else UnlessCondition(parse_substitution(chosen["unless"]))


def text(entity: Entity, name: str) -> Parts | None:
    """Read text with substitutions."""
    value = entity.get(name)
    return None if value is None else parse_substitution(value)


def word(entity: Entity, name: str) -> str | None:
    """Read text without substitutions."""
    value = entity.get(name)
    return None if value is None else unescaped(value)


def of(kind: type) -> Reader:
    """Return the reader of a value of a kind, for which text with substitutions may stand."""

    def read(entity: Entity, name: str) -> Any:
        value = entity.get(name, kind)
        return parse_substitution(value) if isinstance(value, str) else value

    return read


def actions(entity: Entity, name: str) -> list[Action]:
    """Read the actions in an entity; elements of the tag `name` are others."""
    return inner_actions(entity, name)


def pairs(first: str, second: str) -> Reader:
    """Return the reader of elements with two attributes."""
    attributes = (Attribute(first, text, "one", True), Attribute(second, text, "other", True))
    return several(Element(lambda one, other: (tuple(one), other), attributes, conditional=False))


def mapping(entity: Entity, name: str) -> dict[Any, Any] | None:
    """Read elements with name and value."""
    found = pairs("name", "value")(entity, name)
    return None if found is None else dict(found)


def several(element: Element) -> Reader:
    """Return the reader of elements of a tag, as a list."""

    def read(entity: Entity, name: str) -> list[Any] | None:
        return [built(child, element) for child in entity.named(name)] or None

    return read


def on_exit(entity: Entity, name: str) -> Any:
    """Read the reaction to an end: `shutdown` is the only one."""
    value = entity.get(name)
    if value not in (None, "shutdown"):
        raise entity.error(f"{name} is '{value}', expected shutdown")
    return None if value is None else ELEMENTS["shutdown"].make()


def command_line(entity: Entity, name: str) -> list[Parts] | None:
    """Read a command line as its words; substitutions stay within one."""
    value = entity.get(name)
    if value is None:
        return None
    words: list[Parts] = []
    joins = False  # the next part to the last word
    for part in parse_substitution(value):
        if not isinstance(part, TextSubstitution):
            words = [*words[:-1], [*words[-1], part]] if joins else [*words, [part]]
            joins = True
            continue
        pieces = [TextSubstitution(text=piece) for piece in shlex.split(part.text)]
        if pieces and joins and not part.text[0].isspace():
            words[-1] = [*words[-1], pieces.pop(0)]
        words += [[piece] for piece in pieces]
        joins = not part.text[-1:].isspace()
    return words
