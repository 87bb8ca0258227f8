"""Compares the code of a class, exercise by exercise: for the instructor to look at, and never a mark."""

import json
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import quote
from zoneinfo import ZoneInfo

from course_lib.course.exercise_file import read_notebook, source
from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError
from course_lib.grading.copies_page import HandedOut, Work, copies_page
from course_lib.grading.fingerprint import fingerprint
from course_lib.grading.records import result_path
from course_lib.grading.similarity import Comparison, compare
from course_lib.grading.submission import Submission

FOLDER = "copies"
MAX_CODE = 60_000  # characters of a student's code that are compared, four times as many as a long solution


@dataclass(frozen=True)
class Alike:
    """What the index says of one submission: whose code is like it, and where both are side by side."""

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
        content = json.loads(path.read_text(encoding="utf-8"))
        return {"clusters": content["clusters"], "works": content["works"]}
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Remove it and grade again.") from error


@lru_cache(maxsize=2)
def handed_out(exercises: Path) -> HandedOut:
    """Return what students are given: all exercises, and all lessons in the folder beside them."""
    folders = (exercises, exercises.parent / "notebooks")
    notebooks = [path for folder in folders for path in sorted(folder.glob("*.ipynb"))]
    cells = [source(cell) for path in notebooks for cell in _code_cells(read_notebook(path)["cells"])]
    lines = frozenset(line.strip() for cell in cells for line in cell.splitlines())
    return HandedOut(frozenset(run for cell in cells for run in fingerprint([cell]).runs), lines)


def _code_cells(cells: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    return [cell for cell in cells if cell.get("cell_type") == "code"]
