"""tasks.csv, and the analysis of tasks and checks."""

import csv
import random
from dataclasses import replace
from pathlib import Path

import pytest

from course_lib.course.course_file import CourseFile, read_course_file
from course_lib.grading.grade import grade
from course_lib.grading.marks import MarkedResult, results_in
from course_lib.grading.records import CheckResult, Judgement, ReceiptTime, Result, Submission, TaskResult
from course_lib.grading.reports.tables import (
    FEWEST,
    Analysis,
    Item,
    TimeSummary,
    analyse,
    check_times,
    correlation,
    write_tables,
)
from course_lib.grading.store import Course, check_times_path
from tests.grading.graders import write_class
from tests.grading.simulated.results import write_results

EXERCISE = "week01_exercise"


@pytest.fixture
def settings(course: Course) -> CourseFile:
    return read_course_file(course.exercises / "course.toml")


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_tasks_csv_adds_up_to_the_gradebook(tmp_path: Path, settings: CourseFile) -> None:
    students = ["=cmd()" if n == 3 else f"s{n:02}" for n in range(40)]
    write_results(tmp_path, students, settings)
    write_tables(tmp_path, settings.zone)
    tasks = table(tmp_path / "tasks.csv")
    scores: dict[str, float] = {}
    for row in tasks:
        scores[row["student"]] = scores.get(row["student"], 0.0) + float(row["score"])
    book = {row["student"]: float(row["score"]) for row in table(tmp_path / "gradebook.csv") if row["score"]}
    assert scores == pytest.approx(book)
    assert {row["marked_by"] for row in tasks} == {"checks", "person"}
    assert {row["bonus"] for row in tasks} == {"0", "1"}
    assert {(row["public"], row["hidden"]) for row in tasks} == {("3", "2")}
    assert any(row["student"] == "'=cmd()" for row in tasks)


def check(title: str, score: float, hidden: bool = False) -> CheckResult:
    return CheckResult(title, "other" if hidden else "public", hidden, 1.0, score, "", "")


def class_of(tmp_path: Path, settings: CourseFile, count: int) -> Analysis:
    """Results of students of rising skill: "steep" rewards it, "upside down" the opposite, others neither."""
    write_results(tmp_path, [f"s{n:03}" for n in range(3 * count)], settings, seed=3)
    whole = [one for one in results_in(tmp_path) if one.tasks][:count]
    chance, made = random.Random(1), []
    for place, marked in enumerate(whole):
        skill = place / count
        base = tuple(check(f"base {n}", float(skill > n / 10)) for n in range(10))
        odd = (
            check("steep", float(skill > 0.5), hidden=True),
            check("upside down", float(skill < 0.5)),
            check("easy", 1.0),
            check("hard", 0.0),
            check("a coin", float(chance.random() < 0.5)),
        )
        tasks = (TaskResult("week01.a", "A", 50, False, base), TaskResult("week01.b", "B", 50, False, odd))
        made.append(MarkedResult(replace(marked.result, judgement=Judgement(tasks, "", (), "", {}))))
    return analyse(EXERCISE, made, tmp_path)


@pytest.mark.slow
def test_item_discrimination_is_computed_against_the_rest_of_the_exercise(
    tmp_path: Path, settings: CourseFile
) -> None:
    analysis = class_of(tmp_path, settings, 60)
    items = {item.title: item for item in analysis.checks}
    assert items["steep"].is_hidden
    assert (items["steep"].discrimination or 0) > 0.5
    assert (items["upside down"].discrimination or 0) < -0.5
    assert "is it right?" in items["upside down"].remark
    assert items["easy"].remark == "almost all students have it"
    assert "hardly any student" in items["hard"].remark
    assert items["hard"].discrimination is None
    assert abs(items["a coin"].discrimination or 0) < 0.4
    assert [item.task for item in analysis.tasks] == ["week01.a", "week01.b"]
    assert sum(count for _, count, _ in analysis.histogram) == len(analysis.marks) == 60


def test_too_few_submissions_give_no_item_statistics(tmp_path: Path, settings: CourseFile) -> None:
    analysis = class_of(tmp_path, settings, FEWEST - 1)
    assert {item.discrimination for item in analysis.checks} == {None}
    assert {item.remark for item in analysis.checks} == {""}


@pytest.mark.parametrize(
    ("scores", "rests", "value"),
    [
        ([0, 1] * 10, [3, 4] * 10, 1.0),
        ([0, 1] * 10, [4, 3] * 10, -1.0),
        ([1] * 20, [3, 4] * 10, None),
        ([0, 1] * 10, [3] * 20, None),
        ([], [], None),
    ],
)
def test_correlations_match_known_values(
    scores: list[float], rests: list[float], value: float | None
) -> None:
    assert correlation(scores, rests) == (None if value is None else pytest.approx(value))


def test_histogram_has_a_bin_for_marks_above_100() -> None:
    analysis = Analysis(EXERCISE, [0, 9.9, 10, 99.9, 100, 100.5, 250], (), (), ())
    counts = {name: count for name, count, _ in analysis.histogram}
    assert (counts["0-10"], counts["10-20"], counts["90-100"], counts["above 100"]) == (2, 1, 2, 2)
    assert Analysis(EXERCISE, (), (), (), ()).summary == "No marks."


def test_item_titles_are_escaped_and_the_index_links_to_the_page(
    tmp_path: Path, settings: CourseFile
) -> None:
    write_results(tmp_path, [f"s{n:02}" for n in range(30)], settings)
    for path in (tmp_path / "results").glob("*/*.json"):
        path.write_text(path.read_text().replace('"check 1"', '"<script>alert(1)</script>"'))
    write_tables(tmp_path, settings.zone)
    page = (tmp_path / "reports/items.html").read_text()
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)" in page
    assert 'href="items.html"' in (tmp_path / "reports/index.html").read_text()


def test_item_page_has_check_and_scenario_times_and_results_do_not(tmp_path: Path, course: Course) -> None:
    write_class(tmp_path, 2)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    analysis = analyse(EXERCISE, list(results_in(tmp_path / "out")), tmp_path / "out")
    assert analysis.check_times.keys() == {(i.task, i.scenario, i.title) for i in analysis.checks}
    assert {task for task, _ in analysis.scenario_times} == {item.task for item in analysis.tasks}
    assert {spent.count for spent in analysis.scenario_times.values()} == {2}
    assert all(
        spent.longest_seconds >= spent.median_seconds > 0 for spent in analysis.scenario_times.values()
    )
    assert any(spent.median_seconds > 0 for spent in analysis.check_times.values())
    page = (tmp_path / "out/reports/items.html").read_text()
    assert 'aria-label="Scenarios of week01_exercise"' in page
    for path in (tmp_path / "out/results").glob("*/*.json"):
        assert "seconds" not in path.read_text()


@pytest.mark.parametrize("text", ["", "[1]", '[["a", "b", "c", null]]', '{"a": 1}'])
def test_damaged_times_are_ignored(tmp_path: Path, text: str) -> None:
    path = check_times_path(tmp_path, "key")
    path.parent.mkdir()
    path.write_text(text)
    assert check_times(tmp_path, ["key", "none"]) == {}


def test_check_longer_than_a_second_is_reported_as_slow() -> None:
    assert TimeSummary(9, 0.1, 1.2).remark == "slow: a check may take 5 s"
    assert TimeSummary(9, 0.1, 0.2).remark == ""


def test_item_with_a_grader_error_is_excluded_from_statistics(tmp_path: Path, settings: CourseFile) -> None:
    submission = Submission("ada", EXERCISE, Path("ada.ipynb"), ReceiptTime(None, "unknown"))
    failed = MarkedResult(Result(submission, "grader_error", "OSError", "disk"))
    analysis = analyse(EXERCISE, [failed], tmp_path)
    assert (analysis.marks, analysis.checks) == ([], [])
    assert Item("t", "c", "s", False, 50, 0.5, 0.5, 0.5).remark == ""
