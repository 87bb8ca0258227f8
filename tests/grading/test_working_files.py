import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.submission import find_submissions
from course_lib.grading.submissions.submit import submit
from course_lib.ros.messages.definitions import field_definitions

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
        submissions for submissions in find_submissions(exercise.parent) if submissions.claimed_id == "ada"
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


@pytest.mark.usefixtures("restored_packages")
def test_submissions_find_assets_and_message_packages_of_the_course(
    course: Course, tmp_path: Path, write_notebook: WriteNotebook, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    assets = {
        "arm.bin": b"\xff\x00",
        "week02/other_week.bin": b"",
        "soil_msgs/package.xml": b"<package><name>soil_msgs</name></package>",
        "soil_msgs/msg/Soil.msg": b"float64 moisture 2.5\n",
    }
    for name, content in assets.items():
        path = course.exercises / "assets" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    code = """
from pathlib import Path
from soil_msgs.msg import Soil
found = Path("assets/arm.bin").read_bytes(), Path("assets/week02").exists()
# next cell
def half(length):
    return Soil().moisture if length == 5.0 and found == (b"\\xff\\x00", False) else length / 2
"""
    checks = course.exercises / "checks/week01.py"
    checks.write_text(
        checks.read_text()
        .replace("Call(4.0),", "Call(5.0),")
        .replace("expect_value(2.0,", "expect_value(2.5,")
    )
    write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", code)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    result = json.loads((tmp_path / "out/results/ada/week01_exercise.json").read_text())
    scores = {task["task"]: task["score"] for task in result["judgement"]["tasks"]}
    assert scores["week01.half"] == 40, result["judgement"]


@pytest.mark.usefixtures("restored_packages")
def test_types_of_assets_are_known_where_evidence_is_judged(course: Course) -> None:
    folder = course.exercises / "assets/clay_msgs"
    (folder / "msg").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>clay_msgs</name></package>")
    (folder / "msg/Clay.msg").write_text("float64 moisture\n")
    catalog_of(course)
    assert "clay_msgs/msg/Clay" in field_definitions()


def test_too_large_assets_are_rejected_with_the_largest_file(course: Course) -> None:
    (course.exercises / "assets").mkdir()
    (course.exercises / "assets/long.mcap").write_bytes(bytes(33_000_000))
    with pytest.raises(CourseError, match=r"33 MB, expected at most 32 MB.*long\.mcap \(33 MB\)"):
        catalog_of(course)
