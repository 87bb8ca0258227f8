"""Messages between Python and a page: frozen dataclasses in Python, JSON on the way."""

from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from math import isfinite
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from course_lib.errors import CourseError

T = TypeVar("T")
ENVELOPE = frozenset({"type", "page", "number"})  # in every message of a page; `PageLink` reads them


class MessageError(CourseError):
    """A page has sent something that is not as its dataclass describes."""


def to_json(value: Any) -> Any:
    """Convert dataclasses to JSON objects; fields that have their defaults are left out."""
    if is_dataclass(value):
        given = ((field, getattr(value, field.name)) for field in fields(value))
        return {camel(field.name): to_json(item) for field, item in given if item != field.default}
    if isinstance(value, Mapping):
        return {key: to_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [to_json(item) for item in value]
    return value


def from_json(kind: type[T], content: Mapping[str, Any]) -> T:
    """Check a message of a page and convert it to a dataclass.

    Raises:
        MessageError: If a field is missing, unknown or of another type.
    """
    types, needed = _types_of(kind)
    given = {name: value for name, value in content.items() if name not in ENVELOPE}
    for name in sorted(needed - given.keys()):
        raise MessageError(f"{kind.__name__} from the page lacks {name!r}: {str(given)[:200]}")
    for name in sorted(given.keys() - types.keys()):
        raise MessageError(f"{kind.__name__} from the page has {name!r}, expected only {', '.join(types)}.")
    values = {}
    for name, value in given.items():
        field, wanted = types[name]
        try:
            values[field] = _checked(value, wanted)
        except (TypeError, ValueError):
            expected = getattr(wanted, "__name__", str(wanted)) if get_origin(wanted) is None else wanted
            raise MessageError(
                f"{name!r} of {kind.__name__} from the page is {str(value)[:80]!r}, expected {expected}."
            ) from None
    return kind(**values)


def camel(name: str) -> str:
    """Return the name that a field has in JavaScript."""
    first, *others = name.split("_")
    return first + "".join(map(str.capitalize, others))


def _types_of(kind: type) -> tuple[dict[str, tuple[str, Any]], frozenset[str]]:
    """Return field and type by the name in JavaScript, and the names that a message must have."""
    hints = get_type_hints(kind)
    needed = {camel(field.name) for field in fields(kind) if field.default is MISSING}
    return {camel(field.name): (field.name, hints[field.name]) for field in fields(kind)}, frozenset(needed)


def _checked(value: Any, wanted: Any) -> Any:
    """Return a value of the wanted type; lists become tuples, integers floats where those are wanted."""
    if wanted is Any:
        return value
    if isinstance(wanted, UnionType):  # X | None
        return None if value is None else _checked(value, get_args(wanted)[0])
    if get_origin(wanted) is tuple:
        return tuple(_checked(item, kind) for item, kind in zip(value, get_args(wanted), strict=True))
    if wanted is float and type(value) in (int, float) and isfinite(value):
        return value
    if type(value) is not wanted or wanted is float:
        raise TypeError
    return value
