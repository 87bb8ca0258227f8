"""`course classroom`: public checks at each push to GitHub, and clones as submissions."""

import json
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from course_lib.course.course_file import shipped_course_file
from course_lib.course.hand_out import content_hash
from course_lib.course.installation import exercises_dir
from course_lib.course.state import write_whole
from course_lib.errors import CourseError, counted
from course_lib.grading.check_file import check_file
from course_lib.grading.handin.collect import KEPT, PlatformTime, collect, write_receipts
from course_lib.grading.reports.table import printable
from course_lib.grading.term.class_list import ClassList, read_class_list

WORKFLOW = Path(".github/workflows/public_checks.yml")
TEMPLATE = Path(__file__).with_name("files") / WORKFLOW.name
FOLDER = "my_course"  # in which students work, and which they push
EXERCISE = re.compile(r"week\d\d_exercise\.ipynb")
SHA = re.compile(r"[0-9a-f]{40,64}")
ROSTER_HINT = "roster.csv needs a column 'login' with the students' names on GitHub"
PUSHES_HINT = "It is what `gh api repos/ORG/REPO/activity` gives for each repository, one after the other"


def write_workflow(copy: Path) -> list[str]:
    """Write the workflow into the students' copy; returns lines for the terminal.

    Raises:
        CourseError: `copy` is not what `course release` wrote.
    """
    if not (copy / "pyproject.toml").is_file() or not (copy / "exercises").is_dir():
        raise CourseError(f"{copy} is not a students' copy. Type: course release {copy}")
    if (copy / "solutions").exists():
        raise CourseError(f"{copy} holds solutions. Name the students' copy: course release ../for_students")
    text = TEMPLATE.read_text(encoding="utf-8").replace("FOLDER", FOLDER)
    write_whole(copy / WORKFLOW, text.encode())
    return [
        f"Wrote {copy / WORKFLOW}: GitHub runs the public checks at each push.",
        f"Make {copy} the template repository of the assignment. Students work in {FOLDER}: course lab",
    ]


def check_changed(folder: Path) -> bool:
    """Run the public checks of each exercise that differs from the released one; True if all pass.

    Raises:
        CourseError: The folder is missing.
    """
    if not folder.is_dir():
        raise CourseError(f"{folder} is missing: course lab makes it; then git add {folder}")
    results = [check_file(path) for path in _changed(folder)]
    return all(results)


def _changed(folder: Path) -> Iterator[Path]:
    """Yield the exercises of a folder whose cells are not those of the release."""
    for path in sorted(folder.glob("week*.ipynb")):
        released = exercises_dir() / path.name
        if not EXERCISE.fullmatch(path.name) or path.is_symlink() or not path.is_file():
            continue
        if not released.is_file() or content_hash(path) != content_hash(released):
            yield path


def collect_clones(clones: Path, out: Path, roster: Path, pushes: Path | None) -> list[str]:
    """Sort the clones of students' repositories into submissions; returns lines for the terminal.

    Args:
        clones: A folder for each student, ASSIGNMENT-LOGIN, as `gh classroom clone student-repos` makes them.
        out: Gets a folder for each student, by ID.
        roster: The class list, with logins.
        pushes: JSON of GitHub's API, with the time of each push.

    Raises:
        CourseError: A file is wrong, or there is no clone.
    """
    members = read_class_list(roster)
    if not any(member.login for member in members.members):
        raise CourseError(f"{roster}: {ROSTER_HINT}")
    times = _times(pushes) if pushes else {}
    found = sorted(path for path in clones.glob("*") if (path / ".git").is_dir()) if clones.is_dir() else []
    if not found:
        raise CourseError(f"{clones} holds no clone. Type: gh classroom clone student-repos")
    if out.resolve().is_relative_to(clones.resolve()):
        raise CourseError(f"{out} lies in {clones}. Name a folder elsewhere: --out DIR")
    with tempfile.TemporaryDirectory(prefix="course_") as work:
        lines, receipts = _staged(found, Path(work), members, times)
        if receipts:
            lines += collect(Path(work), out, shipped_course_file().zone).refused
            write_receipts(out, receipts)
    if late := sum(not receipt.time for receipt in receipts.values()):
        lines.append(f"{counted(late, 'student')} without the time of the push: {PUSHES_HINT}: --pushes FILE")
    collected = f"Collected {counted(len(receipts), 'student')} into {out}"
    return [printable(line) for line in (*lines, f"{collected}. Next: course grade {out} --out graded")]


def _staged(
    clones: Sequence[Path], place: Path, members: ClassList, times: Mapping[str, str]
) -> tuple[list[str], dict[str, PlatformTime]]:
    """Copy changed exercises into PLACE/STUDENT; returns a line for each clone without any, and the times."""
    lines, receipts = list[str](), dict[str, PlatformTime]()
    for clone in clones:
        student = _student(clone.name, members)
        if not student:
            lines.append(f"refused: {clone.name}: it ends in no login of the class list")
        elif student in receipts:
            lines.append(f"refused: {clone.name}: {student} has two clones")
        elif not _stage(clone, place / student):
            lines.append(f"{student}: no exercise in {_folder(clone)} differs from the released one")
        else:
            receipts[student] = PlatformTime(times.get(_head(clone), ""), "GitHub, push", True)
    return lines, receipts


def _student(name: str, members: ClassList) -> str:
    """Return the ID of the student whose login a clone's name ends with, the longest such login."""
    folded = name.casefold()
    fits = [one for one in members.members if one.login and f"-{folded}".endswith(f"-{one.login}")]
    return max(fits, key=lambda one: len(one.login)).id if fits else ""


def _folder(clone: Path) -> Path:
    """Return where the exercises of a clone are looked for."""
    return clone / FOLDER if (clone / FOLDER).is_dir() else clone


def _stage(clone: Path, place: Path) -> bool:
    """Copy the changed exercises with their working files; returns whether there are any."""
    folder = _folder(clone)
    changed = {path.name for path in _changed(folder)}
    if not changed:
        return False

    def left_out(where: str, names: list[str]) -> set[str]:
        return {name for name in names if not _belongs(Path(where, name), changed)}

    shutil.copytree(folder, place, symlinks=True, ignore=left_out)
    return True


def _belongs(path: Path, exercises: set[str]) -> bool:
    if (
        path.is_symlink()
        or path.name.startswith(".")
        or path.name in ("course_lib", "notebooks", "exercises")
    ):
        return False
    if path.is_dir():
        return True
    is_kept = path.suffix.lower() in KEPT and path.is_file()
    return path.name in exercises if path.suffix.lower() == ".ipynb" else is_kept


def _head(clone: Path) -> str:
    """Return the commit that is checked out, or ""."""
    try:
        head = (clone / ".git" / "HEAD").read_text().strip()
        name = head.removeprefix("ref: ")
        if name == head:
            return head
        loose = clone / ".git" / name
        if loose.is_file():
            return loose.read_text().strip()
        packed = (clone / ".git" / "packed-refs").read_text().splitlines()
    except (OSError, UnicodeError):
        return ""
    return next((line.split()[0] for line in packed if line.endswith(f" {name}")), "")


def _times(path: Path) -> dict[str, str]:
    """Return the time of the first push of each commit, by GitHub's clock."""
    try:
        text, times = path.read_text(encoding="utf-8-sig").strip(), dict[str, str]()
        while text:
            content, end = json.JSONDecoder().raw_decode(text)
            text = text[end:].strip()
            for commit, time in _pushes(content):
                times[commit] = min(time, times.get(commit, time))
    except (OSError, ValueError, RecursionError) as error:
        raise CourseError(f"{path} can't be read: {error}. {PUSHES_HINT}") from error
    if not times:
        raise CourseError(f"{path} has no push with 'after' and 'timestamp'. {PUSHES_HINT}")
    return times


def _pushes(content: Any) -> Iterator[tuple[str, str]]:
    entries = content if isinstance(content, list) else [content]
    for entry in (entry for entry in entries if isinstance(entry, Mapping)):
        commit, time = str(entry.get("after", "")), str(entry.get("timestamp", ""))
        if SHA.fullmatch(commit) and time:
            yield commit, time
