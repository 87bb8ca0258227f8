"""RViz's additions to interactive markers (interactive_markers/src/tools.cpp)."""

import numpy as np
import pytest
from geometry_msgs.msg import Quaternion
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerControl, Marker

from course_lib.displays.interactive_motion import complete, title
from course_lib.displays.markers import DRAW

C = InteractiveMarkerControl
Y_AXIS = Quaternion(z=1.0, w=1.0)  # not of length 1, as in the tutorials


def completed(mode: int, transparent: bool = True, scale: float = 2.0) -> InteractiveMarkerControl:
    control = C(name="c", interaction_mode=mode, orientation=Y_AXIS, description="Menu")
    marker = InteractiveMarker(name="m", scale=scale, controls=[control])
    complete(marker, transparent)
    return control


def test_move_axis_control_has_two_arrows_in_its_color() -> None:
    control = completed(C.MOVE_AXIS)
    assert [(a.points[0].x, a.points[1].x) for a in control.markers] == [(1.0, 1.8), (-1.0, -1.8)]
    arrow = control.markers[0]
    assert (arrow.type, arrow.scale.x, arrow.scale.y, arrow.scale.z) == (Marker.ARROW, 0.3, 0.5, 0.4)
    color = arrow.color
    assert (color.r, color.g, color.b, color.a) == pytest.approx((0, 1, 0, 0.5))
    assert (arrow.pose.orientation.z, arrow.pose.orientation.w) == pytest.approx((0.5**0.5, 0.5**0.5))


@pytest.mark.parametrize("mode", [C.MOVE_PLANE, C.ROTATE_AXIS, C.MOVE_ROTATE])
def test_rotate_and_move_plane_controls_have_a_ring(mode: int) -> None:
    (ring,) = completed(mode).markers
    points = np.array([[point.x, point.y, point.z] for point in ring.points])
    assert points.shape == (216, 3)
    assert set(np.linalg.norm(points, axis=1).round(6)) == {0.5, 0.65}
    assert (points[:, 0] == 0).all()
    areas = np.linalg.norm(np.cross(points[1::3] - points[::3], points[2::3] - points[::3]), axis=1) / 2
    whole = np.pi * (0.65**2 - 0.5**2)
    assert areas.sum() == pytest.approx(whole, rel=0.02)  # without gaps, nothing twice
    assert ring.scale.x == 2.0
    assert len(ring.colors) == (0 if mode == C.MOVE_PLANE else 72)
    assert DRAW[ring.type](ring).status is None


def test_menu_control_has_text_and_button_controls_have_no_handle() -> None:
    (text,) = completed(C.MENU).markers
    assert (text.type, text.text, text.scale.z) == (Marker.TEXT_VIEW_FACING, "Menu", 0.5)
    assert text.pose.position.z == pytest.approx(2.4 - 0.05)
    assert completed(C.BUTTON).markers == []
    assert completed(C.NONE).markers == []


def test_handles_are_opaque_without_transparency() -> None:
    assert completed(C.MOVE_AXIS, transparent=False).markers[0].color.a == 1.0


def test_missing_sizes_orientations_and_names_get_defaults() -> None:
    box = Marker(type=Marker.CUBE)
    box.pose.orientation.w = 0.0
    controls = [C(name="a", markers=[box]), C(name="a"), C(name="b")]
    marker = InteractiveMarker(controls=controls)
    marker.pose.orientation.w = 0.0
    complete(marker, True)
    assert (marker.scale, marker.pose.orientation.w) == (1.0, 1.0)
    assert (box.scale.x, box.scale.y, box.scale.z, box.pose.orientation.w) == (1.0, 1.0, 1.0, 1.0)
    assert len({control.name for control in controls}) == 3


def test_description_is_drawn_above_the_marker() -> None:
    control = title(InteractiveMarker(description="A box", scale=2.0))
    (text,) = control.markers
    assert (text.text, text.pose.position.z, text.scale.z) == ("A box", 2.8, pytest.approx(0.3))
