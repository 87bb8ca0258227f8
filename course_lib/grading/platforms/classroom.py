"""`course classroom`: run public checks on each GitHub push, and collect clones as submissions."""

import json
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from course_lib.course.course_file import shipped_course_file
from course_lib.course.material import exercises_dir
from course_lib.course.student_folder import content_hash
from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading.check_file import check_file
from course_lib.grading.reports.rendering import replace_controls
from course_lib.grading.submissions.choice import ACCEPTED_SUFFIXES, ANY
from course_lib.grading.submissions.collect import PlatformTime, collect, write_receipts
from course_lib.grading.submissions.readers import FOLDERS
from course_lib.grading.submissions.roster import Member, read_class_list

WORKFLOW = Path(".github/workflows/public_checks.yml")
TEMPLATE = Path(__file__).with_name("files") / WORKFLOW.name
FOLDER = "my_course"  # the folder in which students work, and which they push
EXERCISE = re.compile(r"week\d\d_exercise\.ipynb")
SHA = re.compile(r"[0-9a-f]{40,64}")
ROSTER_HINT = "roster.csv needs a column 'login' with the students' GitHub logins"
PUSHES_HINT = "It is the output of `gh api repos/ORG/REPO/activity` for each repository, concatenated"


def write_workflow(copy: Path) -> list[str]:
    """Write the workflow into the students' copy, and return lines for the terminal.

    Raises:
        CourseError: `copy` was not written by `course release`.
    """
    if not (copy / "pyproject.toml").is_file() or not (copy / "exercises").is_dir():
        raise CourseError(f"{copy} is not a students' copy. Type: course release {copy}")
    if (copy / "solutions").exists():
        raise CourseError(
            f"{copy} contains solutions. Pass the students' copy: course release ../for_students"
        )
    text = TEMPLATE.read_text(encoding="utf-8").replace("FOLDER", FOLDER)
    write_atomically(copy / WORKFLOW, text.encode())
    return [
        f"Wrote {copy / WORKFLOW}: GitHub runs the public checks at each push.",
        f"Use {copy} as the template repository of the assignment. Students work in {FOLDER}: course lab",
    ]


def check_changed(folder: Path) -> bool:
    """Run the public checks of each changed exercise, and return whether all pass.

    Raises:
        CourseError: The folder is missing.
    """
    if not folder.is_dir():
        raise CourseError(f"{folder} is missing: course lab creates it; then git add {folder}")
    results = [check_file(path) for path in _changed_files(folder)]
    return all(results)


def _changed_files(folder: Path) -> Iterator[Path]:
    """Yield the exercises in a folder whose cells differ from the release."""
    for path in sorted(folder.glob("week*.ipynb")):
        released = exercises_dir() / path.name
        if not EXERCISE.fullmatch(path.name) or path.is_symlink() or not path.is_file():
            continue
        if not released.is_file() or content_hash(path) != content_hash(released):
            yield path


def collect_clones(clones: Path, out: Path, roster: Path, pushes: Path | None) -> list[str]:
    """Sort clones of students' repositories into submissions, and return lines for the terminal.

    Args:
        clones: A folder per student, ASSIGNMENT-LOGIN, as created by `gh classroom clone
            student-repos`.
        out: The output folder, with a folder per student ID.
        roster: The class list, with logins.
        pushes: JSON of GitHub's API with the time of each push.

    Raises:
        CourseError: A file is invalid, or there are no clones.
    """
    members = read_class_list(roster)
    if not any(member.login for member in members):
        raise CourseError(f"{roster}: {ROSTER_HINT}")
    times = _times(pushes) if pushes else {}
    folders = sorted(path for path in clones.glob("*") if (path / ".git").is_dir()) if clones.is_dir() else []
    if not folders:
        raise CourseError(f"{clones} contains no clones. Run: gh classroom clone student-repos")
    if out.resolve().is_relative_to(clones.resolve()):
        raise CourseError(f"{out} is inside {clones}. Choose another folder: --out DIR")
    with tempfile.TemporaryDirectory(prefix="course_") as work:
        lines, receipts = _stage_all(folders, Path(work), members, times)
        if receipts:
            zone = shipped_course_file().zone
            lines += collect(Path(work), out, zone, exercise=ANY, layout=FOLDERS).rejected_lines
            write_receipts(out, receipts)
    if missing_times := sum(not receipt.time for receipt in receipts.values()):
        lines.append(
            f"{format_count(missing_times, 'student')} without the time of the push: "
            f"{PUSHES_HINT}: --pushes FILE"
        )
    collected = f"Collected {format_count(len(receipts), 'student')} into {out}"
    return [
        replace_controls(line) for line in (*lines, f"{collected}. Next: course grade {out} --out graded")
    ]


def _stage_all(
    clones: Sequence[Path], place: Path, members: Sequence[Member], times: Mapping[str, str]
) -> tuple[list[str], dict[str, PlatformTime]]:
    """Copy changed exercises into PLACE/STUDENT.

    Return a line for each clone that is skipped, and the times.
    """
    lines, receipts = list[str](), dict[str, PlatformTime]()
    for clone in clones:
        # The longest login at the end of a clone's name identifies the student.
        folded_name = clone.name.casefold()
        fits = [m for m in members if m.login and f"-{folded_name}".endswith(f"-{m.login}")]
        student = max(fits, key=lambda member: len(member.login)).id if fits else ""
        if not student:
            lines.append(f"rejected: {clone.name}: its name does not end with a login from the class list")
        elif student in receipts:
            lines.append(f"rejected: {clone.name}: {student} has two clones")
        elif not _copy_exercises(clone, place / student):
            lines.append(f"{student}: no exercise in {_exercise_folder(clone)} differs from the released one")
        else:
            receipts[student] = PlatformTime(times.get(_head_commit(clone), ""), "GitHub, push", True)
    return lines, receipts


def _exercise_folder(clone: Path) -> Path:
    """Return the folder of a clone that contains the exercises."""
    return clone / FOLDER if (clone / FOLDER).is_dir() else clone


def _copy_exercises(clone: Path, place: Path) -> bool:
    """Copy the changed exercises with their working files, and return whether there are any."""
    folder = _exercise_folder(clone)
    changed_files = {path.name for path in _changed_files(folder)}
    if not changed_files:
        return False

    def left_out(where: str, names: list[str]) -> set[str]:
        left = set[str]()
        for path in (Path(where, name) for name in names):
            is_hidden = path.is_symlink() or path.name.startswith(".")
            suffix = path.suffix.lower()
            is_kept = suffix in ACCEPTED_SUFFIXES and path.is_file()
            is_included = path.name in changed_files if suffix == ".ipynb" else is_kept
            is_of_course = path.name in ("course_lib", "notebooks", "exercises")
            if is_hidden or is_of_course or not (path.is_dir() or is_included):
                left.add(path.name)
        return left

    shutil.copytree(folder, place, symlinks=True, ignore=left_out)
    return True


def _head_commit(clone: Path) -> str:
    """Return the commit that is checked out, or ""."""
    try:
        head = (clone / ".git" / "HEAD").read_text().strip()
        name = head.removeprefix("ref: ")
        if name == head:
            return head
        loose = clone / ".git" / name
        if loose.is_file():
            return loose.read_text().strip()
        lines = (clone / ".git" / "packed-refs").read_text().splitlines()
    except (OSError, UnicodeError):
        return ""
    return next((line.split()[0] for line in lines if line.endswith(f" {name}")), "")


def _times(path: Path) -> dict[str, str]:
    """Return the time of the first push of each commit, measured by GitHub."""
    try:
        text, times = path.read_text(encoding="utf-8-sig").strip(), dict[str, str]()
        while text:
            content, end = json.JSONDecoder().raw_decode(text)
            text = text[end:].strip()
            for push in content if isinstance(content, list) else [content]:
                if isinstance(push, Mapping):
                    commit, time = str(push.get("after", "")), str(push.get("timestamp", ""))
                    if SHA.fullmatch(commit) and time:
                        times[commit] = min(time, times.get(commit, time))
    except (OSError, ValueError, RecursionError) as error:
        raise CourseError(f"{path} can't be read: {error}. {PUSHES_HINT}") from error
    if not times:
        raise CourseError(f"{path} has no push with 'after' and 'timestamp'. {PUSHES_HINT}")
    return times
