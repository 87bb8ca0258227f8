from io import BytesIO
from typing import Any

import numpy as np
import pytest
from PIL import Image as Picture
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from course_lib.displays.clouds import DepthError, Shadows, colors, depths, project_depths
from course_lib.displays.clouds import _depth_channels as channels_of

METRES = np.array([[1.0, 2.0, np.nan], [4.0, np.nan, 0.5]], np.float32)
MILLIMETRES = np.array([[1000, 2000, 0], [4000, 0, 500]], np.uint16)
WHITE = np.full((2, 3, 3), 255, np.uint8)


def image(values: np.ndarray, encoding: str) -> Image:
    height, width = values.shape[:2]
    step = values.nbytes // height
    return Image(height=height, width=width, encoding=encoding, step=step, data=values.tobytes())


def info(width: int = 3, height: int = 2, **fields: Any) -> CameraInfo:
    message = CameraInfo(width=width, height=height, **fields)
    message.p = np.array([2.0, 0, 1.0, 0, 0, 4.0, 0.5, 0, 0, 0, 1.0, 0])
    return message


def packed(values: np.ndarray, form: str, before: bytes = b"") -> CompressedImage:
    png = BytesIO()
    Picture.fromarray(values).save(png, "png")
    return CompressedImage(format=form, data=before + png.getvalue())


@pytest.mark.parametrize(
    "message",
    [
        image(METRES, "32FC1"),
        image(np.where(np.isnan(METRES), np.inf, METRES).astype(np.float32), "32FC1"),
        image(MILLIMETRES, "16UC1"),
        image(MILLIMETRES, "mono16"),
        packed(MILLIMETRES, "16UC1; png compressed"),
        packed(MILLIMETRES, "16UC1; compressedDepth png", bytes(12)),
    ],
)
def test_depths_are_in_meters_and_unknown_depths_are_nan(message: Any) -> None:
    np.testing.assert_allclose(depths(message), METRES)


def test_packed_depths_can_be_inverse() -> None:
    a, b = 1000.0, 3.0  # as compressed_depth_image_transport: value = a / depth + b
    values = np.nan_to_num(np.rint(a / METRES + b)).astype(np.uint16)
    header = bytes(4) + np.array([a, b], "<f4").tobytes()
    np.testing.assert_allclose(depths(packed(values, "32FC1; compressedDepth png", header)), METRES)


@pytest.mark.parametrize("wrong", [image(WHITE, "rgb8"), CompressedImage(format="png", data=b"nothing")])
def test_images_without_depths_are_rejected(wrong: Any) -> None:
    with pytest.raises(DepthError, match=r"invalid format|not an image of format"):
        depths(wrong)


def test_compressed_depths_that_are_too_large_are_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Picture, "MAX_IMAGE_PIXELS", 2)
    with pytest.raises(DepthError, match="exceeds limit of 4 pixels"):
        depths(packed(MILLIMETRES, "16UC1; png compressed"))


def test_depth_points_project_to_their_pixels() -> None:
    points = project_depths(METRES, info())
    np.testing.assert_allclose(points[0, 0], [(0 - 1) / 2 * 1.0, (0 - 0.5) / 4 * 1.0, 1.0])
    np.testing.assert_allclose(points[1, 2], [(2 - 1) / 2 * 0.5, (1 - 0.5) / 4 * 0.5, 0.5])
    assert np.isnan(points[0, 2]).all()


def test_binned_region_gives_the_same_points_as_the_full_image() -> None:
    whole = project_depths(np.ones((8, 12), np.float32), info(12, 8))
    part = info(12, 8, binning_x=2, binning_y=2)
    part.roi.x_offset, part.roi.y_offset, part.roi.width, part.roi.height = 4, 2, 6, 4
    seen = project_depths(np.ones((2, 3), np.float32), part)
    np.testing.assert_allclose(seen, whole[2:6:2, 4:10:2], atol=1e-6)


def test_camera_info_of_another_size_is_rejected_with_rviz_text() -> None:
    words = (
        r"Depth image size and camera info don't match: 3 x 2 vs 6 x 8"
        r"\(binning: 2 x 1, ROI size: 12 x 8\)"
    )
    with pytest.raises(DepthError, match=words):
        project_depths(METRES, info(12, 8, binning_x=2))


def test_color_image_must_have_colors_and_an_equal_size() -> None:
    assert (colors(image(WHITE, "rgb8"), (2, 3)) == WHITE).all()
    with pytest.raises(DepthError, match="Encoded type not supported!"):
        colors(image(WHITE[..., 0], "mono8"), (2, 3))
    with pytest.raises(DepthError, match=r"resolution \(4x2\) does not match color image resolution \(3x2\)"):
        colors(image(WHITE, "bgr8"), (2, 4))


def test_invalid_points_are_omitted_and_colors_are_packed() -> None:
    rgb = np.zeros((2, 3, 3), np.uint8)
    rgb[1, 2] = 1, 2, 3
    found = channels_of(project_depths(METRES, info()), rgb)
    assert found["z"].tolist() == [1, 2, 4, 0.5]
    assert found["rgb"].view(np.uint32).tolist() == [0, 0, 0, 0x010203]


def test_occluded_points_are_kept_until_the_timeout_with_half_their_color() -> None:
    shadows = Shadows((2, 3))
    far, near = project_depths(np.full((2, 3), 4.0, np.float32), info()), project_depths(METRES, info())
    points, rgb = shadows.with_hidden(far, WHITE, now=0.0, timeout=10.0)
    assert len(points) == 6
    points, rgb = shadows.with_hidden(near, WHITE, now=9.0, timeout=10.0)
    assert sorted(points[6:, 2]) == [4.0] * 5  # one of the near points is as far as before
    assert rgb[6:].tolist() == [[127] * 3] * 5
    points, _ = shadows.with_hidden(near, WHITE, now=11.0, timeout=10.0)
    assert np.isfinite(points[6:]).all(axis=1).sum() == 0
