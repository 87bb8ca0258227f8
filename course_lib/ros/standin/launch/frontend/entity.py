"""An element of an XML or YAML launch file, with its attributes and the elements in it."""

from collections.abc import Sequence
from typing import Any

import yaml  # type: ignore[import-untyped]  # it ships no types

from course_lib.errors import did_you_mean

_WORDS: dict[type | None, str] = {
    str: "text; put quotes around it",
    bool: "true or false",
    int: "a whole number",
    float: "a number with a point, like 2.0",
    None: "text, a number, true, false or a list",
}


class EntityError(ValueError):
    """A fault of a launch file, with the line where it is."""

    def __init__(self, line: int, text: str) -> None:
        super().__init__(text)
        self.line = line


class Entity:
    """One element; `type_name` is its tag. What is asked for is noted: the rest is a mistake."""

    def __init__(self, type_name: str, line: int) -> None:
        self.type_name, self.line = type_name, line
        self._asked: set[str] = set()

    @property
    def children(self) -> "Sequence[Entity]":
        """The elements in it."""
        raise NotImplementedError

    def named(self, name: str) -> "Sequence[Entity]":
        """Return the elements of a tag in it."""
        raise NotImplementedError

    def get(self, name: str, kind: type | None = str) -> Any:
        """Return an attribute, or None; one of another kind than text may be text with substitutions."""
        raise NotImplementedError

    def refuse_rest(self, known: Sequence[str]) -> None:
        """Raise an EntityError for an attribute or an element that nothing has asked for."""
        raise NotImplementedError

    def error(self, text: str) -> EntityError:
        """Return an error of this element."""
        return EntityError(self.line, f"<{self.type_name}>: {text}")

    def _wrong(self, name: str, kind: type | None, value: object) -> EntityError:
        return self.error(f"{name} is {value!r}, expected {_WORDS[kind]}")


class XmlEntity(Entity):
    """An element of XML; attributes are text, which becomes what is asked for."""

    def __init__(self, type_name: str, line: int, attributes: dict[str, str]) -> None:
        super().__init__(type_name, line)
        self.attributes = attributes
        self.elements: list[XmlEntity] = []

    @property
    def children(self) -> "Sequence[XmlEntity]":
        """The elements in it."""
        self._asked |= {element.type_name for element in self.elements}
        return self.elements

    def named(self, name: str) -> "Sequence[XmlEntity]":
        """Return the elements of a tag in it."""
        self._asked.add(name)
        return [element for element in self.elements if element.type_name == name]

    def get(self, name: str, kind: type | None = str) -> Any:
        """Return an attribute as text or value, a list where `name-sep` says what is between its parts."""
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
        if not _fits(value, kind):
            raise self._wrong(name, kind, text)
        return value

    def refuse_rest(self, known: Sequence[str]) -> None:
        """Raise an EntityError for an attribute or an element that nothing has asked for."""
        for name in self.attributes:
            if name not in self._asked:
                raise self.error(_unexpected("attribute", name, known))
        for element in self.elements:
            if element.type_name not in self._asked:
                raise element.error(f"it is not expected in <{self.type_name}>")


class YamlEntity(Entity):
    """An element of YAML: a mapping, or a list of elements; values have their types already."""

    def __init__(self, type_name: str, line: int, value: Any, lines: dict[int, int]) -> None:
        super().__init__(type_name, line)
        self._value, self._lines = value, lines

    @property
    def children(self) -> "Sequence[YamlEntity]":
        """The elements in it: the list, or the one behind `children`."""
        self._asked.add("children")
        inner = self._value.get("children") if isinstance(self._value, dict) else self._value
        if not isinstance(inner, list):
            raise self.error("expected a list of elements, or a mapping with one behind `children:`")
        return [self._child(one) for one in inner]

    def _child(self, value: Any) -> "YamlEntity":
        line = self._lines.get(id(value), self.line)
        if not isinstance(value, dict) or len(value) != 1:
            raise EntityError(line, f"{str(value)[:60]} in <{self.type_name}>: expected one element, as in "
                              "`- node: {pkg: turtlesim, exec: turtlesim_node}`")  # fmt: skip
        [(name, inner)] = value.items()
        return YamlEntity(str(name), line, inner, self._lines)

    def named(self, name: str) -> "Sequence[YamlEntity]":
        """Return the mappings in the list behind a key."""
        found = self._mapping().get(name)
        self._asked.add(name)
        if found is None:
            return []
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise self.error(f"{name} is {str(found)[:60]}, expected a list of mappings")
        return [YamlEntity(name, self._lines.get(id(one), self.line), one, self._lines) for one in found]

    def get(self, name: str, kind: type | None = str) -> Any:
        """Return the value behind a key."""
        self._asked.add(name)
        value = self._mapping().get(name)
        if value is not None and not isinstance(value, str) and not _fits(value, kind):
            raise self._wrong(name, kind, value)
        return value

    def _mapping(self) -> dict[str, Any]:
        if isinstance(self._value, list | None):
            return {}
        if not isinstance(self._value, dict):
            raise self.error(f"it is {self._value!r}, expected `key: value` lines")
        return self._value

    def refuse_rest(self, known: Sequence[str]) -> None:
        """Raise an EntityError for a key that nothing has asked for."""
        for name in self._value if isinstance(self._value, dict) else ():
            if name not in self._asked:
                raise self.error(_unexpected("key", str(name), known))


def _fits(value: object, kind: type | None) -> bool:
    if kind is None:
        return isinstance(value, str | bool | int | float | list)
    return isinstance(value, kind) and not (kind is int and isinstance(value, bool))


def _unexpected(what: str, name: str, known: Sequence[str]) -> str:
    there = f" It has: {', '.join(sorted(known))}." if known else ""
    return f"unexpected {what} '{name}'{did_you_mean(name, known) or '.'}{there}"
