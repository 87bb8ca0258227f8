"""The substitutions with which Nav2's launch files rewrite configuration files."""

import errno
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# PyYAML has no type information.
import yaml
from launch.entities import Condition, LaunchContext, SomeSubstitutionsType, Substitution, text_of
from launch.substitutions import LaunchConfiguration

from course_lib.third_party import read_text

_POSE = ("x", "y", "z", "roll", "pitch", "yaw")
# A dictionary or list, and a key or index in it.
_Place = tuple[Any, Any]


class ParseMultiRobotPose:
    """The poses of robots, from an argument like `robots:="a={x: 1.0}; b={y: 2.0, yaw: 1.5}"`.

    It reads the command line, so the argument need not be declared.
    """

    def __init__(self, target_argument: str) -> None:
        matching = (word for word in sys.argv[1:] if word.startswith(f"{target_argument}:="))
        self._text = next(matching, "").removeprefix(f"{target_argument}:=")

    def value(self) -> dict[str, dict[str, float]]:
        """Return x, y, z [m], roll, pitch and yaw [rad] of each robot. Missing values are 0."""
        poses = {}
        for part in filter(None, self._text.split(";")):
            name, equals, pose = part.partition("=")
            if equals:
                poses[name.strip()] = {**dict.fromkeys(_POSE, 0.0), **yaml.safe_load(pose)}
        return poses


@dataclass(eq=False, repr=False)
class LaunchConfigAsBool(Substitution):
    """A launch configuration as `True` or `False`; true, 1, yes, on and y count as true."""

    name: str

    def perform(self, context: LaunchContext) -> str:
        """Convert the value of the configuration."""
        value = text_of(context, LaunchConfiguration(self.name))
        return str(value.lower() in ("true", "1", "on", "yes", "y", "t"))


@dataclass(eq=False, repr=False)
class ReplaceString(Substitution):
    """A copy of a file with replaced strings. If the condition is false, the file itself."""

    source_file: SomeSubstitutionsType
    replacements: Mapping[str, SomeSubstitutionsType]
    condition: Condition | None = None

    def perform(self, context: LaunchContext) -> str:
        """Write the copy and return its path, or return the path of the file."""
        source = text_of(context, self.source_file)
        if self.condition is not None and not self.condition.evaluate(context):
            return source
        text = _read(source)
        for old, new in self.replacements.items():
            text = text.replace(old, text_of(context, new))
        return _write_temporary(text, Path(source).suffix)


@dataclass(eq=False, repr=False)
class RewrittenYaml(Substitution):
    """A copy of a YAML file with replaced values.

    Args:
        source_file: The file.
        param_rewrites: Values by parameter name or by dotted path. A path through `ros__parameters`
            that the file lacks is added.
        root_key: A key under which all content is placed; not if it is "".
        key_rewrites: Replacements for keys.
        convert_types: Whether numbers become numbers; booleans always become booleans.
        value_rewrites: Replacements for values that are strings.
    """

    source_file: SomeSubstitutionsType
    param_rewrites: Mapping[str, SomeSubstitutionsType]
    root_key: SomeSubstitutionsType | None = None
    key_rewrites: Mapping[str, SomeSubstitutionsType] | None = None
    convert_types: bool = False
    value_rewrites: Mapping[str, SomeSubstitutionsType] | None = None

    def perform(self, context: LaunchContext) -> str:
        """Write the copy and return its path."""
        data = yaml.safe_load(_read(text_of(context, self.source_file)))
        values = {
            key: _value(text_of(context, text), self.convert_types)
            for key, text in self.param_rewrites.items()
        }
        _rewrite(data, values)
        rewrites = {key: text_of(context, text) for key, text in (self.value_rewrites or {}).items()}
        for (inside, key), _ in list(_leaves(data, "")):
            if isinstance(inside[key], str) and inside[key] in rewrites:
                inside[key] = _value(rewrites[inside[key]], self.convert_types)
        names = {key: text_of(context, text) for key, text in (self.key_rewrites or {}).items()}
        root = text_of(context, self.root_key or "")
        renamed = _rename_keys(data, names)
        return _write_temporary(yaml.dump({root: renamed} if root else renamed), "")


def _read(source_file: str) -> str:
    if not source_file:
        # Path("") would be the working folder.
        raise FileNotFoundError(
            errno.ENOENT, "the file name is empty: give the launch argument for it a value", ""
        )
    return read_text(Path(source_file))


@dataclass(eq=False, repr=False)
class HasNodeParams(Substitution):
    """`True` if a YAML file has parameters for a node, else `False`."""

    source_file: SomeSubstitutionsType
    node_name: str

    def perform(self, context: LaunchContext) -> str:
        """Look the node up in the file."""
        data = yaml.safe_load(_read(text_of(context, self.source_file)))
        return str(self.node_name in data)


def _write_temporary(text: str, suffix: str) -> str:
    """Write a temporary file and return its path."""
    with tempfile.NamedTemporaryFile("w", suffix=suffix, delete=False, encoding="utf-8") as copy:
        copy.write(text)
    return copy.name


def _value(text: str, convert_types: bool) -> Any:
    if convert_types:
        with suppress(ValueError):
            return float(text) if "." in text else int(text)
    return {"true": True, "false": False}.get(text.lower(), text)


def _rewrite(data: Any, values: Mapping[str, Any]) -> None:
    """Set values by name or by path. Add missing paths through `ros__parameters`."""
    for (inside, key), path in list(_leaves(data, "")):
        for name in (key, path):
            if name in values:
                inside[key] = values[name]
    there = {path for _, path in _leaves(data, "")}
    for path, value in values.items():
        *outer, last = path.split(".")
        if path not in there and "ros__parameters" in outer:
            inside = data
            for key in outer:
                inside = inside.setdefault(key, {})
            inside[last] = value


def _leaves(data: Any, prefix: str) -> Iterator[tuple[_Place, str]]:
    """Yield (container, key) and the path of each value, after the values within it."""
    pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in pairs:
        path = f"{prefix}{key}"
        yield from _leaves(value, f"{path}.")
        yield (data, key), path


def _rename_keys(data: Any, names: Mapping[str, str]) -> Any:
    if not isinstance(data, dict):
        return data
    return {names.get(key, key): _rename_keys(value, names) for key, value in data.items()}
