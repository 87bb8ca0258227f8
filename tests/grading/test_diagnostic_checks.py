import math
from collections.abc import Callable
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from course_lib.grading import expect_fact, expect_level, expect_levels
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.task import Scenario, Task
from course_lib.grading.vocabulary.topics import DIGESTS, TOOLS, digest

MakeEvidence = Callable[..., Evidence]


def status(at: float, level: bytes, message: str) -> tuple[float, str, Any]:
    return at, "/diagnostics", DiagnosticArray(status=[DiagnosticStatus(level=level, message=message)])


@pytest.mark.parametrize(
    ("level", "says", "begin", "message"),
    [
        ("OK", "normal", 0.0, "as expected"),
        ("ERROR", "low", 2.0, "as expected"),
        ("OK", "normal", 2.0, "the level is ERROR from 2 to 4 s, expected OK"),
        ("OK", "fine", 0.0, "the message is 'Normal: 30' from 0 to 2 s: it lacks 'fine'"),
        ("OK", "normal", 7.0, "no status was published from 7 to 9 s"),
    ],
)
def test_expected_level_applies_to_the_time_range_of_the_check(
    evidence: MakeEvidence, level: str, says: str, begin: float, message: str
) -> None:
    good, bad = (DiagnosticStatus.OK, "Normal: 30"), (DiagnosticStatus.ERROR, "low")
    recorded = evidence(status(1, *good), status(2, *good), status(3, *bad), status(4, *bad), seconds=9.0)
    # The status at the beginning of a part refers to the second before it.
    check = expect_level(level, says=says, begin=begin, end=begin + 2)
    assert check.judge(recorded).message == message


@pytest.mark.parametrize(("levels", "passed"), [("OE", 2), ("OO", 0), ("EE", 1), ("EO", 0)])
def test_constant_level_earns_less_than_a_quarter(evidence: MakeEvidence, levels: str, passed: int) -> None:
    words = {"O": (DiagnosticStatus.OK, "normal"), "E": (DiagnosticStatus.ERROR, "low")}
    recorded = evidence(
        *(status(2.0 + 3.0 * n, *words[level]) for n, level in enumerate(levels)), seconds=6.0
    )
    checks = expect_levels(("OK", "normal", "well"), ("ERROR", "low", "bad"))
    task = Task("week06.x", "X", "node", "X", ("a", "b", "c"))
    result = judge_task(task, 10, False, [Run(Scenario("public", checks=checks), recorded)])
    assert sum(check.passed for check in result.checks) == passed
    assert passed == 2 or result.fraction < 0.25


def test_missing_diagnostics_messages_are_reported(evidence: MakeEvidence) -> None:
    message = expect_level("OK", says="", begin=0.0, end=2.0).judge(evidence()).message
    assert "nothing was published on /diagnostics" in message


def test_two_statuses_in_one_message_are_reported(evidence: MakeEvidence) -> None:
    two = [DiagnosticStatus(level=DiagnosticStatus.OK, message="normal") for _ in range(2)]
    recorded = evidence((2.0, "/diagnostics", DiagnosticArray(status=two)))
    message = expect_level("OK", says="normal", begin=0.0, end=2.0).judge(recorded).message
    assert message == "a message has 2 statuses from 0 to 2 s, expected one"


@pytest.fixture
def table(monkeypatch: pytest.MonkeyPatch) -> None:
    """Facts about a fictitious robot."""
    right: tuple[Any, ...] = (20, 48, "RELIABLE", 0.7, "/robot/start")
    row = tuple(digest(1, name, value) for name, value in zip(TOOLS, right, strict=True))
    monkeypatch.setitem(DIGESTS, 1, row)


@pytest.mark.usefixtures("table")
@pytest.mark.parametrize(
    ("rate", "score"),
    [
        (20, 1),
        (20.4, 1),
        (19.41, 1),
        (18.0, 0),
        ("20", 0),
        (math.nan, 0),
        (math.inf, 0),
        (True, 0),
        ([20], 0),
    ],
)
def test_measured_rate_is_compared_with_a_tolerance(evidence: MakeEvidence, rate: Any, score: float) -> None:
    verdict = expect_fact("image_rate", serial=1).judge(evidence(returns=({"image_rate": rate},)))
    assert verdict.score == score
    assert "20" not in verdict.message.replace(repr(rate), "")


@pytest.mark.usefixtures("table")
@pytest.mark.parametrize(
    ("name", "value", "score"),
    [
        ("image_width", 48.0, 1), ("image_width", 49, 0), ("image_width", "48", 0),
        ("threshold", 0.7000001, 1), ("threshold", 0.71, 0),
        ("scan_reliability", " RELIABLE", 1), ("scan_reliability", "reliable", 0),
        ("trigger_service", "/robot/start", 1), ("trigger_service", "\udcff", 0),
        ("trigger_service", None, 0),
    ],
)  # fmt: skip
def test_fact_must_have_the_expected_value_and_type(
    evidence: MakeEvidence, name: str, value: Any, score: float
) -> None:
    verdict = expect_fact(name, serial=1).judge(evidence(returns=({name: value},)))
    assert verdict.score == score


def test_missing_fact_is_reported(evidence: MakeEvidence) -> None:
    check = expect_fact("threshold", serial=26)
    assert (
        check.judge(evidence(returns=({},))).message
        == "the returned dict has no key 'threshold', it is empty"
    )
    other = check.judge(evidence(returns=({"Threshold": 0.5},)))
    assert other.message == "the returned dict has no key 'threshold', only 'Threshold'"
    for returns in ((), (None,)):
        message = check.judge(evidence(returns=returns)).message
        assert message == "nothing was returned, expected a dict with the key 'threshold'"


@pytest.mark.parametrize(
    ("returned", "what"),
    [
        ([13.0], "a list"),
        ("13.0", "a str"),
        ({"object": "a set"}, "a set"),
        (13.0, "a float"),
        (13, "an int"),
        (True, "a bool"),
    ],
)
def test_facts_that_are_not_a_dict_are_reported(evidence: MakeEvidence, returned: Any, what: str) -> None:
    message = expect_fact("threshold", serial=26).judge(evidence(returns=(returned,))).message
    assert message == f"{what} was returned, expected a dict with the key 'threshold'"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("trigger_service", "/robot/home_gripper [std_srvs/srv/Trigger]"),
        ("threshold", "Double value is: 0.7"),
    ],
)
def test_pasted_line_with_the_fact_in_it_is_reported(evidence: MakeEvidence, name: str, value: str) -> None:
    message = expect_fact(name, serial=23).judge(evidence(returns=({name: value},))).message
    assert message.endswith(": copy only the value from it")
    message = expect_fact(name, serial=11).judge(evidence(returns=({name: value},))).message
    assert "your robot has another value" in message


@pytest.mark.parametrize("value", ["best effort", "Best-Effort", "best_effort"])
def test_fact_in_another_spelling_is_reported(evidence: MakeEvidence, value: str) -> None:
    message = (
        expect_fact("scan_reliability", serial=17)
        .judge(evidence(returns=({"scan_reliability": value},)))
        .message
    )
    assert (
        message
        == f"scan_reliability is {value!r}: ros2 topic info -v spells it differently, letter by letter"
    )
    message = (
        expect_fact("scan_reliability", serial=11)
        .judge(evidence(returns=({"scan_reliability": value},)))
        .message
    )
    assert "but your robot has another value" in message


def test_number_with_a_unit_is_reported_as_a_string(evidence: MakeEvidence) -> None:
    message = expect_fact("image_rate", serial=11).judge(evidence(returns=({"image_rate": "13 Hz"},))).message
    assert message.endswith("a string; expected a number: write it without quotes and without a unit")


@pytest.mark.parametrize("name", ["image_rate", "image_width", "threshold"])
def test_quoted_number_is_reported_as_a_string(evidence: MakeEvidence, name: str) -> None:
    verdict = expect_fact(name, serial=11).judge(evidence(returns=({name: "13.0"},)))
    assert verdict.message == f"{name} is '13.0', a string; expected a number: write it without quotes"
    assert verdict.mistake == "a value is of the wrong kind"
