from math import cos, pi, sin

import numpy as np
import pytest

from course_lib.displays.frames import Frames
from course_lib.displays.views import (
    FPS,
    FrameAligned,
    Orbit,
    ThirdPersonFollower,
    TopDownOrtho,
    ViewController,
    XYOrbit,
    view_of,
)
from course_lib.errors import CourseError
from tests.displays.test_frames import transform

YAW, PITCH = 0.8, 0.6  # [rad]
AWAY = np.array([cos(YAW) * cos(PITCH), sin(YAW) * cos(PITCH), sin(PITCH)])


def turned_frames() -> Frames:
    frames = Frames("map")
    message = transform("map", "base", 10.0)
    message.transform.rotation.z = message.transform.rotation.w = 0.5**0.5
    frames.add_transforms([message], is_static=True)
    return frames


def test_orbit_camera_has_the_distance_from_its_focal_point() -> None:
    camera = Orbit(distance=8.0, yaw=YAW, pitch=PITCH, focal_point=(1.0, 2.0, 0.5)).camera(Frames("map"))
    np.testing.assert_allclose(camera.eye, np.array([1, 2, 0.5]) + 8 * AWAY)
    np.testing.assert_allclose(camera.target, [1, 2, 0.5])
    assert camera.vertical_fov == pytest.approx(pi / 4)


def test_orbit_follows_only_the_position_of_its_target_frame() -> None:
    camera = Orbit(target_frame="base", yaw=YAW, pitch=PITCH, distance=1.0).camera(turned_frames())
    np.testing.assert_allclose(camera.target, [10, 0, 0])
    np.testing.assert_allclose(np.subtract(camera.eye, camera.target), AWAY)


def test_third_person_follower_rotates_with_its_target_frame() -> None:
    view = ThirdPersonFollower(target_frame="base", yaw=YAW, pitch=PITCH, distance=1.0)
    camera = view.camera(turned_frames())
    away = np.subtract(camera.eye, camera.target)
    np.testing.assert_allclose(away, [-AWAY[1], AWAY[0], AWAY[2]], atol=1e-9)
    assert camera.target[2] > 0  # it is an XYOrbit, whose camera is lifted


def test_xy_orbit_raises_the_camera_by_a_fifth_of_its_distance() -> None:
    plain = Orbit(distance=5.0, yaw=YAW, pitch=PITCH).camera(Frames("map"))
    lifted = XYOrbit(distance=5.0, yaw=YAW, pitch=PITCH).camera(Frames("map"))
    moved = np.subtract(lifted.eye, plain.eye)
    assert np.linalg.norm(moved) == pytest.approx(1.0)
    assert moved @ AWAY == pytest.approx(0.0, abs=1e-9)
    assert moved[2] > 0
    np.testing.assert_allclose(np.subtract(lifted.target, plain.target), moved)


def test_inverted_z_axis_turns_the_view_upside_down() -> None:
    camera = Orbit(invert_z_axis=True, yaw=YAW, pitch=PITCH, distance=1.0).camera(Frames("map"))
    np.testing.assert_allclose(camera.eye, AWAY * [1, -1, -1])
    assert camera.up == (0.0, 0.0, -1.0)


def test_fps_view_looks_ahead_and_down_by_its_pitch() -> None:
    camera = FPS(position=(1.0, 2.0, 3.0), yaw=YAW, pitch=PITCH).camera(Frames("map"))
    np.testing.assert_allclose(camera.eye, [1, 2, 3])
    np.testing.assert_allclose(np.subtract(camera.target, camera.eye), AWAY * [1, 1, -1])


def test_new_fps_view_looks_at_the_origin() -> None:
    camera = FPS().camera(Frames("map"))
    ahead = np.subtract(camera.target, camera.eye)
    np.testing.assert_allclose(np.cross(ahead, camera.eye), 0, atol=1e-9)


def test_top_down_view_has_pixels_per_meter_and_rotates_by_its_angle() -> None:
    camera = TopDownOrtho(x=0.5, y=-0.5, scale=70.0, angle=0.3).camera(Frames("map"))
    np.testing.assert_allclose(camera.target[:2], [0.5, -0.5])
    assert camera.eye[2] == 500.0
    assert camera.orthographic_scale == 70.0
    np.testing.assert_allclose(camera.up, [-sin(0.3), cos(0.3), 0])


MOVED = (
    Orbit(yaw=2.0, pitch=-0.4, distance=3.0, focal_point=(1.0, 2.0, 3.0), target_frame="base"),
    Orbit(yaw=1.0, pitch=0.3, invert_z_axis=True),
    XYOrbit(yaw=5.0, pitch=0.9, distance=4.0, focal_point=(1.0, -2.0, 0.0)),
    ThirdPersonFollower(yaw=0.3, pitch=0.2, focal_point=(0.5, 0.0, 0.1), target_frame="base"),
    FPS(yaw=4.0, pitch=0.7, position=(1.0, 2.0, 3.0), target_frame="base"),
    FrameAligned(yaw=4.0, pitch=0.7, position=(1.0, 2.0, 3.0), target_frame="base"),
    TopDownOrtho(x=0.5, y=-0.5, scale=70.0, angle=0.3, target_frame="base"),
)


@pytest.mark.parametrize("view", MOVED, ids=repr)
def test_view_properties_survive_conversion_to_a_camera_and_back(view: ViewController) -> None:
    frames = turned_frames()
    other = type(view)(target_frame=view["Target Frame"], invert_z_axis=view["Invert Z Axis"])
    other.camera(frames)
    other.set_from_camera(view.camera(frames))
    for prop in view.properties:
        wanted = view[prop.label]
        assert other[prop.label] == (wanted if isinstance(wanted, str) else pytest.approx(wanted)), prop.label


@pytest.mark.parametrize("kind", [Orbit, ThirdPersonFollower])
def test_changed_view_type_keeps_the_camera_position(kind: type[ViewController]) -> None:
    frames, view = turned_frames(), kind()
    former = FPS(yaw=4.0, pitch=0.7, position=(1.0, 2.0, 3.0), target_frame="base")
    view.mimic(former, frames)
    np.testing.assert_allclose(view.camera(frames).eye, former.camera(frames).eye, atol=1e-9)


@pytest.mark.parametrize("view", [Orbit, XYOrbit, ThirdPersonFollower, FPS, TopDownOrtho, FrameAligned])
def test_lost_target_frame_leaves_the_view_unchanged(view: type[ViewController]) -> None:
    frames = turned_frames()
    made = view(target_frame="base")
    before = made.camera(frames)
    frames.fixed_frame = "nowhere"
    assert made.camera(frames) == before


def test_pitch_is_limited_near_the_poles() -> None:
    assert Orbit(pitch=7.0)["Pitch"] == pytest.approx(pi / 2 - 0.001)


def test_unknown_view_property_error_suggests_existing_properties() -> None:
    with pytest.raises(CourseError, match="Orbit has no property 'dist'; it has 'Distance'"):
        Orbit(dist=3.0)


@pytest.mark.parametrize("kind", [Orbit, XYOrbit, FPS, TopDownOrtho])
def test_changed_target_frame_keeps_the_camera_position(kind: type[ViewController]) -> None:
    frames, view = turned_frames(), kind()
    before = view.camera(frames)
    view["Target Frame"] = "base"
    assert view.camera(frames) == before


def test_xy_orbit_focal_point_is_on_the_ground_regardless_of_the_previous_view() -> None:
    view, former = XYOrbit(), FPS(yaw=4.0, pitch=0.7, position=(1.0, 2.0, 3.0))
    view.mimic(former, Frames("map"))
    assert view["Focal Point"][2] == 0.0
    np.testing.assert_allclose(view.camera(Frames("map")).eye, former.camera(Frames("map")).eye, atol=1e-9)


def test_xy_orbit_without_visible_ground_is_reset() -> None:
    view = XYOrbit(distance=3.0)
    view.mimic(FPS(pitch=-0.5), Frames("map"))
    assert [view[label] for label in ("Distance", "Focal Point")] == [10.0, (0.0, 0.0, 0.0)]


def test_orbit_after_a_view_without_focal_point_turns_about_a_point_as_far_as_its_frame() -> None:
    view, former = Orbit(), FPS(position=(3.0, 4.0, 0.0), yaw=pi / 2, pitch=0.0)
    view.mimic(former, Frames("map"))
    assert view["Distance"] == pytest.approx(5.0)
    assert view["Focal Point"] == pytest.approx((3.0, 9.0, 0.0))


@pytest.mark.parametrize("kind", [Orbit, XYOrbit])
def test_orbit_after_a_view_from_above_keeps_the_point_below_and_the_upward_direction(
    kind: type[ViewController],
) -> None:
    view, former = kind(), TopDownOrtho(x=2.0, y=3.0)
    view.mimic(former, Frames("map"))
    assert (view["Distance"], view["Focal Point"]) == (100.0, (2.0, 3.0, 0.0))
    up = view.camera(Frames("map")).view_matrix()[1, :3]
    np.testing.assert_allclose(up, [0, 1, 0], atol=0.002)


def test_view_from_above_shows_the_focal_point_and_copies_another_one() -> None:
    view, copy = TopDownOrtho(), TopDownOrtho()
    view.mimic(Orbit(focal_point=(1.0, 2.0, 3.0), yaw=1.0), Frames("map"))
    assert [view[label] for label in ("X", "Y", "Scale", "Angle")] == [1.0, 2.0, 10.0, 0.0]
    view["Scale"], view["Angle"] = 50.0, 0.5
    copy.mimic(view, Frames("map"))
    assert [copy[label] for label in ("X", "Y", "Scale", "Angle")] == [1.0, 2.0, 50.0, 0.5]
    view.mimic(FPS(position=(7.0, 8.0, 9.0)), Frames("map"))
    assert (view["X"], view["Y"]) == (7.0, 8.0)


def test_fps_view_after_a_view_from_above_keeps_the_upward_direction() -> None:
    view, former = FPS(), TopDownOrtho(angle=0.5)
    view.mimic(former, Frames("map"))
    up = view.camera(Frames("map")).view_matrix()[1, :3]
    np.testing.assert_allclose(up[:2], [-sin(0.5), cos(0.5)], atol=0.002)


AXES = {"+x axis": (0, 1, 0), "-y axis": (1, 0, 0), "-z axis": (0, 0, -1)}  # of base in turned_frames


@pytest.mark.parametrize("axis", AXES)
def test_frame_aligned_view_looks_along_an_axis_of_its_frame(axis: str) -> None:
    camera = FrameAligned(target_frame="base", point_towards=axis).camera(turned_frames())
    np.testing.assert_allclose(camera.eye, [10, 0, 0])
    np.testing.assert_allclose(np.subtract(camera.target, camera.eye), AXES[axis], atol=0.0011)


def test_frame_aligned_view_reports_its_viewing_axis() -> None:
    view = FrameAligned()
    assert view["Point towards"] == "-z axis"
    view["Pitch"] = 0.3
    assert view["Point towards"] == "arbitrary"
    view["Pitch"] = 0.0
    assert view["Point towards"] == "+x axis"


def test_reset_view_keeps_its_target_frame() -> None:
    view = Orbit(distance=3.0, yaw=1.0, target_frame="base")
    view.return_home()
    assert [view[label] for label in ("Distance", "Yaw", "Target Frame")] == [10.0, pi / 4, "base"]


@pytest.mark.parametrize(
    ("name", "kind"), [("rviz/FPS", "FPS"), ("XYOrbit", "XYOrbit"), ("my/Orbit", "FailedView")]
)
def test_ros_1_views_are_converted_and_unknown_views_are_reported(name: str, kind: str) -> None:
    view, *wrong = view_of({"Class": name})
    assert type(view).__name__ == kind
    assert bool(wrong) == (kind == "FailedView")
