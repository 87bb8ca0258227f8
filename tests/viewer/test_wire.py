from typing import Any

import numpy as np
import pytest

from course_lib.viewer.encoding import Message, MessageError, from_json, to_json


class Inner(Message, frozen=True):
    first_name: str
    age: int = 0


class Family(Message, frozen=True):
    a: tuple[Inner, ...]
    anything: Any = None


class Outer(Message, frozen=True):
    place: tuple[float, float]
    is_open: bool = False
    weight: float | None = None
    anything: Any = None


def test_fields_with_default_values_are_omitted() -> None:
    people = to_json(Family((Inner("x"), Inner("y", 3))))["a"]
    assert list(people) == [{"firstName": "x"}, {"firstName": "y", "age": 3}]


def test_numpy_numbers_are_sent_as_plain_numbers() -> None:
    assert to_json(Family((), {"n": np.float32(0.5), "all": np.arange(2)}))["anything"] == {
        "n": 0.5,
        "all": [0, 1],
    }


def test_message_is_parsed_to_its_dataclass_without_the_envelope() -> None:
    content = {"type": "t", "page": "p", "number": 1, "place": [1, 2.5], "isOpen": True, "weight": None}
    assert from_json(Outer, content) == Outer((1, 2.5), is_open=True)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ({}, "missing required field `place`"),
        ({"place": [1, 2], "size": 3}, "unknown field `size`"),
        ({"place": [1]}, r"Expected `array` of length 2, got 1 - at `\$\.place`"),
        ({"place": [1, "2"]}, r"Expected `float`, got `str` - at `\$\.place\[1\]`"),
        ({"place": [1, float("nan")]}, "expected numbers that are finite"),
        ({"place": [1, 2], "weight": float("inf")}, "expected numbers that are finite"),
        ({"place": None}, r"Expected `array`, got `null` - at `\$\.place`"),
        ({"place": [1, 2], "isOpen": 1}, r"Expected `bool`, got `int` - at `\$\.isOpen`"),
        ({"place": [1, 2], "weight": True}, r"Expected `float \| null`, got `bool` - at `\$\.weight`"),
    ],
)
def test_malformed_message_is_rejected_with_the_expected_type(content: dict[str, Any], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        from_json(Outer, content)
