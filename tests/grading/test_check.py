from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import course_lib.grading.check as check_module
from course_lib.course.state import student_state
from course_lib.errors import CourseError
from course_lib.grading import personal
from course_lib.grading.advice import Advice
from course_lib.grading.catalog import load_catalog
from course_lib.grading.check import CheckFailedError, check
from course_lib.grading.judge import CheckResult, TaskResult
from course_lib.grading.records import Course
from course_lib.grading.reports.table import Table


@pytest.fixture(autouse=True)
def student_folder(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A student in a folder of their own, with the small course installed."""
    (tmp_path / "mine/.course").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "mine")
    monkeypatch.setattr(check_module, "shipped_catalog", lambda: load_catalog(course.exercises))
    monkeypatch.setattr(check_module, "_ADVICE", Advice())
    monkeypatch.delenv("COURSE_STRICT", raising=False)


@pytest.fixture
def red_cube(right: str) -> Callable[..., Any]:
    def make(old: str = "", new: str = "") -> Any:
        names: dict[str, Any] = {}
        cell = right.split("# next cell")[0].replace("%load_ext course_lib", "")
        exec(cell.replace(old, new) if old else cell, names)
        return names["RedCubeNode"]

    return make


def test_full_marks_say_that_hidden_checks_follow(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube())
    said = capsys.readouterr().out
    assert "week01.red_cube (A red cube): 2 of 2 checks passed" in said
    assert "all public checks passed; hidden checks run at grading" in said
    assert student_state().get("progress", "week01.red_cube") == {"score": 60.0, "of": 60.0}


def test_the_hint_of_the_mistake_comes_first_and_then_the_ladder_whose_last_one_stays(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    said = []
    for _ in range(5):
        check("week01.red_cube", red_cube("position.z = 0.5", "position.z = 0.0"))
        said.append(capsys.readouterr().out.strip().splitlines())
    assert said[0][-1].startswith("Hint: pose.position is the centre of the shape.")
    assert [lines[-1] for lines in said[1:]] == [
        "Hint 1 of 3: Which fields has a marker?",
        "Hint 2 of 3: The centre is half an edge up.",
        "Hint 3 of 3: Set position.z to 0.5.",
        "Hint 3 of 3: Set position.z to 0.5.",
    ]
    assert "✗ failed" in said[0][1]
    assert "0.50 m too low" in said[0][1]


def test_another_mistake_gets_its_own_hint(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("position.z = 0.5", "position.z = 0.0"))
    check("week01.red_cube", red_cube("color.r =", "color.g ="))
    assert "Hint: r, g, b and a go from 0.0 to 1.0" in capsys.readouterr().out


def test_in_a_notebook_a_check_names_the_kind_of_mistake_first_and_the_numbers_next(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(check_module, "in_notebook", lambda: True)
    monkeypatch.setattr("course_lib.grading.reports.ghost_view.show_ghost", lambda *_: None)
    for seen in (False, True):
        check("week01.red_cube", red_cube("position.z = 0.5", "position.z = 0.0"))
        said = capsys.readouterr().out
        assert ("the position of a marker is wrong" in said, "0.50 m too low" in said) == (not seen, seen)


def test_an_untouched_stub_uses_up_no_hint(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    stub = red_cube("self.publisher.publish(marker)", "raise NotImplementedError('publish it')")
    check("week01.red_cube", stub)
    said = capsys.readouterr().out
    assert "Nothing is filled in yet" in said
    assert said.count("publish it") == 1
    assert "Hint" not in said


def test_an_exception_is_shown_with_the_students_line_and_no_traceback(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("marker.color.r =", "marker.colour.r ="))
    said = capsys.readouterr().out
    assert "AttributeError: 'Marker' object has no attribute 'colour'" in said
    assert "Traceback" not in said


def test_a_value_instead_of_a_function_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    check("week01.half", 4.0)
    assert "got an object of float, expected a function" in capsys.readouterr().out


def test_an_unknown_task_names_the_close_ones() -> None:
    with pytest.raises(CourseError, match=r"Did you mean week01\.red_cube"):
        check("week01.redcube", object)


def test_a_failed_check_raises_where_that_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_STRICT", "1")
    check("week01.half", lambda length: length / 2)
    with pytest.raises(CheckFailedError, match="expected 2"):
        check("week01.half", lambda length: length)


def test_own_values_are_those_of_the_student(
    course: Course, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    student_state().put("identity", "student", "20231234")
    task = load_catalog(course.exercises).task("week01.answer")
    check("week01.answer", 2 * personal.personal_values(task, "20231234")["n"])
    assert "1 of 1 checks passed" in capsys.readouterr().out


def test_html_shows_words_and_icons_and_escapes_everything() -> None:
    bad = CheckResult("<b>title</b>", "public", False, 1, 0.0, "<script>alert(1)</script>", "secret")
    html = Table(TaskResult("t", "T", 1, False, (bad,), ("<i>",)), ("<hint>",))._repr_mimebundle_()[
        "text/html"
    ]
    assert "✗ failed" in html
    for raw in ("<b>", "<script>", "<i>", "<hint>"):
        assert raw not in html


def test_a_hidden_check_shows_the_kind_of_mistake_only() -> None:
    hidden = CheckResult(
        "at 0.123", "longer", True, 1, 0.0, "is 0.5, expected 0.123", "the position is wrong"
    )
    text = str(Table(TaskResult("t", "T", 1, False, (hidden,))))
    assert "hidden check 1: the position is wrong" in text
    assert "0.123" not in text


def test_without_an_id_own_values_are_said_to_be_a_guests(capsys: pytest.CaptureFixture[str]) -> None:
    check("week01.answer", 1)
    assert "No student ID is known" in capsys.readouterr().out
    check("week01.half", lambda length: length / 2)
    assert "No student ID is known" not in capsys.readouterr().out


def test_what_the_code_prints_is_shown_and_repeated_lines_are_counted(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    def half(length: float) -> float:
        print("got", length)  # noqa: T201  what is tested
        return length / 2

    check("week01.half", half)
    assert "It printed:\n  | got 4.0\n" in capsys.readouterr().out
    says = "self.publisher.publish(marker); self.get_logger().info('published')"
    check("week01.red_cube", red_cube("self.publisher.publish(marker)", says))
    said = capsys.readouterr().out
    assert "[red_cube]: published\n  | … repeated 2 times\n" in said


def test_a_flood_of_output_is_cut_and_keeps_its_beginning(capsys: pytest.CaptureFixture[str]) -> None:
    def half(length: float) -> float:
        for number in range(100_000):
            print(number, "x" * 300)  # noqa: T201  what is tested
        return length / 2

    check("week01.half", half)
    lines = capsys.readouterr().out.splitlines()
    assert lines[3].startswith("  | 0 xxx")
    assert any(line.endswith("more lines") for line in lines)
    assert len(lines) < 40
    assert max(map(len, lines)) < 300


def test_a_hint_for_a_common_mistake_comes_through(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("def publish_marker(self)", "def publish_marker()"))
    assert "; hint: write self first: def publish_marker(self)." in capsys.readouterr().out


def test_a_task_without_an_object_says_what_to_type() -> None:
    with pytest.raises(CourseError, match=r'Write: check\("week01\.red_cube", RedCubeNode\)'):
        check("week01.red_cube")


def test_an_object_without_a_task_says_what_to_type(red_cube: Callable[..., Any]) -> None:
    with pytest.raises(CourseError, match=r'like check\("week01\.red_cube", RedCubeNode\)'):
        check(red_cube())


def test_a_function_that_returns_nothing_is_asked_for_its_return(capsys: pytest.CaptureFixture[str]) -> None:
    check("week01.half", lambda length: None)
    assert "half returned None: is there a return?" in capsys.readouterr().out
    check("week01.half", lambda length: 1 / 0)
    assert "is there a return?" not in capsys.readouterr().out


def test_one_cause_is_not_repeated_in_every_row(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("self.publisher.publish(marker)", "pass"))
    said = capsys.readouterr().out
    assert said.count("nothing was published") == 1
    assert said.count("✗ failed") == 1
    assert "0 of 2 checks passed" in said


def test_the_printed_text_is_escaped_in_html() -> None:
    html = Table(TaskResult("t", "T", 1, False, ()), (), ("<b>", "x"))._repr_mimebundle_()["text/html"]
    assert "<pre>&lt;b&gt;\nx</pre>" in html


def test_nan_is_named_with_its_place(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("position.z = 0.5", "position.z = float('nan')"))
    place = "NaN (not a number): pose.position.z on /visualization_marker. Is it"
    assert place in capsys.readouterr().out
    check("week01.half", lambda length: [1.0, float("nan")])
    assert "NaN (not a number): the returned value[1]. Is it" in capsys.readouterr().out
