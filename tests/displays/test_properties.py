from typing import Any

import pytest

from course_lib.displays.properties import (
    Property,
    PropertyHolder,
    booleans,
    color,
    flag,
    frame,
    integer,
    number,
    read_only,
    text,
    vector,
    words,
)
from course_lib.errors import CourseError


class Thing(PropertyHolder):
    properties = (
        Property("Cell Size", 1.0, number(0.1)),
        Property("Line Style", "Lines", words("Lines", "Billboards")),
        Property("Line Style/Line Width", 0.03, number()),
        Property("Shape/Alpha", 1.0, number()),
        Property("Covariance/Alpha", 0.5, number()),
    )

    def __init__(self) -> None:
        super().__init__()
        self.seen: list[str] = []

    def __repr__(self) -> str:
        return "Thing"

    def on_property_change(self, label: str) -> None:
        self.seen.append(label)


@pytest.mark.parametrize("label", ["Line Style/Line Width", "Line Width", "line_width"])
def test_property_is_accessed_by_path_unique_label_or_python_name(label: str) -> None:
    drawable = Thing()
    drawable[label] = 2
    assert drawable["Line Style/Line Width"] == 2.0
    assert drawable.seen == ["Line Style/Line Width"]


def test_conversion_to_a_dict_includes_all_values() -> None:
    assert dict(Thing())["Line Style/Line Width"] == 0.03
    assert list(dict(Thing())) == [prop.label for prop in Thing.properties]


def test_setting_an_equal_value_is_not_a_change() -> None:
    drawable = Thing()
    drawable["Cell Size"] = 1
    assert drawable.seen == []


def test_unknown_label_error_suggests_close_labels() -> None:
    with pytest.raises(CourseError, match="Thing has no property 'cell siz'; it has 'Cell Size'"):
        Thing()["cell siz"]


def test_ambiguous_label_is_an_error_that_requests_the_path() -> None:
    with pytest.raises(CourseError, match="'Alpha' may be 'Shape/Alpha' or 'Covariance/Alpha'"):
        Thing()["Alpha"]


def test_invalid_value_is_reported_with_the_valid_values() -> None:
    with pytest.raises(CourseError, match="'Line Style' is 'Dots', expected one of 'Lines', 'Billboards'"):
        Thing()["Line Style"] = "Dots"


def test_layout_sets_the_listed_properties_and_reports_invalid_values() -> None:
    drawable = Thing()
    config = {
        "Cell Size": "wide",
        "Line Style": {"Value": "Billboards", "Line Width": 0.5},
        "Covariance": {"Alpha": 0.25},
        "Foreign": 1,
        "Shape": None,
    }
    (wrong,) = drawable.load(config)
    assert wrong == "Thing: 'Cell Size' is 'wide', expected a number."
    values = [drawable[prop.label] for prop in Thing.properties]
    assert values == [1.0, "Billboards", 0.5, 1.0, 0.25]


GOOD: list[tuple[Any, Any, Any]] = [
    (number(0.0, 1.0), 2, 1.0),
    (number(0.0, 1.0), "0.5", 0.5),
    (integer(1), 0, 1),
    (integer(1), 3.0, 3),
    (flag, True, True),
    (text, None, ""),
    (text, 5, "5"),
    (frame, "/map", "map"),
    (color, "255; 0; 7", (255, 0, 7)),
    (color, "#ff0007", (255, 0, 7)),
    (color, "red", (255, 0, 0)),
    (color, (1, 2, 300), (1, 2, 255)),
    (vector, {"X": 1, "Y": 2.5, "Z": -3}, (1.0, 2.5, -3.0)),
    (vector, [1, 2, 3], (1.0, 2.0, 3.0)),
    (booleans, {"a": False}, {"a": False}),
]


@pytest.mark.parametrize(("convert", "given", "value"), GOOD)
def test_values_are_converted_as_in_rviz(convert: Any, given: Any, value: Any) -> None:
    assert convert(given) == value


BAD: list[tuple[Any, Any, str]] = [
    (number(), "a", "a number"),
    (number(), True, "a number"),
    (number(), float("nan"), "a number"),
    (integer(0), 1.5, "an integer"),
    (integer(0), float("inf"), "an integer"),
    (flag, 1, "True or False"),
    (text, {}, "a string"),
    (words("A", "B"), ["A"], "one of 'A', 'B'"),
    (color, "1; 2", "a color like"),
    (color, 7, "a color like"),
    (color, "nocolour", "a color like"),
    (vector, {"X": 1}, "three numbers"),
    (vector, 1.0, "three numbers"),
    (booleans, {"a": 1}, "True or False"),
    (booleans, ["a"], "a map like"),
]


@pytest.mark.parametrize(("convert", "given", "expected"), BAD)
def test_invalid_value_is_an_error_with_the_expected_type(convert: Any, given: Any, expected: str) -> None:
    with pytest.raises(ValueError, match=expected):
        convert(given)


def grown() -> Thing:
    drawable = Thing()
    drawable.add_properties(
        Property("Links/arm", True, flag), Property("Links/a/b", True, flag, ("Links", "a/b"))
    )
    return drawable


def test_dynamic_property_behaves_like_others_until_removed() -> None:
    drawable = grown()
    drawable["Links/arm"] = False
    drawable["a/b"] = False
    assert drawable.seen == ["Links/arm", "Links/a/b"]
    drawable.remove_properties("Links")
    assert drawable.properties == Thing.properties
    with pytest.raises(CourseError, match="no property 'arm'"):
        drawable["arm"] = True


def test_dynamic_property_is_initialized_from_the_layout_or_its_former_value() -> None:
    drawable = Thing()
    drawable.load({"Links": {"arm": {"Value": False}, "hand": 3}})
    assert drawable.add_properties(Property("Links/arm", True, flag)) == []
    assert drawable["arm"] is False
    drawable["arm"] = True
    drawable.remove_properties("Links")
    drawable.add_properties(Property("Links/arm", True, flag))
    assert drawable["arm"] is True
    assert drawable.add_properties(Property("Links/hand", True, flag)) == [
        "Thing: 'Links/hand' is 3, expected True or False."
    ]


def test_read_only_property_rejects_values() -> None:
    drawable = Thing()
    drawable.add_properties(Property("Tree/Parent", "", read_only))
    drawable.load({"Tree": {"Parent": "map"}})
    with pytest.raises(CourseError, match="the property is read-only"):
        drawable["Parent"] = "map"
    assert drawable["Parent"] == ""
