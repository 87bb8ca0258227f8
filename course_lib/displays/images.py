"""RViz's Image, Camera and CameraInfo displays.

Images are decoded exactly like in RViz, including its fixed-point YUV conversion and its medians of
the black and white levels.
"""

from collections import deque
from collections.abc import Callable, Mapping
from io import BytesIO
from math import atan
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from course_lib.arrays import AnyArray, Bytes, Matrix, Pixels
from course_lib.displays.display import DrawnDisplay, Subscription, TopicDisplay, node_name
from course_lib.displays.properties import Property, booleans, color, flag, integer, number, words
from course_lib.displays.shapes import rgba_of
from course_lib.displays.statuses import Level
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.drawables import Camera, Drawable, Inset, Lines, Mesh

Limits: TypeAlias = Callable[[AnyArray], tuple[float, float]]


class UnsupportedEncodingError(ValueError):
    """Raised for an encoding that RViz cannot show, with RViz's message."""


class Encoding(NamedTuple):
    """The channel order and data type of a pixel."""

    dtype: str
    # Indices of red, green and blue.
    channels: tuple[int, ...]
    # Numbers per pixel.
    size: int = 3
    # Whether the values of black and white must be determined.
    has_range: bool = False


_GREY, _RGB, _BGR = (0, 0, 0), (0, 1, 2), (2, 1, 0)
_WIDE = Encoding("u2", _GREY, 1, has_range=True)
_ENCODINGS: Mapping[str, Encoding] = {
    "rgb8": Encoding("u1", _RGB),
    "rgba8": Encoding("u1", _RGB, 4),
    **dict.fromkeys(("bgr8", "8UC3", "8SC3"), Encoding("u1", _BGR)),
    **dict.fromkeys(("bgra8", "8UC4", "8SC4"), Encoding("u1", _BGR, 4)),
    **dict.fromkeys(("mono8", "8UC1", "8SC1"), Encoding("u1", _GREY, 1)),
    # RViz reads signed values as unsigned ones.
    **dict.fromkeys(("mono16", "16UC1", "16SC1"), _WIDE),
    "32FC1": Encoding("f4", _GREY, 1, has_range=True),
}
# Byte offsets in a group of two pixels: their brightness, U and V.
_YUV: Mapping[str, tuple[tuple[int, int], int, int]] = {
    **dict.fromkeys(("uyvy", "yuv422"), ((1, 3), 0, 2)),
    **dict.fromkeys(("yuyv", "yuv422_yuy2"), ((0, 2), 1, 3)),
}


def row_bytes(encoding: str, width: int) -> int:
    """Return the number of bytes that the pixels of a row have in a supported encoding."""
    if encoding in _ENCODINGS:
        kind = _ENCODINGS[encoding]
        return width * kind.size * np.dtype(kind.dtype).itemsize
    return width * (2 if encoding in _YUV or encoding.endswith("16") else 1)


def is_supported(encoding: str) -> bool:
    """Return whether RViz can draw images with this encoding."""
    return encoding in _ENCODINGS or encoding in _YUV or encoding.startswith("bayer")


class Range:
    """The values of black and white, as medians over the last images."""

    def __init__(self) -> None:
        self._lows: deque[float] = deque()
        self._highs: deque[float] = deque()

    def add(self, values: AnyArray, window: int) -> tuple[float, float]:
        """Add the values of one image, and return the medians over the last `window` images."""
        finite_values = values[np.isfinite(values)]
        # RViz's initial values.
        low, high = float(finite_values.min(initial=65535)), float(finite_values.max(initial=0))
        if window < 2:
            return low, high
        medians = []
        for lasts, new in ((self._lows, low), (self._highs, high)):
            while len(lasts) > window - 1:
                lasts.pop()
            lasts.appendleft(new)
            # The upper median, truncated to an integer as in RViz.
            medians.append(float(int(sorted(lasts)[len(lasts) // 2])))
        return medians[0], medians[1]


def rgb_of(message: Any, limits: Limits) -> Pixels:
    """Return the pixels of a sensor_msgs/msg/Image.

    Args:
        message: The image.
        limits: Returns the values of black and white, for encodings that need them.

    Raises:
        UnsupportedEncodingError: RViz does not support the encoding.
        ValueError: The amount of data does not match width, height and step.
    """
    encoding = message.encoding
    if encoding in _YUV:
        # Pixels share chrominance in pairs. RViz converts them with integers.
        pairs, (bright, u_at, v_at) = rows_of(message, "u1", 2), _YUV[encoding]
        height, width = pairs.shape[:2]
        if width < 2:
            raise ValueError("the image is one pixel wide; its encoding shares colors between two pixels.")
        four = pairs[:, : width // 2 * 2].reshape(height, -1, 4).astype(np.int32)
        y = four[..., bright]
        u, v = four[..., u_at, None] - 128, four[..., v_at, None] - 128
        parts = [1403 * v, 344 * u - 714 * v, 1770 * u]
        rgb = np.stack([y + np.trunc(part / 1000).astype(np.int32) for part in parts], axis=-1)
        converted: Pixels = rgb.clip(0, 255).astype(np.uint8).reshape(height, -1, 3)
        return converted
    if not is_supported(encoding):
        raise UnsupportedEncodingError(f"Unsupported image encoding [{encoding}]")
    kind = _ENCODINGS["mono8" if encoding.startswith("bayer") else encoding]
    values = rows_of(message, kind.dtype, kind.size)
    pixels: Pixels = _scale_to_bytes(values, limits) if kind.has_range else values
    return pixels[..., kind.channels]


def decode_compressed(message: Any, limits: Limits, mode: Literal["RGB", "RGBA"] = "RGB") -> Pixels:
    """Return the pixels of a sensor_msgs/msg/CompressedImage, PNG or JPEG; see `rgb_of`.

    With 16 bits per pixel it has no alpha.

    Raises:
        ValueError: It is not an image.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(BytesIO(bytes(message.data))) as picture:
            # The image has 16 bits per pixel.
            if picture.mode.startswith("I"):
                return _scale_to_bytes(np.asarray(picture)[..., None], limits)[..., _GREY]
            return np.asarray(picture.convert(mode))
    except Image.DecompressionBombError as error:
        raise ValueError(f"the image is too large: {error}") from error
    except (UnidentifiedImageError, OSError) as error:
        raise ValueError(f"the data is not an image of format {message.format!r}: {error}") from error


def downsample(pixels: Pixels, columns: int) -> Pixels:
    """Return every n-th pixel, for at most `columns` columns and four times as many rows."""
    step = -(-max(pixels.shape[1], pixels.shape[0] // 4) // columns)
    return pixels[::step, ::step]


def _scale_to_bytes(values: AnyArray, limits: Limits) -> Bytes:
    """Scale values to bytes from black to white; all are black if both limits are equal."""
    low, high = limits(values)
    if not high > low:
        return np.zeros(values.shape, np.uint8)
    share = np.nan_to_num((values.astype(np.float32) - low) / (high - low), nan=0.0)
    grey: Bytes = (share.clip(0, 1) * 255).astype(np.uint8)
    return grey


def rows_of(message: Any, kind: str, count: int) -> AnyArray:
    """Return the values of each pixel, shape (height, width, count). Rows may be padded."""
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    height, width = message.height, message.width
    row_bytes = width * count * dtype.itemsize
    step = message.step or row_bytes
    if not height or not width or step < row_bytes or len(message.data) < step * (height - 1) + row_bytes:
        raise ValueError(
            f"the image has {len(message.data)} bytes; {width} x {height} pixels of "
            f"{message.encoding} with step {message.step} take {max(step, row_bytes) * height}."
        )
    strides = (step, count * dtype.itemsize, dtype.itemsize)
    return np.ndarray((height, width, count), dtype, memoryview(message.data), 0, strides)


IMAGE, PACKED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
# Maximum width of an image sent to a page, more than its size in the view [px].
_COLUMNS = 480


def info_topic(image_topic: str) -> str:
    """Return the CameraInfo topic that belongs to an image topic."""
    return f"/{image_topic.removeprefix('/')}".rpartition("/")[0] + "/camera_info"


class PictureDisplay(TopicDisplay):
    """Base class of raw and compressed images in a corner of the view."""

    type_name = IMAGE

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        # The last image.
        self.message: Any = None
        self._is_stale = False
        self._range = Range()

    def on_property_change(self, label: str) -> None:
        """Redraw in the next frame."""
        super().on_property_change(label)
        self._is_stale = True

    def reset(self) -> None:
        """Discard the image."""
        super().reset()
        self.message, self._range = None, Range()

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Subscribe to the topic, whose last component may be the compression."""
        is_compressed = self["Topic"].rpartition("/")[2] == "compressed"
        return (self.subscription(self["Topic"], PACKED if is_compressed else IMAGE, self.receive),)

    def process(self, message: Any) -> None:
        """Keep an image for the next frame. If several arrive, RViz shows the last one."""
        self.message, self._is_stale = message, True

    def update(self) -> None:
        """Show the last image."""
        super().update()
        message, stale, self._is_stale = self.message, self._is_stale, False
        if not stale or message is None or not len(message.data):
            return
        self.statuses.delete("Image")
        try:
            is_compressed = hasattr(message, "format")
            pixels = (
                decode_compressed(message, self.limits) if is_compressed else rgb_of(message, self.limits)
            )
        except UnsupportedEncodingError as error:
            self.statuses.set("error", "Image", str(error))
        except ValueError as error:
            self.statuses.hint("Image", f"RViz's log: Error loading image: {error}")
        else:
            self.show(downsample(pixels, _COLUMNS), *pixels.shape[:2])

    def show(self, pixels: Pixels, rows: int, columns: int) -> None:
        """Show an image. `rows` and `columns` are its size before downsampling."""
        self.context.scene.set_object(f"{self.path}/picture", Inset(pixels))

    def limits(self, values: AnyArray) -> tuple[float, float]:
        """Return the values of black and white: the minimum and maximum of the last five images."""
        return self._range.add(values, 5)


# Encodings whose values RViz scales to black and white.
_NORMALIZED = ("32FC1", "16UC1", "16SC1", "mono16")


class ImageDisplay(PictureDisplay):
    """Images without a camera pose."""

    class_name = "rviz_default_plugins/Image"
    properties = (
        *PictureDisplay.properties,
        Property("Normalize Range", True, flag),
        Property("Min Value", 0.0, number(), shown_if=(("Normalize Range", False),)),
        Property("Max Value", 1.0, number(), shown_if=(("Normalize Range", False),)),
        Property("Median window", 5, integer(1), shown_if=(("Normalize Range", True),)),
    )

    def has_row(self, prop: Property) -> bool:
        """Return whether the panel has a row: RViz normalizes only depths and other large numbers."""
        is_normalized = getattr(self.message, "encoding", "") in _NORMALIZED
        return super().has_row(prop) and (is_normalized or prop in PictureDisplay.properties)

    def limits(self, values: AnyArray) -> tuple[float, float]:
        """Return the values of black and white: properties, truncated as in RViz, or measured."""
        if self["Normalize Range"]:
            return self._range.add(values, self["Median window"])
        return float(int(self["Min Value"])), float(int(self["Max Value"]))


INFO = "sensor_msgs/msg/CameraInfo"
_BOTH, _BACK, _OVER = "background and overlay", "background", "overlay"
_STATUS = "Camera Info"
_NO_POSITION = "CameraInfo/P resulted in an invalid position calculation (nans or infs)"
# Image corners: x right, y down.
_CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
# The edges of the pyramid; the camera is point 0.
_EDGES = np.array([(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)])
_SIDES = np.array([(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 1, 4)])
# The width of the edges [m].
_WIDTH = 0.01
# RViz accepts a far plane in front of the near plane at 0.01 m, which leaves nothing to draw [m].
_NEAREST_FAR_PLANE = 0.02


class CameraDisplay(PictureDisplay):
    """The scene as a camera sees it, with the camera's image behind it, over it, or both."""

    class_name = "rviz_default_plugins/Camera"
    # RViz's message filter has a fixed length here, without a property.
    queue_length = 10
    properties = (
        *PictureDisplay.properties,
        # The check boxes by display name. A display without an entry is enabled.
        Property("Visibility", {}, booleans),
        Property("Image Rendering", _BOTH, words(_BACK, _OVER, _BOTH)),
        Property("Overlay Alpha", 0.5, number(0.0, 1.0)),
        Property("Zoom Factor", 1.0, number(0.00001, 100000.0)),
        Property("Far Plane Distance", 100.0, number(0.00001, 100000.0)),  # [m]
    )
    # The last CameraInfo.
    _info: Any = None

    @property
    def info_topic(self) -> str:
        """The topic of the camera's CameraInfo."""
        return info_topic(self["Topic"].removesuffix("/compressed"))

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout, in which Visibility also has an entry Value."""
        visibility = config.get("Visibility")
        if isinstance(visibility, Mapping):
            flat = {
                name: on for name, on in visibility.items() if name != "Value" and not isinstance(on, Mapping)
            }
            config = {**config, "Visibility": {"Value": flat}}
        return super().load(config)

    def reset(self) -> None:
        """Discard image and camera info."""
        super().reset()
        self._info = None
        text = f"No CameraInfo received on [{self.info_topic}]. Topic may not exist."
        self.statuses.set("warn", _STATUS, text)

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Subscribe to the images and to the camera info."""
        self.statuses.set("ok", _STATUS, "OK")
        qos = Qos(depth=5, reliability="best_effort")
        info = Subscription(self.info_topic, INFO, qos, self._on_info, self.statuses)
        return (*super().make_subscriptions(), info)

    def show(self, pixels: Pixels, rows: int, columns: int) -> None:
        """Show the scene with an image."""
        level, text = self._info_problem()
        camera = None
        transform = None if text else self.transform_at(self.message.header)
        if transform is not None:
            height, width = self._info.height or rows, self._info.width or columns
            camera = self._camera(transform, width, height)
            level, text = ("ok", "ok") if camera else ("error", _NO_POSITION)
        if text:
            self.statuses.set(level, _STATUS, text)
        if camera is None:
            self.context.scene.delete(f"{self.path}/picture")
            return
        self.statuses.set("ok", "Time", "ok")
        rendering, p = self["Image Rendering"], self._info.p
        over = 0.0 if rendering == _BACK else self["Overlay Alpha"]
        hidden_paths = tuple(
            f"displays/{node_name(name)}" for name, on in self["Visibility"].items() if not on
        )
        # Pixels need not be square.
        aspect = width / height * p[5] / p[0]
        # The part of the picture that the image covers, like a region of interest.
        roi, zoom = self._info.roi, self["Zoom Factor"]
        left, top, wide, high = 0.0, 0.0, 1.0, 1.0
        if roi.width or roi.height:
            left, top, wide, high = (
                roi.x_offset / width, roi.y_offset / height, roi.width / width, roi.height / height
            )  # fmt: skip
        area = 0.5 + zoom * (left - 0.5), 0.5 + zoom * (top - 0.5), zoom * wide, zoom * high
        inset = Inset(pixels, aspect, camera, rendering != _OVER, over, hidden_paths, area)
        self.context.scene.set_object(f"{self.path}/picture", inset)

    def _on_info(self, message: Any) -> None:
        self._info = message
        self._is_stale = True

    def _info_problem(self) -> tuple[Level, str]:
        """Return RViz's status for an invalid CameraInfo; the text is empty if it is valid."""
        info = self._info
        if info is None:
            return "warn", (
                f"Expecting Camera Info on topic [{self.info_topic}]. "
                "No CameraInfo received. Topic may not exist."
            )
        if not all(np.isfinite(numbers).all() for numbers in (info.d, info.k, info.r, info.p)):
            return "error", "Contains invalid floating point values (nans or infs)"
        return "ok", ""

    def _camera(self, transform_optical_to_fixed: Matrix, width: int, height: int) -> Camera | None:
        """Return the camera's view, with z ahead, x right, y down; None if a focal length is invalid."""
        fx, cx, tx = self._info.p[[0, 2, 3]]
        fy, cy, ty = self._info.p[[5, 6, 7]]
        if fx <= 0 or fy <= 0:
            return None
        right, down, forward, place = transform_optical_to_fixed[:3].T
        # For stereo, the position is relative to the left camera.
        eye = place - right * tx / fx + down * ty / fy
        zoom = self["Zoom Factor"]
        return Camera(
            eye=tuple(eye),
            target=tuple(eye + forward),
            up=tuple(-down),
            vertical_fov=2 * atan(height / 2 / fy / zoom),
            shift=((cx - width / 2) / height * fy / fx * zoom, (cy - height / 2) / height * zoom),
            far=max(self["Far Plane Distance"], _NEAREST_FAR_PLANE),
        )


class CameraInfoDisplay(DrawnDisplay):
    """The field of view of a camera as a pyramid whose tip is the camera."""

    class_name = "rviz_default_plugins/CameraInfo"
    type_name = "sensor_msgs/msg/CameraInfo"
    is_in_message_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Far clip", 1.0, number()),  # [m], height of the pyramid
        Property("Show edges", True, flag),
        Property("Show polygons", True, flag),
        # RViz draws side polygons only.
        Property("Not show side polygons", True, flag, shown_if=(("Show polygons", True),)),
        Property("Color", (85, 255, 255), color),
        Property("Edge color", (125, 125, 125), color),
        Property("Alpha", 0.5, number()),
    )

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix | None:
        """Return the image corners' directions at a distance of 1 m, shape (4, 3), or None."""
        fx, cx, tx = message.p[[0, 2, 3]]
        fy, cy, ty = message.p[[5, 6, 7]]
        if not (np.isfinite(message.p).all() and fx and fy):
            self.statuses.set("error", "Camera Info", "Invalid intrinsic matrix")
            return None
        self.statuses.set("ok", "Camera Info", "OK")
        width = (message.roi.width or message.width) // (message.binning_x or 1)
        height = (message.roi.height or message.height) // (message.binning_y or 1)
        x, y = (_CORNERS * (width, height)).T
        return np.column_stack([(x - cx - tx) / fx, (y - cy - ty) / fy, np.ones(4)])

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the edges and sides that the properties request."""
        parts: dict[str, Drawable] = {}
        if not self.history or self.history[0] is None:
            return parts
        points = np.vstack([np.zeros(3), self.history[0] * self["Far clip"]])
        if self["Show edges"]:
            rgba = rgba_of(self, "Edge color")
            parts["edges"] = Lines(points[_EDGES].reshape(-1, 3), rgba, _WIDTH, strip=False)
        if self["Show polygons"] and not self["Not show side polygons"]:
            *rgb, alpha = rgba_of(self)
            # RViz multiplies texture and vertex color.
            squared = (*(channel**2 for channel in rgb), alpha)
            parts["sides"] = Mesh(points, _SIDES, squared, lit=False)
        return parts
