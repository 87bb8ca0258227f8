"""The files of a download that count: the exercise of each file, and the files that are set aside.

Students often submit more than required: a zip of the whole course, the lesson, last week's
exercise. None of that may replace a submission or create one, so the exercise is determined first,
for the whole download.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from course_lib.course.material import exercises_dir
from course_lib.errors import CourseError, format_count
from course_lib.grading.submissions import readers
from course_lib.grading.submissions.archives import ReceivedFile, path_problem
from course_lib.grading.submissions.notebook import (
    claimed_id,
    find_exercise_name,
    full_exercise_name,
    is_notebook_name,
    parse_notebook,
)
from course_lib.grading.submissions.submission import lesson_of, read_packed_zip, released_digest

ANY = "*"  # pseudo exercise: all exercises that a student has worked on are collected
WORKING = (".rviz", ".yaml", ".yml", ".py")
ACCEPTED_SUFFIXES = (".ipynb", ".zip", *WORKING)
ADVICE = "Submit {}.ipynb, or the zip that `course submit` writes"
MOST_NAMED = 3  # limit on the files listed for a reason
Kind = Literal["notebook", "working"]


@dataclass(frozen=True)
class DownloadedFile:
    """A file of a download, without its content.

    Args:
        components: The components of its path in the download.
        download_name: Its owner and the data in its name.
        kind: A notebook (also in a zip of `course submit`), or a file that a notebook may refer to.
        exercise: The exercise of a notebook, or "".
        claimed_id: The ID in the file.
        is_touched: False if it is the unchanged exercise.
        problem: The reason why a notebook is not an exercise, or "".
    """

    components: tuple[str, ...]
    download_name: readers.DownloadName
    kind: Kind = "working"
    exercise: str = ""
    claimed_id: str | None = None
    is_touched: bool = True
    problem: str = ""

    @property
    def path(self) -> str:
        """The path in the download."""
        return "/".join(self.components)

    @property
    def owner(self) -> str:
        """The key by which the platform identifies the student."""
        return self.download_name.key


class RejectedFile(NamedTuple):
    """A file of a download that was rejected before the choice."""

    download_name: readers.DownloadName
    name: str
    reason: str


@dataclass
class Choice:
    """The files of a download to keep, and the files that are set aside.

    Args:
        kept: The files to store.
        rejected: For each missing exercise of an owner the name of a file, the exercise and the
            reason.
        lines: A line for each file that is set aside.
    """

    kept: list[DownloadedFile] = field(default_factory=list)
    rejected: list[tuple[readers.DownloadName, str, str]] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)


def inspect_file(arrival: ReceivedFile, download_name: readers.DownloadName) -> DownloadedFile:
    """Determine the kind, the exercise and the ID of a downloaded file.

    Raises:
        CourseError: It is neither a notebook nor a file that a notebook may refer to.
    """
    name = download_name.below[-1]
    # In the student's part of a name, ".." can become a path component.
    if problem := path_problem(download_name.below):
        raise CourseError(problem)
    if readers.is_zip(name):
        try:
            data, receipt = read_packed_zip(arrival.data, name)
        except CourseError as error:
            return DownloadedFile(
                arrival.components,
                download_name,
                "notebook",
                find_exercise_name(name) or "",
                problem=str(error),
            )
        item = _notebook(arrival, download_name, data, str(receipt.get("exercise", "")))
        return replace(item, claimed_id=item.claimed_id or claimed_id(receipt))
    if is_notebook_name(name):
        plain = re.sub(r"^\d{8}_?\d{6}_", "", name)
        item = _notebook(arrival, download_name, arrival.data, plain)
        if item.problem and not name.lower().endswith(".ipynb") and not item.exercise:
            raise CourseError(f"unsupported file type; expected one of {', '.join(ACCEPTED_SUFFIXES)}")
        return item
    if not name.lower().endswith(WORKING):
        raise CourseError(f"unsupported file type; expected one of {', '.join(ACCEPTED_SUFFIXES)}")
    return DownloadedFile(arrival.components, download_name)


def _notebook(
    arrival: ReceivedFile, download_name: readers.DownloadName, data: bytes, name: str
) -> DownloadedFile:
    try:
        notebook = parse_notebook(data, name)
    except CourseError as error:
        return DownloadedFile(
            arrival.components, download_name, "notebook", find_exercise_name(name) or "", problem=str(error)
        )
    exercise, problem = notebook.exercise or "", ""
    if lesson := lesson_of(notebook) if exercise else "":
        problem = f"it is {lesson}, not the exercise"
    elif not exercise:
        problem = "it is not an exercise of this course"
    is_touched = not exercise or notebook.digest != released_digest(exercise)
    return DownloadedFile(
        arrival.components, download_name, "notebook", exercise, notebook.student, is_touched, problem
    )


def choose(
    items: Sequence[DownloadedFile],
    rejected_files: Iterable[RejectedFile],
    layout: readers.Layout,
    exercise: str,
) -> Choice:
    """Choose the files to keep.

    Args:
        items: All files of the download.
        rejected_files: Unreadable and unsafe files.
        layout: The layout of the download.
        exercise: The exercise, "" to determine it, or ANY.

    Raises:
        CourseError: The exercise can't be determined, or files of several students seem to have one
            owner.
    """
    notebooks = [item for item in items if item.kind == "notebook"]
    exercise = exercise or _exercise_of(notebooks, layout)
    _reject_shared_owners(notebooks, layout)
    choice = Choice()
    by_owner = defaultdict[str, list[DownloadedFile]](list)
    for item in items:
        by_owner[item.owner].append(item)
    problems = defaultdict[str, list[RejectedFile]](list)
    for file in rejected_files:
        problems[file.download_name.key].append(file)
    for owner in sorted({*by_owner, *problems}):
        _choose_for_owner(by_owner[owner], problems[owner], exercise, choice)
    return choice


def _choose_for_owner(
    items: Sequence[DownloadedFile],
    rejected_files: Sequence[RejectedFile],
    exercise: str,
    choice: Choice,
) -> None:
    """Add one owner's files to the choice."""
    expected_exercises, set_aside, kept_items = set[str](), list[DownloadedFile](), list[DownloadedFile]()
    for item in items:
        expected = _expected_exercise(item.download_name, exercise)
        expected_exercises.add(expected)
        if item.kind == "working":
            continue
        if expected == ANY:
            (kept_items if item.is_touched else set_aside).append(item)
        elif item.exercise == expected or (not expected and not item.exercise):
            kept_items.append(item)
        else:
            set_aside.append(item)
    edited_exercises = {item.exercise for item in kept_items if item.is_touched and not item.problem}
    untouched = [item for item in kept_items if not item.is_touched and item.exercise in edited_exercises]
    kept_items = [item for item in kept_items if item not in untouched]
    choice.kept += [*kept_items, *(item for item in items if item.kind == "working")]
    choice.lines += _lines([*set_aside, *untouched], exercise)
    names = [file.download_name for file in rejected_files]
    expected_exercises |= {_expected_exercise(name, exercise) for name in names}
    missing = sorted(expected_exercises - {item.exercise for item in kept_items} - {ANY, ""})
    for name in missing if not kept_items else ():
        reasons = [f"{file.name}: {file.reason}" for file in rejected_files]
        for item in set_aside:
            state = "" if item.is_touched else ", as it was released"
            why = item.problem or f"it is {item.exercise}{state}, not {name}"
            reasons.append(f"{item.download_name.below[-1]}: {why}")
        reasons += [
            f"{item.download_name.below[-1]}: a file without a notebook"
            for item in items
            if item.kind == "working"
        ]
        download_name = items[0].download_name if items else rejected_files[0].download_name
        more = (
            f"; and {format_count(len(reasons) - MOST_NAMED, 'other')}" if len(reasons) > MOST_NAMED else ""
        )
        why = f"{'; '.join(reasons[:MOST_NAMED])}{more}. {ADVICE.format(name)}"
        choice.rejected.append((download_name, name, why))


def _expected_exercise(download_name: readers.DownloadName, exercise: str) -> str:
    """Return the exercise that counts for a file.

    The title of its assignment has priority over the option.
    """
    return (
        download_name.assignment
        if download_name.assignment and exercise in ("", download_name.assignment)
        else exercise
    )


def _lines(items: Iterable[DownloadedFile], exercise: str) -> list[str]:
    """Return a line for each file that was set aside, and one for all unchanged exercises of an owner."""
    lines, untouched = [], []
    for item in items:
        if not item.is_touched and not item.problem:
            untouched.append(item)
        elif item.problem:
            lines.append(f"set aside: {item.path}: {item.problem}")
        else:
            expected = _expected_exercise(item.download_name, exercise)
            lines.append(
                f"set aside: {item.path}: it is {item.exercise}, but this download counts for {expected}"
            )
    if untouched:
        names = ", ".join(sorted({item.exercise for item in untouched}))
        released_count = format_count(len(untouched), "exercise")
        lines.append(f"ignored: {untouched[0].download_name.name}: {released_count} as released: {names}")
    return lines


def _exercise_of(notebooks: Sequence[DownloadedFile], layout: readers.Layout) -> str:
    """Return the exercise of a download, or "" if it cannot be determined.

    It is the only one that students have worked on, else the only one that every student submitted.
    Any other rule would let one student's files decide for the others.

    Raises:
        CourseError: Several exercises are possible.
    """
    without_assignment = [
        item for item in notebooks if item.exercise and not item.download_name.assignment and not item.problem
    ]
    edited_exercises = {item.exercise for item in without_assignment if item.is_touched}
    exercises = edited_exercises or {item.exercise for item in without_assignment}
    if len(exercises) > 1:
        exercises_by_owner = defaultdict[str, set[str]](set)
        for item in without_assignment:
            exercises_by_owner[item.owner].add(item.exercise)
        shared = set.intersection(*exercises_by_owner.values())
        exercises = shared if len(shared) == 1 and len(exercises_by_owner) > 1 else exercises
    if len(exercises) > 1:
        owners = {
            name: len(
                {
                    item.owner
                    for item in without_assignment
                    if item.exercise == name and (item.is_touched or not edited_exercises)
                }
            )
            for name in sorted(exercises)
        }
        exercise_counts = ", ".join(
            f"{name} ({format_count(number, 'student')})" for name, number in owners.items()
        )
        first = max(owners, key=lambda name: owners[name])
        raise CourseError(
            f"this download contains {exercise_counts}. Which exercise is it for? Add --exercise {first}"
        )
    if exercises:
        return min(exercises)
    stated_exercises = {
        item.exercise for item in notebooks if item.exercise and not item.download_name.assignment
    }
    return min(stated_exercises) if len(stated_exercises) == 1 else ""


def exercise_option(text: str) -> str:
    """Return the exercise selected by --exercise.

    Raises:
        CourseError: The course has no such exercise.
    """
    if not text or text == ANY:
        return text
    name = full_exercise_name(text)
    known_exercises = sorted(path.stem for path in exercises_dir().glob("week*_exercise.ipynb"))
    if name not in known_exercises:
        raise CourseError(
            f"--exercise {text} is not an exercise of this course: expected one of "
            f"{', '.join(known_exercises)}"
        )
    return name


def _may_have_several_owners(group: Sequence[DownloadedFile]) -> bool:
    """Return whether the paths suggest that files in a folder belong to several students."""
    ids = {item.claimed_id for item in group}
    if len(ids) == 1 and None not in ids:
        return False
    folders = {item.download_name.below[:-1] for item in group}
    names = {
        item.download_name.below[-1]
        for item in group
        if find_exercise_name(item.download_name.below[-1]) is None
    }
    return len(folders) > 1 or len(names) > 1


def _reject_shared_owners(notebooks: Sequence[DownloadedFile], layout: readers.Layout) -> None:
    """Reject a download in which one folder seems to contain files of several students.

    Raises:
        CourseError: The message has the folder, the IDs, and options to pass.
    """
    if layout.name != readers.FOLDERS or layout.is_chosen:
        return
    groups = defaultdict[tuple[str, str], list[DownloadedFile]](list)
    for item in notebooks:
        if item.download_name.student and item.exercise and item.is_touched:
            groups[item.owner, item.exercise].append(item)
    # A single student may have copies in several folders, but hardly every student of a class.
    is_each = bool(groups) and all(map(_may_have_several_owners, groups.values()))
    for (owner, exercise), group in groups.items():
        ids = sorted({item.claimed_id for item in group if item.claimed_id})
        files = format_count(len(group), "file")
        if len(ids) > 1:
            problem = f"{owner} holds {files} of {exercise} with different student IDs ({', '.join(ids[:3])})"
        elif is_each and len(groups) == len({item.components[0] for item in notebooks}):
            problem = f"everything is in {owner}" if len(groups) == 1 else f"{owner} is one of {len(groups)}"
            problem += f", with {files} of {exercise} in several folders or under several names"
        else:
            continue
        raise CourseError(
            f"{problem}, so the layout of this download is unknown and nothing is collected. If "
            "the folders in it belong to students, unpack it and pass the folder with them; if "
            f"each file has its student's ID, as in Google Drive, add --layout google; if {owner} "
            "is one student, add --layout folders. The instructor's guide lists the supported "
            "platforms"
        )
