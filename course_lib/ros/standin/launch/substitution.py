"""Text that is made when the launch runs."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, Union

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

SomeSubstitutionsType: TypeAlias = Union[str, Path, "Substitution", Iterable["SomeSubstitutionsType"]]


class SubstitutionFailure(Exception):  # noqa: N818  # ROS's name
    """A substitution cannot be made."""


class Substitution:
    """The base of all substitutions."""

    def perform(self, context: "LaunchContext") -> str:
        """Make the text."""
        raise NotImplementedError(type(self).__name__)


def perform_substitutions(context: "LaunchContext", parts: SomeSubstitutionsType) -> str:
    """Make the text of one part, or of several joined; strings are themselves."""
    if isinstance(parts, Substitution):
        return parts.perform(context)
    if isinstance(parts, str | Path):
        return str(parts)
    return "".join(perform_substitutions(context, part) for part in parts)


def has_substitution(value: Any) -> bool:
    """Say whether a value is text to be made: a substitution, or a list with one."""
    return isinstance(value, Substitution) or (
        isinstance(value, list | tuple) and any(isinstance(part, Substitution) for part in value)
    )
