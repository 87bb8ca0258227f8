from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading.task import Message, Row, Scenario, Task, my, resolve

HINTS = ("one", "two", "three")
GOOD: dict[str, Any] = {
    "id": "week01.red_cube", "title": "A red cube", "kind": "node", "name": "RedCubeNode", "hints": HINTS,
}  # fmt: skip


def test_a_task_knows_its_week() -> None:
    assert Task(**GOOD).week == "week01"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"id": "red_cube"}, 'expected "week01.post"'),
        ({"kind": "nodes"}, "kind 'nodes', expected one of node, function"),
        ({"name": "Red Cube"}, "no Python name"),
        ({"hints": ("one",)}, "1 hints, expected 3"),
        ({"hints": "one"}, "expected a tuple of str"),
        ({"scenarios": (Scenario("a"), Scenario("a"))}, "two scenarios of one name"),
        ({"scenarios": Scenario("a")}, "expected a tuple of Scenario"),
        ({"kind": "written"}, "a rubric belongs to kind 'written'"),
        ({"kind": "written", "rubric": (Row("why", 0),)}, "above 0"),
    ],
)
def test_a_malformed_task_is_refused_with_its_reason(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(CourseError) as refusal:
        Task(**{**GOOD, **changes})
    assert message in str(refusal.value)


@pytest.mark.parametrize(
    "changes", [{"seconds": 0}, {"seconds": float("nan")}, {"name": ""}, {"checks": (1,)}, {"calls": [1]},
                {"inputs": (Message("/a", "std_msgs/msg/String", {}, at=9.0),)},
                {"inputs": (Message("/a", "std_msgs/msg/String", {}, at="1"),)}]  # type: ignore[arg-type]
)  # fmt: skip
def test_a_malformed_scenario_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(CourseError):
        Scenario(**{"name": "public", **changes})


def test_the_students_own_values_are_found_at_any_depth() -> None:
    value = {"a": (0, my("height")), "b": [my("height")]}
    assert resolve(value, {"height": 0.8}) == {"a": (0, 0.8), "b": [0.8]}


def test_an_unknown_own_value_is_named() -> None:
    with pytest.raises(CourseError, match="my\\('width'\\) is not in the task's personal table"):
        resolve(my("width"), {"height": 0.8})
