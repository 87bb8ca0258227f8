"""Parameters in YAML: files as `--params-file` takes them, values as `-p` does, typed by rcl's rules."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml  # type: ignore[import-untyped]  # it ships no types

PARAMETERS = "ros__parameters"
DEEPEST = 50  # levels
_TRUE = {"Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}
_FALSE = {"N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"}
_INTEGER = re.compile(r"[+-]?(0[xX][0-9a-fA-F]+|\d+)")
_TYPE_NAMES = {bool: "bool", int: "integer", float: "double", str: "string"}


def read_file(path: str) -> list[tuple[str, dict[str, Any]]]:
    """Read a file as (nodes, values by parameter); raises ValueError with rcl's text if it is none."""
    try:
        return read_text(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"Error opening YAML file: {error.strerror}") from error


def read_text(text: str) -> list[tuple[str, dict[str, Any]]]:
    """Read a file's text as (nodes, values by parameter); raises ValueError with rcl's text."""
    return list(_nodes(_compose(text), ""))


def read_value(text: str) -> Any:
    """Read one value; raises ValueError if it cannot be a parameter's."""
    return _value(_compose(text))


def _compose(text: str) -> Any:
    try:
        depth = 0
        for event in yaml.parse(text):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > DEEPEST:
                raise ValueError(f"It is nested too deeply at line {event.start_mark.line + 1}")
            if isinstance(event, yaml.AliasEvent):
                raise ValueError(f"Will not support aliasing at line {event.start_mark.line + 1}")
        return yaml.compose(text)
    except yaml.YAMLError as error:
        line = getattr(getattr(error, "problem_mark", None), "line", 0) + 1
        problem = getattr(error, "problem", None) or "not YAML"
        raise ValueError(f"Error parsing a event near line {line}: {problem}") from error


def _nodes(mapping: Any, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the nodes' names, which may be nested, with their parameters."""
    if not isinstance(mapping, yaml.MappingNode):
        line = mapping.start_mark.line + 1 if mapping else 1
        raise ValueError(f"Cannot have a value before {PARAMETERS} at line {line}")
    for key, value in mapping.value:
        if key.value != PARAMETERS:
            yield from _nodes(value, f"{path}/{str(key.value).strip('/')}")
        elif not path:
            raise ValueError(f"There are no node names before {PARAMETERS} at line {key.start_mark.line + 1}")
        else:
            yield path, dict(_flat(value, ""))


def _flat(mapping: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    if not isinstance(mapping, yaml.MappingNode):
        raise ValueError(f"No value at line {mapping.start_mark.line + 1}")
    for key, value in mapping.value:
        name = f"{prefix}{key.value}"
        if isinstance(value, yaml.MappingNode):
            yield from _flat(value, f"{name}.")
        else:
            yield name, _value(value)


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
    """Type a scalar as rcl does: quoted it is a string, else a bool, an integer, a double or a string."""
    text: str = node.value
    if node.style in ("'", '"', "|", ">"):
        return text
    if not text:
        raise ValueError(f"No value at line {node.start_mark.line + 1}")
    if text in _TRUE | _FALSE:
        return text in _TRUE
    if _INTEGER.fullmatch(text) and -(2**63) <= (number := _integer(text)) < 2**63:
        return number
    try:
        return float(re.sub(r"^([+-]?)\.(?=[infaINFA]{3}$)", r"\1", text)) if "_" not in text else text
    except ValueError:
        return text


def _integer(text: str) -> int:
    """Read an integer as C does: 0x… is hexadecimal, and what begins with a 0 octal, if it can be."""
    digits = text.lstrip("+-")
    base = 16 if digits[:2] in ("0x", "0X") else 8 if re.fullmatch("0[0-7]+", digits) else 10
    return int(text, base)
