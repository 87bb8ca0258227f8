"""Similarity of the code of a class: fingerprints, pairs and clusters."""

import builtins
import re
from collections import Counter, defaultdict
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from course_lib.arrays import Floats

if TYPE_CHECKING:
    from pygments.token import _TokenType

LENGTH = 16  # tokens of one run: about two lines
MIN_WORDS = 6  # a longer text is an answer in words, and compared word by word
DROPPED = ("print", "import", "from", "%", "!")  # first tokens of statements that say nothing of a solution
BUILT_IN = frozenset(dir(builtins)) | {"self"}
MIN_SHARED = 50.0  # runs in common, rare ones counting fully: about eight lines
SHARE = 0.6  # limit in a small class: what part of the shorter solution two have in common
SHARES = (0.4, 0.85)  # least and most of the limit in a larger one
MIN_LINES = 8  # of own code, when all of it is the same letter by letter
FEW = 4  # a run that at most so many solutions have counts fully ...
COMMON = 0.1  # ... or at most this part of the class
CLASS = 10  # from so many different solutions on, the limit follows the class
SPREADS = 6.0  # that a pair must be above the median of the class
CHUNK = 4096  # columns of a matrix


Own = TypeVar("Own", bound=Hashable)


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


@dataclass(frozen=True)
class Pair:
    """Two students, and what part of the shorter solution they have in common, from 0 to 1."""

    one: str
    other: str
    share: float


@dataclass(frozen=True)
class Cluster:
    """Students whose code is alike, with the pairs that join them, the most alike first."""

    students: tuple[str, ...]
    pairs: tuple[Pair, ...]


@dataclass(frozen=True)
class Comparison:
    """The clusters of a class, and from which share on two solutions are in one."""

    clusters: tuple[Cluster, ...]
    limit: float
    median: float | None  # share of two solutions of the class; None if they are too few to tell


def compare(runs: Mapping[str, frozenset[int]], lines: Mapping[str, tuple[str, ...]]) -> Comparison:
    """Compare all solutions with each other.

    A run counts less the more solutions have it, as many find it by themselves; equal solutions count as
    one there, so that a copy does not look common because it was copied often.

    Args:
        runs: Of each student, without what was handed out.
        lines: Of each student, without what was handed out, sorted: small solutions that are letter by
            letter the same are few runs.
    """
    groups = _equal(runs)
    shared = _shared_weights(list(groups))
    names = [members[0] for members in groups.values()]
    amount = np.diag(shared)
    share = shared / np.maximum(np.minimum(amount, amount[:, None]), 1e-9)
    limit, median = _limit(share)
    above, beside = np.nonzero(np.triu((share >= limit) & (shared >= MIN_SHARED), 1))
    pairs = [Pair(names[a], names[b], float(share[a, b])) for a, b in zip(above, beside, strict=True)]
    for weight, members in zip(amount, groups.values(), strict=True):
        if weight >= MIN_SHARED:
            pairs += _joined(members)
    for own, members in _equal(lines).items():
        if len(own) >= MIN_LINES:
            pairs += _joined(members)
    return Comparison(_clusters(pairs), limit, median)


def _equal(solutions: Mapping[str, Own]) -> dict[Own, list[str]]:
    """Return the students of each different solution."""
    groups = defaultdict[Own, list[str]](list)
    for student, own in solutions.items():
        groups[own].append(student)
    return groups


def _joined(students: Sequence[str]) -> list[Pair]:
    """Return pairs that join students of equal solutions."""
    return [Pair(students[0], other, 1.0) for other in students[1:]]


def _shared_weights(solutions: Sequence[frozenset[int]]) -> Floats:
    """Return the weight of the runs that each two solutions share; in the diagonal of all runs of one."""
    number = Counter(run for own in solutions for run in own)
    full = max(FEW, COMMON * len(solutions))
    weights = {run: min(1.0, full / count) for run, count in number.items()}
    columns = {run: column for column, run in enumerate(run for run, count in number.items() if count > 1)}
    shared = np.zeros((len(solutions), len(solutions)))
    for start in range(0, len(columns), CHUNK):
        has = np.zeros((len(solutions), CHUNK))
        for row, own in enumerate(solutions):
            for run in own:
                if start <= columns.get(run, -1) < start + CHUNK:
                    has[row, columns[run] - start] = weights[run] ** 0.5
        shared += has @ has.T
    np.fill_diagonal(shared, [sum(weights[run] for run in own) for own in solutions])
    return shared


def _limit(share: Floats) -> tuple[float, float | None]:
    """Return the share from which on two solutions are alike, and the median of the class."""
    if len(share) < CLASS:
        return SHARE, None
    pairs = share[np.triu_indices(len(share), 1)]
    median = float(np.median(pairs))
    spread = 1.4826 * float(np.median(np.abs(pairs - median)))  # the standard deviation of a normal one
    return float(np.clip(median + SPREADS * spread, *SHARES)), median


def _clusters(pairs: Sequence[Pair]) -> tuple[Cluster, ...]:
    """Return the students that pairs join, each with the strongest pairs that suffice for that."""
    cluster_of: dict[str, set[str]] = {}
    kept = list[Pair]()
    for pair in sorted(pairs, key=lambda pair: (-pair.share, pair.one, pair.other)):
        one, other = (cluster_of.setdefault(name, {name}) for name in (pair.one, pair.other))
        if one is not other:
            one |= other
            cluster_of |= dict.fromkeys(other, one)
            kept.append(pair)
    clusters = {id(members): members for members in cluster_of.values()}.values()
    made = [
        Cluster(tuple(sorted(members)), tuple(pair for pair in kept if pair.one in members))
        for members in clusters
    ]
    return tuple(sorted(made, key=lambda cluster: (-cluster.pairs[0].share, cluster.students)))
