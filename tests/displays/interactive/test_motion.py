"""The motion of interactive markers obeys their controls for every motion of the pointer."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from course_lib.arrays import Floats, Matrix
from course_lib.displays.interactive_motion import (
    BUTTON,
    MENU,
    MOVE_3D,
    MOVE_AXIS,
    MOVE_PLANE,
    MOVE_ROTATE,
    MOVE_ROTATE_3D,
    ROTATE_3D,
    ROTATE_AXIS,
    Drag,
    Pointer,
    facing,
    rotation,
)
from course_lib.viewer.drawables import Camera
from tests.displays.interactive.pointing import pointer_at

CAMERAS = (Camera(eye=(10.0, 2.0, 6.0)), Camera(eye=(3.0, -8.0, 7.0), orthographic_scale=50.0))
numbers = st.floats(-2.0, 2.0)
places = st.tuples(numbers, numbers, numbers).map(np.array)
angles = st.floats(-3.0, 3.0)
cameras = st.sampled_from(CAMERAS)


@st.composite
def rotations(draw: st.DrawFn) -> Matrix:
    return rotation(np.eye(3)[0], draw(angles)) @ rotation(np.eye(3)[2], draw(angles))


@st.composite
def poses(draw: st.DrawFn) -> Matrix:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = draw(rotations()), draw(places)
    return pose


def pressed(
    mode: int, axes: Matrix, grab: Floats, camera: Camera = CAMERAS[0], pose: Matrix | None = None
) -> Drag:
    start = np.eye(4) if pose is None else pose
    return Drag(mode, axes, grab, start, pointer_at(grab, camera), start)


@pytest.mark.slow
@given(rotations(), poses(), places, places, cameras)
def test_drag_along_an_axis_stays_on_the_axis_without_rotation(
    axes: Matrix, pose: Matrix, grab: Floats, to: Floats, camera: Camera
) -> None:
    moved = pressed(MOVE_AXIS, axes, grab, camera, pose).move_to(pointer_at(to, camera)).pose
    step = moved[:3, 3] - pose[:3, 3]
    assert np.cross(step, axes[:, 0]) == pytest.approx(0, abs=1e-6 * (1 + float(np.linalg.norm(step))))
    assert (moved[:3, :3] == pose[:3, :3]).all()


@given(rotations(), places, numbers, cameras)
def test_grabbed_point_follows_a_pointer_on_the_axis(
    axes: Matrix, grab: Floats, far: float, camera: Camera
) -> None:
    drag = pressed(MOVE_AXIS, axes, grab, camera)
    assume(abs(axes[:, 0] @ drag.pointer.direction) < 0.95)  # not along the line of sight
    moved = drag.move_to(pointer_at(grab + far * axes[:, 0], camera)).pose
    assert moved[:3, 3] == pytest.approx(far * axes[:, 0], abs=1e-6)


@given(rotations(), poses(), places, places, cameras)
def test_drag_in_a_plane_keeps_its_distance_and_orientation(
    axes: Matrix, pose: Matrix, grab: Floats, to: Floats, camera: Camera
) -> None:
    moved = pressed(MOVE_PLANE, axes, grab, camera, pose).move_to(pointer_at(to, camera)).pose
    step = moved[:3, 3] - pose[:3, 3]
    assert step @ axes[:, 0] == pytest.approx(0, abs=1e-6 * (1 + float(np.linalg.norm(step))))
    assert (moved[:3, :3] == pose[:3, :3]).all()


@given(rotations(), poses(), places, places, cameras)
def test_rotation_about_an_axis_keeps_the_position_and_the_axis(
    axes: Matrix, pose: Matrix, grab: Floats, to: Floats, camera: Camera
) -> None:
    moved = pressed(ROTATE_AXIS, axes, grab, camera, pose).move_to(pointer_at(to, camera)).pose
    assert (moved[:3, 3] == pose[:3, 3]).all()
    turn = moved[:3, :3] @ pose[:3, :3].T
    assert turn @ axes[:, 0] == pytest.approx(axes[:, 0])
    assert turn @ turn.T == pytest.approx(np.eye(3))


@pytest.mark.parametrize("mode", [MOVE_AXIS, MOVE_PLANE, ROTATE_AXIS, MOVE_3D, MOVE_ROTATE_3D])
@given(rotations(), places, st.lists(places, max_size=4), cameras)
def test_drag_back_to_its_start_restores_the_pose(
    mode: int, axes: Matrix, grab: Floats, way: list[Floats], camera: Camera
) -> None:
    drag = pressed(mode, axes, grab, camera)
    assume(mode != MOVE_AXIS or abs(axes[:, 0] @ drag.pointer.direction) < 0.95)
    assume(mode not in (MOVE_PLANE, ROTATE_AXIS) or abs(axes[:, 0] @ drag.pointer.direction) > 0.05)
    for place in (*way, grab):
        drag = drag.move_to(pointer_at(place, camera))
    assert drag.pose == pytest.approx(np.eye(4), abs=1e-6)


def test_rotation_follows_the_pointer_around_the_axis() -> None:
    above = Camera(eye=(0.0, 0.0, 10.0), up=(0.0, 1.0, 0.0))
    axes = np.column_stack([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]).astype(float)
    drag = pressed(ROTATE_AXIS, axes, np.array([1.0, 0, 0]), above)
    drag = drag.move_to(pointer_at(np.array([0, 2.0, 0]), above))
    assert drag.rotation_angle == pytest.approx(np.pi / 2)
    assert drag.pose[:3, 0] == pytest.approx((0, 1, 0), abs=1e-9)


@given(st.lists(places, min_size=1, max_size=6))
def test_move_rotate_drag_keeps_the_grabbed_point_under_the_pointer(way: list[Floats]) -> None:
    above = Camera(eye=(0.0, 0.0, 10.0), up=(0.0, 1.0, 0.0))
    axes = np.column_stack([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]).astype(float)
    grab = np.array([1.0, 0, 0])
    drag = pressed(MOVE_ROTATE, axes, grab, above)
    for place in way:
        flat = np.array([place[0], place[1], 0.0])
        assume(np.linalg.norm(flat - drag.pose[:3, 3]) > 1e-3)
        drag = drag.move_to(pointer_at(flat, above))
        assert (drag.pose @ [*grab, 1])[:3] == pytest.approx(flat, abs=1e-6)


def test_shift_moves_in_depth_and_its_release_does_not_jump() -> None:
    camera = Camera(eye=(10.0, 0.0, 0.0))
    drag = pressed(MOVE_3D, np.eye(3), np.zeros(3), camera)
    drag = drag.move_to(drag.pointer, shift=True)
    assert (drag.pose == np.eye(4)).all()
    away = drag.move_to(drag.pointer.shifted(0, 100), shift=True)
    assert away.pose[:3, 3] == pytest.approx((-1.5, 0, 0), abs=0.02)  # 100 pixels of 1.5 cm there
    back = away.move_to(away.pointer)
    assert back.pose == pytest.approx(away.pose)


def test_trackball_rotates_the_visible_side_with_the_pointer() -> None:
    camera = Camera(eye=(10.0, 0.0, 0.0))
    drag = pressed(ROTATE_3D, np.eye(3), np.zeros(3), camera)
    right = drag.move_to(drag.pointer.shifted(75, 0)).pose
    assert right[:3, 0] == pytest.approx((0, 1, 0), abs=0.01)  # a quarter: x came towards us, y is right
    down = drag.move_to(drag.pointer.shifted(0, -75)).pose
    assert down[:3, 0] == pytest.approx((0, 0, -1), abs=0.01)
    screwed = drag.move_to(drag.pointer, shift=True).move_to(drag.pointer.shifted(75, 0), shift=True).pose
    assert screwed[:3, 2] == pytest.approx((0, 1, 0), abs=0.01)  # clockwise
    both = replace(drag, mode=MOVE_ROTATE_3D)
    turned = both.move_to(both.pointer, ctrl=True).move_to(both.pointer.shifted(75, 0), ctrl=True).pose
    assert turned == pytest.approx(right)


@pytest.mark.parametrize("mode", [0, BUTTON, MENU])
def test_controls_without_motion_do_not_move_the_marker(mode: int) -> None:
    drag = pressed(mode, np.eye(3), np.zeros(3))
    assert drag.move_to(pointer_at(np.ones(3), CAMERAS[0])) is drag


@pytest.mark.parametrize("mode", range(10))
def test_rays_without_an_intersection_do_not_move_the_marker(mode: int) -> None:
    camera = Camera(eye=(10.0, 0.0, 0.0))
    drag = pressed(mode, np.eye(3)[:, [2, 0, 1]], np.zeros(3), camera)  # x is up: planes are seen as lines
    for direction in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        aside = Pointer(
            np.array(camera.eye), np.array(direction), drag.pointer.axes, 0.0015, is_orthographic=False
        )
        if mode in (MOVE_PLANE, ROTATE_AXIS, MOVE_ROTATE):
            assert drag.move_to(aside) is drag


@given(rotations(), cameras, angles)
def test_view_facing_control_has_x_along_the_view_direction_and_z_up(
    control: Matrix, camera: Camera, turned: float
) -> None:
    right, up, behind = camera.view_matrix()[:3, :3]
    orientation = facing(control, np.array([right, up, -behind]), 0.0)
    assert orientation @ control[:, 0] == pytest.approx(-behind)
    assert orientation @ control[:, 2] == pytest.approx(up)
    by_hand = facing(control, np.array([right, up, -behind]), turned)
    assert by_hand == pytest.approx(rotation(-behind, turned) @ orientation)
