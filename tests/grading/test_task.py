from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check, Evidence, Verdict, passed
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.task import Message, Row, Scenario, Task, my, resolve

HINTS = ("one", "two", "three")
GOOD: dict[str, Any] = {
    "id": "week01.red_cube", "title": "A red cube", "kind": "node", "name": "RedCubeNode", "hints": HINTS,
}  # fmt: skip


def test_task_week_is_derived_from_its_id() -> None:
    assert Task(**GOOD).week == "week01"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"id": "red_cube"}, 'expected "week01.post"'),
        ({"kind": "nodes"}, "kind 'nodes', expected one of node, function"),
        ({"name": "Red Cube"}, "not a Python name"),
        ({"hints": ("one",)}, "1 hints, expected 3"),
        ({"hints": "one"}, "expected a tuple of str"),
        ({"scenarios": (Scenario("a"), Scenario("a"))}, "two scenarios have the same name"),
        ({"scenarios": Scenario("a")}, "expected a tuple of Scenario"),
        ({"kind": "written"}, "a rubric belongs to kind 'written'"),
        ({"kind": "written", "rubric": (Row("why", 0),)}, "above 0"),
    ],
)
def test_malformed_task_is_rejected_with_the_reason(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(CourseError) as refusal:
        Task(**{**GOOD, **changes})
    assert message in str(refusal.value)


@pytest.mark.parametrize(
    "changes", [{"seconds": 0}, {"seconds": float("nan")}, {"name": ""}, {"checks": (1,)}, {"calls": [1]},
                {"inputs": (Message("/a", "std_msgs/msg/String", {}, at=9.0),)},
                {"inputs": (Message("/a", "std_msgs/msg/String", {}, at="1"),)}]  # type: ignore[arg-type]
)  # fmt: skip
def test_malformed_scenario_is_rejected(changes: dict[str, Any]) -> None:
    with pytest.raises(CourseError):
        Scenario(**{"name": "public", **changes})


def test_personal_values_are_found_at_any_depth() -> None:
    value = {"a": (0, my("height")), "b": [my("height")]}
    assert resolve(value, {"height": 0.8}) == {"a": (0, 0.8), "b": [0.8]}


def test_unknown_personal_value_is_reported() -> None:
    with pytest.raises(CourseError, match="my\\('width'\\) is not in the task's personal table"):
        resolve(my("width"), {"height": 0.8})


@pytest.mark.parametrize("returned", [True, None, 1.0, "right"])
def test_check_without_a_verdict_is_reported_with_its_source_line(returned: object) -> None:
    def is_whole(_: Evidence) -> object:
        return returned

    line = is_whole.__code__.co_firstlineno
    task = Task("week01.demo", "D", "function", "f", ("a", "b", "c"))
    scenario = Scenario("public", checks=(Check("whole", is_whole),))  # type: ignore[arg-type]
    result = judge_task(task, 30, False, [Run(scenario, Evidence("week01.demo", "public", 5.0))])
    assert result.score == 0
    assert result.checks[0].broken == (
        f"tests/grading/test_task.py line {line}: TypeError: the check returned {returned!r}, "
        "expected passed(...) or failed(...)"
    )


def test_function_in_place_of_a_check_is_rejected_with_the_code_to_write() -> None:
    def is_whole(_: Evidence) -> Verdict:
        return passed("as expected")

    with pytest.raises(
        CourseError, match=r'is_whole is not a check yet\. Write Check\("the row\'s title", is_whole'
    ):
        Scenario("a", checks=(is_whole,))  # type: ignore[arg-type]
