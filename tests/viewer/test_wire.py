from dataclasses import dataclass
from typing import Any

import pytest

from course_lib.viewer.wire import MessageError, from_json, to_json


@dataclass(frozen=True)
class Inner:
    first_name: str
    age: int = 0


@dataclass(frozen=True)
class Outer:
    place: tuple[float, float]
    is_open: bool = False
    weight: float | None = None
    anything: Any = None


def test_fields_that_have_their_defaults_are_left_out() -> None:
    assert to_json({"a": (Inner("x"), Inner("y", 3))}) == {
        "a": [{"firstName": "x"}, {"firstName": "y", "age": 3}]
    }


def test_a_message_becomes_its_dataclass_and_the_envelope_is_no_part_of_it() -> None:
    content = {"type": "t", "page": "p", "number": 1, "place": [1, 2.5], "isOpen": True, "weight": None}
    assert from_json(Outer, content) == Outer((1, 2.5), is_open=True)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ({}, "Outer from the page lacks 'place'"),
        ({"place": [1, 2], "size": 3}, "has 'size', expected only place, isOpen, weight, anything"),
        ({"place": [1]}, r"'place' of Outer from the page is '\[1\]', expected tuple\[float, float\]"),
        ({"place": [1, "2"]}, "'place' of Outer"),
        ({"place": [1, float("nan")]}, "'place' of Outer"),
        ({"place": None}, "'place' of Outer from the page is 'None'"),
        ({"place": [1, 2], "isOpen": 1}, "'isOpen' of Outer from the page is '1', expected bool"),
        ({"place": [1, 2], "weight": True}, "'weight' of Outer from the page is 'True', expected float"),
    ],
)
def test_malformed_messages_are_refused_with_what_was_expected(content: dict[str, Any], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        from_json(Outer, content)
