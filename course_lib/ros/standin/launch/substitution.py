"""Text that is made when the launch runs."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, Union

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

SomeSubstitutionsType: TypeAlias = Union[str, Path, "Substitution", Iterable["SomeSubstitutionsType"]]


class SubstitutionFailure(Exception):  # noqa: N818  # ROS's name
    """A substitution cannot be made."""


class Substitution:
    """A text that `make` gives when it is asked for."""

    def __init__(self, make: Callable[["LaunchContext"], str]) -> None:
        self._make = make

    def perform(self, context: "LaunchContext") -> str:
        """Make the text."""
        return self._make(context)


def text_of(context: "LaunchContext", parts: SomeSubstitutionsType) -> str:
    """Make the text of one part, or of several joined; strings are themselves."""
    if isinstance(parts, Substitution):
        return parts.perform(context)
    if isinstance(parts, str | Path):
        return str(parts)
    return "".join(text_of(context, part) for part in parts)
