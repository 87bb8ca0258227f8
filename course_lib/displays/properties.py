"""Properties as RViz shows them: a label, a default, and a conversion of accepted values."""

import math
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from course_lib.arrays import Vector
from course_lib.errors import CourseError
from course_lib.ros.near_names import nearest


class KnownAttributes:
    """Base class of objects that reject new public attributes, except from the kit and themselves.

    Python would accept a misspelled `viewer.fixedframe = "map"`, and nothing would happen.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name.startswith("_") or name in vars(self) or hasattr(type(self), name)):
            caller = sys._getframe(1)
            is_kit = str(caller.f_globals.get("__name__", "")).startswith("course_lib.")
            if not is_kit and caller.f_locals.get("self") is not self:
                instead = self._suggest(name)
                write = f" Write: {instead} = {value!r}" if instead else ""
                raise CourseError(f"{self!r} has no attribute {name!r}.{write}")
        super().__setattr__(name, value)

    @property
    def _expression(self) -> str:
        """The expression for the object as written in lessons."""
        return type(self).__name__.lower()

    def _suggest(self, name: str) -> str:
        """Return an expression for the property that a misspelled attribute means, or ""."""
        kind = type(self)
        names = [attribute for attribute in dir(kind) if not attribute.startswith("_")]
        settable = [
            attribute
            for attribute in names
            if getattr(getattr(kind, attribute, None), "fset", None) is not None
        ]
        similar = nearest(name, settable, 0.6)
        return f"{self._expression}.{similar}" if similar else ""


Color: TypeAlias = tuple[int, int, int]  # RGB, 0..255
Convert: TypeAlias = Callable[[Any], Any]
# The label of another property, and the values with which a row is displayed.
Condition: TypeAlias = tuple[Any, ...]
# A condition without values, for rows that RViz always hides.
NEVER: tuple[Condition, ...] = (("",),)
# About the largest float32.
_LARGEST = 3.4e38


@dataclass(frozen=True)
class Property:
    """One row of RViz's property tree.

    Args:
        label: RViz's label; a property below another one is written ``Line Style/Line Width``.
        default: RViz's default.
        convert: Converts a value from a user or a file, or raises ValueError with a description of
            the expected value: `number(...)`, `color`, `flag` and the like.
        names: The names of the rows from the top down to it, if one of them contains a slash, as
            frame names may.
        shown_if: Conditions without which the panel hides the row, as the property has no effect.
        is_saved: Whether layouts contain the value.
    """

    label: str
    default: Any
    convert: Convert
    names: tuple[str, ...] = ()
    shown_if: tuple[Condition, ...] = ()
    is_saved: bool = True

    @property
    def path(self) -> tuple[str, ...]:
        """The names of the rows above the property, and its own name."""
        return self.names or tuple(self.label.split("/"))

    @property
    def is_read_only(self) -> bool:
        """Whether the value is only displayed; layouts do not contain it."""
        return self.convert is read_only


@dataclass(frozen=True)
class LimitedConversion:
    """A conversion with the limits for its control."""

    convert: Convert
    editor: Literal["number", "integer", "enum"]
    low: float = -math.inf
    high: float = math.inf
    options: tuple[str, ...] = ()

    def __call__(self, value: Any) -> Any:
        """Convert a value from a user or a file."""
        return self.convert(value)


def number(low: float = -math.inf, high: float = math.inf) -> LimitedConversion:
    """Return a conversion to a finite number, clipped to `low` and `high` as in RViz."""

    def convert(value: Any) -> float:
        return min(max(_finite(value), low), high)

    return LimitedConversion(_with_expectation("a number", convert), "number", low, high)


def integer(low: int, high: int = 2**31 - 1) -> LimitedConversion:
    """Return a conversion to an integer, clipped to `low` and `high` as in RViz."""

    def convert(value: Any) -> int:
        number = int(value) if isinstance(value, int) else int(float(value))
        if isinstance(value, bool) or number != float(value):
            raise ValueError
        return min(max(number, low), high)

    return LimitedConversion(_with_expectation("an integer", convert), "integer", low, high)


def flag(value: Any) -> bool:
    """Convert a value, a boolean or a string in the notation of layouts, to a boolean."""
    value = {"true": True, "false": False}.get(value.lower(), value) if isinstance(value, str) else value
    if not isinstance(value, bool):
        raise ValueError("True or False")
    return value


def text(value: Any) -> str:
    """Convert a value to a string; YAML's null becomes the empty string."""
    if isinstance(value, list | dict):
        raise ValueError("a string")
    return "" if value is None else str(value)


def frame(value: Any) -> str:
    """Convert the name of a frame, without a leading slash, which tf2 does not allow."""
    return text(value).removeprefix("/")


def words(*options: str) -> LimitedConversion:
    """Return a conversion that accepts only the strings in `options`."""

    def convert(value: Any) -> str:
        if value not in options:
            raise ValueError(f"one of {', '.join(map(repr, options))}")
        return str(value)

    return LimitedConversion(convert, "enum", options=options)


def color(value: Any) -> Color:
    """Convert a value to a color: ``R; G; B`` in 0..255 as in RViz, numbers, ``#rrggbb``, a name."""
    from PIL import ImageColor

    try:
        if isinstance(value, str):
            value = value.split(";") if ";" in value else ImageColor.getrgb(value)[:3]
        red, green, blue = (min(max(int(part), 0), 255) for part in value)
    except (TypeError, ValueError):
        raise ValueError("a color like '255; 0; 0'") from None
    return red, green, blue


def vector(value: Any) -> Vector:
    """Convert a value, three numbers or a map with X, Y and Z, to a vector."""
    try:
        x, y, z = (
            _finite(part)
            for part in ([value[axis] for axis in "XYZ"] if isinstance(value, Mapping) else value)
        )
    except (KeyError, TypeError, ValueError):
        raise ValueError("three numbers, (x, y, z)") from None
    return x, y, z


def booleans(value: Any) -> dict[str, bool]:
    """Convert a map from names to booleans."""
    if not isinstance(value, Mapping):
        raise ValueError("a map like {'name': False}")
    return {str(name): flag(on) for name, on in value.items()}


def read_only(value: Any) -> Any:
    """Reject every value, because the property shows a measured value."""
    raise ValueError("no value: the property is read-only")


class PropertyHolder(KnownAttributes):
    """Base class of objects with properties: ``grid["Cell Size"] = 0.5``.

    A label may be short if it is unique (``Line Width`` for ``Line Style/Line Width``), and may be
    written as a Python name (``cell_size``). Some properties are added later, like those of a
    robot's links.
    """

    properties: tuple[Property, ...] = ()

    def __init__(self) -> None:
        self._values = {prop.label: prop.default for prop in self.properties}
        # The last loaded layout.
        self._loaded: Mapping[str, Any] = {}
        # The owner's part of the last layout, with unknown entries.
        self.config: Mapping[str, Any] = {}

    def add_properties(self, *properties: Property) -> list[str]:
        """Add properties, with their earlier values or the values in the layout.

        Returns:
            Errors in values of the layout.
        """
        new = [prop for prop in properties if prop.label not in self._values]
        self.properties += properties
        self._values |= {prop.label: prop.default for prop in new}
        return self._add_properties(new)

    def remove_properties(self, label: str) -> None:
        """Remove the properties that were added below a label."""
        class_properties = type(self).properties
        self.properties = tuple(p for p in self.properties if p in class_properties or p.path[0] != label)

    def __getitem__(self, label: str) -> Any:
        """Return a property; measured values are functions, which are called on access."""
        is_exact = label in self._values
        value = self._values[label if is_exact else self._property(label).label]
        return value() if callable(value) else value

    # Hidden from mypy, for which every attribute would exist.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # Python calls this for attributes that do not exist.
            instead = "" if name.startswith("_") else self._suggest(name)
            write = f". Write: {instead}" if instead else ""
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}{write}")

    def _suggest(self, name: str) -> str:
        labels = {prop.path[-1].replace(" ", "_"): prop.label for prop in self.properties}
        label = labels.get(nearest(name, labels, 0.6), "") or labels.get(name, "")
        return f'{self._expression}["{label}"]' if label else super()._suggest(name)

    def has_row(self, prop: Property) -> bool:
        """Return whether the panel has a row for a property. RViz hides rows without an effect."""
        return all(values and self[label] in values for label, *values in prop.shown_if)

    def panel_rows(self) -> Iterator[tuple[tuple[str, ...], Property]]:
        """Yield the displayed properties, and the path of each in the panel, parents first."""
        return ((prop.path, prop) for prop in self.properties if self.has_row(prop))

    def row_name(self, path: tuple[str, ...]) -> str:
        """Return the name that the panel shows for the row at a path."""
        return path[-1]

    def is_expanded(self, path: tuple[str, ...]) -> bool:
        """Return whether the row at a path shows the rows below it, until the user collapses it."""
        return False

    @classmethod
    def describe(cls, prop: Property) -> str:
        """Return RViz's description of a property, or ""."""
        for kind in cls.__mro__:
            texts = descriptions().get(kind.__name__, {})
            if text := texts.get(prop.label) or texts.get(prop.path[-1]):
                return text.replace("{type}", getattr(cls, "type_name", "")).lstrip()
        return ""

    def get(self, label: str, default: Any) -> Any:
        """Return a property by its full label, or a default if there is none."""
        return self._values.get(label, default)

    def keys(self) -> Iterable[str]:
        """Return the labels of all properties, so that ``dict(display)`` contains the values."""
        return self._values.keys()

    def __setitem__(self, label: str, value: Any) -> None:
        prop = self._property(label)
        try:
            new = prop.convert(value)
        except (TypeError, ValueError) as error:
            raise CourseError(f"{self}: {prop.label!r} is {value!r}, expected {error}.") from None
        if new != self._values[prop.label]:
            self._values[prop.label] = new
            self.apply_change(prop.label)

    def apply_change(self, label: str) -> None:
        """Call `on_property_change`; a display makes its exceptions a status."""
        self.on_property_change(label)

    def on_property_change(self, label: str) -> None:
        """React to a new value of a property."""

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set values from a layout; properties that it does not contain keep their values.

        Returns:
            Errors in values that were skipped.
        """
        self._loaded = config
        return self._add_properties(self.properties)

    def _add_properties(self, properties: Iterable[Property]) -> list[str]:
        wrong = []
        parents = {prop.path[:-1] for prop in self.properties}
        for prop in properties:
            # A property with children keeps its own value under ``Value``.
            config: Any = self._loaded
            for name in prop.path:
                config = config.get(name) if isinstance(config, Mapping) else None
            value = config["Value"] if isinstance(config, Mapping) and "Value" in config else config
            only_below = prop.path in parents and isinstance(value, Mapping)
            is_loaded = prop.is_saved and not prop.is_read_only
            if value is not None and not only_below and is_loaded:
                try:
                    self[prop.label] = value
                except CourseError as error:
                    wrong.append(str(error))
        return wrong

    def _property(self, label: str) -> Property:
        plain_label = _argument_name(label)
        exact = [prop for prop in self.properties if _argument_name(prop.label) == plain_label]
        by_end = [prop for prop in self.properties if _argument_name(prop.path[-1]) == plain_label]
        matches = exact or by_end
        if len(matches) == 1:
            return matches[0]
        if matches:
            raise CourseError(f"{self}: {label!r} may be {' or '.join(repr(p.label) for p in matches)}.")
        labels = [prop.label for prop in self.properties]
        if plain_label in ("name", "names") and hasattr(self, "name"):
            raise CourseError(
                f"The name of {self} is not a property: write name= in add(…), or display.name = 'a name'."
            )
        similar = get_close_matches(label, labels, 3, 0.4) or labels
        raise CourseError(f"{self} has no property {label!r}; it has {', '.join(map(repr, similar))}.")


@cache
def descriptions() -> Mapping[str, Mapping[str, str]]:
    """Return RViz's descriptions, by the name of a Python class and a label."""
    return tomllib.loads(Path(__file__).with_name("descriptions.toml").read_text("utf-8"))


def _with_expectation(expectation: str, convert: Convert) -> Convert:
    def checked(value: Any) -> Any:
        try:
            return convert(value)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(expectation) from None

    return checked


def _finite(value: Any) -> float:
    """Convert a number that RViz can store as float32."""
    number = float(value)
    if isinstance(value, bool) or not abs(number) < _LARGEST:
        raise ValueError
    return number


def _argument_name(label: str) -> str:
    return label.lower().replace(" ", "_").replace("(", "").replace(")", "")
