"""RViz's DepthCloud display."""

from collections import deque
from io import BytesIO
from typing import Any

import numpy as np

from course_lib.arrays import AnyArray, Float32s, Matrix, Pixels
from course_lib.displays.clouds.cloud import Cloud
from course_lib.displays.clouds.display import CLOUD_PROPERTIES, CloudDisplay
from course_lib.displays.display import Display, Interest
from course_lib.displays.frames import NS, nanoseconds
from course_lib.displays.images.camera import INFO
from course_lib.displays.images.display import IMAGE, PACKED, info_topic, rgb_of, rows_of, unpacked
from course_lib.displays.properties import Property, flag, integer, number, text, words
from course_lib.displays.topic_display import FilteredDisplay
from course_lib.ros.qos import Qos

_SHADOW = 0.01  # [m] that a point must be behind another one to be hidden by it
_WHOLE = ("16UC1", "mono16", "16SC1")  # in [mm], 0 is unknown; 32FC1 is in [m], unknown if not finite
_HEADER = 12  # bytes before the picture of a compressedDepth image
_HINTS = {"Depth Map Topic": "Depth Map Transport Hint", "Color Image Topic": "Color Transport Hint"}
_LISTENING = ("Depth Map", "Color Image", "Color Transport", "Reliability Policy", "Queue Size")
_FAR, _TURNED = 0.01, np.radians(0.5)  # how much a camera may move, [m], and turn, without losing its shadows


class DepthError(ValueError):
    """RViz cannot make points of images; with its words."""


def depths(message: Any) -> Float32s:
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


def projected(depth: Float32s, info: Any) -> Float32s:
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


def channels_of(points: Float32s, rgb: Pixels) -> dict[str, AnyArray]:
    """Return points and their colours, shape (..., 3), without those that are nowhere."""
    known = np.isfinite(points).all(axis=-1)
    parts = rgb[known].astype(np.uint32)
    packed = parts[:, 0] << 16 | parts[:, 1] << 8 | parts[:, 2]
    return dict(zip("xyz", points[known].T, strict=True)) | {"rgb": packed.view(np.float32)}


class Shadows:
    """Points that were seen before something hid them; one for each pixel.

    Args:
        shape: Rows and columns of the images.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self._points = np.full((*shape, 3), np.nan, np.float32)
        self._rgb = np.zeros((*shape, 3), np.uint8)
        self._seen = np.zeros(shape)  # [s]

    def with_hidden(
        self, points: Float32s, rgb: Pixels, now: float, timeout: float
    ) -> tuple[Float32s, Pixels]:
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


def _whole(values: AnyArray) -> tuple[float, float]:
    return 0.0, 255.0


def _raw(message: Any) -> AnyArray:
    if message.encoding not in (*_WHOLE, "32FC1"):
        raise DepthError("Depth image has invalid format (only 16 bit and float are supported)!")
    return rows_of(message, "u2" if message.encoding in _WHOLE else "f4", 1)[..., 0]


def _packed(message: Any) -> AnyArray:
    """Return the numbers in a PNG; those of compressedDepth may stand for the inverse of a depth."""
    from PIL import Image, UnidentifiedImageError

    data = bytes(message.data)
    is_inverse = message.format.startswith("32FC1")
    try:
        with Image.open(BytesIO(data[_HEADER if "compressedDepth" in message.format else 0 :])) as picture:
            values = np.asarray(picture)
    except (UnidentifiedImageError, OSError) as error:
        raise DepthError(f"the data is not a picture of format {message.format!r}: {error}") from error
    if not is_inverse:
        return values
    a, b = np.frombuffer(data, "<f4", 2, 4)
    with np.errstate(divide="ignore"):
        return np.where(values == 0, np.nan, a / (values - b))


class DepthCloudDisplay(CloudDisplay, FilteredDisplay):
    """Images of a depth camera as points, coloured by those of a camera at the same place."""

    class_name = "rviz_default_plugins/DepthCloud"
    type_name = IMAGE
    topic_label = "Depth Map Topic"
    status_label = "Depth Map"
    queue_label = "Queue Size"
    properties = (
        *Display.properties,
        Property("Reliability Policy", "Best effort", words("System Default", "Reliable", "Best effort")),
        Property("Topic Filter", True, flag),  # of the names that RViz offers for both topics
        Property("Depth Map Topic", "", text),
        Property("Depth Map Transport Hint", "raw", words("raw", "compressed", "compressedDepth")),
        Property("Color Image Topic", "", text),
        Property("Color Transport Hint", "raw", words("raw", "compressed")),
        Property("Queue Size", 5, integer(1)),
        Property("Auto Size", True, flag),
        Property("Auto Size/Auto Size Factor", 1.0, number(0.0001)),
        Property("Occlusion Compensation", False, flag),
        Property("Occlusion Compensation/Occlusion Time-Out", 30.0, number()),  # [s]
        *CLOUD_PROPERTIES,
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._info: Any = None  # the last one
        self._depth: Any = None  # the last image that was not shown yet
        self._waiting_colors: deque[Any] = deque()
        self._shadows: Shadows | None = None
        self._camera = np.eye(4)  # where it was when the shadows began

    def changed(self, label: str) -> None:
        """Resubscribe, or redraw."""
        super().changed(label)
        if label.startswith(_LISTENING) and label != self.topic_label and self.started:
            self.start()
        if label == "Occlusion Compensation":
            self._shadows = None

    def reset(self) -> None:
        """Forget all images."""
        super().reset()
        self._info, self._depth, self._waiting_colors = None, None, deque(maxlen=self["Queue Size"])
        self._shadows = None

    def qos(self) -> Qos:
        """Return what both images are asked for with."""
        policy = self["Reliability Policy"]
        asked = {} if policy == "System Default" else {"reliability": policy.lower().replace(" ", "_")}
        return Qos(depth=self["Queue Size"], **asked)

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to the depths, to what describes their camera, and to the colours if there is a topic."""
        self.statuses.set("ok", self.status_label, "0 depth maps received")
        self.statuses.set("ok", "Message", "Ok")
        sensor = Qos(depth=5, reliability="best_effort")
        info = self.interest(info_topic(self[self.topic_label]), INFO, self._take_info, sensor)
        images = [self._images(self.topic_label, self.take)]
        if self["Color Image Topic"]:
            images.append(self._images("Color Image Topic", self._take_colors))
            self._values["Color Transformer"] = "RGB8"
        return (info, *images)

    def process(self, message: Any) -> None:
        """Show the depths of an image, as soon as its colours are there."""
        self._depth = message
        self._match()

    def _images(self, topic: str, take: Any) -> Interest:
        hint = self[_HINTS[topic]]
        packed = hint != "raw"
        return self.interest(self[topic] + f"/{hint}" * packed, PACKED if packed else IMAGE, take)

    def _take_info(self, message: Any) -> None:
        self._info = message

    def _take_colors(self, message: Any) -> None:
        self._waiting_colors.append(message)
        self._match()

    def _match(self) -> None:
        """Show the last depths with the colours that are nearest in time; older ones are of no use."""
        depth, color = self._depth, None
        if depth is None or (self["Color Image Topic"] and not self._waiting_colors):
            return
        stamp_ns = nanoseconds(depth.header.stamp)
        if self._waiting_colors:
            color = min(self._waiting_colors, key=lambda one: abs(nanoseconds(one.header.stamp) - stamp_ns))
            while self._waiting_colors.popleft() is not color:
                pass
        self._depth = None
        no_info = f"no CameraInfo has come on {info_topic(self[self.topic_label])}: RViz draws nothing."
        self.statuses.hint("Camera Info", *([no_info] if self._info is None else []))
        transform = None if self._info is None else self.transform_at(depth.header)
        if transform is None:
            return
        try:
            self._show_images(depth, color, transform)
        except ValueError as error:
            self.statuses.set("error", "Message", f"Error updating depth cloud: {error}")

    def _show_images(self, image: Any, color: Any, transform: Matrix) -> None:
        depth = depths(image)
        points = projected(depth, self._info)
        rgb = np.full(points.shape, 255, np.uint8) if color is None else colors(color, depth.shape)
        self._say_sizes(image, color, depth.shape, rgb.shape)
        if self["Auto Size"] and self._info.k[0]:
            wide = self["Auto Size Factor"] / self._info.k[0] * (self._info.binning_x or 1)
            self._values["Size (m)"] = float(wide)  # [m], one metre ahead
        if self["Occlusion Compensation"]:
            if self._shadows is None or self._shadows.shape != depth.shape or self._has_moved(transform):
                self._shadows, self._camera = Shadows(depth.shape), transform
            now, timeout = self.context.now_ns / NS, self["Occlusion Time-Out"]
            points, rgb = self._shadows.with_hidden(points, rgb, now, timeout)
        self.keep(Cloud(channels_of(points, rgb), transform, self.context.now_ns))

    def _say_sizes(self, image: Any, color: Any, size: tuple[int, ...], color_size: tuple[int, ...]) -> None:
        self.statuses.set("ok", "Depth Image Size", f"{size[1]} x {size[0]}")
        if color is None:
            return
        self.statuses.set("ok", "Image Size", f"{color_size[1]} x {color_size[0]}")
        frames = image.header.frame_id, color.header.frame_id
        wrong = "Depth image frame id [{}] doesn't match color image frame id [{}]".format(*frames)
        self.statuses.hint("Frames", *([f"RViz warns for a moment: {wrong}"] if len({*frames}) > 1 else []))

    def _has_moved(self, transform: Matrix) -> bool:
        turn = transform[:3, :3].T @ self._camera[:3, :3]
        angle = np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))
        return bool(np.linalg.norm(transform[:3, 3] - self._camera[:3, 3]) > _FAR or angle > _TURNED)
