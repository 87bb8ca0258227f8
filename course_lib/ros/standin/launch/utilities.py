"""Functions that own actions and substitutions of a launch file use."""

from collections.abc import Iterable
from typing import Any

from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, text_of
from launch.substitutions import TextSubstitution


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Return text, a substitution or several of both as a list of substitutions."""
    if isinstance(subs, Substitution):
        return [subs]
    if isinstance(subs, Iterable) and not isinstance(subs, str):
        return [one for part in subs for one in normalize_to_list_of_substitutions(part)]
    return [TextSubstitution(text=str(subs))]


def perform_substitutions(context: LaunchContext, subs: Iterable[Any]) -> str:
    """Return the text of substitutions, joined."""
    return text_of(context, subs)
