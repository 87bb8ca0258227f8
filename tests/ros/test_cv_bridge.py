"""The expected colors are results of OpenCV's cvtColor for the same pixels."""

from io import BytesIO
from typing import Any

import numpy as np
import pytest
from cv_bridge import CvBridge, CvBridgeError
from numpy.testing import assert_array_equal
from PIL import Image as Picture
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

BRIDGE = CvBridge()
PIXELS = np.array([[[10, 20, 30], [200, 100, 50]]], np.uint8)
PAIR = np.array([[[90, 100], [240, 180]]], np.uint8)  # U or Y, then Y or V
MOSAIC = np.array([[10, 200, 30, 40], [50, 60, 170, 80], [90, 15, 110, 120], [130, 140, 150, 255]], np.uint8)
DTYPES = ("uint8", "int8", "uint16", "int16", "int32", "float32", "float64")


def converted(pixels: Any, source: str, target: str) -> Any:
    return BRIDGE.imgmsg_to_cv2(BRIDGE.cv2_to_imgmsg(pixels, source), target)


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("dtype", DTYPES)
def test_every_pixel_type_survives_a_round_trip(dtype: str, channels: int) -> None:
    shape = (3, 5) if channels == 1 else (3, 5, channels)
    pixels = np.arange(15 * channels).reshape(shape).astype(dtype)
    message = BRIDGE.cv2_to_imgmsg(pixels, header=Header(frame_id="camera"))
    back = BRIDGE.imgmsg_to_cv2(message)
    assert_array_equal(back, pixels)
    assert back.dtype == pixels.dtype
    assert (message.height, message.width, message.header.frame_id) == (3, 5, "camera")
    assert BRIDGE.encoding_to_dtype_with_channels(message.encoding) == (dtype, channels)


@pytest.mark.parametrize(
    ("pixels", "source", "target", "expected"),
    [
        (PIXELS, "bgr8", "rgb8", [[[30, 20, 10], [50, 100, 200]]]),
        (PIXELS, "rgb8", "rgba8", [[[10, 20, 30, 255], [200, 100, 50, 255]]]),
        (PIXELS, "bgr8", "mono8", [[22, 96]]),
        (PIXELS, "rgb8", "mono8", [[18, 124]]),
        (PIXELS, "bgr8", "mono16", [[22 * 257, 96 * 257]]),
        (PIXELS, "bgr8", "bgr16", (PIXELS.astype(int) * 257).tolist()),
        (PIXELS, "bgr8", "8UC3", PIXELS.tolist()),
        (PIXELS[..., 0], "mono8", "bgr8", [[[10] * 3, [200] * 3]]),
        (np.array([[128, 129, 65535]], np.uint16), "mono16", "mono8", [[0, 1, 255]]),
        (np.array([[1.5, -3.0]], np.float32), "32FC1", "16UC1", [[2, 0]]),
        (PAIR, "yuv422", "mono8", [[100, 180]]),
        (PAIR, "yuv422", "rgb8", [[[255, 22, 21], [255, 115, 114]]]),
        (PAIR, "yuv422_yuy2", "rgb8", [[[169, 55, 30], [255, 229, 204]]]),
    ],
)
def test_colors_are_converted_as_in_opencv(pixels: Any, source: str, target: str, expected: Any) -> None:
    assert converted(pixels, source, target).tolist() == expected


def test_bayer_images_are_converted_as_in_opencv() -> None:
    assert converted(MOSAIC, "bayer_rggb8", "rgb8")[1].tolist() == [
        [60, 109, 60],
        [60, 109, 60],
        [70, 170, 70],
        [70, 170, 70],
    ]
    assert converted(MOSAIC, "bayer_rggb8", "mono8")[1:3].tolist() == [[89, 89, 129, 129], [50, 50, 115, 115]]


def test_padded_rows_and_big_endian_pixels_are_read() -> None:
    rows = np.array([[1, 258, 9], [3, 4, 9]], ">u2")
    message = Image(height=2, width=2, step=6, encoding="mono16", is_bigendian=1, data=rows.tobytes())
    back = BRIDGE.imgmsg_to_cv2(message)
    assert back.tolist() == [[1, 258], [3, 4]]
    assert back.dtype.isnative
    assert BRIDGE.cv2_to_imgmsg(rows).is_bigendian


@pytest.mark.parametrize(
    ("pixels", "source", "target", "message"),
    [
        (PIXELS, "rgb9", "passthrough", r"Unrecognized image encoding \[rgb9\]"),
        (PIXELS, "mono8", "passthrough", "encoding specified as mono8, but image has incompatible type 8UC3"),
        (PIXELS, "8UC3", "bgr8", r"\[8UC3\] is not a color format. but \[bgr8\] is"),
        (PIXELS, "bgr8", "8UC1", r"\[bgr8\] is a color format but \[8UC1\] is not"),
        (PIXELS, "8UC3", "8UC2", "do not have the same number of channel"),
        (PIXELS, "bgr8", "yuv422", r"Unsupported conversion from \[bgr8\] to \[yuv422\]"),
        (MOSAIC, "bayer_rggb8", "rgba8", "Unsupported conversion"),
    ],
)
def test_unsupported_conversion_raises_the_error_message_of_ros(
    pixels: Any, source: str, target: str, message: str
) -> None:
    with pytest.raises(CvBridgeError, match=message):
        converted(pixels, source, target)


def test_only_arrays_with_opencv_types_become_messages() -> None:
    with pytest.raises(TypeError, match="Your input type is not a numpy array"):
        BRIDGE.cv2_to_imgmsg([[1, 2]])  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="int64"):
        BRIDGE.cv2_to_imgmsg(np.zeros((2, 2), np.int64))


@pytest.mark.parametrize("shape", [(8, 9), (8, 9, 3), (8, 9, 4)])
def test_compressed_images_keep_their_channels(shape: tuple[int, ...]) -> None:
    pixels = np.arange(np.prod(shape)).reshape(shape).astype(np.uint8)
    message = BRIDGE.cv2_to_compressed_imgmsg(pixels, "png")
    assert message.format == "png"
    assert_array_equal(BRIDGE.compressed_imgmsg_to_cv2(message), pixels)


def test_compressed_image_is_bgr_by_default_and_has_another_encoding_on_request() -> None:
    file = BytesIO()
    Picture.new("RGB", (2, 2), (200, 100, 50)).save(file, "PNG")
    message = CompressedImage(format="png", data=file.getvalue())
    assert BRIDGE.compressed_imgmsg_to_cv2(message)[0, 0].tolist() == [50, 100, 200]
    assert BRIDGE.compressed_imgmsg_to_cv2(message, "rgb8")[0, 0].tolist() == [200, 100, 50]


def test_invalid_compressed_image_and_unknown_format_are_errors() -> None:
    with pytest.raises(CvBridgeError, match="cannot be read"):
        BRIDGE.compressed_imgmsg_to_cv2(CompressedImage(data=b"no picture"))
    with pytest.raises(CvBridgeError, match=r"extension \.gif7"):
        BRIDGE.cv2_to_compressed_imgmsg(PIXELS, "gif7")
