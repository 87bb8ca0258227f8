"""What Nav2's launch files rewrite files with."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from launch.conditions import Condition
from launch.launch_context import LaunchContext
from launch.substitution import SomeSubstitutionsType, Substitution, perform_substitutions


class ReplaceString(Substitution):
    """A copy of a file in which texts are replaced by others; gives the copy's path."""

    def __init__(
        self,
        source_file: SomeSubstitutionsType,
        replacements: Mapping[str, SomeSubstitutionsType],
        condition: Condition | None = None,
    ) -> None:
        self._source_file, self._replacements, self._condition = source_file, replacements, condition

    def perform(self, context: LaunchContext) -> str:
        """Write the copy, unless the condition is false."""
        source = Path(perform_substitutions(context, self._source_file))
        if self._condition is not None and not self._condition.evaluate(context):
            return str(source)
        text = source.read_text(encoding="utf-8")
        for old, new in self._replacements.items():
            text = text.replace(old, perform_substitutions(context, new))
        with tempfile.NamedTemporaryFile("w", suffix=source.suffix, delete=False, encoding="utf-8") as copy:
            copy.write(text)
        return copy.name
