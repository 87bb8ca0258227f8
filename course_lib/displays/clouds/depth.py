"""Depth images as points, as RViz's MultiLayerDepth makes them."""

from io import BytesIO
from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.displays.clouds.cloud import Channel
from course_lib.displays.images.pixels import Pixels, rgb_of, rows_of, unpacked
from course_lib.viewer.arrays import Floats

_SHADOW = 0.01  # [m] that a point must be behind another one to be hidden by it
_WHOLE = ("16UC1", "mono16", "16SC1")  # in [mm], 0 is unknown; 32FC1 is in [m], unknown if not finite
_HEADER = 12  # bytes before the picture of a compressedDepth image


class DepthError(ValueError):
    """RViz cannot make points of images; with its words."""


def depths(message: Any) -> Floats:
    """Return the depths of an image in [m], NaN where unknown, shape (rows, columns).

    Raises:
        DepthError: If the image has no depths.
    """
    values = _packed(message) if hasattr(message, "format") else _raw(message)
    if values.dtype.kind == "f":
        return np.where(np.isfinite(values), values, np.nan).astype(np.float32)
    return np.where(values == 0, np.nan, values * np.float32(0.001)).astype(np.float32)


def colors(message: Any, shape: tuple[int, ...]) -> Pixels:
    """Return the RGB of an image that goes with depths of some shape.

    Raises:
        DepthError: If it does not.
    """
    if not hasattr(message, "format") and not {"rgb", "bgr"} & {message.encoding[:3]}:
        raise DepthError("Encoded type not supported!")
    pixels = unpacked(message, _whole) if hasattr(message, "format") else rgb_of(message, _whole)
    (rows, columns), (height, width) = shape, pixels.shape[:2]
    if (rows, columns) != (height, width):
        sizes = f"({columns}x{rows}) does not match color image resolution ({width}x{height})"
        raise DepthError(f"Depth image resolution {sizes}")
    return pixels


def projected(depth: Floats, info: Any) -> Floats:
    """Return the points of an image of depths, shape (rows, columns, 3), z ahead, x right, y down, [m].

    Raises:
        DepthError: If the sensor_msgs/msg/CameraInfo describes an image of another size.
    """
    (rows, columns), roi = depth.shape, info.roi
    bins = max(info.binning_x, 1), max(info.binning_y, 1)
    width, height = (roi.width or info.width) // bins[0], (roi.height or info.height) // bins[1]
    if (columns, rows) != (width, height):
        sizes = f"{columns} x {rows} vs {width} x {height}(binning: {bins[0]} x {bins[1]}"
        roi_size = f"ROI size: {roi.width or info.width} x {roi.height or info.height})"
        raise DepthError(f"Depth image size and camera info don't match: {sizes}, {roi_size}")
    with np.errstate(divide="ignore", invalid="ignore"):
        x = (np.arange(columns) - (info.p[2] - roi.x_offset) / bins[0]) / (info.p[0] / bins[0])
        y = (np.arange(rows) - (info.p[6] - roi.y_offset) / bins[1]) / (info.p[5] / bins[1])
        return np.stack([x * depth, y[:, None] * depth, depth], axis=-1).astype(np.float32)


def channels_of(points: Floats, rgb: Pixels) -> dict[str, Channel]:
    """Return points and their colours, shape (..., 3), without those that are nowhere."""
    known = np.isfinite(points).all(axis=-1)
    parts = rgb[known].astype(np.uint32)
    packed = parts[:, 0] << 16 | parts[:, 1] << 8 | parts[:, 2]
    return dict(zip("xyz", points[known].T, strict=True)) | {"rgb": packed.view(np.float32)}


class Shadows:
    """What was seen of a scene before something came between; one point for each pixel.

    Args:
        shape: Rows and columns of the images.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self._points = np.full((*shape, 3), np.nan, np.float32)
        self._rgb = np.zeros((*shape, 3), np.uint8)
        self._seen = np.zeros(shape)  # [s]

    def with_hidden(self, points: Floats, rgb: Pixels, now: float, timeout: float) -> tuple[Floats, Pixels]:
        """Return points and colours of an image, shape (rows, columns, 3), with what is hidden by it.

        Args:
            points: As `projected` returns them.
            rgb: Their colours.
            now: Time in [s].
            timeout: How long hidden points are remembered, [s].
        """
        self._points[self._seen < now - timeout] = np.nan
        depth, before = points[..., 2], self._points[..., 2]
        hides = np.isnan(depth) | (depth < before - np.float32(_SHADOW))
        hidden, hidden_rgb = self._points[hides], self._rgb[hides]
        self._points[~hides], self._rgb[~hides], self._seen[~hides] = points[~hides], rgb[~hides] // 2, now
        return (
            np.concatenate([points.reshape(-1, 3), hidden]),
            np.concatenate([rgb.reshape(-1, 3), hidden_rgb]),
        )


def _whole(values: npt.NDArray[Any]) -> tuple[float, float]:
    return 0.0, 255.0


def _raw(message: Any) -> npt.NDArray[Any]:
    if message.encoding not in (*_WHOLE, "32FC1"):
        raise DepthError("Depth image has invalid format (only 16 bit and float are supported)!")
    return rows_of(message, "u2" if message.encoding in _WHOLE else "f4", 1)[..., 0]


def _packed(message: Any) -> npt.NDArray[Any]:
    """Return the numbers in a PNG; those of compressedDepth may stand for the inverse of a depth."""
    from PIL import Image, UnidentifiedImageError

    data = bytes(message.data)
    is_inverse = message.format.startswith("32FC1")
    try:
        with Image.open(BytesIO(data[_HEADER if "compressedDepth" in message.format else 0 :])) as picture:
            values = np.asarray(picture)
    except (UnidentifiedImageError, OSError) as error:
        raise DepthError(f"the data is no picture of format {message.format!r}: {error}") from error
    if not is_inverse:
        return values
    a, b = np.frombuffer(data, "<f4", 2, 4)
    with np.errstate(divide="ignore"):
        return np.where(values == 0, np.nan, a / (values - b))
