"""image_geometry: pixels, rays and rectified points of cameras."""

import importlib.util
import math
import random
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from image_geometry import PinholeCameraModel, StereoCameraModel
from sensor_msgs.msg import CameraInfo, RegionOfInterest

from course_lib.errors import CourseError

pytestmark = pytest.mark.filterwarnings("ignore:the matrix subclass:PendingDeprecationWarning")  # ROS's own

K = [400.0, 0.0, 320.0, 0.0, 410.0, 240.0, 0.0, 0.0, 1.0]
P = [400.0, 0.0, 320.0, 0.0, 0.0, 410.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]
R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]


def info(**fields: Any) -> CameraInfo:
    message = CameraInfo(**{"k": K, "p": P, "r": R, "width": 640, "height": 480, **fields})
    message.header.frame_id = "camera"
    return message


def camera(**fields: Any) -> PinholeCameraModel:
    model = PinholeCameraModel()
    model.fromCameraInfo(info(**fields))
    return model


def stereo() -> StereoCameraModel:
    """Two cameras 0.1 m apart."""
    model = StereoCameraModel()
    model.fromCameraInfo(info(), info(p=[*P[:3], -40.0, *P[4:]]))
    return model


def distorted(x: float, y: float, d: Sequence[float]) -> tuple[float, float]:
    """Return a point of the plane at depth 1 as the lens shows it: the formulas of OpenCV's manual."""
    k1, k2, p1, p2, k3, k4, k5, k6 = (*d, *[0.0] * (8 - len(d)))
    r2 = x * x + y * y
    scale = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    return (
        x * scale + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * scale + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


@pytest.mark.parametrize("seed", range(10))
def test_ray_through_the_pixel_of_a_point_passes_through_the_point(seed: int) -> None:
    rng = random.Random(seed)
    point = np.array([rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(0.5, 9)])
    model = camera()
    u, v = model.project3dToPixel(point.tolist())
    assert (u, v) == pytest.approx((400 * point[0] / point[2] + 320, 410 * point[1] / point[2] + 240))
    assert model.projectPixelTo3dRay((u, v)) == pytest.approx(point / np.linalg.norm(point))


@pytest.mark.parametrize("count", [0, 4, 5, 8, 12, 14])
@pytest.mark.parametrize("seed", range(5))
def test_rectified_point_is_the_projection_through_a_lens_without_distortion(seed: int, count: int) -> None:
    rng = random.Random(seed)
    d = [rng.uniform(-0.02, 0.02) for _ in range(min(count, 8))]
    x, y = rng.uniform(-0.5, 0.5), rng.uniform(-0.4, 0.4)
    x_seen, y_seen = distorted(x, y, d)
    model = camera(d=d + [0.0] * (count - len(d)))
    seen = (400 * x_seen + 320, 410 * y_seen + 240)
    assert model.rectifyPoint(seen).tolist() == pytest.approx([400 * x + 320, 410 * y + 240], abs=0.01)


def test_point_without_a_rectified_position_is_returned_unchanged() -> None:
    turned_round = [0.0, 0.0, 0.0, 0.0, 0.0, -9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.05]
    assert camera(d=turned_round).rectifyPoint((620, 440)).tolist() == pytest.approx([620, 440])


def test_invalid_number_of_distortion_coefficients_is_rejected() -> None:
    with pytest.raises(ValueError, match=r"d has 3 coefficients; the model has \(4, 5, 8, 12, 14\) or none"):
        camera(d=[0.1, 0.0, 0.0]).rectifyPoint((1, 1))


def test_matrices_follow_binning_and_region_and_full_matrices_are_kept() -> None:
    region = RegionOfInterest(x_offset=20, y_offset=40, width=200, height=100)
    model = camera(binning_x=2, binning_y=4, roi=region)
    assert (model.fx(), model.fy(), model.cx(), model.cy()) == (200, 102.5, 150, 50)
    assert model.intrinsicMatrix().tolist() == [[200, 0, 150], [0, 102.5, 50], [0, 0, 1]]
    assert (model.fullIntrinsicMatrix().A1.tolist(), model.fullProjectionMatrix().A1.tolist()) == (K, P)
    assert (model.raw_roi, model.fullResolution()) == (region, (640, 480))


def test_region_of_zeros_is_the_full_image() -> None:
    model = camera()
    assert (model.raw_roi.width, model.raw_roi.height) == (640, 480)
    assert (model.distortionCoeffs(), model.tfFrame()) == (None, "camera")


def test_lengths_and_pixels_at_a_depth_are_inverse_conversions() -> None:
    model = camera()
    assert (model.getDeltaU(0.5, 2.0), model.getDeltaX(100.0, 2.0)) == (100.0, 0.5)
    assert (model.getDeltaV(0.5, 2.0), model.getDeltaY(102.5, 2.0)) == (102.5, 0.5)
    assert model.getDeltaU(1.0, 0.0) == model.getDeltaV(1.0, 0.0) == math.inf
    assert (model.fovX(), model.fovY()) == pytest.approx((2 * math.atan(0.8), 2 * math.atan(240 / 410)))


def test_point_in_the_camera_plane_has_no_pixel() -> None:
    assert np.isnan(camera().project3dToPixel((1.0, 1.0, 0.0))).all()


def test_stereo_camera_computes_a_point_from_its_pixel_and_disparity() -> None:
    model, point = stereo(), (0.3, -0.2, 2.0)
    (u_left, v_left), (u_right, v_right) = model.project3dToPixel(point)
    assert (u_left - u_right, v_left) == pytest.approx((20.0, v_right))
    assert model.getDisparity(2.0) == pytest.approx(20.0)
    assert model.getZ(20.0) == pytest.approx(2.0)
    x, _, z = model.projectPixelTo3d((u_left, v_left), u_left - u_right)
    assert (x, z) == pytest.approx((0.3, 2.0))


def test_zero_disparity_is_at_infinity() -> None:
    assert stereo().projectPixelTo3d((1.0, 1.0), 0.0) == (0.0, 0.0, 0.0)
    assert stereo().getZ(0.0) == stereo().getDisparity(0.0) == math.inf
    assert stereo().tfFrame() == "camera"


@pytest.mark.skipif(importlib.util.find_spec("cv2") is not None, reason="OpenCV is installed")
def test_rectify_image_without_opencv_reports_the_install_command() -> None:
    image = np.zeros((480, 640), np.uint8)
    with pytest.raises(CourseError, match=r"^rectifyImage needs OpenCV.*pip install opencv-python-headless$"):
        camera().rectifyImage(image, image.copy())
