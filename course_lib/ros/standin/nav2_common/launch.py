"""The substitution with which Nav2's launch files rewrite files."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from launch.entities import Condition, LaunchContext, SomeSubstitutionsType, Substitution, text_of


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
            with tempfile.NamedTemporaryFile(
                "w", suffix=source.suffix, delete=False, encoding="utf-8"
            ) as copy:
                copy.write(text)
            return copy.name

        super().__init__(make)
