"""Functions for launch files that compute namespaces, parameters and remappings themselves."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution
from launch.utilities import normalize_to_list_of_substitutions

from launch_ros.actions import LifecycleEventManager as LifecycleEventManager
from launch_ros.parameter_descriptions import Parameter, ParameterFile, check_values, flat_values

SomeRemapRule = tuple[SomeSubstitutionsType, SomeSubstitutionsType]
SomeRemapRules = Iterable[SomeRemapRule]
RemapRule = tuple[tuple[Substitution, ...], tuple[Substitution, ...]]
RemapRules = Sequence[RemapRule]
SomeParameters = Sequence[Any]
Parameters = Sequence[Any]
EvaluatedParameters = Sequence[Path | dict[str, Any]]


def is_namespace_absolute(ns: str) -> bool:
    """Return whether a namespace begins with "/"."""
    return ns.startswith("/")


def is_root_namespace(ns: str) -> bool:
    """Return whether a namespace is "/"."""
    return ns == "/"


def make_namespace_absolute(ns: str | None) -> str | None:
    """Return a namespace with a leading "/"; None stays None."""
    return ns if ns is None or is_namespace_absolute(ns) else f"/{ns}"


def prefix_namespace(base_ns: str | None, ns: str | None) -> str | None:
    """Return a namespace within another one. An absolute namespace is returned unchanged."""
    if base_ns is None and ns is None:
        return None
    if ns is None:
        joined = base_ns or ""
    else:
        joined = ns if not base_ns or is_namespace_absolute(ns) else f"{base_ns.rstrip('/')}/{ns}"
    return joined if is_root_namespace(joined) else joined.rstrip("/")


def normalize_remap_rule(remap_rule: SomeRemapRule) -> RemapRule:
    """Return a remapping whose names are tuples of substitutions."""
    source, target = (tuple(normalize_to_list_of_substitutions(name)) for name in remap_rule)
    return source, target


def normalize_remap_rules(remap_rules: SomeRemapRules) -> Iterable[RemapRule]:
    """Yield remappings whose names are tuples of substitutions."""
    yield from map(normalize_remap_rule, remap_rules)


def normalize_parameters(parameters: SomeParameters) -> Parameters:
    """Return a node's `parameters` in the form that `evaluate_parameters` accepts.

    Raises:
        TypeError: They are not a list, or no parameter can have a value.
    """
    if isinstance(parameters, str) or not isinstance(parameters, Sequence):
        raise TypeError(f"Expecting list of parameters, got {parameters}")
    check_values(parameters)
    parameter_types = (Mapping, Parameter, ParameterFile)
    return tuple(p if isinstance(p, parameter_types) else ParameterFile(p) for p in parameters)


def evaluate_parameters(context: LaunchContext, parameters: Parameters) -> EvaluatedParameters:
    """Return the paths of parameter files, and dictionaries with values by full name."""
    evaluated: list[Any] = []
    for parameter in parameters:
        if isinstance(parameter, Mapping):
            values = flat_values(context, parameter)
            evaluated.append({name: tuple(v) if isinstance(v, list) else v for name, v in values})
        else:
            evaluated.append(
                parameter.evaluate(context) if isinstance(parameter, ParameterFile) else parameter
            )
    return tuple(evaluated)
