"""`course gradescope WEEK`: an autograder.zip, which grades one week's exercise on Gradescope."""

import io
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, get_args
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from course_lib.course.course_file import read_course_file
from course_lib.course.installation import checkout_root, course_package
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.platforms.harness import ROSTER
from course_lib.grading.platforms.kit_source import PACKAGE, PROJECT, KitSource, belongs, kit_source
from course_lib.grading.term.class_list import read_class_list

Hidden = Literal["after_published", "after_due_date", "hidden", "visible"]
NEEDS = {"full": " --require-sandbox", "any": " --i-trust-these-submissions", "partial": ""}
YEAR = (2000, 1, 1, 0, 0, 0)  # of all files in the zip
EXECUTABLE, PLAIN = 0o755, 0o644
FILES = Path(__file__).with_name("files")


def write_autograder(week: str, out: Path, *, hidden: str, need: str, roster: Path | None) -> list[str]:
    """Write autograder.zip; returns lines for the terminal.

    Args:
        week: "week01".
        out: The zip.
        hidden: When students see the results of hidden checks, in Gradescope's word.
        need: The least isolation in which a submission is run.
        roster: roster.csv with the students' e-mail addresses, by which their IDs are found.

    Raises:
        CourseError: There is no such week, the roster is wrong, or `out` can't be written.
    """
    if hidden not in get_args(Hidden):
        raise CourseError(f"--hidden {hidden}: expected one of {', '.join(get_args(Hidden))}")
    root = checkout_root()
    run = _script("run_autograder.sh").replace("WEEK", week).replace("HIDDEN", hidden)
    script = run.replace(" NEED", NEEDS[need])
    kit = KitSource("", "the kit") if (root / PACKAGE).is_dir() else kit_source()
    setup = _script("setup.sh").replace("KIT ", f"{kit.words} ".lstrip())
    files = {**dict(_course_files(root, week)), **kit.files, **_roster_file(roster)}
    data = io.BytesIO()
    with ZipFile(data, "w") as archive:
        for name, text in (("setup.sh", setup), ("run_autograder", script)):
            _put(archive, name, text.encode(), EXECUTABLE)
        for name, content in files.items():
            _put(archive, name, content, PLAIN)
    try:
        write_whole(out, data.getvalue())
    except OSError as error:
        raise CourseError(
            f"{out} can't be written: {error.strerror}. Name another file: --out FILE"
        ) from error
    note = "" if roster else ". Without --roster, the file says whose personal values count"
    return [
        f"Wrote {out}: the course, {kit.name}, and of {week} the solution and hidden checks{note}",
        "Upload it in Gradescope: the assignment's Configure Autograder, base image Ubuntu 22.04 or newer",
    ]


def _script(name: str) -> str:
    return (FILES / name).read_text(encoding="utf-8")


def _roster_file(roster: Path | None) -> dict[str, bytes]:
    if roster is None:
        return {}
    if not any(member.email for member in read_class_list(roster).members):
        raise CourseError(f"{roster} has no column 'email', by which Gradescope's students are found")
    return {f"course/solutions/{ROSTER}": roster.read_bytes()}


def _put(archive: ZipFile, name: str, content: bytes, mode: int) -> None:
    info = ZipInfo(name, YEAR)
    info.external_attr = mode << 16
    archive.writestr(info, content, ZIP_DEFLATED)


def _course_files(root: Path, week: str) -> Iterator[tuple[str, bytes]]:
    """Yield the files of a course that has one week, by their names in the zip."""
    yield "course/exercises/course.toml", one_week(root / "exercises" / "course.toml", week)
    solution = root / "solutions" / f"{week}_solution.ipynb"
    paths = [solution, root / "solutions" / "checks" / f"{week}.py"]
    if missing := [path for path in paths if not path.is_file()]:
        raise CourseError(f"{missing[0]} is missing: an autograder needs the solution and hidden checks")
    paths += [root / name for name in PROJECT if (root / name).is_file()]
    paths += sorted((root / "notebooks").glob(f"{week}*"))
    for top in (course_package().name, "exercises"):
        paths += sorted(path for path in (root / top).rglob("*") if belongs(path.relative_to(root)))
    for path in paths:
        if path.is_file() and path != root / "exercises" / "course.toml":
            yield f"course/{path.relative_to(root).as_posix()}", path.read_bytes()


def one_week(path: Path, week: str) -> bytes:
    """Return course.toml without the term and the tables of other weeks.

    Raises:
        CourseError: It has no such week with points, or a faulty one; or others are not written as tables.
    """
    course = read_course_file(path)
    course.demand(week)
    weeks = course.weeks
    if week not in weeks or not weeks[week].points:
        known = ", ".join(name for name, settings in weeks.items() if settings.points)
        raise CourseError(f"there is no exercise of {week!r}; weeks with an exercise: {known}")
    heads = rf"^\[(?:weeks\.(?!{week}[\].])|term[\].])[^\n]*"
    others = re.compile(rf"{heads}.*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
    text = others.sub("", path.read_text(encoding="utf-8"))
    left = tomllib.loads(text)
    if list(left["weeks"]) != [week] or "term" in left:
        raise CourseError(f"{path}: write week and term as tables: [weeks.{week}], [term]")
    return text.encode()
