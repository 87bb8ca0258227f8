import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.grading.grade import grade
from course_lib.grading.store import Course
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.submission import find_submissions
from course_lib.grading.submissions.submit import submit

WriteNotebook = Callable[..., Path]
CODE = """
layout = "layouts/mine.rviz"
others = ["../secret.yaml", "/etc/a.yaml", "link.yaml", "none.yaml", "photo.png", "C:\\\\a.yaml", "fine.yaml"]
"""


@pytest.fixture
def exercise(tmp_path: Path, write_notebook: WriteNotebook) -> Path:
    """A notebook that refers to two files in its folder, and to others that must not be packed."""
    path = write_notebook(tmp_path / "work/week01_exercise.ipynb", CODE, student="ada")
    (tmp_path / "work/layouts").mkdir()
    (tmp_path / "work/layouts/mine.rviz").write_text("Panels: é")
    (tmp_path / "work/fine.yaml").write_text("a: 1")
    (tmp_path / "work/photo.png").write_text("not a kind of file that tasks have")
    (tmp_path / "secret.yaml").write_text("b: 2")
    (tmp_path / "work/link.yaml").symlink_to(tmp_path / "secret.yaml")
    return path


def test_submission_package_contains_and_lists_the_files_used_by_the_notebook(
    exercise: Path, tmp_path: Path
) -> None:
    receipt = submit(exercise, tmp_path / "handed_in.zip")
    assert receipt.content["files"] == "layouts/mine.rviz, fine.yaml"
    (tmp_path / "in").mkdir()
    (tmp_path / "handed_in.zip").rename(tmp_path / "in/handed_in.zip")
    (submission,) = find_submissions(tmp_path / "in")
    assert submission.files == {"layouts/mine.rviz": "Panels: é", "fine.yaml": "a: 1"}
    assert submission.sha256 == receipt.content["sha256"]


def test_working_files_are_searched_only_in_the_notebook_folder(exercise: Path) -> None:
    assert list(working_files(exercise, (CODE,))) == ["layouts/mine.rviz", "fine.yaml"]


def test_notebooks_of_several_students_in_one_folder_share_no_files(exercise: Path) -> None:
    submissions = [
        submissions for submissions in find_submissions(exercise.parent) if submissions.claimed == "ada"
    ]
    assert submissions[0].files == {}


def test_archive_members_with_unsafe_names_are_ignored(exercise: Path, tmp_path: Path) -> None:
    packed = submit(exercise, tmp_path / "handed_in.zip").file
    with zipfile.ZipFile(packed, "a") as archive:
        for name in ("files/../../evil.yaml", "files//etc/evil.yaml", "files/large.yaml"):
            archive.writestr(name, "x" * 2_000_000)
    assert list(working_files(packed, ())) == ["layouts/mine.rviz", "fine.yaml"]


def test_file_task_is_graded_with_the_submitted_file(
    course: Course, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    checks = course.exercises / "checks/week01.py"
    text = checks.read_text()
    checks.write_text(
        text.replace(
            '"week01.answer", "Your number", "value", "answer", HINTS, personal={"n": (10, 20, 30)}',
            '"week01.answer", "Your layout", "file", "layout", HINTS',
        ).replace('expect_value(my("n", times=2))', 'expect_text("Panels")')
    )
    for student, content in (("ada", "Panels: 1"), ("bob", "nothing")):
        write_notebook(tmp_path / "in" / student / "week01_exercise.ipynb", 'layout = "layouts/mine.rviz"')
        (tmp_path / "in" / student / "layouts").mkdir()
        (tmp_path / "in" / student / "layouts/mine.rviz").write_text(content)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    scores = {}
    for path in (tmp_path / "out/results").glob("*/*.json"):
        tasks = json.loads(path.read_text())["judgement"]["tasks"]
        scores[path.parent.name] = next(task["score"] for task in tasks if task["task"] == "week01.answer")
    assert scores == {"ada": 10, "bob": 0}
