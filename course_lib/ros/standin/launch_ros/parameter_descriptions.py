"""Parameters of nodes: values and files."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

import yaml  # type: ignore[import-untyped]  # it ships no types
from launch.conditions import as_bool
from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, text_of
from launch.frontend import parse_substitution


class ParameterValue:
    """A value of a chosen type; substitutions without one are read as YAML."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self._value, self._type = value, value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """Return the value."""
        is_number = isinstance(self._value, int | float)
        if self._type is str and not is_number:
            return text_of(context, self._value)
        value = evaluated(context, self._value)
        return self._type(value) if isinstance(self._type, type) else value


class Parameter:
    """A name with a value of a chosen type."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self._name, self._value = name, ParameterValue(value, value_type=value_type)

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return both."""
        return text_of(context, self._name), self._value.evaluate(context)


class ParameterFile:
    """A YAML file of parameters; with `allow_substs` each `$(…)` in it is replaced."""

    def __init__(self, param_file: SomeSubstitutionsType, *, allow_substs: Any = False) -> None:
        self._file, self._allow_substs = param_file, allow_substs

    def evaluate(self, context: LaunchContext) -> Path:
        """Return its path; where something may be replaced, that of a copy."""
        file = Path(text_of(context, self._file))
        if not as_bool(context, self._allow_substs):
            return file
        text = text_of(context, parse_substitution(file.read_text(encoding="utf-8")))
        with NamedTemporaryFile(
            "w", prefix="launch_params_", suffix=".yaml", delete=False, encoding="utf-8"
        ) as copy:
            copy.write(text)
        return Path(copy.name)


def evaluated(context: LaunchContext, value: Any) -> Any:
    """Return a parameter's value: text with substitutions is read as YAML, as in ROS; other text stays."""
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    several = value if isinstance(value, list | tuple) else [value]
    if any(isinstance(part, Substitution) for part in several):
        return _read(text_of(context, value))
    if isinstance(value, list | tuple):
        return [evaluated(context, part) for part in value]
    return value


def words_for(context: LaunchContext, parameters: Any) -> Iterator[str]:
    """Yield one entry of a node's `parameters` as words behind --ros-args."""
    if isinstance(parameters, Parameter):
        parameters = dict([parameters.evaluate(context)])
    if isinstance(parameters, Mapping):
        for name, value in _flat(context, parameters, ""):
            yield from ("-p", f"{name}:={json.dumps(value, ensure_ascii=False)}")
    else:
        is_file = isinstance(parameters, ParameterFile)
        yield from (
            "--params-file",
            str((parameters if is_file else ParameterFile(parameters)).evaluate(context)),
        )


def _flat(context: LaunchContext, values: Mapping[Any, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        name = prefix + text_of(context, key)
        if isinstance(value, Mapping):
            yield from _flat(context, value, f"{name}.")
        else:
            yield name, evaluated(context, value)


def _read(text: str) -> Any:
    try:
        value = yaml.safe_load(text) if text else ""
    except yaml.YAMLError:
        value = None
    if not isinstance(value, bool | int | float | str | list):
        raise TypeError(
            f"Unable to parse the value {text[:80]!r} as a parameter. If it is meant to be a string, try "
            "wrapping it in launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
        )
    return value
