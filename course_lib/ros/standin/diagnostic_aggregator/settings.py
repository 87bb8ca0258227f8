"""The parameters of the aggregator and of its analyzers."""

import re
from collections.abc import Mapping
from typing import Any

from rclpy.parameter import Parameter

from course_lib.errors import CourseError

Parameters = Mapping[str, Any]
_Table = Mapping[str, tuple[Parameter.Type, Any]]  # by name: type, default

_STRINGS = (Parameter.Type.STRING_ARRAY, ())
GENERIC: _Table = {
    "path": (Parameter.Type.STRING, ""),
    **dict.fromkeys(("find_and_remove_prefix", "remove_prefix", "startswith", "contains"), _STRINGS),
    **dict.fromkeys(("expected", "regex"), _STRINGS),
    "timeout": (Parameter.Type.DOUBLE, 5.0),  # [s]
    "num_items": (Parameter.Type.INTEGER, -1),
    "discard_stale": (Parameter.Type.BOOL, False),
}
AGGREGATOR: _Table = {
    "path": (Parameter.Type.STRING, ""),
    "pub_rate": (Parameter.Type.DOUBLE, 1.0),  # [Hz]
    "history_depth": (Parameter.Type.INTEGER, 1000),
    "other_as_errors": (Parameter.Type.BOOL, False),
    "critical": (Parameter.Type.BOOL, False),
}


def checked(parameters: Parameters, table: _Table) -> dict[str, Any]:
    """Give each parameter of a table, or its default.

    A value of another type is a CourseError; on a robot the node dies of that, with the same first line.
    """
    for name in table.keys() & parameters.keys():
        wanted, found = table[name][0], Parameter.Type.from_parameter_value(parameters[name])
        if found is not wanted:
            example = {"STRING_ARRAY": f"['{parameters[name]}']", "DOUBLE": f"{parameters[name]}.0"}
            raise CourseError(
                f"expected [{wanted.name.lower()}] got [{found.name.lower()}]\n"
                f"hint: {name}: {parameters[name]} in the YAML; write "
                f"{name}: {example.get(wanted.name, table[name][1])}."
            )
    return {name: parameters.get(name, default) for name, (_, default) in table.items()}


def children(parameters: Parameters) -> dict[str, dict[str, Any]]:
    """Sort the parameters of a group by its analyzers; what has no type or path, or is ignored, is none."""
    found: dict[str, dict[str, Any]] = {}
    for name, value in sorted(parameters.items()):
        parts = re.fullmatch(r"((?:analyzers\.)?[^.]+)\.(.+)", name)
        if parts:
            found.setdefault(parts[1], {})[parts[2]] = value
    ignored = (None, "", "diagnostic_aggregator/IgnoreAnalyzer")
    return {name: own for name, own in found.items() if own.get("type") not in ignored and own.get("path")}
