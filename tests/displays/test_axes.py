import numpy as np
import pytest

from course_lib.displays.session import RvizSession
from course_lib.displays.shapes import axes
from course_lib.displays.tf import AxesDisplay
from course_lib.ros.tf2 import Transform
from course_lib.viewer.drawables import Solids
from course_lib.viewer.scene import Scene

AXES = "rviz_default_plugins/Axes"
NODE = "displays/Axes/drawing"


def test_each_axis_extends_from_the_origin_in_its_direction_and_color() -> None:
    solids = axes(2.0, 0.1)
    ends = np.array([[0, 0, -0.5, 1], [0, 0, 0.5, 1]])
    for axis, placement in enumerate(solids.placements):
        start, end = (placement @ end for end in ends)
        np.testing.assert_allclose(start[:3], 0, atol=1e-12)
        np.testing.assert_allclose(end[:3], 2.0 * np.eye(3)[axis], atol=1e-12)
        assert np.linalg.det(placement[:3, :3]) == pytest.approx(2.0 * 0.1**2)
        np.testing.assert_allclose(solids.colors[axis, :3], np.eye(3)[axis])


def test_axes_are_drawn_at_their_frame_and_hidden_while_it_is_unknown() -> None:
    session = RvizSession(Scene(), "map")
    display = session.add(AXES, "Axes", {"Reference Frame": "base", "Length": 0.5})
    assert isinstance(display, AxesDisplay)
    scene = session.context.scene
    assert not scene.is_visible(NODE)
    assert [row[2:] for row in display.rows()] == [
        ("error", "For frame [base]: Fixed Frame [map] does not exist")
    ]
    session.context.frames.buffer.set_transform(
        Transform("map", "base", 0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0)), is_static=True
    )
    session.context.frames.fixed_frame = "map"
    session.refresh()
    assert scene.is_visible(NODE)
    np.testing.assert_allclose(scene.transform(NODE)[:3, 3], [1, 2, 3])
    assert [row[2:] for row in display.rows()] == [("ok", "Transform OK")]


def test_axes_radius_is_drawn_as_the_diameter() -> None:
    session = RvizSession(Scene(), "map")
    session.add(AXES, "Axes", {}, Radius=0.2)
    drawable = session.context.scene.node(NODE).object
    assert isinstance(drawable, Solids)
    np.testing.assert_allclose(np.linalg.norm(drawable.placements[:, :3, 0], axis=1), 0.2)
