"""Every combination of personal options is tried, as far as there are not too many."""

from itertools import product

import pytest

from course_lib.authoring.edits import Variant, apply_changes, failure_text
from course_lib.authoring.rehearsal import MOST, count_options, with_option
from course_lib.errors import CourseError
from course_lib.grading.records import CheckResult, TaskResult
from course_lib.grading.task import Task


def task(**personal: tuple[float, ...]) -> Task:
    return Task("week09.post", "A post", "node", "Post", ("a", "b", "c"), personal=personal)


def option_values(one: Task) -> list[tuple[float, ...]]:
    rows = [with_option(one, row).personal for row in range(count_options([one]))]
    return [tuple(choice for (choice,) in row.values()) for row in rows]


def test_every_combination_of_two_values_is_tried_once() -> None:
    low, critical = (0.5, 0.75, 0.9), (0.1, 0.2)
    assert sorted(option_values(task(low=low, critical=critical))) == sorted(product(low, critical))
    assert count_options([task(), task(low=low), task(low=low, critical=critical)]) == 6


def test_too_many_combinations_are_sampled_evenly() -> None:
    many = option_values(task(a=tuple(range(30)), b=tuple(range(30))))
    assert len(set(many)) == len(many) == MOST
    assert {b for _, b in many} == set(range(30))


def test_replacement_of_a_text_by_itself_is_rejected() -> None:
    variant = Variant("week09.post", way="the same", change=(("x = 1", "x = 1"),))
    with pytest.raises(CourseError, match="'x = 1' is replaced by itself, expected a different new text"):
        apply_changes(variant, "Post", ["class Post:\n    x = 1"])


def test_exception_of_a_custom_check_is_reported_with_its_location() -> None:
    broken = "checks/week09.py line 12: IndexError: list index out of range"
    check = CheckResult("own", "public", False, 1.0, 0.0, "could not judge", "could not judge", broken=broken)
    result = TaskResult("week09.post", "A post", 100.0, False, (check,))
    assert failure_text(result).splitlines() == [broken, "could not judge"]
