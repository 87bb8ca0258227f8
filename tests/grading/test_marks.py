from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.course_file import LatePolicy
from course_lib.grading.evidence import Check, Evidence, Verdict, with_formal
from course_lib.grading.judge import judge_task
from course_lib.grading.marks import results_in
from course_lib.grading.records import (
    CheckResult,
    Mark,
    ReceiptTime,
    Result,
    Run,
    Submission,
    TaskResult,
    count_days_late,
)
from course_lib.grading.reports.rendering import escape_formula
from course_lib.grading.reports.tables import write_gradebook
from course_lib.grading.task import Scenario, Task

PARIS = ZoneInfo("Europe/Paris")
DEADLINE = datetime(2026, 10, 24, 23, 59, tzinfo=PARIS)  # the clocks change in the night after


def task(points: float, score: float, *, bonus: bool = False) -> TaskResult:
    return TaskResult("t", "T", points, bonus, (CheckResult("c", "public", False, 1, score, "", ""),))


@pytest.mark.parametrize(
    ("received", "days"),
    [
        (DEADLINE - timedelta(days=3), 0),
        (DEADLINE, 0),
        (DEADLINE.astimezone(UTC) + timedelta(minutes=5), 0),
        (DEADLINE.astimezone(UTC) + timedelta(minutes=6), 1),
        (datetime(2026, 10, 25, 23, 59, tzinfo=PARIS), 1),  # 25 hours later, and yet one day
        (datetime(2026, 10, 26, 0, 5, tzinfo=PARIS), 2),
        (datetime(2026, 11, 24, 12, 0, tzinfo=PARIS), 31),
    ],
)
def test_late_days_are_rounded_up_in_local_time(received: datetime, days: int) -> None:
    assert count_days_late(received, DEADLINE, LatePolicy(grace_minutes=5)) == days


def test_submission_without_a_deadline_is_never_late() -> None:
    assert count_days_late(DEADLINE, None, LatePolicy()) == 0


def test_bonus_is_added_and_penalty_is_a_fraction_of_the_score() -> None:
    tasks = [task(60, 1.0), task(40, 0.5), task(10, 1.0, bonus=True)]
    assert Mark.compute(tasks, 0, LatePolicy()) == Mark(90, 100, 0, 0, 90)
    assert Mark.compute(tasks, 2, LatePolicy()) == Mark(90, 100, 2, 18, 72)
    assert Mark.compute(tasks, 11, LatePolicy()) == Mark(90, 100, 11, 90, 0)


def test_penalty_has_a_maximum_and_ends_with_the_last_accepted_day() -> None:
    late, tasks = LatePolicy(max_percent=30, accepted_days=7), [task(100, 0.8)]
    assert [Mark.compute(tasks, days, late).final for days in (0, 2, 3, 7, 8)] == [80, 64, 56, 56, 0]


def judge_checks(*checks: Check) -> TaskResult:
    demo = Task("week01.demo", "A demo", "value", "demo", ("one", "two", "three"))
    run = Run(Scenario("public", checks=checks), Evidence("week01.demo", "public", 1.0))
    return judge_task(demo, 50, False, [run])


def scoring(score: float) -> Check:
    return Check("c", lambda _: Verdict(score, "m"))


def test_points_are_distributed_by_check_weight() -> None:
    assert judge_checks(scoring(1.0).worth(3), scoring(0.0)).score == 37.5
    assert judge_checks(scoring(1.0), scoring(0.0).worth(0)).score == 50
    assert judge_checks(scoring(0.25)).score == 12.5
    assert judge_checks().score == 0


@pytest.mark.parametrize("score", [float("nan"), -1.0, 2.0])
def test_none_score_counts_as_zero(score: float) -> None:
    assert judge_checks(scoring(score)).score == 0


def raising(evidence: Evidence) -> Verdict:
    raise KeyError(evidence.task)


def test_raising_check_scores_zero_and_needs_review() -> None:
    result = judge_checks(Check("my check", raising), scoring(1.0))
    assert (result.score, result.needs_hand_mark) == (25, True)
    assert result.checks[0].broken == "tests/grading/test_marks.py line 89: KeyError: 'week01.demo'"
    assert "KeyError" not in result.checks[0].message + result.checks[0].mistake
    assert not replace(result, manual=50.0).needs_hand_mark


def test_broken_check_without_points_does_not_withhold_the_mark() -> None:
    assert not judge_checks(Check("my check", raising).worth(0), scoring(1.0)).needs_hand_mark


def test_check_reports_a_broken_required_check() -> None:
    result = judge_checks(scoring(1.0).requiring(Check("my check", raising)))
    assert (result.checks[0].score, result.checks[0].broken) == (
        0,
        "tests/grading/test_marks.py line 89: KeyError: 'week01.demo'",
    )


NO_NUMBER: Any = "a"


@pytest.mark.parametrize("answer", [None, 1.0, Verdict(NO_NUMBER, "m")])
def test_check_returning_an_invalid_verdict_is_reported_as_broken(answer: Any) -> None:
    assert judge_checks(Check("c", lambda _: answer)).needs_hand_mark


def test_required_check_is_evaluated_once_per_run() -> None:
    calls = []

    def shape(evidence: Evidence) -> Verdict:
        calls.append(evidence.scenario)
        return Verdict(1.0, "m")

    shaped = Check("shape", shape)
    assert judge_checks(shaped, *[scoring(1.0).requiring(shaped)] * 5).passed
    assert calls == ["public"]


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r", "\uff1d", "\uff0b", "\uff0d", "\uff20"])
def test_text_that_a_spreadsheet_takes_for_a_formula_is_escaped(start: str) -> None:
    assert escape_formula(f"{start}cmd()") == f"'{start}cmd()"


def test_formula_in_the_gradebook_is_escaped(tmp_path: Path) -> None:
    when = ReceiptTime(datetime(2026, 1, 1, tzinfo=UTC), "receipt")
    submission = Submission("=cmd()", "week01_exercise", tmp_path / "a.ipynb", when)
    Result(submission, "rejected", "unreadable", '@SUM(A1), "quoted"').write(tmp_path)
    assert write_gradebook(tmp_path, results_in(tmp_path)).read_text().splitlines()[1] == (
        '\'=cmd(),week01_exercise,,,,,,rejected,unreadable,"\'@SUM(A1), ""quoted"""'
    )


def test_gradebook_contains_no_control_characters_of_a_file_name(tmp_path: Path) -> None:
    when = ReceiptTime(datetime(2026, 1, 1, tzinfo=UTC), "receipt")
    submission = Submission("\x1b[2Jada", "week01_exercise", tmp_path / "a.ipynb", when)
    Result(submission, "rejected", "unreadable", "\u202e\x07=1+1\x9b.ipynb").write(tmp_path)
    assert write_gradebook(tmp_path, results_in(tmp_path)).read_text().splitlines()[1] == (
        "ada,week01_exercise,,,,,,rejected,unreadable,'=1+1.ipynb"
    )


def test_check_scores_only_if_its_required_checks_pass() -> None:
    shape = Check("a cube", lambda evidence: Verdict(0.5, "half a cube"))
    rate = Check("once a second", lambda evidence: Verdict(1.0, "as expected"))
    scenario = Scenario("public", checks=(shape, rate.requiring(shape), rate.requiring(rate)))
    run = Run(scenario, Evidence("week01.demo", "public", 5.0))

    result = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run])

    assert [check.score for check in result.checks] == [0.5, 0.0, 1.0]
    assert result.checks[1].message == 'checked once "a cube" passes'


def test_unmet_requirement_is_reported_with_its_row_or_else_its_message() -> None:
    shape = Check("the marker: type", lambda evidence: Verdict(0.0, "it is a sphere"))
    always = Check("all the time", lambda evidence: Verdict(0.0, "silent from 2 s to 4 s"))
    rate = Check("once a second", lambda evidence: Verdict(1.0, "as expected"))
    checks = (shape.titled("a cube"), rate.requiring(shape), rate.requiring(always))
    run = Run(Scenario("public", checks=checks), Evidence("week01.demo", "public", 5.0))

    result = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run])

    messages = [check.message for check in result.checks]
    assert messages[1:] == ['checked once "a cube" passes', "silent from 2 s to 4 s"]


def test_formal_checks_have_a_tenth_of_the_weight_and_require_the_shape_check() -> None:
    shape = Check("a cube", lambda evidence: Verdict(1.0 if evidence.samples else 0.0, ""))
    color = Check("red", lambda evidence: Verdict(1.0, "as expected"), weight=2.0)
    rate, stamps = (Check(name, lambda evidence: Verdict(1.0, "as expected")) for name in ("rate", "stamps"))
    checks = with_formal((shape, color), rate, stamps)

    run = Run(Scenario("public", checks=checks), Evidence("week01.demo", "public", 5.0))
    result = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run])

    assert [check.score for check in result.checks] == [0, 1, 0, 0]
    assert sum(check.weight for check in checks[2:]) == pytest.approx(0.1 * sum(c.weight for c in checks))
    assert with_formal((shape,)) == (shape,)


def test_own_mistake_of_a_check_precedes_the_mistake_of_a_required_check() -> None:
    shape = Check("a cube", lambda evidence: Verdict(0.0, "no cube"))
    rate = Check("once a second", lambda evidence: Verdict(0.5, "too slow", "a rate is wrong"))
    scenario = Scenario("public", checks=(rate.requiring(shape),))
    run = Run(scenario, Evidence("week01.demo", "public", 5.0))

    (check,) = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run]).checks

    assert (check.score, check.message, check.mistake) == (0.0, "too slow", "a rate is wrong")
