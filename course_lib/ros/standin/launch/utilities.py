"""Functions for custom actions and substitutions."""

from collections.abc import Iterable
from typing import Any

from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, text_of
from launch.substitutions import TextSubstitution


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Convert a string, a substitution or an iterable of both to a list of substitutions."""
    if isinstance(subs, Substitution):
        return [subs]
    if isinstance(subs, Iterable) and not isinstance(subs, str):
        return [one for part in subs for one in normalize_to_list_of_substitutions(part)]
    return [TextSubstitution(text=str(subs))]


def perform_substitutions(context: LaunchContext, subs: Iterable[Any]) -> str:
    """Perform substitutions and join the results."""
    return text_of(context, subs)
