from collections.abc import Callable
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary import expect_fact, expect_level
from course_lib.robots.unknown_make import Make

MakeEvidence = Callable[..., Evidence]


def status(at: float, level: bytes, message: str) -> tuple[float, str, Any]:
    return at, "/diagnostics", DiagnosticArray(status=[DiagnosticStatus(level=level, message=message)])


@pytest.mark.parametrize(
    ("level", "says", "begin", "message"),
    [
        ("OK", "normal", 0.0, "as expected"),
        ("ERROR", "low", 2.0, "as expected"),
        ("OK", "normal", 2.0, "the level is ERROR from 2 to 4 s, expected OK"),
        ("OK", "fine", 0.0, "the message is 'Normal: 30' from 0 to 2 s: 'fine' is not in it"),
        ("OK", "normal", 7.0, "no status came from 7 to 9 s"),
    ],
)
def test_levels_hold_for_the_seconds_that_lie_in_a_part(
    evidence: MakeEvidence, level: str, says: str, begin: float, message: str
) -> None:
    good, bad = (DiagnosticStatus.OK, "Normal: 30"), (DiagnosticStatus.ERROR, "low")
    came = evidence(status(1, *good), status(2, *good), status(3, *bad), status(4, *bad), seconds=9.0)
    # What is reported at a part's begin is about the second before it.
    check = expect_level(level, says=says, begin=begin, end=begin + 2)
    assert check.judge(came).message == message


def test_silence_on_diagnostics_is_named(evidence: MakeEvidence) -> None:
    said = expect_level("OK", says="", begin=0.0, end=2.0).judge(evidence()).message
    assert "nothing was published on /diagnostics" in said


@pytest.mark.parametrize(
    ("factor", "score"), [(1.0, 1.0), (1.02, 1.0), (0.9, 0.0), ("30", 0.0), (float("nan"), 0.0)]
)
def test_a_measured_rate_may_be_a_little_off(evidence: MakeEvidence, factor: Any, score: float) -> None:
    rate = factor if isinstance(factor, str) else factor * Make(26).image_hz
    verdict = expect_fact("image_rate", serial=26).judge(evidence(returns=({"image_rate": rate},)))
    assert verdict.score == score
    assert str(Make(26).image_hz) not in verdict.message.replace(repr(rate), "")


def test_a_fact_that_is_not_there_is_named(evidence: MakeEvidence) -> None:
    given: tuple[tuple[Any, ...], ...] = ((), (None,), ({},))
    for returns in given:
        said = expect_fact("threshold", serial=26).judge(evidence(returns=returns)).message
        assert said == "there is no 'threshold' in what came back"
