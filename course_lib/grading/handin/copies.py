"""Similar code in a class: what is compared, and the instructor's page."""

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Any, Literal
from urllib.parse import quote
from zoneinfo import ZoneInfo

from course_lib.course.exercise import code_cells, read_notebook, source
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.handin.similarity import Comparison, Fingerprint, Pair, compare, fingerprint, numbered
from course_lib.grading.handin.submission import Submission
from course_lib.grading.records import result_path
from course_lib.grading.reports.table import fill

MAX_PAIRS = 40  # of a cluster that are shown

Kind = Literal["same", "own", "given"]
FOLDER = "copies"
MAX_CODE = 60_000  # characters of a student's code that are compared, four times as many as a long solution


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
    """Code that all students were given: the runs of its tokens, and its lines word for word."""

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


@dataclass(frozen=True)
class Alike:
    """The index's entry of one submission: students with similar code, and a link to the comparison."""

    others: tuple[str, ...]
    link: str


def compare_class(found: Iterable[Submission], out: Path, exercises: Path, zone: ZoneInfo) -> None:
    """Compare all submissions of each exercise, also with those graded before, and write the pages.

    Args:
        found: All that was handed in, with notebooks.
        out: Where OUT/copies keeps what was compared, and OUT/reports the pages.
        exercises: The folder of the exercises as they were handed out.
        zone: Of the times on the pages.
    """
    given = handed_out(exercises)
    works = defaultdict[str, dict[str, Work]](dict)
    for one in found:
        if one.notebook is not None and not one.problem:
            earlier = works[one.exercise].get(one.student)
            cells = _code(one.notebook.cells, one.files, earlier.cells if earlier else ())
            time = one.received.time
            works[one.exercise][one.student] = Work(cells, time.isoformat() if time else "")
    for exercise, fresh in works.items():
        known = {**_graded_before(out, exercise), **fresh}
        runs = {name: given.own_runs(work) for name, work in known.items()}
        comparison = compare(runs, {name: given.own_lines(work) for name, work in known.items()})
        page = copies_page(exercise, comparison, known, given, zone)
        write_whole(out / "reports" / page_name(exercise), page.encode("utf-8", "replace"))
        content = _content(comparison, known)
        write_whole(out / FOLDER / f"{exercise}.json", content.encode("utf-8", "replace"))


def _code(cells: Sequence[str], files: Mapping[str, str], earlier: Sequence[str]) -> tuple[str, ...]:
    """Return a student's code, of all attempts and each piece once, as far as it is compared."""
    programs = [text for name, text in sorted(files.items()) if name.endswith(".py")]
    code, left = list[str](), MAX_CODE
    for text in dict.fromkeys([*earlier, *cells, *programs]):
        code.append(text[:left])
        left = max(0, left - len(text))
    return tuple(filter(None, code))


def alike_in(out: Path) -> dict[tuple[str, str], Alike]:
    """Return what OUT/copies says, by student and exercise."""
    known = {}
    for path in sorted((out / FOLDER).glob("*.json")):
        for number, students in enumerate(_read(path)["clusters"], 1):
            for student in students:
                others = tuple(name for name in students if name != student)
                known[student, path.stem] = Alike(others, f"{page_name(path.stem)}#cluster-{number}")
    return known


def page_name(exercise: str) -> str:
    """Return the name of an exercise's page in OUT/reports; folders of students never end in .html."""
    return quote(f"copies_{exercise}.html")


def _content(comparison: Comparison, works: Mapping[str, Work]) -> str:
    content = {
        "clusters": [cluster.students for cluster in comparison.clusters],
        "works": {student: [work.cells, work.received] for student, work in works.items()},
    }
    return json.dumps(content, ensure_ascii=False, indent=1)


def _graded_before(out: Path, exercise: str) -> dict[str, Work]:
    """Return the code of those who have a result: they may have been graded from another folder."""
    path = out / FOLDER / f"{exercise}.json"
    known = _read(path)["works"] if path.is_file() else {}
    return {
        student: Work(tuple(cells), received)
        for student, (cells, received) in known.items()
        if result_path(out, student, exercise).is_file()
    }


def _read(path: Path) -> dict[str, Any]:
    try:
        content = read_json(path.read_text(encoding="utf-8"))
        return {"clusters": content["clusters"], "works": content["works"]}
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Remove it and grade again.") from error


@lru_cache(maxsize=2)
def handed_out(exercises: Path) -> HandedOut:
    """Return what students are given: all exercises, and all lessons in the folder beside them."""
    folders = (exercises, exercises.parent / "notebooks")
    notebooks = [path for folder in folders for path in sorted(folder.glob("*.ipynb"))]
    cells = [source(cell) for path in notebooks for _, cell in code_cells(read_notebook(path))]
    lines = frozenset(line.strip() for cell in cells for line in cell.splitlines())
    return HandedOut(frozenset(run for cell in cells for run in fingerprint([cell]).runs), lines)
