"""From release to mark, as users go: the students' copy, a fresh environment, an answer, a mark."""

import csv
import os
import signal
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

from tests.authoring.test_new_course import BUILT_HERE
from tests.patience import PATIENCE
from tests.processes import Program

ROOT = Path(__file__).parents[1]
SOLUTION = ROOT / "solutions" / "week01_solution.ipynb"


def run(*command: str | Path, cwd: Path) -> str:
    process = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False, timeout=900)
    assert process.returncode == 0, process.stdout + process.stderr
    return process.stdout


@pytest.fixture(scope="module")
def instructors(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("instructors")


@pytest.fixture(scope="module")
def student(instructors: Path) -> Path:
    """A student's machine: the released project, installed in a new environment."""
    home = instructors.parent / "student"
    # `course release` would verify all weeks before, which tests/notebooks/test_answers.py does.
    write = "import pathlib; from course_lib.course.release import release; release(pathlib.Path({!r}))"
    run(sys.executable, "-c", write.format(str(home / "course")), cwd=ROOT)
    venv.create(home / "venv", with_pip=False)
    # pip and the dependencies, which take a minute to download, come from this environment; not the
    # kit.
    packages = next((home / "venv" / "lib").glob("python*/site-packages"))
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    # The build requirements also come from here; tests/test_distribution.py checks that all are
    # declared.
    options = ("-q", "--no-deps", *BUILT_HERE)
    run(home / "venv" / "bin" / "python", "-m", "pip", "install", *options, "-e", "course", cwd=home)
    return home


def course(student: Path) -> Path:
    return student / "venv" / "bin" / "course"


@pytest.mark.slow
def test_release_runs_from_its_own_copy_and_contains_no_answers(student: Path) -> None:
    code = "import course_lib; print(course_lib.__file__)"
    used = run(student / "venv" / "bin" / "python", "-c", code, cwd=student)
    assert used.startswith(str(student / "course"))
    assert not [p for p in (student / "course").rglob("*") if "solution" in p.name]


@pytest.fixture(scope="module")
def lab_address(student: Path) -> str:
    """Run `course lab` once, which creates the student's folder; return the address that it printed."""
    command = [str(course(student)), "lab", "--no-browser"]
    process = Program(command, cwd=student, stdout=subprocess.PIPE)
    address = process.find(r"http://\S+")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE)
    return address


@pytest.mark.slow
def test_course_lab_opens_the_student_folder(student: Path, lab_address: str) -> None:
    assert "token=" in lab_address
    assert (student / "my_course" / "week01_exercise.ipynb").is_file()


@pytest.mark.slow
@pytest.mark.usefixtures("lab_address")
def test_solved_exercise_is_checked_submitted_and_gets_full_marks(student: Path, instructors: Path) -> None:
    folder = student / "my_course"
    (folder / "week01_exercise.ipynb").write_bytes(SOLUTION.read_bytes())
    assert "all public checks passed" in run(course(student), "check", "week01_exercise.ipynb", cwd=folder)
    receipt = run(course(student), "submit", "week01_exercise.ipynb", "--out", "handed_in.zip", cwd=folder)
    assert "handed_in.zip" in receipt
    (instructors / "inbox" / "ada").mkdir(parents=True)
    os.rename(folder / "handed_in.zip", instructors / "inbox" / "ada" / "handed_in.zip")
    run(sys.executable, "-m", "course_lib", "grade", "inbox", "--out", "graded", cwd=instructors)
    (row,) = csv.DictReader((instructors / "graded" / "gradebook.csv").read_text().splitlines())
    assert (row["student"], row["score"], row["max_score"]) == ("ada", "110.0", "100.0")
    report = (instructors / "graded" / "reports" / "ada" / "week01_exercise.html").read_text()
    assert "110 of 100" in report.replace(".0", "")
