import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from course_lib.grading.executors import InlineExecutor
from course_lib.grading.grade import grade
from course_lib.grading.jail.launch import shared_template
from course_lib.grading.records import CheckResult, TaskResult
from course_lib.grading.reports.report import _sorted_rows
from course_lib.grading.store import Course

WriteNotebook = Callable[..., Path]
SCRIPT = "<script>alert(1)</script>"


def report(course: Course, tmp_path: Path, notebook: Path) -> str:
    grade(notebook.parents[1], tmp_path / "out", jobs=1, course=course)
    return (tmp_path / "out/reports/ada/week01_exercise.html").read_text()


def test_report_shows_mark_reasons_and_both_scenes(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    wrong = right.replace("position.z = 0.5", "position.z = 0.2")
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", wrong))
    for text in (
        "A red cube",
        "0.30 m too low",
        "45 of 60 points",
        "<strong>Yours</strong>",
        "<strong>Expected</strong>",
    ):
        assert text in page
    assert page.count('class="course-scene"') == 2
    assert len(page) < 100_000


def test_report_is_self_contained(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", right))
    assert not re.findall(r"""(?:src|href)=["']?(?:https?:)?//""", page)


def test_student_text_is_escaped(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    code = right.replace('frame_id = "map"', f'frame_id = "{SCRIPT}"')
    code += f"# next cell\nprint('{SCRIPT}')\n# next cell\nraise ValueError('{SCRIPT}')\n"
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", code))
    assert "&lt;script&gt;alert(1)" in page
    assert SCRIPT not in page


def test_title_and_values_of_a_hidden_check_are_not_shown(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    wrong = right.replace("create_timer(1.0", "create_timer(0.5").replace("length / 2", "abs(length) / 2")
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", wrong))
    assert "a topic is published too fast" in page
    assert "a value has the wrong sign" in page
    assert "2.00 Hz" not in page
    assert "3.5" not in page.split("<script>")[0].replace("0.35", "")


def test_exception_text_does_not_reveal_hidden_inputs_in_the_report(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    spy = right.replace("return length / 2", "raise ValueError(f'got {length}')")
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", spy))
    assert "ValueError: got 4.0" in page
    # The name of the viewer's file has a digest, which may contain the digits.
    assert "-7" not in re.sub(r"viewer-\w+\.js", "", page.split("<script>")[0])
    assert "in a hidden scenario the code raises an exception" in page


def test_report_states_its_isolation(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", right))
    assert f"Ran with isolation: {shared_template().isolation}." in page


def test_lateness_is_reported_in_the_time_zone_of_the_course(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    notebook = write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", right)
    (tmp_path / "in/received.csv").write_text(
        "file,received\nada/week01_exercise.ipynb,2026-10-12T22:10:00Z\n"
    )
    page = " ".join(report(course, tmp_path, notebook).split())
    assert "Received 2026-10-13 00:10+02:00 (Europe/Paris; by received.csv)" in page
    assert "deadline 2026-10-11 23:59+02:00: 2 started days late." in page
    assert "takes off 2 \u00d7 10 % of 110 points: 110 \u2212 22 = <strong>88</strong>." in page


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("points", "message"),
    [(1, ""), (3000, "Reduced to"), (100_000, "a report has room for")],
)
def test_report_size_is_limited_regardless_of_the_published_messages(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook, points: int, message: str
) -> None:
    cloud = "import random\nfrom geometry_msgs.msg import Point\n" + right.replace(
        "marker.pose.position.z = 0.5",
        "marker.type = Marker.POINTS\n        "
        f"marker.points = [Point(x=random.random(), y=random.random()) for _ in range({points})]",
    ).replace("create_timer(1.0", "create_timer(0.05")
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", cloud))
    assert len(page) < 1_000_000
    assert message in page


def test_failed_checks_are_listed_first_and_hidden_checks_keep_their_numbers(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    wrong = right.replace("marker.color.r = marker.color.a", "marker.color.b = marker.color.a")
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", wrong))
    task = page.split("<h2")[1]
    assert task.index("✗ failed") < task.index("✓ passed")


def test_terminal_colors_and_bidirectional_controls_are_removed(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    code = right + "# next cell\nprint('\\x1b[31mred\\x1b[0m \\u202eleft\\x07')\n"
    page = report(course, tmp_path, write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", code))
    assert "red left" in page


def test_checks_with_the_same_failure_share_a_row_above_passed_checks() -> None:
    def check(title: str, score: float, why: str) -> CheckResult:
        return CheckResult(title, "public", False, 1.0, score, why, "a kind")

    checks = check("a", 1.0, "as expected"), check("b", 0.0, "nothing came"), check("c", 0.0, "nothing came")
    result = TaskResult("week01.x", "X", 10.0, False, checks)
    assert [row[2] for row in _sorted_rows(result, is_final=False)] == ["b; c", "a"]


def test_failure_to_write_a_report_is_reported_and_the_mark_is_kept(
    course: Course,
    right: str,
    write_notebook: WriteNotebook,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def fail(*_: object) -> None:
        raise ValueError("too short")

    @contextmanager
    def in_this_process(*_: object) -> Iterator[tuple[InlineExecutor, InlineExecutor, int]]:
        yield InlineExecutor(), InlineExecutor(), 1

    monkeypatch.setattr("course_lib.grading.grade.report", fail)
    monkeypatch.setattr("course_lib.grading.grade.executors", in_this_process)
    write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", right, student="ada")
    assert grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    output = capsys.readouterr().out
    assert "No report could be written: ValueError: too short (ada). The marks are valid." in output
    assert ",110.0,graded" in (tmp_path / "out/gradebook.csv").read_text()
