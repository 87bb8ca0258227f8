"""Definitions from .msg, .srv and .action files, in the form of rosbags' type store.

A service is two messages, ``std_srvs/srv/Trigger_Request`` and ``std_srvs/srv/Trigger_Response``; an action
is three, with those that rosidl adds for the services and the topic on which it travels.
"""

import re
from collections.abc import Iterator, Mapping, MutableMapping
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError

SERVICE_PARTS = ("_Request", "_Response")
ACTION_PARTS = ("_Goal", "_Result", "_Feedback")
# CDR knows no empty struct: a message without fields carries one byte under this name.
PLACEHOLDER = "structure_needs_at_least_one_member"
_PARTS: Mapping[str, tuple[str, ...]] = {"msg": ("",), "srv": SERVICE_PARTS, "action": ACTION_PARTS}
# rosidl_adapter/parser.py: how types and fields may be called, and what stands behind a field's name.
_TYPE_NAME = "[A-Z][A-Za-z0-9]*"
_FIELD_NAME = "(?!.*__)(?!.*_$)[a-z][a-z0-9_]*"
_FIELD = re.compile(
    r"\s*(?P<type>[\w/]+(<=\d+)?(\[(<=)?\d*\])?)\s+(?P<name>\w+)"
    r"(\s+(?P<default>\"[^\"]*\"|'[^']*'|[^\s#=\"'][^#]*?))?\s*(#.*)?"
)
# What rosidl makes of an action's three parts (rosidl_parser/definition.py, class Action).
_ACTION_TRANSPORT: Mapping[str, str] = {
    "_SendGoal_Request": "unique_identifier_msgs/UUID goal_id\n{action}_Goal goal",
    "_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
    "_GetResult_Request": "unique_identifier_msgs/UUID goal_id",
    "_GetResult_Response": "int8 status\n{action}_Result result",
    "_FeedbackMessage": "unique_identifier_msgs/UUID goal_id\n{action}_Feedback feedback",
}


def read_interface(path: Path) -> dict[str, Any]:
    """Read ``my_msgs/msg/Name.msg`` as messages by type; a CourseError if parts are missing or too many."""
    package, folder, name = path.parent.parent.name, path.parent.name, path.stem
    pieces = re.split(r"^---[ \t]*\n?", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    parts = _PARTS[folder]
    if len(pieces) != len(parts):
        raise CourseError(
            f"{path}: a .{folder} file has {len(parts)} parts with --- between them, not {len(pieces)}."
        )
    texts = dict(zip(parts, pieces, strict=True))
    if folder == "action":
        own = f"{package}/action/{name}"
        texts |= {part: text.format(action=own) for part, text in _ACTION_TRANSPORT.items()}
    return {f"{package}/{folder}/{name}{part}": _parse(text, package) for part, text in texts.items()}


def names_in(path: Path) -> list[str]:
    """Return the types of the messages that `read_interface` finds in a file, without reading it."""
    name, parts = "/".join((*path.parts[-3:-1], path.stem)), _PARTS[path.parent.name]
    return [name + part for part in (*parts, *(_ACTION_TRANSPORT if parts == ACTION_PARTS else ()))]


def _parse(text: str, package: str) -> Any:
    """Parse one message; types without a package are the package's own messages."""
    from rosbags.typesys import get_types_from_msg

    (definition,) = get_types_from_msg(text.strip() or f"uint8 {PLACEHOLDER}", f"{package}/msg/A").values()
    return definition


def read_defaults(path: Path) -> dict[tuple[str, str], Any]:
    """Return the default values in the file by type name and field."""
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    package, folder, name = path.parent.parent.name, path.parent.name, path.stem
    parts, found = iter(_PARTS[folder]), {}
    part = next(parts)
    for line in path.read_text(encoding="utf-8").splitlines():
        field = _FIELD.fullmatch(line)
        if line.startswith("---"):
            part = next(parts)
        elif field is not None and field["default"]:
            value = yaml.safe_load(field["default"])
            kind = {"f": float, "b": bool}.get(field["type"][0], lambda value: value)
            found[f"{package}/{folder}/{name}{part}", field["name"]] = (
                [kind(one) for one in value] if isinstance(value, list) else kind(value)
            )
    return found


def check_interface(path: Path) -> None:
    """Raise a CourseError for the first line that is none, and for names that rosidl does not take."""
    from rosbags.typesys import TypesysError

    if not re.fullmatch(_TYPE_NAME, path.stem):
        raise CourseError(f"{path}: a type's name is written like JointLimit, so {path.stem!r} is none.")
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        field = _FIELD.fullmatch(line)
        if field is not None and not re.fullmatch(_FIELD_NAME, field["name"]):
            raise CourseError(
                f"{path}, line {number}: '{field['name']}' is an invalid field name. It should have the "
                f"pattern '^{_FIELD_NAME}$', like joint_limit."
            )
        try:
            _parse("" if line.startswith("---") else line, "x")
        except TypesysError as error:
            raise CourseError(
                f"{path}, line {number}: {line.strip()!r} is neither a field, like `float64 speed`, nor a "
                "constant, like `uint8 FAST=1`."
            ) from error


class LazyTypes(MutableMapping[str, Any]):
    """Types by name, for rosbags' store: those given, and those of all files in a folder of packages.

    A file takes milliseconds to parse and there are hundreds of them; a program needs a few.

    Args:
        known: Types that were read before.
        folder: Of packages with files.
        defaults: Gets the default values in a file, by type and field.
    """

    def __init__(self, known: dict[str, Any], folder: Path, defaults: dict[tuple[str, str], Any]) -> None:
        self._known, self._defaults = known, defaults
        self._files = {name: path for path in folder.glob("*/*/*.*") for name in names_in(path)}

    def __getitem__(self, name: str) -> Any:
        if name not in self._known and name in self._files:
            self._known |= read_interface(self._files[name])
            self._defaults |= read_defaults(self._files[name])
        return self._known[name]

    def __setitem__(self, name: str, fields: Any) -> None:
        self._known[name] = fields

    def __delitem__(self, name: str) -> None:
        del self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._known or name in self._files

    def __iter__(self) -> Iterator[str]:
        yield from dict.fromkeys((*self._known, *self._files))

    def __len__(self) -> int:
        return len(self._known.keys() | self._files.keys())
