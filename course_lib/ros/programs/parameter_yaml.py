"""Parameters in YAML, typed by rcl's rules: files of `--params-file`, and values of `-p`."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

# PyYAML has no type information.
import yaml

from course_lib import third_party

PARAMETERS = "ros__parameters"
# Limit on the nesting of collections.
DEEPEST = 50
_TRUE = {"Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}
_FALSE = {"N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"}
_INTEGER = re.compile(r"[+-]?(0[xX][0-9a-fA-F]+|[0-9]+)")
_STRING = "tag:yaml.org,2002:str"
# rcl uses libyaml, too, which accepts a tab before a comment.
_LOADER = getattr(yaml, "CLoader", yaml.Loader)
_RESOLVER = yaml.resolver.Resolver()
_TYPE_NAMES = {bool: "bool", int: "integer", float: "double", str: "string"}


def read_file(path: str) -> list[tuple[str, dict[str, Any]]]:
    """Read a parameter file as (node name pattern, values by parameter).

    Raises:
        ValueError: The file is not a parameter file; the text is rcl's.
    """
    try:
        return read_text(third_party.read_text(Path(path)))
    except OSError as error:
        raise ValueError(f"Error opening YAML file: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ValueError(f"Error parsing a event: {third_party.NOT_UTF8}") from error


def read_text(text: str) -> list[tuple[str, dict[str, Any]]]:
    """Parse a file's text as (node name pattern, values by parameter).

    A file without values is accepted. If there are several documents, the last one takes
    precedence.

    Raises:
        ValueError: The text is not a parameter file; the message is rcl's.
    """
    return [pair for document in _documents(text) for pair in _nodes(document, "")]


def read_value(text: str) -> Any:
    """Parse one value. Raise ValueError if a parameter cannot have it.

    Spaces or a comment do not count as a value: the parameter is not set, as in rcl.
    """
    documents = _documents(text)
    if not documents and text:
        return None
    return _value(documents[0] if documents else None)


def read_argument(text: str) -> Any:
    """Parse the value of `-p`. Unlike `read_value` it accepts lists in a list, as rcl does."""
    node = next(iter(_documents(text)), None)
    return _last_list(node, {}) if isinstance(node, yaml.SequenceNode) else read_value(text)


def _last_list(sequence: yaml.SequenceNode, values: dict[tuple[bool, type], Any]) -> Any:
    """Return the value of a list that may contain lists, as rcl reads it for `-p`.

    rcl begins a new list at each bracket that opens, and none is open behind one that closes. Of
    each type it keeps the last value, and returns the first of these types: bool, int, float, str.

    Args:
        sequence: The list.
        values: Receives the last values, by whether they are lists, and their type.
    """
    items: list[Any] | None = []
    for node in sequence.value:
        if isinstance(node, yaml.SequenceNode):
            _last_list(node, values)
            items = None
        elif items is None:
            value = _value(node)
            values[False, type(value)] = value
        else:
            items.append(node)
            part = yaml.SequenceNode(sequence.tag, items, sequence.start_mark)
            value = _value(part)
            values[True, type(value[0])] = value
    order = [(is_list, kind) for is_list in (False, True) for kind in _TYPE_NAMES]
    return next((values[key] for key in order if key in values), [])


def _documents(text: str) -> list[Any]:
    try:
        depth = 0
        for event in yaml.parse(text, Loader=_LOADER):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > DEEPEST:
                raise ValueError(f"It is nested too deeply at line {event.start_mark.line + 1}")
            if isinstance(event, yaml.AliasEvent):
                raise ValueError(f"Will not support aliasing at line {event.start_mark.line + 1}")
        return list(yaml.compose_all(text, Loader=_LOADER))
    except yaml.YAMLError as error:
        line = getattr(getattr(error, "problem_mark", None), "line", 0) + 1
        problem = getattr(error, "problem", None) or "not YAML"
        if re.match(" *\t", "".join(text.splitlines()[line - 1 : line])):
            problem = "found character '\\t' that cannot start any token"
        raise ValueError(f"Error parsing a event near line {line}: {problem}") from error


def _nodes(mapping: Any, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the names of nodes, which may be nested, with their parameters."""
    if not isinstance(mapping, yaml.MappingNode):
        line = mapping.start_mark.line + 1 if mapping else 1
        raise ValueError(f"Cannot have a value before {PARAMETERS} at line {line}")
    for position, (key, value) in enumerate(mapping.value):
        if key.value != PARAMETERS:
            name = str(key.value)
            is_separated = path.endswith("/") or (not path and name.startswith("/"))
            yield from _nodes(value, f"{path}{name}" if is_separated else f"{path}/{name}")
        elif not path:
            raise ValueError(f"There are no node names before {PARAMETERS} at line {key.start_mark.line + 1}")
        elif path.endswith("/"):
            raise ValueError("node name must not be empty")
        elif "//" in path:
            raise ValueError(f"{path[: path.rindex('/') + 1]} contains repeated forward slash")
        elif re.search(r"[^\w/*]|\w\*|\*\w", path, re.ASCII):
            raise ValueError("node name must not contain characters other than alphanumerics or '_'")
        else:
            if any(other.value == PARAMETERS for other, _ in mapping.value[:position]):
                line = key.start_mark.line + 1
                raise ValueError(f"There are no node names before {PARAMETERS} at line {line}")
            flattened = _Flattened()
            flattened.read(value)
            # Of a repeated name, the type decides which value is used, as if it were in two files.
            parameters: dict[str, Any] = {}
            for parameter, content in flattened.parameters:
                if parameter in parameters:
                    yield path, parameters
                    parameters = {}
                parameters[parameter] = content
            yield path, parameters


@dataclass
class _Flattened:
    """The parameters of one `ros__parameters`, read as by rcl, which fails at empty maps.

    It adds the name of a map to the names around it at the map's first key, and removes the last
    name at its end, even if it was empty.
    """

    parameters: list[tuple[str, Any]] = field(default_factory=list)
    # The full names of the maps around a key.
    _names: list[str] = field(default_factory=list)
    # The name of a map without a key so far.
    _new_map: str = ""
    # Whether an empty map has ended all of `ros__parameters`.
    _has_ended: bool = False

    def read(self, mapping: Any) -> None:
        """Add the parameters of a map."""
        if not isinstance(mapping, yaml.MappingNode):
            raise ValueError(f"No value at line {mapping.start_mark.line + 1}")
        for key, value in mapping.value:
            if self._has_ended:
                # Everything below is read as the names of nodes.
                if not isinstance(value, yaml.MappingNode):
                    line = key.start_mark.line + 1
                    raise ValueError(f"Cannot have a value before {PARAMETERS} at line {line}")
                self.read(value)
                continue
            if self._new_map:
                # A parameter of this name becomes the map.
                self.parameters = [pair for pair in self.parameters if pair[0] != self._new_map]
                self._names.append(self._new_map)
                self._new_map = ""
            self._add(f"{self._names[-1]}.{key.value}" if self._names else str(key.value), value)

    def _add(self, name: str, value: Any) -> None:
        inner = value
        # The only item of a list, or of nested lists with one item each.
        while isinstance(inner, yaml.SequenceNode):
            inner = inner.value[0] if len(inner.value) == 1 else None
        if isinstance(value, yaml.MappingNode):
            if not value.value:
                # rcl adds a parameter that is not set.
                self.parameters.append((name, None))
            self._new_map = name
            self.read(value)
            if self._names:
                self._names.pop()
            else:
                self._has_ended = True
        elif isinstance(inner, yaml.MappingNode):
            self.parameters += _flat_in_list(inner, f"{name}.")
        else:
            self.parameters.append((name, _value(value)))


def _flat_in_list(mapping: yaml.MappingNode, prefix: str) -> Iterator[tuple[str, Any]]:
    """Yield the parameters of a map in a list.

    rcl ignores the list, so that `joints: [{names: [a]}]` is `joints.names`, and takes a value that
    is not a list as one. The files of ros2_control's GPIO controllers have such maps.
    """
    for key, value in mapping.value:
        name = f"{prefix}{key.value}"
        if isinstance(value, yaml.MappingNode):
            yield from _flat_in_list(value, f"{name}.")
        elif isinstance(value, yaml.ScalarNode) and len(mapping.value) > 1:
            raise ValueError(f"Sequences cannot hold lists or maps, at line {key.start_mark.line + 1}")
        else:
            values = _value(value)
            yield name, values if isinstance(values, list) else [values]


def _value(node: Any) -> Any:
    if isinstance(node, yaml.ScalarNode):
        return _scalar(node)
    if not isinstance(node, yaml.SequenceNode):
        raise ValueError(
            "No value at line 1" if node is None else "a parameter is a value or a list of values"
        )
    values: list[Any] = []
    for item in node.value:
        if not isinstance(item, yaml.ScalarNode):
            raise ValueError(f"Sequences cannot hold lists or maps, at line {item.start_mark.line + 1}")
        values.append(_scalar(item))
        if type(values[-1]) is not type(values[0]):
            raise ValueError(
                f"Sequence should be of same type. Value type '{_TYPE_NAMES[type(values[-1])]}' "
                f"do not belong at line_num {item.start_mark.line + 1}"
            )
    return values


def _scalar(node: yaml.ScalarNode) -> bool | int | float | str:
    """Infer a scalar's type as rcl does: a string if quoted, else bool, integer, double or string."""
    text: str = node.value
    plain_tag: str = _RESOLVER.resolve(yaml.ScalarNode, text, (True, False))
    # Quoted, or not a string by itself but with the tag `!!str`.
    if node.style in ("'", '"', "|", ">") or (node.tag == _STRING != plain_tag):
        return text
    if not text:
        raise ValueError(f"No value at line {node.start_mark.line + 1}")
    if text in _TRUE | _FALSE:
        return text in _TRUE
    if _INTEGER.fullmatch(text):
        # As in C, 0x… is hexadecimal, and a leading 0 means octal if possible.
        digits = text.lstrip("+-")
        base = 16 if digits[:2] in ("0x", "0X") else 8 if re.fullmatch("0[0-7]+", digits) else 10
        if -(2**63) <= (number := int(text, base)) < 2**63:
            return number
    try:
        real = float(re.sub(r"^([+-]?)\.(?=[infaINFA]{3}$)", r"\1", text))
    except ValueError:
        return text
    is_out_of_range = math.isinf(real) and any(character.isdigit() for character in text)
    # Unlike C, Python reads underscores and digits of other scripts.
    return real if text.isascii() and "_" not in text and not is_out_of_range else text
