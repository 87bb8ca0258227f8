"""The substitutions with which Nav2's launch files rewrite files."""

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml  # type: ignore[import-untyped]  # it ships no types
from launch.entities import Condition, LaunchContext, SomeSubstitutionsType, Substitution, text_of

_Place = tuple[Any, Any]  # a mapping or list, and a key in it


class ReplaceString(Substitution):
    """A copy of a file in which texts are replaced by others; the file itself if a condition is false."""

    def __init__(
        self,
        source_file: SomeSubstitutionsType,
        replacements: Mapping[str, SomeSubstitutionsType],
        condition: Condition | None = None,
    ) -> None:
        def make(context: LaunchContext) -> str:
            source = Path(text_of(context, source_file))
            if condition is not None and not condition.evaluate(context):
                return str(source)
            text = source.read_text(encoding="utf-8")
            for old, new in replacements.items():
                text = text.replace(old, text_of(context, new))
            return _written(text, source.suffix)

        super().__init__(make)


class RewrittenYaml(Substitution):
    """A copy of a YAML file with other values.

    Args:
        source_file: The file.
        param_rewrites: Values by the name of a parameter, or by its path with dots; a path through
            `ros__parameters` that the file has not is added.
        root_key: Puts all under this key; "" does not.
        key_rewrites: Other names for keys.
        convert_types: Numbers stay numbers; truths always do.
    """

    def __init__(
        self,
        source_file: SomeSubstitutionsType,
        param_rewrites: Mapping[str, SomeSubstitutionsType],
        root_key: SomeSubstitutionsType | None = None,
        key_rewrites: Mapping[str, SomeSubstitutionsType] | None = None,
        convert_types: bool = False,
    ) -> None:
        def make(context: LaunchContext) -> str:
            data = yaml.safe_load(Path(text_of(context, source_file)).read_text(encoding="utf-8"))
            values = {
                key: _value(text_of(context, text), convert_types) for key, text in param_rewrites.items()
            }
            _rewrite(data, values)
            names = {key: text_of(context, text) for key, text in (key_rewrites or {}).items()}
            root = text_of(context, root_key or "")
            renamed = _renamed(data, names)
            return _written(yaml.dump({root: renamed} if root else renamed), "")

        super().__init__(make)


class HasNodeParams(Substitution):
    """`True` where a YAML file has parameters for a node, else `False`."""

    def __init__(self, source_file: SomeSubstitutionsType, node_name: str) -> None:
        def make(context: LaunchContext) -> str:
            data = yaml.safe_load(Path(text_of(context, source_file)).read_text(encoding="utf-8"))
            return str(node_name in data)

        super().__init__(make)


def _written(text: str, suffix: str) -> str:
    """Write a copy; returns its path."""
    with tempfile.NamedTemporaryFile("w", suffix=suffix, delete=False, encoding="utf-8") as copy:
        copy.write(text)
    return copy.name


def _value(text: str, convert_types: bool) -> Any:
    if convert_types:
        with suppress(ValueError):
            return float(text) if "." in text else int(text)
    return {"true": True, "false": False}.get(text.lower(), text)


def _rewrite(data: Any, values: Mapping[str, Any]) -> None:
    """Set values by name, then by path; adds paths through `ros__parameters`."""
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
    """Yield the place and the path of each value, after those within it."""
    pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in pairs:
        path = f"{prefix}{key}"
        yield from _leaves(value, f"{path}.")
        yield (data, key), path


def _renamed(data: Any, names: Mapping[str, str]) -> Any:
    if not isinstance(data, dict):
        return data
    return {names.get(key, key): _renamed(value, names) for key, value in data.items()}
