"""Docstrings name their subject: the style of CONTRIBUTING.md."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# First words of sentences without a subject, and of verbs that say too little.
FORBIDDEN = {
    "what", "who", "whom", "whose", "how", "where", "when", "whether", "which", "why", "whoever", "whatever",
    "say", "says", "tell", "tells", "let", "give", "gives", "have", "make", "makes", "take", "takes",
}  # fmt: skip


def docstrings(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the line and the text of the docstrings of a module, its classes and its functions."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            text = ast.get_docstring(node)
            if text:
                yield getattr(node, "lineno", 1), text


@pytest.mark.parametrize("room", ["course_lib", "exercises", "solutions", "tests"])
def test_no_docstring_opens_with_a_vague_word(room: str) -> None:
    opened = [
        f"{path.relative_to(ROOT)}:{line}: {text.splitlines()[0]}"
        for path in sorted((ROOT / room).rglob("*.py"))
        for line, text in docstrings(path)
        if text.split(maxsplit=1)[0].strip(".,:;`").lower() in FORBIDDEN
    ]
    assert opened == []
