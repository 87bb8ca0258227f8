"""Misspelled attributes of viewers, displays, views and options are rejected with a suggestion."""

from collections.abc import Iterator
from typing import Any

import pytest
from visualization_msgs.msg import Marker

from course_lib.displays import OwnDisplay, Points, Property, register, text
from course_lib.displays.registry import REGISTRY
from course_lib.displays.viewer import Viewer
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph, use_graph


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    with use_graph(Graph()):
        viewer = Viewer()
        viewer.add("Marker", name="People")
        yield viewer
        viewer.close()


@pytest.mark.parametrize(
    ("line", "instead"),
    [
        ('viewer.fixedframe = "world"', "viewer.fixed_frame = 'world'"),
        ('viewer.Fixed_Frame = "world"', "viewer.fixed_frame = 'world'"),
        ('viewer["People"].topic = "/people"', 'viewer["People"]["Topic"] = \'/people\''),
        ('viewer["People"].topik = "/people"', 'viewer["People"]["Topic"] = \'/people\''),
        ('viewer["People"].Enabled = False', 'viewer["People"]["Enabled"] = False'),
        ("viewer.view.distance = 3.0", 'viewer.view["Distance"] = 3.0'),
        ('viewer.background_color = "#fff"', "viewer.options[\"Background Color\"] = '#fff'"),
        ("viewer.options.frame_rate = 5", 'viewer.options["Frame Rate"] = 5'),
    ],
)
def test_misspelled_attribute_is_rejected_with_the_correct_spelling(
    viewer: Viewer, line: str, instead: str
) -> None:
    with pytest.raises(CourseError) as caught:
        exec(line, {"viewer": viewer})
    assert str(caught.value).endswith(f". Write: {instead}")
    # The suggestion works.
    exec(instead, {"viewer": viewer})


def test_attribute_without_a_close_match_is_rejected(viewer: Viewer) -> None:
    with pytest.raises(CourseError, match=r"has no attribute 'foo'\.$"):
        exec("viewer.foo = 3", {"viewer": viewer})


def test_property_read_as_an_attribute_is_an_error_with_the_correct_expression(viewer: Viewer) -> None:
    with pytest.raises(
        AttributeError, match=r"has no attribute 'topic'. Write: viewer\[\"People\"\]\[\"Topic\"\]"
    ):
        exec('viewer["People"].topic', {"viewer": viewer})


def test_known_attributes_can_be_set(viewer: Viewer) -> None:
    viewer.fixed_frame = "world"
    viewer["People"].name = "Persons"
    viewer["Persons"]["Topic"] = "/persons"
    assert (viewer.fixed_frame, viewer["Persons"].name) == ("world", "Persons")


def test_custom_display_sets_attributes_in_its_methods(viewer: Viewer) -> None:
    @register
    class Counting(OwnDisplay):
        class_name = "test/Counting"
        type_name = "visualization_msgs/msg/Marker"
        properties = (*OwnDisplay.properties, Property("Word", "x", text))

        def reset(self) -> None:
            self.count = 0
            super().reset()

        def made(self, message: Marker, transform_frame_to_fixed: object) -> object:
            return message

        def parts(self) -> dict[str, Points]:
            return {}

    try:
        display: Any = viewer.add("test/Counting", "/x")
        assert display.count == 0
    finally:
        REGISTRY.pop("test/Counting")


def test_class_instead_of_a_class_name_is_rejected(viewer: Viewer) -> None:
    with pytest.raises(CourseError, match=r"write its name in quotes, add\('Marker'\)"):
        viewer.add(Marker, topic="/x")  # type: ignore[arg-type]  # the mistake
