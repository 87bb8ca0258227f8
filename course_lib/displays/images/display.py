"""The Image display, and what the Camera display shares with it."""

from collections import deque
from collections.abc import Callable, Mapping
from io import BytesIO
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from course_lib.arrays import AnyArray, Bytes, Pixels
from course_lib.displays.display import Interest
from course_lib.displays.properties import Property, flag, integer, number
from course_lib.displays.topic_display import TopicDisplay
from course_lib.viewer.drawables import Inset

Limits: TypeAlias = Callable[[AnyArray], tuple[float, float]]


class UnsupportedEncodingError(ValueError):
    """RViz cannot show an image; with its words."""


class Encoding(NamedTuple):
    """The layout of the numbers of a pixel."""

    dtype: str
    channels: tuple[int, ...]  # which of the numbers are red, green and blue
    size: int = 3  # numbers per pixel
    ranged: bool = False  # whether black and white are at values that have to be found


_GREY, _RGB, _BGR = (0, 0, 0), (0, 1, 2), (2, 1, 0)
_WIDE = Encoding("u2", _GREY, 1, ranged=True)
_ENCODINGS: Mapping[str, Encoding] = {
    "rgb8": Encoding("u1", _RGB),
    "rgba8": Encoding("u1", _RGB, 4),
    **dict.fromkeys(("bgr8", "8UC3", "8SC3"), Encoding("u1", _BGR)),
    **dict.fromkeys(("bgra8", "8UC4", "8SC4"), Encoding("u1", _BGR, 4)),
    **dict.fromkeys(("mono8", "8UC1", "8SC1"), Encoding("u1", _GREY, 1)),
    **dict.fromkeys(("mono16", "16UC1", "16SC1"), _WIDE),  # signed ones too are read without a sign
    "32FC1": Encoding("f4", _GREY, 1, ranged=True),
}
# Of two pixels in four bytes: where their brightness is, and U and V.
_YUV: Mapping[str, tuple[tuple[int, int], int, int]] = {
    **dict.fromkeys(("uyvy", "yuv422"), ((1, 3), 0, 2)),
    **dict.fromkeys(("yuyv", "yuv422_yuy2"), ((0, 2), 1, 3)),
}


class Range:
    """The values of black and white: medians over the last images."""

    def __init__(self) -> None:
        self._lows: deque[float] = deque()
        self._highs: deque[float] = deque()

    def found(self, values: AnyArray, window: int) -> tuple[float, float]:
        """Return the medians over as many images, with the values of one more."""
        known = values[np.isfinite(values)]
        low, high = float(known.min(initial=65535)), float(known.max(initial=0))  # RViz's search begins there
        if window < 2:
            return low, high
        return _median(self._lows, low, window), _median(self._highs, high, window)


def rgb_of(message: Any, limits: Limits) -> Pixels:
    """Return the pixels of a sensor_msgs/msg/Image.

    Args:
        message: The image.
        limits: Says which values are black and white, for encodings that need it.

    Raises:
        UnsupportedEncodingError: If RViz does not know the encoding.
        ValueError: If there is not as much data as width, height and step say.
    """
    encoding = message.encoding
    if encoding in _YUV:
        return _from_yuv(rows_of(message, "u1", 2), *_YUV[encoding])
    kind = _ENCODINGS["mono8"] if encoding.startswith("bayer") else _ENCODINGS.get(encoding)
    if kind is None:
        raise UnsupportedEncodingError(f"Unsupported image encoding [{encoding}]")
    values = rows_of(message, kind.dtype, kind.size)
    pixels: Pixels = (_ranged(values, limits) if kind.ranged else values)[..., kind.channels]
    return pixels


def unpacked(message: Any, limits: Limits) -> Pixels:
    """Return the pixels of a sensor_msgs/msg/CompressedImage, PNG or JPEG; see `rgb_of`.

    Raises:
        ValueError: If it is not a picture.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(BytesIO(bytes(message.data))) as picture:
            if picture.mode.startswith("I"):  # 16 bits
                return _ranged(np.asarray(picture)[..., None], limits)[..., _GREY]
            return np.asarray(picture.convert("RGB"))
    except (UnidentifiedImageError, OSError) as error:
        raise ValueError(f"the data is not a picture of format {message.format!r}: {error}") from error


def reduced(pixels: Pixels, columns: int) -> Pixels:
    """Return a picture with about as many columns at most: every second pixel, every third ..."""
    step = -(-pixels.shape[1] // columns)
    return pixels[::step, ::step]


def zoomed(pixels: Pixels, zoom: float) -> Pixels:
    """Return a picture magnified around its middle; what is outside of it is black."""
    if zoom == 1:
        return pixels
    places = [((np.arange(n) + 0.5 - n / 2) / zoom + n / 2) for n in pixels.shape[:2]]
    row, column = (np.floor(place).astype(int) for place in places)
    inside = [(index >= 0) & (index < n) for index, n in zip((row, column), pixels.shape[:2], strict=True)]
    picked = pixels[row.clip(0, len(pixels) - 1)][:, column.clip(0, pixels.shape[1] - 1)]
    shown: Pixels = picked * (inside[0][:, None] & inside[1])[..., None].astype(np.uint8)
    return shown


def _ranged(values: AnyArray, limits: Limits) -> Bytes:
    """Return values as bytes from black to white; all black if these are the same."""
    low, high = limits(values)
    if not high > low:
        return np.zeros(values.shape, np.uint8)
    share = np.nan_to_num((values.astype(np.float32) - low) / (high - low), nan=0.0)
    grey: Bytes = (share.clip(0, 1) * 255).astype(np.uint8)
    return grey


def rows_of(message: Any, kind: str, count: int) -> AnyArray:
    """Return the numbers of each pixel, shape (height, width, count); a row may be longer than its pixels."""
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    height, width = message.height, message.width
    used = width * count * dtype.itemsize
    step = message.step or used
    if not height or not width or step < used or len(message.data) < step * (height - 1) + used:
        raise ValueError(
            f"the image has {len(message.data)} bytes; {width} x {height} pixels of {message.encoding} "
            f"with step {message.step} take {max(step, used) * height}."
        )
    strides = (step, count * dtype.itemsize, dtype.itemsize)
    return np.ndarray((height, width, count), dtype, memoryview(message.data), 0, strides)


def _from_yuv(pairs: Pixels, bright: tuple[int, int], u_at: int, v_at: int) -> Pixels:
    """Return RGB of pixels that share their colour in pairs, by RViz's whole numbers."""
    height, width = pairs.shape[:2]
    four = pairs[:, : width // 2 * 2].reshape(height, -1, 4).astype(np.int32)
    y = four[..., bright]
    u, v = four[..., u_at, None] - 128, four[..., v_at, None] - 128
    parts = [1403 * v, 344 * u - 714 * v, 1770 * u]
    rgb = np.stack([y + np.trunc(part / 1000).astype(np.int32) for part in parts], axis=-1)
    pixels: Pixels = rgb.clip(0, 255).astype(np.uint8).reshape(height, -1, 3)
    return pixels


def _median(values: deque[float], new: float, window: int) -> float:
    """Return the median of the last values, the upper of two in the middle; RViz drops its fraction."""
    while len(values) > window - 1:
        values.pop()
    values.appendleft(new)
    return float(int(sorted(values)[len(values) // 2]))


IMAGE, PACKED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
_COLUMNS = 480  # [px] that a page gets of a picture at most: more than its place in the view has


def info_topic(image_topic: str) -> str:
    """Return the topic on which the camera of an image is described: beside it."""
    return f"/{image_topic.removeprefix('/')}".rpartition("/")[0] + "/camera_info"


class PictureDisplay(TopicDisplay):
    """A display of images in the view's corner: raw, or compressed if the topic's name ends so."""

    type_name = IMAGE

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.message: Any = None  # the last one
        self._stale = False
        self._range = Range()

    def changed(self, label: str) -> None:
        """Redraw in the next frame."""
        super().changed(label)
        self.redraw()

    def redraw(self) -> None:
        """Redraw in the next frame."""
        self._stale = True

    def reset(self) -> None:
        """Forget the image."""
        super().reset()
        self.message, self._range = None, Range()

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to the topic; its last part is the way of compression."""
        packed = self["Topic"].rpartition("/")[2] == "compressed"
        return (self.interest(self["Topic"], PACKED if packed else IMAGE, self.take),)

    def process(self, message: Any) -> None:
        """Keep an image for the next frame; of several that come before, RViz shows the last."""
        self.message, self._stale = message, True

    def update(self) -> None:
        """Show the image that has come last."""
        super().update()
        message, stale, self._stale = self.message, self._stale, False
        if not stale or message is None or not len(message.data):
            return
        self.statuses.delete("Image")
        try:
            packed = hasattr(message, "format")
            pixels = unpacked(message, self.limits) if packed else rgb_of(message, self.limits)
        except UnsupportedEncodingError as error:
            self.statuses.set("error", "Image", str(error))
        except ValueError as error:
            self.statuses.hint("Image", f"RViz's log: Error loading image: {error}")
        else:
            self.show(reduced(pixels, _COLUMNS))

    def show(self, pixels: Pixels) -> None:
        """Show a picture."""
        self.context.scene.set_object(f"{self.path}/picture", Inset(pixels))

    def limits(self, values: AnyArray) -> tuple[float, float]:
        """Return the values of black and white: the least and the greatest of the last five images."""
        return self._range.found(values, 5)


class ImageDisplay(PictureDisplay):
    """Images as they are."""

    class_name = "rviz_default_plugins/Image"
    properties = (
        *PictureDisplay.properties,
        Property("Normalize Range", True, flag),
        Property("Min Value", 0.0, number()),
        Property("Max Value", 1.0, number()),
        Property("Median window", 5, integer(1)),
    )

    def limits(self, values: AnyArray) -> tuple[float, float]:
        """Return the values of black and white: the properties, which RViz rounds down, or those found."""
        if self["Normalize Range"]:
            return self._range.found(values, self["Median window"])
        return float(int(self["Min Value"])), float(int(self["Max Value"]))
