from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseWithCovariance
from hypothesis import given
from hypothesis import strategies as st

from course_lib.displays.properties import PropertyHolder
from course_lib.displays.shapes import COVARIANCE_PROPERTIES, draw_covariances, uncertain_pose
from course_lib.viewer.drawables import Solids
from tests.displays.poses.test_poses import pose

PLACE, TURN = "Covariance/Position", "Covariance/Orientation"
SMALL = 1e-4  # [rad^2], of angles that are as large as their tangents
factors = st.lists(st.floats(-1, 1), min_size=9, max_size=9).map(lambda some: np.reshape(some, (3, 3)))


class Holder(PropertyHolder):
    properties = COVARIANCE_PROPERTIES


def turned_frame() -> np.ndarray:
    transform_frame_to_fixed = np.eye(4)
    transform_frame_to_fixed[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    return transform_frame_to_fixed


def drawn_poses(
    covariance: np.ndarray, frame: np.ndarray | None = None, turned: bool = False, values: Any = ()
) -> dict[str, np.ndarray]:
    """Return the poses of the drawables for some property values."""
    holder = Holder()
    for label, value in dict(values).items():
        holder[label] = value
    message = PoseWithCovariance(pose=pose(2.0, turned), covariance=covariance.ravel())
    parts = draw_covariances([uncertain_pose(message, np.eye(4) if frame is None else frame)], holder)
    assert all(isinstance(part, Solids) for part in parts.values())
    return {name: part.placements[:, :3].astype(float) for name, part in parts.items()}  # type: ignore[union-attr]  # solids, as was just seen


def blocks(place: np.ndarray, turn: np.ndarray) -> np.ndarray:
    return np.block([[place, np.zeros((3, 3))], [np.zeros((3, 3)), turn]])


@given(factor=factors)
def test_position_ellipsoid_is_one_standard_deviation_along_the_frame_axes(factor: np.ndarray) -> None:
    covariance = factor @ factor.T
    frame = turned_frame()
    (body,) = drawn_poses(blocks(covariance, np.eye(3)), frame, turned=True)["place"]
    wanted = frame[:3, :3] @ covariance @ frame[:3, :3].T
    # the unit sphere has a radius of 1/2
    np.testing.assert_allclose(body[:, :3] @ body[:, :3].T / 4, wanted, atol=1e-5)
    assert np.linalg.det(body[:, :3]) >= -1e-6


@pytest.mark.parametrize(("axis", "angles"), [(0, (2, 1)), (1, (2, 0)), (2, (0, 1))])
@given(factor=factors)
def test_orientation_disc_has_the_width_of_the_angles_perpendicular_to_its_axis(
    axis: int, angles: tuple[int, int], factor: np.ndarray
) -> None:
    covariance = SMALL * factor @ factor.T
    disc = drawn_poses(blocks(np.eye(3), covariance))["discs"][axis]
    assert disc[:, 3].tolist() == [2 + (axis == 0), axis == 1, axis == 2]
    along, across = disc[axis, :2], np.delete(disc[:, :2], axis, axis=0)
    np.testing.assert_allclose(along, 0, atol=1e-9)
    # RViz shows the variance of roll along the x of the disc across z
    np.testing.assert_allclose(
        np.diag(across @ across.T) / 4, covariance.diagonal()[list(angles)], rtol=1e-2, atol=1e-9
    )


def test_large_angles_are_drawn_by_their_tangents_and_limited_to_89_degrees() -> None:
    widths = [
        np.linalg.norm(drawn_poses(blocks(np.eye(3), np.eye(3) * deviation**2))["discs"][0], axis=0)[0]
        for deviation in (0.5, 100.0)
    ]
    np.testing.assert_allclose(widths, [2 * np.tan(0.5), 2 * np.tan(np.radians(89))], rtol=1e-5)


def test_planar_covariance_is_a_flat_ellipse_and_a_yaw_cone_from_the_pose() -> None:
    covariance = np.diag([0.25, 1.0, 0, 0, 0, 0.04])
    parts = drawn_poses(covariance)
    assert sorted(parts) == ["cones", "place"]
    np.testing.assert_allclose(np.linalg.norm(parts["place"][0, :, :3], axis=0), [1, 2, 0.001], rtol=1e-5)
    (cone,) = parts["cones"]
    tip, rim = ((cone @ (*point, 1.0)) for point in ((0, 0, 0.5), (0, 0.5, -0.5)))
    np.testing.assert_allclose(tip, [2, 0, 0], atol=0.01)
    np.testing.assert_allclose(rim - tip, [1, np.tan(0.2), 0], atol=1e-5)


@pytest.mark.parametrize(("frame", "ahead"), [("Local", [0, 1, 0]), ("Fixed", [1, 0, 0])])
def test_orientation_covariance_is_shown_in_the_axes_of_the_pose_or_its_frame(
    frame: str, ahead: list[float]
) -> None:
    (first, *_) = drawn_poses(np.eye(6), turned=True, values={f"{TURN}/Frame": frame})["discs"]
    np.testing.assert_allclose(first[:, 3] - [2, 0, 0], ahead, atol=1e-6)


def test_covariance_with_a_negative_eigenvalue_has_zero_extent() -> None:
    (body,) = drawn_poses(np.diag([-1.0, 1.0, 1.0, 1.0, 1.0, 1.0]))["place"]
    assert not body[:, :3].any()


@pytest.mark.parametrize(
    ("label", "value", "remaining"),
    [("Covariance", False, []), (PLACE, False, ["discs"]), (TURN, False, ["place"])],
)
def test_position_and_orientation_can_be_hidden(label: str, value: bool, remaining: list[str]) -> None:
    assert sorted(drawn_poses(np.eye(6), values={label: value})) == remaining


@pytest.mark.parametrize(
    ("label", "part"), [(f"{PLACE}/Scale", "place"), (f"{TURN}/Scale", "discs"), (f"{TURN}/Offset", "discs")]
)
def test_scales_and_offset_enlarge_the_covariance(label: str, part: str) -> None:
    covariance = np.eye(6) * SMALL
    one, two = (drawn_poses(covariance, values={label: value})[part][0] for value in (1.0, 2.0))
    np.testing.assert_allclose(two[:, :2], 2 * one[:, :2], rtol=1e-3, atol=1e-9)


def test_covariance_colors_are_uniform_or_one_per_axis() -> None:
    holder = Holder()
    shown = [uncertain_pose(PoseWithCovariance(covariance=np.eye(6).ravel()), np.eye(4))]
    holder[f"{PLACE}/Color"], holder[f"{PLACE}/Alpha"] = (255, 0, 0), 0.25
    parts: Any = draw_covariances(shown, holder)
    assert parts["place"].colors.tolist() == [1, 0, 0, 0.25]
    np.testing.assert_allclose(parts["discs"].colors, [[1, 1, 127 / 255, 0.5]] * 3, atol=1e-6)
    holder[f"{TURN}/Color Style"] = "RGB"
    parts = draw_covariances(shown, holder)
    assert parts["discs"].colors[:, :3].tolist() == np.eye(3).tolist()
