from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.course_file import Late
from course_lib.grading.evidence import Check, Evidence, Verdict, with_formal
from course_lib.grading.handin.received import Received
from course_lib.grading.handin.submission import Submission
from course_lib.grading.judge import CheckResult, TaskResult, judge_task
from course_lib.grading.marks.mark import Result, results_in
from course_lib.grading.marks.marks import Mark, add_up, count_days_late
from course_lib.grading.reports.tables import write_gradebook
from course_lib.grading.run.job import Run
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
def test_late_days_are_started_days_of_local_time(received: datetime, days: int) -> None:
    assert count_days_late(received, DEADLINE, Late(grace_minutes=5)) == days


def test_without_a_deadline_nothing_is_late() -> None:
    assert count_days_late(DEADLINE, None, Late()) == 0


def test_a_bonus_comes_on_top_and_the_penalty_is_a_part_of_the_score() -> None:
    tasks = [task(60, 1.0), task(40, 0.5), task(10, 1.0, bonus=True)]
    assert add_up(tasks, 0, Late()) == Mark(90, 100, 0, 0, 90)
    assert add_up(tasks, 2, Late()) == Mark(90, 100, 2, 18, 72)
    assert add_up(tasks, 11, Late()) == Mark(90, 100, 11, 90, 0)


def judged(*checks: Check) -> TaskResult:
    demo = Task("week01.demo", "A demo", "value", "demo", ("one", "two", "three"))
    run = Run(Scenario("public", checks=checks), Evidence("week01.demo", "public", 1.0))
    return judge_task(demo, 50, False, [run])


def scoring(score: float) -> Check:
    return Check("c", lambda _: Verdict(score, "m"))


def test_checks_share_the_points_by_their_weights() -> None:
    assert judged(scoring(1.0).worth(3), scoring(0.0)).score == 37.5
    assert judged(scoring(1.0), scoring(0.0).worth(0)).score == 50
    assert judged(scoring(0.25)).score == 12.5
    assert judged().score == 0


@pytest.mark.parametrize("score", [float("nan"), -1.0, 2.0])
def test_a_score_that_is_none_counts_nothing(score: float) -> None:
    assert judged(scoring(score)).score == 0


def raising(evidence: Evidence) -> Verdict:
    raise KeyError(evidence.task)


def test_a_check_that_raises_costs_that_check_and_a_person_looks_at_it() -> None:
    result = judged(Check("my check", raising), scoring(1.0))
    assert (result.score, result.waits) == (25, True)
    assert result.checks[0].broken == "KeyError: 'week01.demo'"
    assert "KeyError" not in result.checks[0].message + result.checks[0].mistake
    assert not replace(result, manual=50.0).waits


def test_a_check_that_only_reports_makes_nobody_wait() -> None:
    assert not judged(Check("my check", raising).worth(0), scoring(1.0)).waits


def test_a_check_that_requires_a_broken_one_names_it() -> None:
    result = judged(scoring(1.0).requiring(Check("my check", raising)))
    assert (result.checks[0].score, result.checks[0].broken) == (0, "KeyError: 'week01.demo'")


NO_NUMBER: Any = "a"


@pytest.mark.parametrize("answer", [None, 1.0, Verdict(NO_NUMBER, "m")])
def test_a_check_that_returns_something_else_is_broken(answer: Any) -> None:
    assert judged(Check("c", lambda _: answer)).waits


def test_a_check_that_others_require_is_evaluated_once_in_a_run() -> None:
    calls = []

    def shape(evidence: Evidence) -> Verdict:
        calls.append(evidence.scenario)
        return Verdict(1.0, "m")

    shaped = Check("shape", shape)
    assert judged(shaped, *[scoring(1.0).requiring(shaped)] * 5).passed
    assert calls == ["public"]


def test_a_formula_in_the_gradebook_is_only_a_text(tmp_path: Path) -> None:
    when = Received(datetime(2026, 1, 1, tzinfo=UTC), "receipt")
    submission = Submission("=cmd()", "week01_exercise", tmp_path / "a.ipynb", when)
    Result(submission, "rejected", "unreadable", '@SUM(A1), "quoted"').write(tmp_path)
    assert write_gradebook(tmp_path, results_in(tmp_path)).read_text().splitlines()[1] == (
        '\'=cmd(),week01_exercise,,,,,,rejected,unreadable,"\'@SUM(A1), ""quoted"""'
    )


def test_a_check_scores_only_where_the_checks_it_requires_pass() -> None:
    shape = Check("a cube", lambda evidence: Verdict(0.5, "half a cube"))
    rate = Check("once a second", lambda evidence: Verdict(1.0, "as expected"))
    scenario = Scenario("public", checks=(shape, rate.requiring(shape), rate.requiring(rate)))
    run = Run(scenario, Evidence("week01.demo", "public", 5.0))

    result = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run])

    assert [check.score for check in result.checks] == [0.5, 0.0, 1.0]
    assert result.checks[1].message == "counts when this passes: a cube"


def test_formal_checks_weigh_a_tenth_together_and_need_the_shape() -> None:
    shape = Check("a cube", lambda evidence: Verdict(1.0 if evidence.samples else 0.0, ""))
    color = Check("red", lambda evidence: Verdict(1.0, "as expected"), weight=2.0)
    rate, stamps = (Check(name, lambda evidence: Verdict(1.0, "as expected")) for name in ("rate", "stamps"))
    checks = with_formal((shape, color), rate, stamps)

    run = Run(Scenario("public", checks=checks), Evidence("week01.demo", "public", 5.0))
    result = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run])

    assert [check.score for check in result.checks] == [0, 1, 0, 0]
    assert sum(check.weight for check in checks[2:]) == pytest.approx(0.1 * sum(c.weight for c in checks))
    assert with_formal((shape,)) == (shape,)


def test_a_check_names_its_own_mistake_before_that_of_a_check_which_it_requires() -> None:
    shape = Check("a cube", lambda evidence: Verdict(0.0, "no cube"))
    rate = Check("once a second", lambda evidence: Verdict(0.5, "too slow", "a rate is wrong"))
    scenario = Scenario("public", checks=(rate.requiring(shape),))
    run = Run(scenario, Evidence("week01.demo", "public", 5.0))

    (check,) = judge_task(Task("week01.demo", "D", "node", "N", ("a", "b", "c")), 30, False, [run]).checks

    assert (check.score, check.message, check.mistake) == (0.0, "too slow", "a rate is wrong")
