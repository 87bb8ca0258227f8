import importlib
import linecache
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import course_lib.grading.check as check_module
from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import exercises_dir
from course_lib.course.state import save_check, student_state
from course_lib.errors import CourseError
from course_lib.grading import expect_value, inputs, my
from course_lib.grading.advice import Advice, call_note
from course_lib.grading.check import CheckFailedError, check, next_step, stale_note
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import NEEDS_ANOTHER
from course_lib.grading.records import CheckResult, TaskResult
from course_lib.grading.reports.rendering import Table, rows
from course_lib.grading.store import Course
from course_lib.grading.task import Call, Row, Scenario, Task, load_catalog, shipped_catalog


@pytest.fixture(autouse=True)
def student_folder(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A student's folder with the small course installed."""
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


@pytest.mark.parametrize(
    ("newest", "is_stale"),
    [
        ("def area(a, b):\n    return a * b\n", False),
        ("%matplotlib inline\ndef area(a, b):\n    return a * b\n", False),
        ("Sure! Here it is:\n\ndef area(a, b):\n    return a * b\n", True),
        ("import numpi\n\ndef area(a, b):\n    return a + b\n", True),
        ("def length(a):\n    return a\n", False),
    ],
)
def test_failed_newest_definition_of_the_object_is_reported(newest: str, is_stale: bool) -> None:
    cell = "def area(a, b):\n    return a * b\n"
    linecache.cache["cell1.py"] = (len(cell), None, cell.splitlines(keepends=True), "cell1.py")
    names: dict[str, Any] = {}
    exec(compile(cell, "cell1.py", "exec"), names)
    notes = stale_note(names["area"], [cell, newest])
    assert [note.startswith("Hint: The newest cell with area ended with") for note in notes] == [
        True
    ] * is_stale


def test_full_public_score_announces_the_hidden_checks(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube())
    output = capsys.readouterr().out
    assert "week01.red_cube (A red cube): 2 of 2 checks passed" in output
    assert output.strip().splitlines()[-2:] == [
        "all public checks passed; hidden checks run at grading",
        "This task: 60 of 60 points so far. Next is task 2: Half of it.",
    ]
    assert student_state().get("progress", "week01.red_cube") == {"score": 60.0, "of": 60.0}


def test_imported_file_of_the_student_is_reported_even_if_the_check_passes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("my_half.py").write_text("def half(length):\n    return length / 2\n")
    monkeypatch.syspath_prepend(Path.cwd())
    monkeypatch.delitem(sys.modules, "my_half", raising=False)
    check("week01.half", importlib.import_module("my_half").half)
    assert "my_half.py is not part of your submission" in capsys.readouterr().out


@pytest.mark.parametrize("exercise", sorted(exercises_dir().glob("week*.ipynb")), ids=lambda path: path.stem)
def test_next_steps_follow_the_order_of_the_tasks(exercise: Path) -> None:
    cells = "\n".join(source(cell) for cell in read_notebook(exercise)["cells"])
    headings = re.findall(r"^## Task (\d+)(, stretch)?:", cells, re.MULTILINE)
    catalog = shipped_catalog()
    tasks = [catalog.task(name) for name in re.findall(r'check\("(.+?)"', cells)]
    assert len(tasks) == len(headings)
    steps = [next_step(catalog, task) for task in tasks]
    assert steps[:-1] == [
        f"Next is task {number}{' for a bonus' if stretch else ''}: {task.title}.".replace("?.", "?")
        for (number, stretch), task in zip(headings[1:], tasks[1:], strict=True)
    ]
    assert f"course submit {exercise.name}" in steps[-1]


def test_next_step_omits_passed_tasks_and_lists_earlier_open_tasks() -> None:
    catalog, state = shipped_catalog(), student_state()
    tasks = catalog.tasks_of_week("week02")
    for number in (1, 3, 4):
        save_check(state, tasks[number - 1].id, passed=True, cells=[], student="")
    assert next_step(catalog, tasks[1]) == f"Next is task 5 for a bonus: {tasks[4].title}."
    save_check(state, tasks[4].id, passed=True, cells=[], student="")
    hand_in = "To hand in, type in a terminal: course submit week02_exercise.ipynb"
    assert next_step(catalog, tasks[4]) == f"Still open: task 2. {hand_in}"
    assert next_step(catalog, tasks[1]) == f"All tasks have passed. {hand_in}"


def test_success_message_has_an_icon_and_the_next_step_unlike_failure() -> None:
    passed = CheckResult("a post", "public", False, 1.0, 1.0, "as expected", "")
    task = TaskResult("week01.post", "A post", 20.0, False, (passed,))
    html = Table(task, next_step="Next is task 2: A wall.")._repr_mimebundle_()["text/html"]
    block = html[html.index("border-left") :]
    assert "✓ all public checks passed" in block
    assert "This task: 20 of 20 points so far. Next is task 2: A wall." in block
    failed = replace(task, checks=(replace(passed, score=0.0),))
    report = replace(task, rubric=(Row("It is complete", 20.0),))
    lines = str(Table(report, next_step="Next is task 2: A wall.")).splitlines()
    assert lines[-2:] == ["recorded; a person reads and marks it", "Next is task 2: A wall."]
    assert "border-left" not in Table(failed, next_step="Next")._repr_mimebundle_()["text/html"]


def test_hint_for_the_mistake_precedes_the_ladder_and_its_last_step_is_repeated(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    printed = []
    for _ in range(5):
        check("week01.red_cube", red_cube("position.z = 0.5", "position.z = 0.0"))
        printed.append(capsys.readouterr().out.strip().splitlines())
    assert printed[0][-1].startswith("Hint: pose.position is the centre of the shape.")
    assert [lines[-1] for lines in printed[1:]] == [
        "Hint 1 of 3: Which fields has a marker?",
        "Hint 2 of 3: The centre is half an edge up.",
        "Hint 3 of 3: Set position.z to 0.5.",
        "Hint 3 of 3: Set position.z to 0.5.",
    ]
    assert "✗ failed" in printed[0][1]
    assert "0.50 m too low" in printed[0][1]


def test_each_mistake_gets_its_own_hint(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("position.z = 0.5", "position.z = 0.0"))
    check("week01.red_cube", red_cube("color.r =", "color.g ="))
    assert "Hint: r, g, b and a go from 0.0 to 1.0" in capsys.readouterr().out


def test_failed_check_shows_the_values_immediately_in_a_notebook(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(check_module, "in_notebook", lambda: True)
    monkeypatch.setattr("course_lib.grading.reports.scenes.show_ghost", lambda *_: None)
    check("week01.red_cube", red_cube("position.z = 0.5", "position.z = 0.0"))
    assert "0.50 m too low" in capsys.readouterr().out


def test_unchanged_stub_does_not_advance_the_hint_ladder(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    stub = red_cube("self.publisher.publish(marker)", "raise NotImplementedError('publish it')")
    check("week01.red_cube", stub)
    output = capsys.readouterr().out
    assert "still stops at the line with raise NotImplementedError" in output
    assert output.count("publish it") == 1
    assert "Hint" not in output


def test_exception_is_shown_with_the_student_line_and_no_traceback(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("marker.color.r =", "marker.colour.r ="))
    output = capsys.readouterr().out
    assert "AttributeError: 'Marker' object has no attribute 'colour'" in output
    assert "Traceback" not in output


def test_passing_a_value_instead_of_a_function_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    check("week01.half", 4.0)
    assert "got an object of float, expected a function" in capsys.readouterr().out


def test_unknown_task_error_suggests_similar_tasks() -> None:
    with pytest.raises(CourseError, match=r"Did you mean week01\.red_cube"):
        check("week01.redcube", object)


def test_failed_check_raises_in_strict_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_STRICT", "1")
    check("week01.half", lambda length: length / 2)
    with pytest.raises(CheckFailedError, match="expected 2"):
        check("week01.half", lambda length: length)


def test_personal_values_depend_on_the_student_id(
    course: Course, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    student_state().put("identity", "student", "20231234")
    task = load_catalog(course.exercises).task("week01.answer")
    check("week01.answer", 2 * inputs.personal_values(task, "20231234")["n"])
    assert "1 of 1 checks passed" in capsys.readouterr().out


def test_html_table_has_text_and_icons_and_is_escaped() -> None:
    bad = CheckResult("<b>title</b>", "public", False, 1, 0.0, "<script>alert(1)</script>", "secret")
    html = Table(TaskResult("t", "T", 1, False, (bad,), ("<i>",)), ("<hint>",))._repr_mimebundle_()[
        "text/html"
    ]
    # JupyterLab narrows columns as far as it may.
    assert 'white-space:nowrap">✗ failed' in html
    for raw in ("<b>", "<script>", "<i>", "<hint>"):
        assert raw not in html


def test_hidden_check_shows_only_the_mistake_category() -> None:
    hidden = CheckResult(
        "at 0.123", "longer", True, 1, 0.0, "is 0.5, expected 0.123", "the position is wrong"
    )
    text = str(Table(TaskResult("t", "T", 1, False, (hidden,))))
    assert "hidden check 1: the position is wrong" in text
    assert "0.123" not in text


def test_missing_student_id_is_reported_only_for_tasks_with_personal_values(
    capsys: pytest.CaptureFixture[str],
) -> None:
    check("week01.answer", 1)
    assert "Your student ID is not set" in capsys.readouterr().out
    check("week01.half", lambda length: length / 2)
    assert "Your student ID is not set" not in capsys.readouterr().out


def test_printed_output_is_shown_and_repeated_lines_are_counted(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    def half(length: float) -> float:
        print("got", length)  # noqa: T201  what is tested
        return length / 2

    check("week01.half", half)
    assert "It printed:\n  | got 4.0\n" in capsys.readouterr().out
    says = "self.publisher.publish(marker); self.get_logger().info('published')"
    check("week01.red_cube", red_cube("self.publisher.publish(marker)", says))
    output = capsys.readouterr().out
    assert "[red_cube]: published\n  | … repeated 2 times\n" in output


def test_excessive_output_is_truncated_after_its_beginning(capsys: pytest.CaptureFixture[str]) -> None:
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


def test_hint_for_a_common_mistake_is_shown(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("def publish_marker(self)", "def publish_marker()"))
    assert "; hint: write self first: `def publish_marker(self)`." in capsys.readouterr().out


def test_check_without_an_object_shows_the_correct_call() -> None:
    with pytest.raises(CourseError, match=r'Write: check\("week01\.red_cube", RedCubeNode\)'):
        check("week01.red_cube")


def test_check_without_a_task_shows_the_correct_call(red_cube: Callable[..., Any]) -> None:
    with pytest.raises(CourseError, match=r'like check\("week01\.red_cube", RedCubeNode\)'):
        check(red_cube())


def test_missing_return_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    check("week01.half", lambda length: None)
    assert "half returned None: is there a return?" in capsys.readouterr().out
    check("week01.half", lambda length: 1 / 0)
    assert "is there a return?" not in capsys.readouterr().out


def test_shared_cause_is_not_repeated_in_every_row(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("self.publisher.publish(marker)", "pass"))
    output = capsys.readouterr().out
    assert output.count("nothing was published") == 1
    assert output.count("✗ failed") == 1
    assert "0 of 2 checks passed" in output


def test_code_between_backticks_in_a_hint_is_shown_as_code() -> None:
    hint = "Hint: `low < <b> <= high` is one line"
    html = Table(TaskResult("t", "T", 1, False, ()), (hint,))._repr_mimebundle_()["text/html"]
    assert "<p>Hint: <code>low &lt; &lt;b&gt; &lt;= high</code> is one line</p>" in html


def test_printed_output_is_escaped_in_html() -> None:
    html = Table(TaskResult("t", "T", 1, False, ()), (), ("<b>", "x"))._repr_mimebundle_()["text/html"]
    assert "<pre>&lt;b&gt;\nx</pre>" in html


def test_nan_is_reported_with_its_location(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.red_cube", red_cube("position.z = 0.5", "position.z = float('nan')"))
    place = "NaN (not a number): pose.position.z on /visualization_marker. Is it"
    assert place in capsys.readouterr().out
    check("week01.half", lambda length: [1.0, float("nan")])
    assert "NaN (not a number): the returned value[1]. Is it" in capsys.readouterr().out


def test_failed_check_of_a_function_shows_its_call(capsys: pytest.CaptureFixture[str]) -> None:
    check("week01.half", lambda length: length)
    assert "The first failed check calls half(4.0)\n" in capsys.readouterr().out
    check("week01.half", lambda length: length / 2)
    assert "calls half" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("call", "shown"),
    [
        (
            Call({"/scan": [(0.1234567, 400)]}, ends=[1, True]),
            "f({'/scan': [[0.1235, 400]]}, ends=[1, True])",
        ),
        (Call(my("n")), "f(20)"),
        (Call([0.25] * 20), None),
        (Call(), None),
    ],
)
def test_call_of_the_first_failed_check_is_shown_unless_it_is_long_or_has_no_arguments(
    call: Call, shown: str | None
) -> None:
    checks = (expect_value(1, call=0), expect_value(2, call=1))
    scenario = Scenario("public", calls=(Call(1), call), checks=checks)
    personal = {"n": (20,)}
    task = Task("week01.t", "T", "function", "f", ("1", "2", "3"), (scenario,), personal=personal)
    outcomes = [CheckResult("", "public", False, 1.0, score, "", "") for score in (1.0, 0.0)]
    result = TaskResult(task.id, "T", 1.0, False, tuple(outcomes))
    evidence = Evidence(task.id, "public", 1.0, personal={"n": 20})
    expected = [] if shown is None else [f"The first failed check calls {shown}"]
    assert call_note(task, result, [evidence]) == expected


def test_call_of_a_check_that_only_requires_a_failed_one_is_not_shown() -> None:
    checks = (expect_value(1, call=0), expect_value(2, call=1))
    scenario = Scenario("public", calls=(Call(1), Call(2)), checks=checks)
    task = Task("week01.t", "T", "function", "f", ("1", "2", "3"), (scenario,))
    mistakes = (NEEDS_ANOTHER, "a value is wrong")
    outcomes = tuple(CheckResult("", "public", False, 1.0, 0.0, "", mistake) for mistake in mistakes)
    result = TaskResult(task.id, "T", 1.0, False, outcomes)
    evidence = Evidence(task.id, "public", 1.0)
    assert call_note(task, result, [evidence]) == ["The first failed check calls f(2)"]


def test_object_of_another_task_is_reported(
    red_cube: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    check("week01.half", red_cube())
    assert (
        'Hint: RedCubeNode belongs to another task. Write: check("week01.half", half)'
        in capsys.readouterr().out
    )


def test_cell_that_defines_the_object_twice_is_reported(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cell = "def half(length):\n    return length / 2\n\n\ndef half(length):\n    return length\n"
    shell = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=[cell]))
    names: dict[str, Any] = {}
    exec(cell, names)
    with monkeypatch.context() as kernel:
        kernel.setattr("IPython.get_ipython", lambda: shell)
        check("week01.half", names["half"])
    shown = capsys.readouterr().out
    assert "Hint: The cell defines half 2 times, and only the last one counts" in shown


def test_titles_of_a_row_state_their_scenario_once() -> None:
    titles = ("a ramp: each point", "a ramp: stripe 1", "the count", "a drive: stripe 1")
    results = [CheckResult(title, "public", False, 1.0, 0.0, "nothing was published", "") for title in titles]
    (row,) = rows(results)
    assert row.title == "a ramp: each point, stripe 1; the count; a drive: stripe 1"
