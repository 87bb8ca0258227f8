"""Parameters of nodes: values and files."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

# PyYAML has no type information.
import yaml
from launch.conditions import as_bool
from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, text_of
from launch.frontend import parse_substitution

from course_lib.ros.programs.packages import INSTALLED
from course_lib.third_party import read_text

# Number of characters of a value that an error shows.
_EXCERPT_LENGTH = 60


class ParameterValue:
    """A value of a given type. Without a type, substitutions are parsed as YAML."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self._value, self._type = value, value_type

    def evaluate(self, context: LaunchContext, name: str = "") -> Any:
        """Return the value. An error contains the name of the parameter."""
        is_number = isinstance(self._value, int | float)
        if self._type is str and not is_number:
            return text_of(context, self._value)
        value = evaluate_value(context, self._value, name)
        return self._type(value) if isinstance(self._type, type) else value


# Types that the dictionaries of a node's `parameters` may contain.
_VALUES = (bool, int, float, str, bytes, Sequence, Substitution, ParameterValue)


class Parameter:
    """A parameter name, with a value of a given type."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self._name, self._value = name, ParameterValue(value, value_type=value_type)

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return the name and the value."""
        name = text_of(context, self._name)
        return name, self._value.evaluate(context, name)


class ParameterFile:
    """A YAML file with parameters.

    With `allow_substs`, substitutions `$(…)` in it are performed.
    """

    def __init__(self, param_file: SomeSubstitutionsType, *, allow_substs: Any = False) -> None:
        self._file, self._allow_substs = param_file, allow_substs

    def evaluate(self, context: LaunchContext) -> Path:
        """Return the path of the file, or of a copy with performed substitutions."""
        file = Path(text_of(context, self._file))
        if not as_bool(context, self._allow_substs):
            return file
        text = text_of(context, parse_substitution(read_text(file)))
        with NamedTemporaryFile(
            "w", prefix="launch_params_", suffix=".yaml", delete=False, encoding="utf-8"
        ) as copy:
            copy.write(text)
        return Path(copy.name)


def evaluate_value(context: LaunchContext, value: Any, name: str = "") -> Any:
    """Return a parameter's value.

    As in ROS, strings with substitutions are parsed as YAML, other strings are not.

    Raises:
        TypeError: The string is not a YAML value.
    """
    if isinstance(value, ParameterValue):
        return value.evaluate(context, name)
    several = value if isinstance(value, list | tuple) else [value]
    if any(isinstance(part, Substitution) for part in several):
        return _read(text_of(context, value), name)
    if isinstance(value, list | tuple):
        return [evaluate_value(context, part, name) for part in value]
    return value


def check_values(parameters: Iterable[Any] | None) -> None:
    """Raise launch_ros's TypeError for an invalid parameter value, such as None or a Path."""
    for entry in parameters or ():
        values = list(entry.items()) if isinstance(entry, Mapping) else []
        for name, value in values:
            if isinstance(value, Mapping):
                check_values([value])
            elif not isinstance(value, _VALUES):
                raise TypeError(
                    f"Unexpected type for parameter value {value!r}: parameter {name} takes a "
                    "bool, number, string, list or substitution"
                )


def words_for(context: LaunchContext, parameters: Any) -> Iterator[str]:
    """Yield one entry of a node's `parameters` as arguments after --ros-args."""
    if isinstance(parameters, Parameter):
        parameters = dict([parameters.evaluate(context)])
    if isinstance(parameters, Mapping):
        for name, value in flat_values(context, parameters):
            yield from ("-p", f"{name}:={json.dumps(value, ensure_ascii=False)}")
    else:
        is_file = isinstance(parameters, ParameterFile)
        file = (parameters if is_file else ParameterFile(parameters)).evaluate(context)
        # A file of a missing package is the reason why its node is skipped.
        if file.is_file() or file.is_relative_to(INSTALLED):
            yield from ("--params-file", str(file))
        else:
            text = f"Parameter file path is not a file: {file}"
            context.runner.log("WARNING", "launch_ros.actions.node", text)


def flat_values(
    context: LaunchContext, values: Mapping[Any, Any], prefix: str = ""
) -> Iterator[tuple[str, Any]]:
    """Yield the full name and the value of each parameter of nested dictionaries."""
    for key, value in values.items():
        name = prefix + text_of(context, key)
        if isinstance(value, Mapping):
            yield from flat_values(context, value, f"{name}.")
        else:
            yield name, evaluate_value(context, value, name)


def _read(text: str, name: str) -> Any:
    try:
        value = yaml.safe_load(text) if text else ""
    except yaml.YAMLError:
        value = None
    if not isinstance(value, bool | int | float | str | list):
        excerpt = repr(text) if len(text) <= _EXCERPT_LENGTH else f"{text[:_EXCERPT_LENGTH]!r}…"
        raise TypeError(
            f"Unable to parse the value of parameter {name} as yaml. If the parameter is meant to "
            "be a string, try wrapping it in "
            "launch_ros.parameter_descriptions.ParameterValue(value, value_type=str). The value is "
            f"{excerpt}"
        )
    return value
