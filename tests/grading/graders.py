"""A class of small submissions, and graders in separate processes that tests interrupt."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

from course_lib.grading.store import Course
from tests.grading.conftest import RIGHT
from tests.processes import LIMIT_OF_A_SERVER, Program

GRADE = """
import sys, time
from pathlib import Path
from course_lib.errors import CourseError
from course_lib.grading import grade as stages
from course_lib.grading.grade import grade
from course_lib.grading.store import Course

def with_pauses(graded):
    def rows(work, *rest):
        for number, row in enumerate(graded(work, *rest), 1):
            yield row
            pause = work.out.with_name(f"pause_{number}")
            while pause.exists():
                pause.write_text("now")
                time.sleep(0.01)
    return rows

if __name__ == "__main__":
    stages._grade_all = with_pauses(stages._grade_all)
    top, out, jobs, flags = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
    course = Course(top / "course/exercises", top / "course/solutions")
    try:
        grade(top / "in", out, jobs=jobs, course=course, **dict.fromkeys(flags, True))
    except CourseError as error:
        sys.exit(f"error: {error}")
"""


def write_class(top: Path, count: int) -> Path:
    """Write `count` submissions that differ: right ones, wrong ones, some late."""
    for number in range(count):
        student = f"s{number:04}"
        code = RIGHT.replace("position.z = 0.5", f"position.z = {0.5 + 0.1 * (number % 3)}")
        cells = [{"cell_type": "code", "source": cell} for cell in code.split("# next cell\n")]
        content = {"nbformat": 4, "metadata": {"course": {"student": student}}, "cells": cells}
        folder = top / "in" / student
        folder.mkdir(parents=True)
        (folder / "week01_exercise.ipynb").write_text(json.dumps(content))
        (folder / "timestamp.txt").write_text(f"2026-10-1{number % 4} 12:00:00 UTC")
    return top / "in"


def start_grader(course: Course, out: Path, jobs: int, *flags: str) -> Program:
    """Start a grader of the class in a separate process.

    It pauses after row 3 as long as there is a file `pause_3` beside `out`, and says so in the
    file.
    """
    script = out.parent / "grade.py"
    script.write_text(GRADE)
    top = str(course.exercises.parents[1])
    command = [sys.executable, str(script), top, str(out), str(jobs), *flags]
    return Program(command, limit=LIMIT_OF_A_SERVER, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def fingerprint(out: Path) -> dict[str, str]:
    """Return hashes of marks, results and evidence, which must not depend on interruptions."""
    files = [out / "gradebook.csv", *out.glob("results/*/*.json"), *out.glob("evidence/*.gz")]
    return {str(file.relative_to(out)): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}
