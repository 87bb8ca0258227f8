"""Normalised code: what stays the same when a copy gets other names, comments, and order of cells."""

import builtins
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pygments.token import _TokenType

LENGTH = 16  # tokens of one run: about two lines
MIN_WORDS = 6  # a longer text is an answer in words, and compared word by word
DROPPED = ("print", "import", "from", "%", "!")  # first tokens of statements that say nothing of a solution
BUILT_IN = frozenset(dir(builtins)) | {"self"}


@dataclass(frozen=True)
class Token:
    """A token with its names made neutral, and its line in the cell, from 0."""

    text: str
    line: int


@dataclass(frozen=True)
class Fingerprint:
    """The runs of tokens of one student's code.

    Args:
        runs: The hash of each run, in the order of the code; equal code has equal hashes in one process.
        lines: The line of each token of these runs, LENGTH for each run.
    """

    runs: tuple[int, ...]
    lines: tuple[tuple[int, ...], ...]


def fingerprint(cells: Iterable[str]) -> Fingerprint:
    """Return the runs of LENGTH tokens; none reaches over the end of a cell, so their order does not matter.

    Args:
        cells: Sources of cells; their lines are counted as in `numbered`.
    """
    runs, lines, first = list[int](), list[tuple[int, ...]](), 0
    for cell in cells:
        tokens = normalised(cell)
        for start in range(len(tokens) - LENGTH + 1):
            run = tokens[start : start + LENGTH]
            runs.append(hash(tuple(token.text for token in run)))
            lines.append(tuple(first + token.line for token in run))
        first += len(numbered(cell))
    return Fingerprint(tuple(runs), tuple(lines))


def numbered(cell: str) -> list[str]:
    """Return the lines of a cell as they are counted and shown, with an empty one at its end."""
    return [*cell.split("\n"), ""]


@lru_cache(maxsize=20_000)  # most cells of a class are the ones that were handed out
def normalised(cell: str) -> tuple[Token, ...]:
    """Return the tokens of a cell without comments, imports and prints, with own names as V."""
    raw = list(_lexed(cell))
    own = set(_own_names(raw))
    return tuple(token for statement in _statements(raw) for token in _neutral(statement, own))


Raw = tuple["_TokenType", str, int]


def _lexed(cell: str) -> Iterator[Raw]:
    """Yield kind, text and line of each token and line end; a string's text is one token."""
    from pygments.lexers.python import PythonLexer
    from pygments.token import Comment, String, Text

    line, text, start = 0, "", 0
    for kind, value in PythonLexer(stripnl=False).get_tokens(cell):
        if kind in String and kind not in String.Doc and kind not in String.Interpol:
            start, text = (start, text + value) if text else (line, value)
        elif kind not in Comment and kind not in String.Doc:
            if text:
                yield String, text, start
                text = ""
            if kind not in Text or "\n" in value:
                yield kind, value, line
        line += value.count("\n")


def _own_names(raw: Sequence[Raw]) -> Iterator[str]:
    """Yield the names of functions, classes, constants and attributes that the code itself gives."""
    from pygments.token import Name

    values = [value for _, value, _ in raw]
    for place, (kind, value, _) in enumerate(raw):
        if kind in Name.Function or kind in Name.Class:
            yield value
        elif values[place : place + 2] == ["self", "."] and values[place + 3 : place + 4] in (["="], [":"]):
            yield values[place + 2]
        elif value[:1].isupper() and kind in Name and values[place + 1 : place + 2] == ["="]:
            yield value


def _statements(raw: Iterable[Raw]) -> Iterator[list[Raw]]:
    """Yield the statements that say something of a solution."""
    from pygments.token import Text

    statement, depth = list[Raw](), 0
    for kind, value, line in raw:
        if kind not in Text:
            depth = max(0, depth + (value in "([{") - (value in ")]}")) if len(value) == 1 else depth
            statement.append((kind, value, line))
        elif depth == 0 and statement:
            if not _is_dropped(statement):
                yield statement
            statement = []
    if statement and not _is_dropped(statement):
        yield statement


def _is_dropped(statement: Sequence[Raw]) -> bool:
    return statement[0][1] in DROPPED or any(value == "get_logger" for _, value, _ in statement[:3])


def _neutral(statement: Sequence[Raw], own: set[str]) -> Iterator[Token]:
    """Yield the tokens of a statement: V for a student's name, N for a number, S for a text."""
    from pygments.token import Name, Number, String

    before = ""
    for kind, value, line in statement:
        if kind in String:
            yield from _words(value, line)
        elif kind in Number:
            yield Token("N", line)
        elif kind in Name and not _is_known(value, before, own):
            yield Token("V", line)
        else:
            yield Token(value, line)
        before = value


def _is_known(name: str, before: str, own: set[str]) -> bool:
    """Return whether a name is of Python or of a library: a student who copies does not change it."""
    if name in own:
        return False
    return before == "." or name in BUILT_IN or name[:1].isupper()


def _words(text: str, line: int) -> Iterator[Token]:
    words = [(word[0].casefold(), text.count("\n", 0, word.start())) for word in re.finditer(r"\w+", text)]
    if len(words) < MIN_WORDS:
        words = [("S", 0)]
    for word, below in words:
        yield Token(word, line + below)
