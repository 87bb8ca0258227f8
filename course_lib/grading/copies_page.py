"""The instructor's page of similar code: clusters, and pairs side by side."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby
from typing import Literal
from zoneinfo import ZoneInfo

from course_lib.grading.fingerprint import Fingerprint, fingerprint, numbered
from course_lib.grading.reports.table import fill
from course_lib.grading.similarity import Comparison, Pair

MAX_PAIRS = 40  # of a cluster that are shown

Kind = Literal["same", "own", "given"]


@dataclass(frozen=True)
class Work:
    """One student's code, and when it was received, in UTC; "" if no time is known."""

    cells: tuple[str, ...]
    received: str

    def received_in(self, zone: ZoneInfo) -> str:
        """Return the time in a zone, to the minute."""
        if not self.received:
            return "time unknown"
        return datetime.fromisoformat(self.received).astimezone(zone).isoformat(" ", "minutes")


@dataclass(frozen=True)
class HandedOut:
    """What all students were given: the runs of its tokens, and its lines word for word."""

    runs: frozenset[int]
    lines: frozenset[str]

    def own_runs(self, work: Work) -> frozenset[int]:
        """Return the runs of a student's code that nobody gave."""
        return frozenset(fingerprint(work.cells).runs) - self.runs

    def own_lines(self, work: Work) -> tuple[str, ...]:
        """Return the lines of a student's code that nobody gave, sorted, as the order of cells may differ."""
        lines = (line.strip() for cell in work.cells for line in cell.splitlines())
        return tuple(sorted(line for line in lines if line and line not in self.lines))


@dataclass(frozen=True)
class Line:
    """A line of one side: its number from 1, its text, and the number of its like on the other side."""

    number: int
    text: str
    kind: Kind
    like: int = 0


@dataclass(frozen=True)
class Block:
    """Lines of one kind that follow each other."""

    kind: Kind
    lines: tuple[Line, ...]


def copies_page(
    exercise: str, comparison: Comparison, works: Mapping[str, Work], given: HandedOut, zone: ZoneInfo
) -> str:
    """Return the page of one exercise, with every text of a student escaped and times in a zone."""
    clusters = [
        {
            "students": sorted((works[name].received_in(zone), name) for name in cluster.students),
            "pairs": [_pair(pair, works, given) for pair in cluster.pairs[:MAX_PAIRS]],
            "left_out": len(cluster.pairs[MAX_PAIRS:]),
        }
        for cluster in comparison.clusters
    ]
    shown = {"clusters": clusters, "limit": comparison.limit, "median": comparison.median}
    return fill("copies.html", exercise=exercise, compared=len(works), **shown)


def _pair(pair: Pair, works: Mapping[str, Work], given: HandedOut) -> dict[str, object]:
    """Return a pair with the one that was received first on the left."""
    names = sorted((pair.one, pair.other), key=lambda name: (works[name].received, name))
    first, second = (fingerprint(works[name].cells) for name in names)
    likes = (_alike(first, second, given.runs), _alike(second, first, given.runs))
    blocks = [_blocks(works[name], like, given) for name, like in zip(names, likes, strict=True)]
    return {"share": pair.share, "sides": list(zip(names, blocks, strict=True))}


def _alike(one: Fingerprint, other: Fingerprint, handed_out: frozenset[int]) -> dict[int, int]:
    """Return the lines of the one that are in the other, by number from 0, and where they are there."""
    where = defaultdict[int, list[int]](list)
    for place, run in enumerate(other.runs):
        where[run].append(place)
    like, place = dict[int, int](), -1
    for run, lines in zip(one.runs, one.lines, strict=True):
        if run in where and run not in handed_out:
            place = place + 1 if place + 1 in where[run] else where[run][0]  # go on where the last one was
            for own, its in zip(lines, other.lines[place], strict=True):
                like.setdefault(own, its)
    return like


def _blocks(work: Work, like: Mapping[int, int], given: HandedOut) -> list[Block]:
    lines = _lines([line for cell in work.cells for line in numbered(cell)], like, given)
    return [Block(kind, tuple(group)) for kind, group in groupby(lines, lambda line: line.kind)]


def _lines(texts: Sequence[str], like: Mapping[int, int], given: HandedOut) -> Iterator[Line]:
    kind: Kind = "given"
    for number, text in enumerate(texts):
        if text.strip():  # an empty line is of the kind of the one above
            is_given = text.strip() in given.lines
            kind = "given" if is_given else "same" if number in like else "own"
        is_same = kind == "same" and number in like
        yield Line(number + 1, text, kind, like[number] + 1 if is_same else 0)
