"""`course new course "Robotics 101"` creates an installable project, tested from creation to a mark."""

import csv
import errno
import json
import os
import subprocess
import sysconfig
import venv
from pathlib import Path
from unicodedata import normalize

import pytest

from course_lib.authoring.new import new_course
from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from tests.grading.autograder_layout import graded_upload

ROOT = Path(__file__).parents[2]
PACKAGE = "course_robotics_101"


# The build requirements also come from this environment, which saves most of 5 s of CPU time.
BUILT_HERE = ("--no-build-isolation", "--check-build-dependencies")


def install(home: Path, project: Path, *options: str) -> Path:
    """Return the Python of a new environment in which a project and the kit are installed."""
    venv.create(home, with_pip=False)
    packages = next(home.glob("lib/python*/site-packages"))
    # The kit and its dependencies come from this environment; the course itself does not.
    (packages / "kit.pth").write_text(f"{sysconfig.get_path('purelib')}\n{ROOT}\n")
    python = home / "bin" / "python"
    run(python, "-m", "pip", "install", "-q", "--no-deps", *options, "-e", project, cwd=home)
    return python


def run(*command: str | Path, cwd: Path, code: int = 0) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def test_course_that_cannot_be_written_completely_leaves_no_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr("course_lib.authoring.new.new_week", fail)
        with pytest.raises(OSError, match="No space left on device"):
            new_course("Robotics 101", tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert (new_course("Robotics 101", tmp_path) / "pyproject.toml").is_file()


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return new_course("Robotics 101", tmp_path_factory.mktemp("authors"))


@pytest.fixture(scope="module")
def python(project: Path) -> Path:
    return install(project.parent / "venv", project)


@pytest.mark.slow
def test_new_course_can_be_verified_released_installed_and_graded(project: Path, python: Path) -> None:
    output = run(python, "-m", "course_lib", "verify", "week00", cwd=project)
    assert "week00: 0 flaws" in output
    assert "Everything is correct." in output
    # The course's own test verifies all weeks and runs their lessons. pytest takes 1.3 s to load
    # nbmake.
    run(python, "-m", "pytest", "-q", "-p", "no:nbmake", "tests", cwd=project)
    students = project.parent / "students"
    # `course release` would verify the same files again; tests/authoring/test_guide.py runs it.
    code = "from pathlib import Path; from course_lib.course.release import release; "
    run(python, "-c", f"{code}release(Path({str(students)!r}))", cwd=project)
    names = {path.relative_to(students).as_posix() for path in students.rglob("*") if path.is_file()}
    assert {f"{PACKAGE}/__init__.py", "exercises/week01_exercise.ipynb", "pyproject.toml"} <= names
    assert not [name for name in names if "solution" in name or name.startswith("tests")]
    hand_in(project, project.parent / "inbox" / "ada")
    run(python, "-m", "course_lib", "grade", "inbox", "--out", "graded", cwd=project.parent)
    (row,) = csv.DictReader((project.parent / "graded" / "gradebook.csv").read_text().splitlines())
    assert (row["student"], row["score"], row["max_score"]) == ("ada", "100.0", "100.0")


def hand_in(project: Path, folder: Path) -> None:
    folder.mkdir(parents=True)
    notebook = json.loads((project / "solutions" / "week01_solution.ipynb").read_text())
    notebook["metadata"]["course"]["student"] = "ada"
    (folder / "week01_exercise.ipynb").write_text(json.dumps(notebook))


@pytest.mark.slow
def test_installed_course_is_found_from_any_working_directory(python: Path, tmp_path: Path) -> None:
    code = (
        "from pathlib import Path; from course_lib.course import student_folder\n"
        "print(*student_folder.prepare(Path('mine')).added)"
    )
    added = run(python, "-c", code, cwd=tmp_path).split()
    assert added == ["week00_start.ipynb", "week01_exercise.ipynb", "week01_first_steps.ipynb"]


@pytest.mark.slow
def test_course_of_the_current_folder_takes_precedence(project: Path, python: Path) -> None:
    other = new_course("Maps", project.parent)
    options = ("-q", "--no-deps", *BUILT_HERE)
    run(python, "-m", "pip", "install", *options, "-e", other, cwd=project.parent)
    code = "from course_lib.course.material import exercises_dir; print(exercises_dir())"
    assert run(python, "-c", code, cwd=other).strip() == str(other / "exercises")
    assert run(python, "-c", code, cwd=project).strip() == str(project / "exercises")
    assert "several courses are installed" in run(python, "-c", code, cwd=project.parent, code=1)
    run(python, "-m", "pip", "uninstall", "-q", "-y", "maps", cwd=project.parent)


@pytest.mark.slow
def test_new_week_in_an_uninstalled_course_does_not_change_another_course(
    project: Path, python: Path
) -> None:
    other = new_course("Not Installed", project.parent)
    output = run(python, "-m", "course_lib", "new", "week02", "Maps", cwd=other / "exercises", code=2)
    assert f"the installed one is {project}. To work on this one, run: pip install" in output
    assert f"run: cd '{project}'" in output
    assert not list(project.rglob("*week02*"))


@pytest.mark.parametrize("title", ["Feldrobotik Übung", "Feldrobotik U\u0308bung", "Fêldrøbotïk & Uebung!"])
def test_accents_of_a_title_are_left_out_of_the_names_of_package_and_folder(
    tmp_path: Path, title: str
) -> None:
    root = new_course(title.replace(" &", ""), tmp_path)
    assert root.name == "feldrobotik_uebung"
    course_file = (root / "exercises/course.toml").read_text(encoding="utf-8")
    assert course_file.startswith(f'title = "{normalize("NFC", title.replace(" &", ""))}"')
    text = (root / "pyproject.toml").read_text(encoding="utf-8")
    assert 'name = "feldrobotik-uebung"' in text
    assert text.replace("…", "").isascii()


def test_course_title_without_latin_letters_is_rejected_with_a_way_out(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match=r"pip accepts no others\. Use such a title, and then write"):
        new_course("机器人", tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_new_course_depends_on_the_kit_and_lists_its_weeks(project: Path) -> None:
    assert "course-lib>=" in (project / "pyproject.toml").read_text()
    course = read_course_file(project / "exercises" / "course.toml")
    assert (course.title, list(course.weeks)) == ("Robotics 101", ["week00", "week01"])


@pytest.mark.slow
def test_gradescope_autograder_contains_course_and_kit_and_grades(
    project: Path, python: Path, tmp_path: Path
) -> None:
    archive = tmp_path / "autograder.zip"
    output = run(python, "-m", "course_lib", "gradescope", "week01", "--out", archive, cwd=project)
    assert "the course, the kit's" in output
    solution = project / "solutions" / "week01_solution.ipynb"
    results = graded_upload(archive, solution, tmp_path / "autograder")
    assert results["score"] == 100.0, results
    assert results["extra_data"]["status"] == "graded"
