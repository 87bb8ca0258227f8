"""Elements of XML and YAML launch files, with their attributes and child elements."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias
from xml.parsers import expat

import yaml

from course_lib.errors import did_you_mean
from course_lib.third_party import read_bytes

_WORDS: dict[type | None, str] = {
    str: "text; put quotes around it",
    bool: "true or false",
    int: "a whole number",
    float: "a number with a point, like 2.0",
    None: "text, a number, true, false or a list",
}


class EntityError(ValueError):
    """An error in a launch file, with its line."""

    def __init__(self, line: int, text: str) -> None:
        super().__init__(text)
        self.line = line


class _Element:
    """An element with the tag `type_name`, in XML or YAML.

    It records which attributes and children are read, because all others are errors.
    """

    def __init__(self, type_name: str, line: int) -> None:
        self.type_name, self.line = type_name, line
        self._asked: set[str] = set()

    def error(self, text: str) -> EntityError:
        """Create an error for this element."""
        return EntityError(self.line, f"<{self.type_name}>: {text}")

    def _type_error(self, name: str, kind: type | None, value: object) -> EntityError:
        return self.error(f"{name} is {value!r}, expected {_WORDS[kind]}")


class XmlEntity(_Element):
    """An XML element. Its attributes are strings, which are converted to the requested type."""

    def __init__(self, type_name: str, line: int, attributes: dict[str, str]) -> None:
        super().__init__(type_name, line)
        self.attributes = attributes
        self.elements: list[XmlEntity] = []

    @property
    def children(self) -> "Sequence[XmlEntity]":
        """The child elements."""
        self._asked |= {element.type_name for element in self.elements}
        return self.elements

    def named(self, name: str) -> "Sequence[XmlEntity]":
        """Return the child elements with a tag."""
        self._asked.add(name)
        return [element for element in self.elements if element.type_name == name]

    def get(self, name: str, kind: type | None = str) -> Any:
        """Return an attribute as the requested type; as a list if `name-sep` gives a separator.

        A string with substitutions is returned unchanged, and None if there is no such attribute.
        """
        self._asked |= {name, f"{name}-sep"}
        text = self.attributes.get(name)
        if text is None:
            return None
        separator = self.attributes.get(f"{name}-sep")
        if separator:
            return [self._value(name, part, kind) for part in text.split(separator)]
        return self._value(name, text, kind)

    def _value(self, name: str, text: str, kind: type | None) -> Any:
        if kind is str or not text or "$(" in text:
            return text
        if kind is bool:
            text = {"0": "false", "1": "true"}.get(text, text)
        try:
            value = yaml.safe_load(text)
        except yaml.YAMLError:
            return text
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            return float(value)
        if not _is_valid_value(value, kind):
            raise self._type_error(name, kind, text)
        return value

    def reject_rest(self, known: Sequence[str]) -> None:
        """Raise an EntityError for an attribute or child element that has not been read."""
        for name in self.attributes:
            if name not in self._asked:
                raise self.error(_unexpected_message("attribute", name, known))
        for element in self.elements:
            if element.type_name not in self._asked:
                raise element.error(f"it is not expected in <{self.type_name}>")


class YamlEntity(_Element):
    """A YAML element: a mapping or a list of elements. Its values already have types."""

    def __init__(self, type_name: str, line: int, value: Any, lines: dict[int, int]) -> None:
        super().__init__(type_name, line)
        self._value, self._lines = value, lines

    @property
    def children(self) -> "Sequence[YamlEntity]":
        """The child elements: the element's own list, or the list below its key `children`."""
        self._asked.add("children")
        inner = self._value.get("children") if isinstance(self._value, dict) else self._value
        if not isinstance(inner, list):
            raise self.error("expected a list of elements, or a mapping with a list below `children:`")
        children = []
        for value in inner:
            line = self._lines.get(id(value), self.line)
            if not isinstance(value, dict) or len(value) != 1:
                raise EntityError(
                    line,
                    f"{str(value)[:60]} in <{self.type_name}>: expected one element, as in "
                    "`- node: {pkg: turtlesim, exec: turtlesim_node}`",
                )
            [(name, content)] = value.items()
            children.append(YamlEntity(str(name), line, content, self._lines))
        return children

    def named(self, name: str) -> "Sequence[YamlEntity]":
        """Return the mappings in the list of a key."""
        items = self._mapping().get(name)
        self._asked.add(name)
        if items is None:
            return []
        if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
            raise self.error(f"{name} is {str(items)[:60]}, expected a list of mappings")
        return [YamlEntity(name, self._lines.get(id(item), self.line), item, self._lines) for item in items]

    def get(self, name: str, kind: type | None = str) -> Any:
        """Return the value of a key, which may be a string with substitutions; None without the key."""
        self._asked.add(name)
        value = self._mapping().get(name)
        if value is not None and not isinstance(value, str) and not _is_valid_value(value, kind):
            raise self._type_error(name, kind, value)
        return value

    def _mapping(self) -> dict[str, Any]:
        if isinstance(self._value, list | None):
            return {}
        if not isinstance(self._value, dict):
            raise self.error(f"it is {self._value!r}, expected `key: value` lines")
        return self._value

    def reject_rest(self, known: Sequence[str]) -> None:
        """Raise an EntityError for a key that has not been read."""
        for name in self._value if isinstance(self._value, dict) else ():
            if name not in self._asked:
                raise self.error(_unexpected_message("key", str(name), known))


# An element of a launch file. Both classes have the same methods.
Entity: TypeAlias = XmlEntity | YamlEntity


def _is_valid_value(value: object, kind: type | None) -> bool:
    if kind is None:
        return isinstance(value, str | bool | int | float | list)
    return isinstance(value, kind) and not (kind is int and isinstance(value, bool))


# Names in Python's launch files, with the names in XML and YAML files.
NAMES_IN_PYTHON = {
    "package": "pkg",
    "executable": "exec",
    "arguments": "args",
    "parameters": "param",
    "remappings": "remap",
}


def _unexpected_message(kind: str, name: str, known_names: Sequence[str]) -> str:
    if name == "ns":
        return f"unexpected {kind} 'ns'. In ROS 2 write <push-ros-namespace namespace=\"…\"/> in a group"
    if name == "doc" and "description" in known_names:
        return f"unexpected {kind} 'doc'. This is a file of ROS 1: in ROS 2 it is description"
    if NAMES_IN_PYTHON.get(name) in known_names:
        return f"unexpected {kind} {name!r}. Here it is {NAMES_IN_PYTHON[name]}, and not {name} as in Python"
    there = f" It has: {', '.join(sorted(known_names))}." if known_names else ""
    return f"unexpected {kind} '{name}'{did_you_mean(name, known_names) or '.'}{there}"


# Limit on the size of a file [bytes].
_LARGEST = 4 * 2**20
# Limit on the nesting of elements.
_MAX_DEPTH = 50
# Limit on the number of values of a YAML file, counted again for each alias.
_MAX_VALUES = 50_000


def read_entity(file: Path) -> Entity:
    """Return the root of a launch file.

    Raises:
        EntityError: The file is not valid.
        OSError: The file cannot be read.
    """
    data = read_bytes(file)
    if len(data) > _LARGEST:
        raise EntityError(1, f"it has {len(data)} bytes, more than a launch file can have ({_LARGEST})")
    is_yaml = file.suffix in (".yaml", ".yml") or (file.suffix != ".xml" and data.lstrip()[:1] != b"<")
    return _yaml_root(data) if is_yaml else _XmlReader().root_of(data)


class _XmlReader:
    """Builds entities from the events of the expat parser."""

    def __init__(self) -> None:
        self._open: list[XmlEntity] = []
        self._root: XmlEntity | None = None
        self._parser = expat.ParserCreate()
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.EntityDeclHandler = self._reject_entity

    def root_of(self, data: bytes) -> Entity:
        """Parse the data and return the root element."""
        try:
            self._parser.Parse(data, True)
        except expat.ExpatError as error:
            raise EntityError(error.lineno, f"not XML: {expat.ErrorString(error.code)}") from error
        # expat raises an error for a file without elements.
        assert self._root is not None
        return self._root

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        element = XmlEntity(name, self._parser.CurrentLineNumber, attributes)
        if self._open:
            self._open[-1].elements.append(element)
        else:
            self._root = element
        self._open.append(element)
        if len(self._open) > _MAX_DEPTH:
            raise element.error(f"more than {_MAX_DEPTH} elements are nested")

    def _end(self, name: str) -> None:
        self._open.pop()

    def _reject_entity(self, name: str, *rest: object) -> None:
        line = self._parser.CurrentLineNumber
        raise EntityError(line, f"the file declares the entity '{name}', which launch files do not need")


# PyYAML has no type information.
class _Loader(yaml.SafeLoader):  # type: ignore[misc]
    """Records the line of each mapping."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        # Line numbers by the id() of the mapping.
        self.lines: dict[int, int] = {}

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """Construct the value of a node and record its line."""
        value = super().construct_object(node, deep)
        if isinstance(node, yaml.MappingNode):
            self.lines[id(value)] = node.start_mark.line + 1
        return value


def _yaml_root(data: bytes) -> Entity:
    try:
        loader = _Loader(data)
        node = loader.get_single_node()
        if node is None or not isinstance(node, yaml.MappingNode) or len(node.value) != 1:
            raise EntityError(1, "expected one key, `launch:`, with a list of elements")
        _check_size(node)
        [(name, value)] = loader.construct_document(node).items()
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        # The data that precede a character which YAML does not allow.
        before = data[: getattr(error, "position", 0)]
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        line = mark.line if mark else before.count(b"\n")
        raise EntityError(line + 1, f"not YAML: {problem}") from error
    except RecursionError as error:
        raise EntityError(1, f"more than {_MAX_DEPTH} elements are nested") from error
    return YamlEntity(str(name), node.start_mark.line + 1, value, loader.lines)


def _check_size(root: Any) -> None:
    """Raise an EntityError if a file with expanded aliases is too large or too deeply nested."""
    waiting, count = [(root, 1)], 0
    while waiting:
        node, depth = waiting.pop()
        count += 1
        if depth > 2 * _MAX_DEPTH or count > _MAX_VALUES:
            excess = (
                f"more than {_MAX_VALUES} values"
                if count > _MAX_VALUES
                else f"more than {_MAX_DEPTH} nested elements"
            )
            raise EntityError(node.start_mark.line + 1, f"{excess}, with all aliases followed")
        if isinstance(node, yaml.SequenceNode):
            waiting += [(child, depth + 1) for child in node.value]
        elif isinstance(node, yaml.MappingNode):
            waiting += [(child, depth + 1) for pair in node.value for child in pair]
