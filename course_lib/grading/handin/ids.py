"""The student whose personal values count: the sender's ID against the ID that the file names."""

import csv
import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from course_lib.course.identity import normalise
from course_lib.errors import CourseError
from course_lib.grading.handin.received import ID_FROM, LIST
from course_lib.grading.handin.submission import Submission

ROSTER, PLATFORM = "roster", "platform"  # in the column ID_FROM of received.csv
MISMATCH, NO_ID, UNVERIFIED = "ID mismatch", "no ID", "ID not verified"
PLATFORM_NAME = re.compile(r"participant_?\d+|.+_\d+_assignsubmission_.*")  # Moodle's, before a roster


def with_ids(found: Sequence[Submission], top: Path) -> list[Submission]:
    """Return the submissions with the student whose personal values count for each.

    The folder names the student, and the student's values count, whatever ID is in the file. Only where the
    folder's name is the platform's own number, as no roster was given, does the file's ID count; then nobody
    can tell whether it is right, unless two students name the same one.

    Args:
        found: All submissions of a class.
        top: Their folder, with the received.csv that `course collect` wrote.
    """
    numbers = _platform_numbers(top)
    owners = defaultdict[str, set[str]](set)
    for one in found:
        owners[one.student].add(one.student)
        if one.claimed:
            owners[one.claimed].add(one.student)
    return [_with_id(one, top, numbers, owners) for one in found]


def _with_id(one: Submission, top: Path, numbers: frozenset[str], owners: dict[str, set[str]]) -> Submission:
    if not one.sha256:  # it can't be read: nothing in it is judged
        return one
    is_number = one.student in numbers or PLATFORM_NAME.fullmatch(one.student)
    if one.path.parent != top and not is_number:
        return _of_folder(one)
    if is_number and one.claimed and owners[one.claimed] != {one.student}:
        note = f"the file names {one.claimed}, as does the file of somebody else"
        return replace(one, values_of=one.claimed, id_flag=MISMATCH, id_note=note)
    if one.claimed is None:
        note = "the file names no student: judged with the personal values of a guest"
        return replace(one, id_flag=NO_ID, id_note=note)
    return replace(one, values_of=one.claimed, id_flag=UNVERIFIED)  # often true of all: one line says so


def _of_folder(one: Submission) -> Submission:
    """Return a submission whose folder is its student's."""
    mine = replace(one, values_of=one.student)
    if one.claimed == one.student:
        return mine
    judged = f"judged with the personal values of {one.student}"
    if one.claimed is None:
        return replace(mine, id_flag=NO_ID, id_note=f"the file names no student: {judged}")
    note = f"the file names {one.claimed}, but {one.student} handed it in: {judged}"
    return replace(mine, id_flag=MISMATCH, id_note=note)


def _platform_numbers(top: Path) -> frozenset[str]:
    """Return the folders that `course collect` named after a platform's number, for want of a roster."""
    path = top / LIST
    if not path.is_file():
        return frozenset()
    try:
        with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
            rows = [row for row in csv.DictReader(file) if row.get(ID_FROM) == PLATFORM]
    except (OSError, csv.Error):  # reading the times from it says so
        return frozenset()
    return frozenset(_folder(row.get("file") or "") for row in rows)


def _folder(file: str) -> str:
    """Return the student's folder of a path in received.csv, as a submission has it."""
    name = file.lstrip("'").split("/")[0]
    try:
        return normalise(name)
    except CourseError:
        return name
