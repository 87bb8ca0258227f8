import io
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pictures
from sensor_msgs.msg import CompressedImage, Image

from course_lib.displays.images import (
    Range,
    UnsupportedEncodingError,
    decode_compressed,
    downsample,
    rgb_of,
)

COLORS = np.random.default_rng(1).integers(0, 256, (4, 6, 3), np.uint8)


def image(values: Any, encoding: str, padding: int = 0, big: bool = False) -> Image:
    rows = np.asarray(values)
    flat = rows.reshape(len(rows), -1).astype(rows.dtype.newbyteorder(">" if big else "<"))
    data = np.hstack([flat.view(np.uint8), np.zeros((len(rows), padding), np.uint8)])
    message = Image(height=rows.shape[0], width=rows.shape[1], encoding=encoding, data=data.tobytes())
    message.step, message.is_bigendian = data.shape[1], int(big)
    return message


def whole(values: Any) -> tuple[float, float]:
    return float(np.nanmin(values)), float(np.nanmax(values))


@pytest.mark.parametrize(
    ("encoding", "order"),
    [("rgb8", [0, 1, 2]), ("bgr8", [2, 1, 0]), ("8UC3", [2, 1, 0]), ("rgba8", [0, 1, 2, 0]),
     ("bgra8", [2, 1, 0, 0]), ("8UC4", [2, 1, 0, 0])],
)  # fmt: skip
@pytest.mark.parametrize("padding", [0, 5])
def test_color_channels_are_read_in_encoding_order(encoding: str, order: list[int], padding: int) -> None:
    np.testing.assert_array_equal(rgb_of(image(COLORS[..., order], encoding, padding), whole), COLORS)


@pytest.mark.parametrize("encoding", ["mono8", "8UC1", "bayer_rggb8"])
def test_single_byte_pixels_are_gray(encoding: str) -> None:
    np.testing.assert_array_equal(rgb_of(image(COLORS[..., :1], encoding), whole), COLORS[..., [0, 0, 0]])


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize(("encoding", "kind"), [("16UC1", "u2"), ("mono16", "u2"), ("32FC1", "f4")])
def test_value_range_maps_from_black_to_white(encoding: str, kind: str, big: bool) -> None:
    values = np.array([[100, 200], [300, 500]], kind)[..., None]
    pixels = rgb_of(image(values, encoding, big=big), whole)
    assert pixels[..., 0].tolist() == [[0, 63], [127, 255]]
    flat = rgb_of(image(np.full((2, 2, 1), 7, kind), encoding), whole)
    assert not flat.any()


def test_unknown_depths_are_black() -> None:
    depths = np.array([[np.nan, 1.0, 3.0, np.inf]], np.float32)[..., None]
    pixels = rgb_of(image(depths, "32FC1"), lambda values: Range().add(values, 5))
    assert pixels[0, :, 0].tolist() == [0, 0, 255, 255]


def test_value_bounds_are_medians_rounded_down() -> None:
    found = Range()
    highs = [found.add(np.array([0.0, high]), 3)[1] for high in (2.5, 90.0, 3.9)]
    assert highs == [2.0, 90.0, 3.0]
    assert Range().add(np.array([0.0, 2.5]), 1) == (0.0, 2.5)


@pytest.mark.parametrize(("encoding", "order"), [("uyvy", "UYVY"), ("yuyv", "YUYV"), ("yuv422_yuy2", "YUYV")])
def test_pixel_pairs_share_their_color(encoding: str, order: str) -> None:
    # a grey pair, and red after RViz's formula: R = Y + 1.403 V'
    pairs = [((50, 200), {"U": 128, "V": 128}), ((76, 76), {"U": 85, "V": 255})]
    data = []
    for bright, tint in pairs:
        rest = iter(bright)
        data += [next(rest) if part == "Y" else tint[part] for part in order]
    message = Image(height=1, width=4, encoding=encoding, step=8, data=bytes(data))
    pixels = rgb_of(message, whole)[0]
    assert pixels[:2].tolist() == [[50] * 3, [200] * 3]
    assert pixels[2].tolist() == pixels[3].tolist() == [254, 0, 0]


def test_unknown_encoding_is_reported_with_rviz_text() -> None:
    with pytest.raises(UnsupportedEncodingError, match=r"^Unsupported image encoding \[hsv9\]$"):
        rgb_of(image(COLORS, "hsv9"), whole)


@pytest.mark.parametrize("change", [{"width": 7}, {"height": 9}, {"step": 3}, {"width": 0}])
def test_truncated_data_are_an_error(change: dict[str, int]) -> None:
    message = image(COLORS, "rgb8")
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(ValueError, match="the image has 72 bytes"):
        rgb_of(message, whole)


def test_compressed_images_are_read() -> None:
    packed = io.BytesIO()
    Pictures.fromarray(COLORS).save(packed, "png")
    message = CompressedImage(format="rgb8; png compressed bgr8", data=packed.getvalue())
    np.testing.assert_array_equal(decode_compressed(message, whole), COLORS)
    deep = io.BytesIO()
    Pictures.fromarray(np.array([[1000, 3000]], np.uint16)).save(deep, "png")
    assert decode_compressed(CompressedImage(data=deep.getvalue()), whole)[0, :, 0].tolist() == [0, 255]
    with pytest.raises(ValueError, match="not an image of format 'jpeg'"):
        decode_compressed(CompressedImage(format="jpeg", data=b"nothing"), whole)


def test_compressed_image_that_is_too_large_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Pictures, "MAX_IMAGE_PIXELS", 10)
    data = io.BytesIO()
    Pictures.new("L", (30, 1)).save(data, "png")
    with pytest.raises(ValueError, match="the image is too large: Image size"):
        decode_compressed(CompressedImage(format="png", data=data.getvalue()), whole)


def test_high_image_is_scaled_down_too() -> None:
    assert downsample(np.zeros((40_000, 1, 3), np.uint8), 100).shape[0] <= 400


def test_image_is_scaled_down_to_the_requested_width() -> None:
    assert downsample(np.zeros((480, 640, 3), np.uint8), 640).shape == (480, 640, 3)
    assert downsample(np.zeros((480, 641, 3), np.uint8), 640).shape == (240, 321, 3)


@pytest.mark.parametrize("encoding", ["yuv422", "yuyv"])
def test_image_too_narrow_for_shared_colors_is_an_error(encoding: str) -> None:
    with pytest.raises(ValueError, match="one pixel wide"):
        rgb_of(Image(width=1, height=1, step=2, encoding=encoding, data=bytes(2)), whole)
