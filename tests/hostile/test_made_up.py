"""No check raises over what students publish and return, and none takes beyond its time."""

import random
from typing import Any

import pytest

from course_lib import grading
from course_lib.grading.evidence import Check, Evidence
from tests.hostile.judging import WORDS, course_over, judge, right_runs, words_over
from tests.hostile.parsing import STAFFS, STUDENTS, Parsers, parse_any

ROUNDS = 60


@pytest.mark.parametrize("seed", range(4))
def test_no_word_raises_over_made_up_evidence(seed: int) -> None:
    assert words_over(random.Random(seed), ROUNDS) > 20 * ROUNDS


@pytest.mark.slow
def test_no_check_of_the_course_raises_over_spoilt_answers() -> None:
    runs = right_runs(("week03", "week04", "week05"))
    assert course_over(random.Random(0), runs, 500) > 1000


def test_every_word_is_tried() -> None:
    assert {name for name, _ in WORDS} == {name for name in dir(grading) if name.startswith("expect_")}


def test_a_check_that_raises_or_loops_is_found() -> None:
    def raises(_: Evidence) -> Any:
        raise KeyError("x")

    with pytest.raises(AssertionError, match="KeyError"):
        judge(Check("c", raises), Evidence("a", "b", 1.0))


@pytest.mark.parametrize(("parsers", "count"), [(STUDENTS, 1500), (STAFFS, 300)], ids=["students", "staff"])
def test_no_parser_raises_what_it_does_not_announce(parsers: Parsers, count: int) -> None:
    chance = random.Random(0)
    for _ in range(count):
        parse_any(chance, parsers)
