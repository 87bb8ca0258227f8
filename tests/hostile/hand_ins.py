"""Downloads of generated classes whose students choose names resembling those of the platforms."""

import json
import random
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError
from course_lib.grading.submissions.collect import collect
from course_lib.grading.submissions.readers import choose_layout
from course_lib.grading.submissions.submission import find_submissions
from tests.grading.platforms import NAME, notebook, zipped

PARIS = ZoneInfo("Europe/Paris")
TRICKS = (
    "4100001", "_4100001_", "_4100001_90001_", "_assignsubmission_file_",
    "x_4100002_assignsubmission_file_", "_attempt_2020-01-01-00-00-00_", " - Mar 1, 2020 100 AM - ",
    "(4100003)", "Submission attachment(s)", "submitted", "inbound", "+week01+2020-01-01 00:00:00 UTC+",
    "Version 99", "anon_ab_1_", "LATE_", "Abgaben", "A_B_c_4100001", " - 2020-01-01T00:00:00.000000",
    "submission_4100001", "week01", "é", ".", "..", " ", "-", "timestamp.txt", "received.csv",
    "submission_metadata.yml", "grades.csv", "\\", ":", "\u202e", "%s", "=1+1",
)  # fmt: skip


@dataclass(frozen=True)
class Naming:
    """A platform's naming scheme for a student's files, and the folder of the collected files."""

    prefix: Callable[[int], str]
    student: Callable[[int], str]


NAMINGS: dict[str, Naming] = {
    "moodle folders": Naming(lambda n: f"S {n}_{n}_assignsubmission_file_/", lambda n: f"participant{n}"),
    "moodle": Naming(lambda n: f"S {n}_{n}_assignsubmission_file_", lambda n: f"participant{n}"),
    "canvas": Naming(lambda n: f"s{n}_{n}_9{n}_", str),
    "blackboard": Naming(lambda n: f"Week 1_u{n}_attempt_2026-03-08-23-59-00_", lambda n: f"u{n}"),
    "brightspace": Naming(lambda n: f"{n}-64 - S {n} - Mar 8, 2026 1159 PM/", str),
    "sakai": Naming(lambda n: f"Week 1/S, N({n})/Submission attachment(s)/", str),
    "gradescope": Naming(lambda n: f"assignment_9_export/submission_{n}/", str),
    "teams": Naming(lambda n: f"Submitted files/S {n}/Week 1/Version 1/", lambda n: f"s{n}"),
    "ilias": Naming(lambda n: f"Week 1/Abgaben/S_N_u{n}_{n}/", lambda n: f"u{n}"),
    "codegrade": Naming(lambda n: f"Week 1/S {n} - 2026-03-08T22:59:00.000000/", lambda n: f"s{n}"),
    "nbgrader": Naming(lambda n: f"submitted/{n}/week01/", str),
    "folders": Naming(lambda n: f"{n}/", str),
}


def _name(chance: random.Random) -> str:
    parts = [chance.choice(TRICKS) for _ in range(chance.randint(0, 3))]
    ending = chance.choice(
        (NAME, NAME, "week01_exercise.ipynb.txt", "week01_exercise.json", "week01_exercise (1).ipynb")
    )
    return "".join(parts).replace("/", "") + ending


def _hand_in(chance: random.Random, number: int) -> dict[str, bytes]:
    """Return one student's files by their paths after the platform's prefix."""
    mine = notebook(f"owner = {number}", exercise="week01_exercise")
    folders = "".join(f"{chance.choice(TRICKS)}/" for _ in range(chance.choice((0, 0, 1, 2))))
    files = {folders + _name(chance): mine}
    if chance.random() < 0.3:
        inner = {
            f"{chance.choice(TRICKS)}/{_name(chance)}": mine,
            "timestamp.txt": b"2020-01-01 00:00:00 UTC",
        }
        files[chance.choice(TRICKS).strip(".") + "hw.zip"] = zipped(inner)
    if chance.random() < 0.2:
        receipt = {"exercise": "week01_exercise", "student": "4100001", "time": "2020-01-01T00:00:00+00:00"}
        files["packed.zip"] = zipped({NAME: mine, "receipt.json": json.dumps(receipt).encode()})
    if chance.random() < 0.2:
        files[f"{chance.choice(TRICKS)}/timestamp.txt"] = b"2020-01-01 00:00:00 UTC"
    return files


def read_class(chance: random.Random, students: int = 20) -> int:
    """Read the names of one class without collecting it. Return the number of submissions.

    Raises:
        AssertionError: A name selects another student or time than the platform's part of it.
    """
    naming = NAMINGS[chance.choice(sorted(set(NAMINGS) - {"gradescope"}))]
    names: dict[tuple[str, ...], int] = {}
    for number in range(4100001, 4100001 + students):
        folders = "".join(f"{chance.choice(TRICKS)}/" for _ in range(chance.choice((0, 0, 1, 2))))
        names[tuple(f"{naming.prefix(number)}{folders}{_name(chance)}".split("/"))] = number
    layout = choose_layout(sorted(names), "in.zip", PARIS)
    for path, number in names.items():
        try:
            download_name = layout.read(path)
        except CourseError:
            continue
        assert download_name.student == naming.student(number), path
        assert download_name.time is None or download_name.time.year == 2026, path
    return students


def collect_class(chance: random.Random, students: int = 5) -> int:
    """Collect one class; returns how many hand-ins it had.

    Raises:
        AssertionError: A file lies in the folder of another student, or has a time that its student
            chose.
    """
    naming = NAMINGS[chance.choice(sorted(NAMINGS))]
    numbers = [4100001 + number for number in range(students)]
    files: dict[str, bytes] = {}
    for number in numbers:
        files |= {naming.prefix(number) + name: data for name, data in _hand_in(chance, number).items()}
    if naming is NAMINGS["gradescope"]:
        people = "".join(f"submission_{n}:\n  :submitters:\n  - :name: S\n    :sid: '{n}'\n" for n in numbers)
        files["assignment_9_export/submission_metadata.yml"] = people.encode()
    with tempfile.TemporaryDirectory() as work, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of names that are in an archive twice
        source, out = Path(work, "in.zip"), Path(work, "out")
        source.write_bytes(zipped(files))
        try:
            collect(source, out, PARIS)
            submissions = find_submissions(out, zone=PARIS, with_rejected=True)
        except CourseError:
            # The layout is ambiguous, or every file of the class was refused.
            return students
        owners = {naming.student(number): number for number in numbers}
        for one in submissions:
            assert one.student in owners, (sorted(files), one.path)
            code = one.notebook.cells if one.notebook else (f"owner = {owners[one.student]}",)
            assert code == (f"owner = {owners[one.student]}",), (sorted(files), one.path)
            time = one.received.time if one.received.is_trusted else None
            assert time is None or time.year == 2026, (sorted(files), one.path)
    return students
