"""A term on this machine: a class handed in, graded in the jail, returned and added up; seconds of each.

    python -m tests.benchmarks.bench_term --students 12 --weeks 1 3
    python -m tests.benchmarks.bench_term --records 180      # records alone: no code runs

Students hand in the right answer, one with a change, or nothing; some are late. The
totals are computed again by tests/grading/term/recompute.py, which must agree.
"""

import argparse
import csv
import json
import random
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from zoneinfo import ZoneInfo

from course_lib.course.course_file import CourseFile, read_course_file
from course_lib.course.exercise import read_notebook
from course_lib.course.installation import exercises_dir, solutions_dir
from course_lib.grading.grade import grade
from course_lib.grading.handin.collect import collect
from course_lib.grading.records import Course
from course_lib.grading.reports.feedback import feedback
from course_lib.grading.reports.tables import write_tables
from course_lib.grading.term.term import Files, write_term
from tests.grading.platforms import Handed, moodle_zip, table
from tests.grading.term import recompute
from tests.grading.term.simulated import write_results

ZONE = ZoneInfo("Europe/Paris")
CHANGES = (("+ ", "- "), ("0.5", "0.6"), ('"map"', '"base"'), ("sin(", "cos("), ("range(", "range(1, "))
TERM = '\n[term]\ndrop_lowest = 1\ngroup_weeks = ["week07"]\n'
TIMES = ("Sunday, 7 March 2027, 8:00 PM", "Tuesday, 9 March 2027, 8:00 AM")  # before and after the deadline


@contextmanager
def timed(what: str, count: int) -> Iterator[None]:
    """Print the seconds of a stage, and for each thing."""
    begin = time.perf_counter()
    yield
    seconds = time.perf_counter() - begin
    sys.stdout.write(
        f"{what:12} {seconds:8.2f} s  {1000 * seconds / max(count, 1):8.1f} ms each of {count}\n"
    )


def settings_in(top: Path) -> Path:
    """Write a course.toml with a deadline for each week, beside links to the course."""
    folder = top / "exercises"
    folder.mkdir()
    for path in exercises_dir().iterdir():
        if path.name != "course.toml":
            (folder / path.name).symlink_to(path)
    lines = ['time_zone = "Europe/Paris"']
    for line in (exercises_dir() / "course.toml").read_text().splitlines():
        lines += [line, *["deadline = 2027-03-07T23:59:00"] * (line.startswith("title") and len(lines) > 2)]
    (folder / "course.toml").write_text("\n".join(lines) + TERM)
    return folder / "course.toml"


def handed_in(week: str, students: Sequence[str], chance: random.Random) -> list[Handed]:
    """Return right answers, changed ones and gaps."""
    solution = json.dumps(read_notebook(solutions_dir() / f"{week}_solution.ipynb"))
    made = []
    for number, student in enumerate(students):
        kind = chance.choice(("right", "wrong", "wrong", "wrong", "missing"))
        old, new = chance.choice(CHANGES) if kind == "wrong" else ("", "")
        text = solution.replace(old.replace('"', '\\"'), new.replace('"', '\\"')) if old else solution
        if kind != "missing":
            files = {f"{week}_exercise.ipynb": text.encode()}
            made.append(Handed(student, 1000 + number, student, chance.choice(TIMES), files))
    return made


def graded_class(top: Path, students: Sequence[str], weeks: Sequence[str], toml: Path) -> Path:
    """Collect, grade and return the hand-ins of all weeks."""
    chance, out = random.Random(0), top / "graded"
    course = Course(toml.parent, solutions_dir())
    count = 0
    for week in weeks:
        handed = handed_in(week, students, chance)
        count += len(handed)
        moodle_zip(top / f"{week}.zip", handed)
        rows = [(f"Participant {one.number}", one.id, one.time) for one in handed]
        table(top / f"{week}.csv", ("Identifier", "ID number", "Last modified (submission)"), rows)
    with timed("collect", count):
        for week in weeks:
            collect(top / f"{week}.zip", top / "in", ZONE, top / f"{week}.csv")
    with timed("grade", count):
        grade(top / "in", out, course=course)
    with timed("feedback", count):
        sys.stdout.write("\n".join(feedback(out, "moodle", course=course)) + "\n")
    return out


def add_up(out: Path, top: Path, students: Sequence[str], toml: Path, course: CourseFile) -> None:
    """Write the tables of the class, and compare the totals with those of a script of its own."""
    roster = top / "roster.csv"
    roster.write_text("id,group\n" + "".join(f"{one},g{n // 3}\n" for n, one in enumerate(students)))
    results = len(list(out.glob("results/*/*.json")))
    with timed("tables", results):
        write_tables(out, ZONE)
    with timed("term", results):
        sys.stdout.write("\n".join(write_term(out, Files(roster), course)) + "\n")
    with (out / "term.csv").open(newline="") as file:
        totals = {row["student"]: row["total"] for row in csv.DictReader(file)}
    again = recompute.totals(out, roster, toml)
    wrong = [one for one, total in again.items() if abs(float(totals[one] or 0) - (total or 0)) > 0.03]
    sys.stdout.write(f"{len(totals)} totals, {len(wrong)} of them differ from the script's: {wrong}\n")


def main() -> None:
    """Run a class, or only its records."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--students", type=int, default=12)
    parser.add_argument("--weeks", type=int, nargs="+", default=[1, 3])
    parser.add_argument("--records", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder)
        toml = settings_in(top)
        course = read_course_file(toml)
        students = [f"s{number:03}" for number in range(options.records or options.students)]
        if options.records:
            out = top / "graded"
            write_results(out, students, course)
        else:
            out = graded_class(top, students, [f"week{week:02}" for week in options.weeks], toml)
        add_up(out, top, students, toml, course)


if __name__ == "__main__":
    main()
