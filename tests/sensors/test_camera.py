import io
from typing import Any, Literal

import numpy as np
import pytest
from PIL import Image as Pictures
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from course_lib.errors import CourseError
from course_lib.sensors import sensor_nodes
from course_lib.sensors.sensor_nodes import CameraNode, Pinhole
from course_lib.sensors.world import Thing, World, box, placed
from tests.sensors.scenes import TRANSFORM_OPTICAL_TO_WORLD, published

SMALL = Pinhole(40, 30, 40.0)
# Red is to the left (+y) and up, green to the right and down.
WORLD = World([
    Thing(box(1, 1, 1), placed(5, 1, 0.8), (1, 0, 0)),
    Thing(box(1, 1, 1), placed(5, -1, -0.8), (0, 1, 0)),
])  # fmt: skip


def capture(message: type, **settings: Any) -> Any:
    node = lambda: CameraNode(WORLD, TRANSFORM_OPTICAL_TO_WORLD, pinhole=SMALL, **settings)  # noqa: E731  # one use
    return published(node, message)[0]


def pixels(image: Any) -> Any:
    return np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)


def test_objects_to_the_left_and_above_appear_left_and_up_in_the_image() -> None:
    image = capture(Image)
    assert (image.encoding, image.step, len(image.data)) == ("rgb8", 120, 3600)
    red, green = ((pixels(image)[..., a] > 50) & (pixels(image)[..., b] == 0) for a, b in ((0, 1), (1, 0)))
    (red_v, red_u), (green_v, green_u) = np.nonzero(red), np.nonzero(green)
    assert red_u.max() < 20 < green_u.min()
    assert red_v.max() < 15 < green_v.min()


def test_surfaces_facing_the_camera_are_bright_and_the_sky_is_uniform() -> None:
    picture = pixels(capture(Image))
    v, u = np.rint(SMALL.matrix[:2] @ (-1 / 4.5, -0.8 / 4.5, 1))[::-1].astype(int)
    assert picture[v, u, 0] > 200
    assert picture[-1, 0].tolist() == [153, 191, 230]


@pytest.mark.parametrize(("kind", "error"), [("png", 0), ("jpeg", 40)])
def test_compressed_images_agree_with_raw_images(kind: Literal["png", "jpeg"], error: float) -> None:
    message = capture(CompressedImage, compressed=kind)
    assert message.format == f"rgb8; {kind} compressed bgr8"
    unpacked = np.asarray(Pictures.open(io.BytesIO(bytes(message.data))), int)
    assert np.abs(unpacked - pixels(capture(Image))).mean() <= error


def test_no_compressed_images_are_published_without_compression() -> None:
    with pytest.raises(IndexError):
        capture(CompressedImage, compressed=None)


def test_camera_info_has_the_stamp_and_frame_of_the_image() -> None:
    assert capture(CameraInfo).header == capture(Image).header
    assert capture(CameraInfo).header.frame_id == "camera_optical_frame"


def test_noise_changes_colors_and_dropouts_are_black() -> None:
    clean, noisy = pixels(capture(Image)), pixels(capture(Image, noise=5.0))
    assert 2 < np.abs(clean.astype(int) - noisy).mean() < 8
    assert (pixels(capture(Image, dropout=1.0)) == 0).all()


@pytest.mark.parametrize("rows", [1, 7, 32])
def test_image_shaded_in_parts_has_the_same_lighting(rows: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rays, distance = Pinhole(9, 65, 40.0).rays, np.random.default_rng(0).uniform(1.0, 3.0, 9 * 65)
    distance[::11] = np.inf
    monkeypatch.setattr(sensor_nodes, "_ROWS", 65)
    whole = sensor_nodes.shade(rays, distance, 9)
    monkeypatch.setattr(sensor_nodes, "_ROWS", rows)
    assert (sensor_nodes.shade(rays, distance, 9) == whole).all()


def test_unknown_compression_is_reported() -> None:
    with pytest.raises(CourseError, match="compressed is 'gif'; expected 'png', 'jpeg' or None"):
        capture(Image, compressed="gif")
