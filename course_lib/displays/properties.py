"""Properties as RViz shows them: a label, a default, and what values it takes."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, Literal, TypeAlias

from course_lib.arrays import Vector
from course_lib.errors import CourseError

Color: TypeAlias = tuple[int, int, int]  # RGB, 0..255
Convert: TypeAlias = Callable[[Any], Any]
_LARGEST = 3.4e38  # of a number in four bytes


@dataclass(frozen=True)
class Property:
    """One row of RViz's property tree.

    Args:
        label: RViz's label; a property below another one is written ``Line Style/Line Width``.
        default: RViz's default.
        convert: Turns what a user or a file gives into the value, or raises ValueError with what it
            expects: `number(...)`, `color`, `flag` and the like.
        names: Of the rows down to it, if one of them has a slash, as frames may.
    """

    label: str
    default: Any
    convert: Convert
    names: tuple[str, ...] = ()

    @property
    def path(self) -> tuple[str, ...]:
        """The names of the rows down to it, and its own."""
        return self.names or tuple(self.label.split("/"))

    @property
    def is_read_only(self) -> bool:
        """The value is shown but never set; layouts do not keep it."""
        return self.convert is read_only


@dataclass(frozen=True)
class Limited:
    """A conversion with its limits, for the control of a property."""

    convert: Convert
    editor: Literal["number", "integer", "enum"]
    low: float = -math.inf
    high: float = math.inf
    options: tuple[str, ...] = ()

    def __call__(self, value: Any) -> Any:
        """Turn what a user or a file gives into the value."""
        return self.convert(value)


def number(low: float = -math.inf, high: float = math.inf) -> Limited:
    """Return a conversion to a finite number, which RViz keeps within the bounds `low` and `high`."""

    def convert(value: Any) -> float:
        return min(max(_finite(value), low), high)

    return Limited(_expecting("a number", convert), "number", low, high)


def integer(low: int, high: int = 2**31 - 1) -> Limited:
    """Return a conversion to a whole number, which RViz keeps within the bounds `low` and `high`."""

    def convert(value: Any) -> int:
        whole = int(value) if isinstance(value, int) else int(float(value))
        if isinstance(value, bool) or whole != float(value):
            raise ValueError
        return min(max(whole, low), high)

    return Limited(_expecting("a whole number", convert), "integer", low, high)


def flag(value: Any) -> bool:
    """Convert a value that is True or False, or one of these as layouts write it."""
    value = {"true": True, "false": False}.get(value.lower(), value) if isinstance(value, str) else value
    if not isinstance(value, bool):
        raise ValueError("True or False")
    return value


def text(value: Any) -> str:
    """Convert a value that is text; YAML's null is the empty one."""
    if isinstance(value, list | dict):
        raise ValueError("text")
    return "" if value is None else str(value)


def frame(value: Any) -> str:
    """Convert the name of a frame, without the leading slash that tf2 does not know."""
    return text(value).removeprefix("/")


def words(*options: str) -> Limited:
    """Return a conversion that accepts one of the options."""

    def convert(value: Any) -> str:
        if value not in options:
            raise ValueError(f"one of {', '.join(map(repr, options))}")
        return str(value)

    return Limited(convert, "enum", options=options)


def color(value: Any) -> Color:
    """Convert a value as RViz does colours: ``R; G; B`` in 0..255, three numbers, ``#rrggbb`` or a name."""
    from PIL import ImageColor

    try:
        if isinstance(value, str):
            value = value.split(";") if ";" in value else ImageColor.getrgb(value)[:3]
        red, green, blue = (min(max(int(part), 0), 255) for part in value)
    except (TypeError, ValueError):
        raise ValueError("a colour like '255; 0; 0'") from None
    return red, green, blue


def vector(value: Any) -> Vector:
    """Convert a value of three numbers, or a map with X, Y and Z."""
    try:
        x, y, z = (
            _finite(part)
            for part in ([value[axis] for axis in "XYZ"] if isinstance(value, Mapping) else value)
        )
    except (KeyError, TypeError, ValueError):
        raise ValueError("three numbers, (x, y, z)") from None
    return x, y, z


def booleans(value: Any) -> dict[str, bool]:
    """Convert a map from names to True or False."""
    if not isinstance(value, Mapping):
        raise ValueError("a map like {'name': False}")
    return {str(name): flag(on) for name, on in value.items()}


def read_only(value: Any) -> Any:
    """Refuse every value: the property shows what the display has found out."""
    raise ValueError("nothing: it only shows what is there")


class PropertyHolder:
    """Something with properties: ``grid["Cell Size"] = 0.5``.

    A label may be short if it is unique (``Line Width`` for ``Line Style/Line Width``), and may be written
    as a Python name (``cell_size``). Some become known later, like those of a robot's links.
    """

    properties: tuple[Property, ...] = ()

    def __init__(self) -> None:
        self._values = {prop.label: prop.default for prop in self.properties}
        self._loaded: Mapping[str, Any] = {}  # the layout it has taken last
        self.config: Mapping[str, Any] = {}  # of the layout it comes from, with what we do not know

    def grow(self, *properties: Property) -> list[str]:
        """Get further properties, with the values they had before or that the layout has for them.

        Returns:
            What was wrong with values of the layout.
        """
        new = [prop for prop in properties if prop.label not in self._values]
        self.properties += properties
        self._values |= {prop.label: prop.default for prop in new}
        return self._take(new)

    def shrink(self, label: str) -> None:
        """Lose what has grown below a label."""
        own = type(self).properties
        self.properties = tuple(p for p in self.properties if p in own or p.path[0] != label)

    def __getitem__(self, label: str) -> Any:
        known = label in self._values
        return self._values[label if known else self._property(label).label]

    def get(self, label: str, default: Any) -> Any:
        """Return a property by its whole label, or something else if there is none."""
        return self._values.get(label, default)

    def keys(self) -> Iterable[str]:
        """Return the labels of all properties; with them ``dict(display)`` shows the values."""
        return self._values.keys()

    def __setitem__(self, label: str, value: Any) -> None:
        prop = self._property(label)
        try:
            new = prop.convert(value)
        except (TypeError, ValueError) as error:
            raise CourseError(f"{self}: {prop.label!r} is {value!r}, expected {error}.") from None
        if new != self._values[prop.label]:
            self._values[prop.label] = new
            self.changed(prop.label)

    def changed(self, label: str) -> None:
        """React to a property's new value."""

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set values from a layout; a property that it does not name keeps its value.

        Returns:
            What was wrong with values that were left out.
        """
        self._loaded = config
        return self._take(self.properties)

    def _take(self, properties: Iterable[Property]) -> list[str]:
        wrong = []
        parents = {prop.path[:-1] for prop in self.properties}
        for prop in properties:
            value = _nested(self._loaded, prop.path)
            only_below = prop.path in parents and isinstance(value, Mapping)
            if value is not None and not only_below and not prop.is_read_only:
                try:
                    self[prop.label] = value
                except CourseError as error:
                    wrong.append(str(error))
        return wrong

    def _property(self, label: str) -> Property:
        wanted = _plain(label)
        exact = [prop for prop in self.properties if _plain(prop.label) == wanted]
        by_end = [prop for prop in self.properties if _plain(prop.path[-1]) == wanted]
        found = exact or by_end
        if len(found) == 1:
            return found[0]
        if found:
            raise CourseError(f"{self}: {label!r} may be {' or '.join(repr(p.label) for p in found)}.")
        labels = [prop.label for prop in self.properties]
        near = get_close_matches(label, labels, 3, 0.4) or labels
        raise CourseError(f"{self} has no property {label!r}, but {', '.join(map(repr, near))}.")


def _expecting(what: str, convert: Convert) -> Convert:
    def checked(value: Any) -> Any:
        try:
            return convert(value)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(what) from None

    return checked


def _finite(value: Any) -> float:
    """Return a number that RViz can keep, in four bytes."""
    number = float(value)
    if isinstance(value, bool) or not abs(number) < _LARGEST:
        raise ValueError
    return number


def _plain(label: str) -> str:
    return label.lower().replace(" ", "_")


def _nested(config: Any, path: Iterable[str]) -> Any:
    """Return the value at a path of labels; a property with children keeps its own under ``Value``."""
    for name in path:
        config = config.get(name) if isinstance(config, Mapping) else None
    return config["Value"] if isinstance(config, Mapping) and "Value" in config else config
