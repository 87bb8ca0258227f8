"""No check raises an exception or exceeds its time limit, for any published or returned data."""

import random
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import pytest

from course_lib import grading
from course_lib.grading import vocabulary
from course_lib.grading.evidence import Check, Evidence
from tests.hostile.judging import WORDS, course_over, judge, right_runs, words_over
from tests.hostile.parsing import STAFFS, STUDENTS, Parsers, parse_any

ROUNDS = 60


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(4))
def test_expect_functions_do_not_raise_on_generated_evidence(seed: int) -> None:
    assert words_over(random.Random(seed), ROUNDS) > 20 * ROUNDS


@pytest.mark.slow
def test_course_checks_do_not_raise_on_corrupted_answers() -> None:
    runs = right_runs(("week03", "week04", "week05"))
    assert course_over(random.Random(0), runs, 500) > 1000


def test_every_expect_function_is_fuzzed() -> None:
    public = {name for name in dir(grading) if name.startswith("expect_")}
    assert {name for name, _ in WORDS} == public, "WORDS in tests/hostile/judging.py has a row of each"


def test_every_check_function_is_public() -> None:
    public = {getattr(grading, name) for name in dir(grading)}
    modules = [import_module(f"{vocabulary.__name__}.{m.name}") for m in iter_modules(vocabulary.__path__)]
    functions = {value for m in modules for name, value in vars(m).items() if name.startswith("expect_")}
    hidden = sorted(function.__name__ for function in functions - public)
    assert hidden == [], "course_lib/grading/__init__.pyi lists the names that check files import"


def test_raising_or_looping_check_is_detected() -> None:
    def raises(_: Evidence) -> Any:
        raise KeyError("x")

    with pytest.raises(AssertionError, match="KeyError"):
        judge(Check("c", raises), Evidence("a", "b", 1.0))


@pytest.mark.sample(1)
@pytest.mark.parametrize(("parsers", "count"), [(STUDENTS, 1500), (STAFFS, 300)], ids=["students", "staff"])
def test_parsers_raise_only_their_documented_exceptions(parsers: Parsers, count: int) -> None:
    chance = random.Random(0)
    for _ in range(count):
        parse_any(chance, parsers)
