"""Find similar code in a class, and write the instructor's page about it.

The amount of compared code is limited, because all pairs of students are compared. In long code,
the statements that bind a task's object come first, with the last binding of each name first,
because that is the one in effect: statements before it would change nothing. Code that is left out
is reported, and so is code that unpacks or builds other code at run time.
"""

import builtins
import json
import re
import unicodedata
from collections import Counter, defaultdict
from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar
from urllib.parse import quote
from zoneinfo import ZoneInfo

import numpy as np

from course_lib.arrays import Floats
from course_lib.course.exercise import code_cells, read_notebook, source
from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.records import Submission
from course_lib.grading.reports.rendering import fill
from course_lib.grading.store import result_path
from course_lib.grading.task import Task
from course_lib.third_party import read_json

if TYPE_CHECKING:
    from pygments.token import _TokenType

LENGTH = 16  # number of tokens in a run: about two lines
MIN_WORDS = 6  # a longer string is an answer in prose and is compared word by word
# first tokens of statements that carry no information about a solution
DROPPED = ("print", "import", "from", "%", "!")
BUILT_IN = frozenset(dir(builtins)) | {"self"}
MIN_SHARED = 50.0  # minimum of common runs, weighted by rarity: about eight lines
SHARE = 0.6  # limit in a small class: common fraction of the shorter solution
SHARES = (0.4, 0.85)  # minimum and maximum of the limit in a larger class
MIN_LINES = 8  # minimum lines of own code for a comparison letter by letter
# A run has full weight if at most FEW solutions, or the fraction COMMON of the class, contain it.
FEW = 4
MAX_CACHED = 10_000  # limit on the characters of a cached cell: no cell of the course is longer
COMMON = 0.1
CLASS = 10  # number of different solutions from which the limit adapts to the class
SPREADS = 6.0  # required distance of a pair from the median of the class
CHUNK = 4096  # number of columns in a matrix product
RARE = 16  # a run shared by at most this many students is added pair by pair


Own = TypeVar("Own", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Token:
    """A token with normalized names, and its line in the cell, counted from 0."""

    text: str
    line: int


@dataclass(frozen=True)
class Fingerprint:
    """The runs of tokens in one student's code.

    Args:
        runs: The hash of each run in code order; equal code has equal hashes within one process.
        lines: The lines of each run's tokens, LENGTH per run.
    """

    runs: tuple[int, ...]
    lines: tuple[tuple[int, ...], ...]


def fingerprint(cells: Iterable[str]) -> Fingerprint:
    """Return all runs of LENGTH tokens in the code of one student.

    Runs do not cross cells, so the order of cells is irrelevant.

    Comments, imports and prints are left out, and names that the code defines count as the same.

    Args:
        cells: Sources of cells; their lines are counted as in `numbered`.
    """
    runs, lines, first = list[int](), list[tuple[int, ...]](), 0
    for cell in cells:
        tokens = normalize_tokens(cell) if len(cell) <= MAX_CACHED else normalize_tokens.__wrapped__(cell)
        for start in range(len(tokens) - LENGTH + 1):
            run = tokens[start : start + LENGTH]
            runs.append(hash(tuple(token.text for token in run)))
            lines.append(tuple(first + token.line for token in run))
        first += len(numbered_lines(cell))
    return Fingerprint(tuple(runs), tuple(lines))


def numbered_lines(cell: str) -> list[str]:
    """Return the counted and displayed lines of a cell, with an empty line at the end."""
    return [*cell.split("\n"), ""]


# Most cells of a class are unchanged cells of the course.
@lru_cache(maxsize=20_000)
def normalize_tokens(cell: str) -> tuple[Token, ...]:
    """Return a cell's tokens without comments, imports and prints, with the student's names as V."""
    raw = list(lex(cell))
    own_names = set(_own_names(raw))
    return tuple(
        token for statement in _statements(raw) for token in _normalize_statement(statement, own_names)
    )


Raw = tuple["_TokenType", str, int]


def lex(cell: str) -> Iterator[Raw]:
    """Yield type, text and line of each token and line end; a whole string is one token."""
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
    """Yield the names of functions, classes, constants and attributes that the code defines."""
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
    """Yield the statements that carry information about a solution."""
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


def _normalize_statement(statement: Sequence[Raw], own_names: set[str]) -> Iterator[Token]:
    """Yield the normalized tokens of a statement: V for an own name, N for a number, S for a string."""
    from pygments.token import Name, Number, String

    before = ""
    for kind, value, line in statement:
        if kind in String:
            tokens = [
                (word[0].casefold(), value.count("\n", 0, word.start()))
                for word in re.finditer(r"\w+", value)
            ]
            if len(tokens) < MIN_WORDS:
                tokens = [("S", 0)]
            for word, below in tokens:
                yield Token(word, line + below)
        elif kind in Number:
            yield Token("N", line)
        elif (
            # Copies do not change the names of Python and of libraries.
            kind in Name
            and (value in own_names or (before != "." and value not in BUILT_IN and not value[:1].isupper()))
        ):
            yield Token("V", line)
        else:
            yield Token(value, line)
        before = value


@dataclass(frozen=True)
class Pair:
    """Two students, and the common fraction of the shorter solution, from 0 to 1."""

    first: str
    second: str
    share: float


@dataclass(frozen=True)
class Cluster:
    """Students with similar code, and the pairs that join them, most similar first."""

    students: tuple[str, ...]
    pairs: tuple[Pair, ...]


@dataclass(frozen=True)
class Comparison:
    """The clusters of a class, and the common fraction from which two solutions count as similar."""

    clusters: tuple[Cluster, ...]
    limit: float
    median: float | None  # common fraction of two solutions of the class; None if there are too few


def compare(
    runs: Mapping[str, frozenset[int]],
    lines: Mapping[str, tuple[str, ...]],
    texts: Mapping[str, frozenset[str]] | None = None,
) -> Comparison:
    """Compare all solutions with each other.

    A run has less weight the more solutions contain it, because many students find it
    independently. Equal solutions count as one for this purpose, so that a copy does not look
    common because it was copied often.

    Args:
        runs: Each student's runs, without runs of the course's code.
        lines: Each student's sorted lines, without lines of the course; they detect small identical
            solutions, which have few runs.
        texts: Each student's strings that may contain a program; a string shared by few students
            joins them.
    """
    groups = _group_equal(runs)
    shared = _shared_weights(list(groups))
    names = [members[0] for members in groups.values()]
    amount = np.diag(shared)
    share = shared / np.maximum(np.minimum(amount, amount[:, None]), 1e-9)
    limit, median = _similarity_limit(share)
    first, second = np.nonzero(np.triu((share >= limit) & (shared >= MIN_SHARED), 1))
    pairs = [Pair(names[a], names[b], float(share[a, b])) for a, b in zip(first, second, strict=True)]
    for weight, members in zip(amount, groups.values(), strict=True):
        if weight >= MIN_SHARED:
            pairs += _pairs_of_equal_solutions(members)
    for solution_lines, members in _group_equal(lines).items():
        if len(solution_lines) >= MIN_LINES:
            pairs += _pairs_of_equal_solutions(members)
    owners = defaultdict[str, list[str]](list)
    for student, texts_of_student in (texts or {}).items():
        for text in texts_of_student:
            owners[text].append(student)
    for students in owners.values():
        # A string that many students have is from another source.
        if len(students) <= max(FEW, COMMON * len(texts or ())):
            pairs += _pairs_of_equal_solutions(students)
    return Comparison(_clusters(pairs), limit, median)


def _group_equal(solutions: Mapping[str, Own]) -> dict[Own, list[str]]:
    """Group the students by equal solutions."""
    groups = defaultdict[Own, list[str]](list)
    for student, lines in solutions.items():
        groups[lines].append(student)
    return groups


def _pairs_of_equal_solutions(students: Sequence[str]) -> list[Pair]:
    """Return pairs that join the students of equal solutions."""
    return [Pair(students[0], other, 1.0) for other in students[1:]]


def _shared_weights(solutions: Sequence[frozenset[int]]) -> Floats:
    """Return the weight of the common runs of each pair.

    The diagonal contains the weight of all runs.
    """
    number = Counter(run for runs in solutions for run in runs)
    full = max(FEW, COMMON * len(solutions))
    weights = {run: min(1.0, full / count) for run, count in number.items()}
    rows = defaultdict[int, list[int]](list)
    for row, runs in enumerate(solutions):
        for run in runs:
            if number[run] > 1:
                rows[run].append(row)
    shared = np.zeros((len(solutions), len(solutions)))
    of_many = [run for run in rows if number[run] > RARE]
    for start in range(0, len(of_many), CHUNK):
        chunk = of_many[start : start + CHUNK]
        has = np.zeros((len(solutions), len(chunk)))
        for column, run in enumerate(chunk):
            has[rows[run], column] = weights[run] ** 0.5
        shared += has @ has.T
    # Most runs are rare. A matrix of them would be nearly empty, so they are added pair by pair.
    by_count = defaultdict[int, list[int]](list)
    for run in rows:
        if number[run] <= RARE:
            by_count[number[run]].append(run)
    for count, group in by_count.items():
        row_indices = np.array([rows[run] for run in group])
        weight = np.array([weights[run] for run in group])
        for first in range(count):
            for other in range(count):
                np.add.at(shared, (row_indices[:, first], row_indices[:, other]), weight)
    np.fill_diagonal(shared, [sum(weights[run] for run in runs) for runs in solutions])
    return shared


def _similarity_limit(share: Floats) -> tuple[float, float | None]:
    """Return the threshold of similarity for two solutions, and the median of the class."""
    if len(share) < CLASS:
        return SHARE, None
    pairs = share[np.triu_indices(len(share), 1)]
    median = float(np.median(pairs))
    spread = 1.4826 * float(np.median(np.abs(pairs - median)))  # estimated standard deviation
    return float(np.clip(median + SPREADS * spread, *SHARES)), median


def _clusters(pairs: Sequence[Pair]) -> tuple[Cluster, ...]:
    """Return the connected students, each cluster with the strongest pairs that suffice to connect it."""
    cluster_of: dict[str, set[str]] = {}
    kept_pairs = list[Pair]()
    for pair in sorted(pairs, key=lambda pair: (-pair.share, pair.first, pair.second)):
        one, other = (cluster_of.setdefault(name, {name}) for name in (pair.first, pair.second))
        if one is not other:
            one |= other
            cluster_of |= dict.fromkeys(other, one)
            kept_pairs.append(pair)
    clusters = {id(members): members for members in cluster_of.values()}.values()
    found_clusters = [
        Cluster(tuple(sorted(members)), tuple(pair for pair in kept_pairs if pair.first in members))
        for members in clusters
    ]
    return tuple(sorted(found_clusters, key=lambda cluster: (-cluster.pairs[0].share, cluster.students)))


MAX_CODE = 60_000  # limit on the compared characters of a student: four times a long solution
MAX_LEXED = 200_000  # limit on the characters that are searched for names
LONG_TEXT = 200  # minimum length of a string that may contain a program
MOST_BLANKS = 0.03  # maximum fraction of blanks in a string that is not prose
# Functions that run code, called by their plain names, unlike "re.compile" or "model.eval".
RUNNING = ("exec", "eval", "compile", "__import__")
UNPACKING = (
    "base64", "binascii", "zlib", "gzip", "bz2", "lzma", "marshal", "pickle", "codecs", "fromhex", "runpy",
    "builtins", "__builtins__", "CodeType", "FunctionType", "run_cell", "run_line_magic",
)  # fmt: skip
SUSPECT = re.compile(rf"\b(?:{'|'.join((*RUNNING, *UNPACKING))})\b")
# The beginning of a definition or an assignment, found even in code that Python can't parse.
STATEMENT = re.compile(r"^(?=(?:@|class\b|def\b|async\b|[A-Za-z_]\w*\s*[:=]))", re.MULTILINE)
# Possessive, and within a line: empty lines would be searched again from each of them.
RUN_MAGIC = re.compile(r"^[^\S\n]*+%(?:(?:run|load|cell_magic)|%(?:python3?|script|bash|sh))\b", re.MULTILINE)


@dataclass(frozen=True)
class ComparedCode:
    """The code that is compared, and remarks about code that is not."""

    cells: tuple[str, ...]
    remarks: tuple[str, ...] = ()


def select_code(
    texts: Collection[str], names: Sequence[str], released_lines: Collection[str]
) -> ComparedCode:
    """Return the part of a student's code that is compared, without repetitions.

    Args:
        texts: Cells and programs of all attempts.
        names: The objects of the tasks.
        released_lines: Lines of the course's code.
    """
    remarks = find_indirect_code(texts, released_lines)
    if sum(map(len, texts)) <= MAX_CODE:
        return ComparedCode(tuple(filter(None, texts)), remarks)
    selected, capacity = list[str](), MAX_CODE
    for part in _sort_by_weight([part for text in texts for part in STATEMENT.split(text)], names):
        selected.append(part[:capacity])
        capacity = max(0, capacity - len(part))
    surplus = sum(map(len, texts)) - MAX_CODE
    return ComparedCode(tuple(filter(None, selected)), (f"{surplus / 1000:.3g} kB not compared", *remarks))


def _sort_by_weight(parts: Sequence[str], names: Sequence[str]) -> list[str]:
    """Sort statements: definitions of a task's object first, then other definitions, then the rest.

    Within each group, later statements come first.
    """
    name_pattern = "|".join(map(re.escape, names)) or "(?!)"
    binds = re.compile(
        rf"^(?:class|(?:async )?def)\s+(?:{name_pattern})\b|^(?:{name_pattern})\s*[:=]", re.MULTILINE
    )
    defines = re.compile(r"^(?:class|(?:async )?def)\s", re.MULTILINE)
    groups: tuple[list[str], ...] = ([], [], [])
    for text in reversed(parts):
        groups[0 if binds.search(text) else 1 if defines.search(text) else 2].append(text)
    return [text for group in groups for text in group]


def find_indirect_code(texts: Iterable[str], released_lines: Collection[str]) -> tuple[str, ...]:
    """Return how a student's own code creates code at run time, which can't be compared."""
    suspects = dict[str, None]()
    for text in texts:
        own_code = "\n".join(line for line in text.splitlines() if line.strip() not in released_lines)
        # Python normalizes identifiers in the same way.
        own_code = unicodedata.normalize("NFKC", own_code)
        if RUN_MAGIC.search(own_code):
            suspects["a magic that runs code"] = None
        names = dict.fromkeys(SUSPECT.findall(own_code))
        # Tokens distinguish names from words in comments and strings, but lexing is slow.
        if names and len(own_code) <= MAX_LEXED:
            names = dict.fromkeys(_find_suspect_names(own_code))
        suspects |= names
    return (f"uses {', '.join(suspects)}",) if suspects else ()


def _find_suspect_names(text: str) -> Iterator[str]:
    from pygments.token import Name

    before = ""
    for kind, value, _ in lex(text):
        names = value.split(".") if kind in Name.Namespace else [value]
        for name in names if kind in Name else ():
            if name in UNPACKING or (name in RUNNING and before != "."):
                yield name
        before = value if value.strip() else before


def long_texts(cells: Iterable[str]) -> frozenset[str]:
    """Return the strings that may contain a packed program: long strings with hardly any spaces."""
    from pygments.token import String

    literals = set[str]()
    for cell in cells:
        for kind, value, _ in lex(cell):
            text = value.strip("'\"bBrRuUfF")
            if kind in String and len(text) >= LONG_TEXT:
                blanks = sum(map(text.count, " \n\t"))
                literals |= {text} if blanks <= MOST_BLANKS * len(text) else set()
    return frozenset(literals)


MAX_PAIRS = 40  # limit on the displayed pairs of a cluster

Kind = Literal["same", "own", "given"]
FOLDER = "copies"


@dataclass(frozen=True)
class ComparedSubmission:
    """One student's compared code, its time of receipt in UTC ("" if unknown), and remarks."""

    cells: tuple[str, ...]
    received: str
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class ReleasedCode:
    """The course's own code: the runs of its tokens, and its lines."""

    runs: frozenset[int]
    lines: frozenset[str]
    texts: frozenset[str] = frozenset()

    def own_runs(self, work: ComparedSubmission) -> frozenset[int]:
        """Return the runs of a student's code that are not from the course."""
        return frozenset(fingerprint(work.cells).runs) - self.runs

    def own_lines(self, work: ComparedSubmission) -> tuple[str, ...]:
        """Return a student's lines that are not from the course, sorted, as the order of cells may differ."""
        lines = (line.strip() for cell in work.cells for line in cell.splitlines())
        return tuple(sorted(line for line in lines if line and line not in self.lines))


@dataclass(frozen=True)
class Line:
    """A line of one side, numbered from 1, with the number of the similar line on the other."""

    number: int
    text: str
    kind: Kind
    similar_number: int = 0


@dataclass(frozen=True)
class Block:
    """Consecutive lines of one kind."""

    kind: Kind
    lines: tuple[Line, ...]


def copies_page(
    exercise: str,
    comparison: Comparison,
    works: Mapping[str, ComparedSubmission],
    released: ReleasedCode,
    zone: ZoneInfo,
) -> str:
    """Return the page of one exercise, with all student text escaped, and times in `zone`."""
    times = {
        name: datetime.fromisoformat(work.received).astimezone(zone).isoformat(" ", "minutes")
        for name, work in works.items()
        if work.received
    }
    clusters = [
        {
            "students": sorted((times.get(name, "time unknown"), name) for name in cluster.students),
            "pairs": [_pair(pair, works, released) for pair in cluster.pairs[:MAX_PAIRS]],
            "left_out": len(cluster.pairs[MAX_PAIRS:]),
        }
        for cluster in comparison.clusters
    ]
    unread = sorted((name, work.remarks) for name, work in works.items() if work.remarks)
    values = {"unread": unread, "clusters": clusters, "limit": comparison.limit, "median": comparison.median}
    return fill("copies.html", exercise=exercise, compared=len(works), **values)


def _pair(pair: Pair, works: Mapping[str, ComparedSubmission], released: ReleasedCode) -> dict[str, object]:
    """Return the data of a pair. The submission that was received first is on the left."""
    names = sorted((pair.first, pair.second), key=lambda name: (works[name].received, name))
    first, second = (fingerprint(works[name].cells) for name in names)
    likes = (_match_lines(first, second, released.runs), _match_lines(second, first, released.runs))
    blocks = [_blocks(works[name], like, released) for name, like in zip(names, likes, strict=True)]
    return {"share": pair.share, "sides": list(zip(names, blocks, strict=True))}


def _match_lines(
    one: Fingerprint,
    other: Fingerprint,
    released_code: frozenset[int],
) -> dict[int, int]:
    """Map the lines of one submission that occur in the other to their numbers there, from 0."""
    where = defaultdict[int, list[int]](list)
    for place, run in enumerate(other.runs):
        where[run].append(place)
    like, place = dict[int, int](), -1
    for run, lines in zip(one.runs, one.lines, strict=True):
        if run in where and run not in released_code:
            place = (
                place + 1 if place + 1 in where[run] else where[run][0]
            )  # prefer the position after the last match
            for own_line, its in zip(lines, other.lines[place], strict=True):
                like.setdefault(own_line, its)
    return like


def _blocks(work: ComparedSubmission, like: Mapping[int, int], released: ReleasedCode) -> list[Block]:
    """Group consecutive lines by origin: released code, the other submission, or neither."""
    kind: Kind = "given"
    lines: list[Line] = []
    for number, text in enumerate(line for cell in work.cells for line in numbered_lines(cell)):
        # An empty line has the kind of the line above it.
        if text.strip():
            is_given = text.strip() in released.lines
            kind = "given" if is_given else "same" if number in like else "own"
        is_same = kind == "same" and number in like
        lines.append(Line(number + 1, text, kind, like[number] + 1 if is_same else 0))
    return [Block(kind, tuple(group)) for kind, group in groupby(lines, lambda line: line.kind)]


@dataclass(frozen=True)
class SimilarSubmission:
    """The index's entry of one submission: students with similar code, code not compared, and a link."""

    others: tuple[str, ...]
    link: str
    remarks: tuple[str, ...] = ()


def compare_class(
    submissions: Iterable[Submission],
    out: Path,
    exercises: Path,
    zone: ZoneInfo,
    tasks: Iterable[Task],
) -> None:
    """Compare all submissions of each exercise, including those graded before, and write the pages.

    Args:
        submissions: All submissions, with notebooks.
        out: The folder of records: OUT/copies keeps the compared code, OUT/reports the pages.
        exercises: The folder of the course's exercises.
        zone: The zone of times on the pages.
        tasks: The tasks of all weeks; code that binds their objects is compared first.
    """
    names = defaultdict[str, list[str]](list)
    for task in tasks:
        names[task.id.split(".")[0]].append(task.name)
    released = released_code(exercises)
    code = defaultdict[tuple[str, str], dict[str, None]](dict)  # code of all attempts, without repetitions
    received_times: dict[tuple[str, str], str] = {}
    for file in submissions:
        if file.notebook is not None and not file.problem:
            programs = [text for name, text in sorted(file.files.items()) if name.endswith(".py")]
            code[file.exercise, file.student] |= dict.fromkeys([*file.notebook.cells, *programs])
            time = file.received.time
            received_times[file.exercise, file.student] = time.isoformat() if time else ""
    works = defaultdict[str, dict[str, ComparedSubmission]](dict)
    for (exercise, student), texts in code.items():
        selected = select_code(texts, names[exercise.split("_")[0]], released.lines)
        work = ComparedSubmission(selected.cells, received_times[exercise, student], selected.remarks)
        works[exercise][student] = work
    for exercise, fresh in works.items():
        # Students with a result may have been graded from another folder, so their code is
        # compared, too.
        path = out / FOLDER / f"{exercise}.json"
        previous = _read(path)["works"] if path.is_file() else {}
        work_of = {
            **{
                student: ComparedSubmission(tuple(cells), received_times, *map(tuple, more))
                for student, (cells, received_times, *more) in previous.items()
                if result_path(out, student, exercise).is_file()
            },
            **fresh,
        }
        runs = {name: released.own_runs(work) for name, work in work_of.items()}
        lines = {name: released.own_lines(work) for name, work in work_of.items()}
        strings = {name: long_texts(work.cells) - released.texts for name, work in work_of.items()}
        comparison = compare(runs, lines, strings)
        page = copies_page(exercise, comparison, work_of, released, zone)
        write_atomically(out / "reports" / page_name(exercise), page.encode("utf-8", "replace"))
        content = {
            "clusters": [cluster.students for cluster in comparison.clusters],
            "works": {name: [work.cells, work.received, work.remarks] for name, work in work_of.items()},
        }
        text = json.dumps(content, ensure_ascii=False, indent=1)
        write_atomically(path, text.encode("utf-8", "replace"))


def read_similar(out: Path) -> dict[tuple[str, str], SimilarSubmission]:
    """Return the entries of OUT/copies by student and exercise."""
    similar = dict[tuple[str, str], SimilarSubmission]()
    for path in sorted((out / FOLDER).glob("*.json")):
        content, page = _read(path), page_name(path.stem)
        # Files of older versions have no remarks.
        unread = {
            name: tuple(more[0]) for name, (_, _, *more) in content["works"].items() if more and more[0]
        }
        for student, remarks in unread.items():
            similar[student, path.stem] = SimilarSubmission((), f"{page}#not-compared", remarks)
        for number, students in enumerate(content["clusters"], 1):
            for student in students:
                other_students = tuple(name for name in students if name != student)
                link = f"{page}#cluster-{number}"
                similar[student, path.stem] = SimilarSubmission(other_students, link, unread.get(student, ()))
    return similar


def page_name(exercise: str) -> str:
    """Return the file name of an exercise's page in OUT/reports.

    Student folders never end in .html.
    """
    return quote(f"copies_{exercise}.html")


def _read(path: Path) -> dict[str, Any]:
    try:
        content = read_json(path.read_text(encoding="utf-8"))
        return {"clusters": content["clusters"], "works": content["works"]}
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Remove it and grade again.") from error


@lru_cache(maxsize=2)
def released_code(exercises: Path) -> ReleasedCode:
    """Return the course's own code: all exercises, and all lessons in the folder next to them."""
    folders = (exercises, exercises.parent / "notebooks")
    notebooks = [path for folder in folders for path in sorted(folder.glob("*.ipynb"))]
    cells = [source(cell) for path in notebooks for _, cell in code_cells(read_notebook(path))]
    lines = frozenset(line.strip() for cell in cells for line in cell.splitlines())
    runs = frozenset(run for cell in cells for run in fingerprint([cell]).runs)
    return ReleasedCode(runs, lines, long_texts(cells))
