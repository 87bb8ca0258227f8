"""RViz's displays of point clouds: PointCloud2, PointCloud, LaserScan, DepthCloud and scalars.

A message is converted to a `Cloud`, arrays by channel name. A transformer, RViz's term for a way to
color points, computes colors from a cloud; `TRANSFORMERS` is the table of them. The arithmetic uses
the same number types as RViz, so clouds agree with its images to the last bit.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from io import BytesIO
from math import isfinite
from typing import Any, ClassVar, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import AnyArray, Float32s, Matrix, Pixels, Reals
from course_lib.displays.display import (
    FILTER_PROPERTIES,
    INVALID,
    QUEUE_LABEL,
    Display,
    Subscription,
    TopicDisplay,
)
from course_lib.displays.frames import NS, nanoseconds
from course_lib.displays.images import IMAGE, INFO, PACKED, decode_compressed, info_topic, rgb_of, rows_of
from course_lib.displays.properties import (
    NEVER,
    Property,
    PropertyHolder,
    color,
    flag,
    integer,
    number,
    read_only,
    text,
    words,
)
from course_lib.displays.shapes import alpha_drawn_twice
from course_lib.errors import format_count
from course_lib.ros.graph.topics import Qos
from course_lib.ros.tf2 import Transform, TransformException, interpolate
from course_lib.viewer.drawables import Points, Spot

# numpy types by the constants of sensor_msgs/msg/PointField. RViz reads signed integers as
# unsigned.
_TYPES = {1: "u1", 2: "u1", 3: "u2", 4: "u2", 5: "u4", 6: "u4", 7: "f4", 8: "f8"}
_XYZ = ("x", "y", "z")
AXES = ("X", "Y", "Z")
# The property and value that other properties depend on: a transformer, or a check box.
_BY_INTENSITY = ("Color Transformer", "Intensity")
_BY_AXIS, _BY_FLAT = ("Color Transformer", "AxisColor"), ("Color Transformer", "FlatColor")
_FIXED_INTENSITIES = (_BY_INTENSITY, ("Autocompute Intensity Bounds", False))
_FIXED_VALUES = (_BY_AXIS, ("Autocompute Value Bounds", False))
_RAINBOW_COLORS = (_BY_INTENSITY, ("Use rainbow", True))
_TWO_COLORS = (_BY_INTENSITY, ("Use rainbow", False))
COLOR_PROPERTIES = (
    Property("Channel Name", "intensity", text, shown_if=(_BY_INTENSITY,)),
    Property("Use rainbow", True, flag, shown_if=(_BY_INTENSITY,)),
    Property("Invert Rainbow", False, flag, shown_if=_RAINBOW_COLORS),
    Property("Min Color", (0, 0, 0), color, shown_if=_TWO_COLORS),
    Property("Max Color", (255, 255, 255), color, shown_if=_TWO_COLORS),
    Property("Autocompute Intensity Bounds", True, flag, shown_if=(_BY_INTENSITY,)),
    Property("Min Intensity", 0.0, number(), shown_if=_FIXED_INTENSITIES),
    Property("Max Intensity", 4096.0, number(), shown_if=_FIXED_INTENSITIES),
    Property("Axis", "Z", words(*AXES), shown_if=(_BY_AXIS,)),
    Property("Autocompute Value Bounds", True, flag, shown_if=(_BY_AXIS,)),
    # [m]
    Property("Autocompute Value Bounds/Min Value", -10.0, number(), shown_if=_FIXED_VALUES),
    Property("Autocompute Value Bounds/Max Value", 10.0, number(), shown_if=_FIXED_VALUES),
    Property("Use Fixed Frame", True, flag, shown_if=(_BY_AXIS,)),
    Property("Color", (255, 255, 255), color, shown_if=(_BY_FLAT,)),
)
# For each section of the rainbow: the constant part (red, green, blue) of the color.
_RAINBOW = np.array([(0, 0, 1), (0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0)], np.float32)
_CHANGING = np.array([0, 1, 2, 0, 1])
# Measured values of properties, by label.
Bounds: TypeAlias = dict[str, float]


@dataclass(frozen=True)
class Cloud:
    """The points of one message.

    Args:
        channels: The fields by name, shape (N,) each.
        transform_cloud_to_fixed: Transform from the cloud to the fixed frame, shape (4, 4).
        received_ns: Robot time of reception [ns].
    """

    channels: Mapping[str, AnyArray]
    transform_cloud_to_fixed: Matrix
    received_ns: int

    @property
    def positions(self) -> Float32s:
        """The points in the frame of the cloud, shape (N, 3), [m]."""
        return np.stack([self.channels[axis] for axis in _XYZ], axis=-1).astype(np.float32)

    def is_float32(self, name: str, *, or_int32: bool = False) -> bool:
        """Return whether a channel has 32-bit floats or, with `or_int32`, 32-bit integers."""
        kinds = ("f", "u") if or_int32 else ("f",)
        channel = self.channels.get(name)
        return channel is not None and channel.dtype.itemsize == 4 and channel.dtype.kind in kinds


def size_problem(message: Any) -> str | None:
    """Return RViz's status if the sizes in a sensor_msgs/msg/PointCloud2 are inconsistent."""
    width, height, step, size = message.width, message.height, message.point_step, len(message.data)
    if width * height * step == size:
        return None
    return (
        f"Data size ({size} bytes) does not match width ({width}) times height ({height}) times "
        f"point_step ({step}).  Dropping message."
    )


def channels_of(message: Any) -> tuple[dict[str, AnyArray], list[str]]:
    """Return the fields of a sensor_msgs/msg/PointCloud2 by name, for finite points.

    Returns:
        The channels, and errors about fields that are skipped.
    """
    count, step = message.width * message.height, message.point_step
    channels: dict[str, AnyArray] = {}
    wrong = []
    # In reverse order, so that the first of duplicate fields takes precedence.
    for field in reversed(message.fields):
        dtype = np.dtype(_TYPES.get(field.datatype, "V1")).newbyteorder(">" if message.is_bigendian else "<")
        if field.datatype not in _TYPES or field.offset + dtype.itemsize > step:
            wrong.append(
                f"field {field.name!r} (datatype {field.datatype}, offset {field.offset}) is not a "
                f"number within the {step} bytes of a point."
            )
            continue
        place = (memoryview(message.data), field.offset, (step,))
        channels[field.name] = np.ndarray(count, dtype, *place) if count else np.empty(0, dtype)
    return finite(channels), wrong


def finite(channels: dict[str, AnyArray]) -> dict[str, AnyArray]:
    """Remove the points whose coordinates are not finite."""
    finite_axes = [np.isfinite(channels[axis]) for axis in _XYZ if axis in channels]
    if not finite_axes or all(axis.all() for axis in finite_axes):
        return channels
    is_finite = np.logical_and.reduce(finite_axes)
    return {name: channel[is_finite] for name, channel in channels.items()}


class Transformer(NamedTuple):
    """A way to color a cloud."""

    supports: Callable[[Cloud], bool]
    # The supported transformer with the highest score is the default.
    score: int
    # Returns colors RGB or RGBA in 0..1, shape (N, 3) or (N, 4), and the measured bounds.
    colors: Callable[[Cloud, PropertyHolder], tuple[Reals, Bounds]]


def best_transformer(cloud: Cloud, preferred: str) -> str:
    """Return the transformer that RViz uses: the chosen one if the cloud supports it, else RGB8."""
    able = {name for name, transformer in TRANSFORMERS.items() if transformer.supports(cloud)}
    if preferred in able:
        return preferred
    return "RGB8" if "RGB8" in able else max(able, key=lambda name: (TRANSFORMERS[name].score, name))


def rainbow(value: npt.ArrayLike) -> Float32s:
    """Return colors from red at 1 through green to violet at 0, shape (N, 3)."""
    hue = np.clip(np.nan_to_num(np.asarray(value, np.float32)), 0, 1) * 5 + 1
    part = np.minimum(hue.astype(int), 5)
    remainder = hue - part
    rgb: Float32s = _RAINBOW[part - 1]
    falls = np.where(part % 2 == 1, 1 - remainder, remainder)
    rgb[np.arange(len(rgb)), _CHANGING[part - 1]] = np.where(hue >= 6, 0, falls)
    return rgb


def _intensity(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    name = holder["Channel Name"]
    if name == "intensity" and name not in cloud.channels:
        name = "intensities"
    if name not in cloud.channels:
        return np.ones((len(cloud.positions), 3), np.float32), {}
    values = cloud.channels[name].astype(np.float32)
    bounds = {}
    if holder["Autocompute Intensity Bounds"]:
        low, high = np.clip(_bounds(values, 999999.0), -999999.0, 999999.0).tolist()
        bounds = {"Min Intensity": low, "Max Intensity": high}
    else:
        low, high = holder["Min Intensity"], holder["Max Intensity"]
    share = (values - low) / ((high - low) or 1e20)
    if holder["Use rainbow"]:
        return rainbow(share if holder["Invert Rainbow"] else 1 - share), bounds
    share = np.clip(np.nan_to_num(share), 0, 1)[:, None]
    dark, bright = (np.array(holder[label]) / 255 for label in ("Min Color", "Max Color"))
    return (bright * share + dark * (1 - share)).astype(np.float32), bounds


def _axis(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    axis, points = AXES.index(holder["Axis"]), cloud.positions
    values = points[:, axis]
    if holder["Use Fixed Frame"]:
        row = cloud.transform_cloud_to_fixed[axis]
        values = (points @ row[:3] + row[3]).astype(np.float32)
    bounds = {}
    if holder["Autocompute Value Bounds"]:
        low, high = _bounds(values, 9999.0)
        bounds = {f"Autocompute Value Bounds/{name} Value": v for name, v in (("Min", low), ("Max", high))}
    else:
        low, high = holder["Min Value"], holder["Max Value"]
    return rainbow(1 - (values - low) / ((high - low) or 0.001)), bounds


def _flat_color(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    rgb = np.array(holder["Color"], np.float32) / 255
    return np.broadcast_to(rgb, (len(cloud.positions), 3)), {}


def _rgb8(cloud: Cloud, holder: PropertyHolder) -> tuple[Reals, Bounds]:
    name = "rgb" if "rgb" in cloud.channels else "rgba"
    channel = np.ascontiguousarray(cloud.channels[name])
    color_words = channel.view(channel.dtype.str.replace("f", "u")).astype("<u4")
    bgra = color_words.view(np.uint8).reshape(-1, 4)
    return bgra[:, [2, 1, 0] if name == "rgb" else [2, 1, 0, 3]] / np.float32(255), {}


def _bounds(values: Float32s, limit: float) -> tuple[float, float]:
    """Return the minimum and maximum. As in RViz, the search starts at `limit` and `-limit`."""
    numbers = values[~np.isnan(values)]
    return float(numbers.min(initial=limit)), float(numbers.max(initial=-limit))


TRANSFORMERS: Mapping[str, Transformer] = {
    "AxisColor": Transformer(lambda cloud: True, 255, _axis),
    "FlatColor": Transformer(lambda cloud: True, 0, _flat_color),
    "Intensity": Transformer(lambda cloud: True, 255, _intensity),
    "RGB8": Transformer(
        lambda cloud: any(cloud.is_float32(name, or_int32=True) for name in ("rgb", "rgba")), 0, _rgb8
    ),
    "RGBF32": Transformer(
        lambda cloud: cloud.is_float32("r") and {"g", "b"} <= cloud.channels.keys(),
        0,
        lambda cloud, holder: (
            np.stack([cloud.channels[name] for name in "rgb"], axis=-1).astype(np.float32),
            {},
        ),
    ),
}


# RViz gives squares soft edges, which are invisible at this size.
STYLES: dict[str, Spot] = {
    "Points": "disc",
    "Squares": "square",
    "Flat Squares": "square",
    "Spheres": "sphere",
    "Boxes": "box",
    "Tiles": "tile",
}

CLOUD_PROPERTIES = (
    Property("Selectable", True, flag),
    Property("Style", "Flat Squares", words(*STYLES)),
    # [m]
    Property("Size (m)", 0.01, number(0.0001), shown_if=(("Style", *[s for s in STYLES if s != "Points"]),)),
    Property("Size (Pixels)", 3.0, number(1.0), shown_if=(("Style", "Points"),)),  # [px]
    Property("Alpha", 1.0, number(0.0, 1.0)),
    Property("Decay Time", 0.0, number(0.0)),  # [s]
    Property("Position Transformer", "", words("", "XYZ")),
    Property("Color Transformer", "", words("", *TRANSFORMERS)),
    *COLOR_PROPERTIES,
)
_NOT_DRAWN = {"Enabled", "Topic", "Selectable", "Decay Time"}


class DisplayedCloud(NamedTuple):
    """A cloud in the scene."""

    cloud: Cloud
    path: str


class CloudDisplay(TopicDisplay):
    """Base class of displays of clouds.

    A cloud is drawn in the next frame and removed after its decay time.
    """

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._new_clouds: list[Cloud] = []
        self._displayed: list[DisplayedCloud] = []
        self._is_stale = False
        self._cloud_count = 0

    def on_property_change(self, label: str) -> None:
        """Redraw all clouds in the next frame, if the property affects the drawing."""
        super().on_property_change(label)
        self._is_stale |= label.partition("/")[0] not in _NOT_DRAWN

    def reset(self) -> None:
        """Discard all clouds."""
        super().reset()
        self._new_clouds, self._displayed = [], []

    def keep(self, cloud: Cloud) -> None:
        """Keep a cloud for the next frame, if RViz can draw it."""
        self.statuses.delete("Message")
        self._values["Color Transformer"] = best_transformer(cloud, self["Color Transformer"])
        if not (cloud.is_float32("x") and {"y", "z"} <= cloud.channels.keys()):
            self.statuses.set("error", "Message", "No position transformer available for cloud")
            return
        self._values["Position Transformer"] = "XYZ"
        self._new_clouds.append(cloud)

    def update(self) -> None:
        """Draw new clouds and remove expired ones."""
        super().update()
        if self._is_stale:
            for displayed in self._displayed:
                self._draw(displayed)
        self._is_stale = False
        if self._new_clouds or self["Decay Time"] > 0:
            while self._displayed and self._is_old(self._displayed[0].cloud):
                self.context.scene.delete(self._displayed.pop(0).path)
        for cloud in self._new_clouds:
            if cloud is self._new_clouds[-1] or not self._is_old(cloud):
                self._cloud_count += 1
                displayed = DisplayedCloud(cloud, f"{self.path}/clouds/{self._cloud_count}")
                self._displayed.append(displayed)
                self.context.scene.set_transform(displayed.path, cloud.transform_cloud_to_fixed)
                self._draw(displayed)
        self._new_clouds = []
        count = sum(len(displayed.cloud.positions) for displayed in self._displayed)
        text = f"Showing [{count}] points from [{len(self._displayed)}] messages"
        self.statuses.set("ok", "Points", text)

    def _is_old(self, cloud: Cloud) -> bool:
        """Return whether a cloud has expired; without a decay time the next one replaces it."""
        age = (self.context.now_ns - cloud.received_ns) / NS  # [s]
        return bool(age > self["Decay Time"] or not self["Decay Time"])

    def _draw(self, displayed: DisplayedCloud) -> None:
        style = self["Style"]
        in_pixels = style == "Points"
        size = (self["Size (Pixels)" if in_pixels else "Size (m)"],) * 3
        name = best_transformer(displayed.cloud, self["Color Transformer"])
        with np.errstate(invalid="ignore"):
            own_colors, bounds = TRANSFORMERS[name].colors(displayed.cloud, self)
        self._values |= bounds
        # Only the channel rgba provides alpha.
        colors = np.empty((len(own_colors), 4), np.float32)
        colors[:, :3] = own_colors[:, :3]
        colors[:, 3] = self["Alpha"] * (own_colors[:, 3] if own_colors.shape[1] == 4 else 1.0)
        if not (colors[:, 3] == 1).all():
            colors[:, 3] = alpha_drawn_twice(colors[:, 3])
        grow = not in_pixels and bool(self._values.get("Auto Size"))
        points = displayed.cloud.positions
        is_finite = np.isfinite(points)
        # RViz counts the invalid points of a PointCloud, but moves them out of sight.
        if not is_finite.all():
            is_valid = is_finite.all(axis=1)
            points, colors = points[is_valid], colors[is_valid]
        drawable = Points(points, colors, size, in_pixels, STYLES[style], grow)
        self.context.scene.set_object(displayed.path, drawable)


class PointCloud2Display(CloudDisplay):
    """Clouds of any layout. They do not wait for transforms."""

    class_name = "rviz_default_plugins/PointCloud2"
    type_name = "sensor_msgs/msg/PointCloud2"
    properties = (*CloudDisplay.properties, *CLOUD_PROPERTIES)

    def process(self, message: Any) -> None:
        """Show a cloud. Like RViz it ignores a cloud without x, y and z, but adds a hint."""
        silent = (
            []
            if set(_XYZ) <= {field.name for field in message.fields}
            else ["the cloud has no fields x, y and z: RViz draws nothing."]
        )
        self.statuses.hint("Fields", *silent)
        if silent:
            return
        problem = size_problem(message)
        if problem:
            self.statuses.set("error", "Message", problem)
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            channels, wrong = channels_of(message)
            self.statuses.hint("Fields", *wrong)
            self.keep(Cloud(channels, transform, self.context.now_ns))


class PointCloudDisplay(CloudDisplay):
    """Clouds of the older type from ROS 1, with a list of numbers for each channel."""

    queue_label = QUEUE_LABEL
    class_name = "rviz_default_plugins/PointCloud"
    type_name = "sensor_msgs/msg/PointCloud"
    properties = (*FILTER_PROPERTIES, *CLOUD_PROPERTIES)

    def process(self, message: Any) -> None:
        """Show a cloud. As in RViz, a channel without a number for each point is 0 everywhere."""
        transform = self.transform_at(message.header)
        if transform is None:
            return
        points = np.array([(p.x, p.y, p.z) for p in message.points], np.float32).reshape(-1, 3)
        channels: dict[str, AnyArray] = {}
        wrong = []
        for channel in message.channels:
            if len(channel.values) == len(points):
                channels[channel.name] = np.array(channel.values, np.float32)
            else:
                channels[channel.name] = np.zeros(len(points), np.float32)
                values = format_count(len(channel.values), "value")
                count = format_count(len(points), "point")
                wrong.append(f"channel {channel.name!r} has {values} for {count}; RViz draws 0 for each.")
        self.statuses.hint("Channels", *wrong)
        channels |= dict(zip("xyz", points.T, strict=True))
        self.keep(Cloud(channels, transform, self.context.now_ns))


class LaserScanDisplay(CloudDisplay):
    """The end points of a scanner's beams, each transformed at the time of its beam."""

    queue_label = QUEUE_LABEL
    class_name = "rviz_default_plugins/LaserScan"
    type_name = "sensor_msgs/msg/LaserScan"
    properties = (*FILTER_PROPERTIES, *CLOUD_PROPERTIES)

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        # Longest duration of a scan [ns].
        self._longest_ns = 0

    def reset(self) -> None:
        """Discard all scans. As in RViz, the warning about the scan time remains."""
        super().reset()
        self._warn_about_time()

    def process(self, message: Any) -> None:
        """Show a scan."""
        if not isfinite(message.time_increment):
            self.statuses.set("error", "Topic", INVALID)
            return
        # The time from the first to the last beam [s].
        seconds = (len(message.ranges) - 1) * float(message.time_increment)
        duration_ns = max(int(seconds * NS), 0) if isfinite(seconds) else 0
        if duration_ns > self._longest_ns:
            self._longest_ns = duration_ns
            self._warn_about_time()
        frames, frame = self.context.frames, message.header.frame_id.removeprefix("/")
        stamp_ns = nanoseconds(message.header.stamp)
        try:
            ends = [
                frames.buffer.lookup(frames.fixed_frame, frame, t) for t in (stamp_ns, stamp_ns + duration_ns)
            ]
        except TransformException:
            self.transform_at(message.header, known=False)
            return
        self.transform_at(message.header)
        hits, intensities = len(message.ranges), len(message.intensities)
        wrong = f"the scan has {hits} ranges but {intensities} intensities, which are ignored."
        self.statuses.hint("Intensities", *([wrong] if intensities not in (0, hits) else []))
        self.keep(Cloud(_project_scan(message, *ends), np.eye(4), self.context.now_ns))

    def transform_problem(self, message: Any) -> str | None:
        """Return why a scan has to wait.

        The transforms at its first and last beam must be known.
        """
        later = nanoseconds(message.header.stamp) + self._longest_ns
        frame = message.header.frame_id.removeprefix("/")
        return super().transform_problem(message) or self.context.frames.problem(frame, later)

    def _warn_about_time(self) -> None:
        seconds = self._longest_ns // NS
        if seconds > 1:
            self.statuses.set(
                "warn",
                "Scan Time",
                "Laser scan time, computed from time_increment * len(ranges), is rather large:  "
                f"{seconds}s.\nThe display of any message will be delayed by this amount of time!",
            )


def _project_scan(scan: Any, first: Transform, last: Transform) -> dict[str, AnyArray]:
    """Return the end points of the beams in the fixed frame, and their intensities (laser_geometry).

    Each point is transformed by its own interpolation between two transforms.
    """
    ranges = np.asarray(scan.ranges, np.float64)
    with np.errstate(invalid="ignore"):
        beam = np.flatnonzero((ranges < scan.range_max) & (ranges >= scan.range_min))
    angles = scan.angle_min + beam * scan.angle_increment
    points = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]) * ranges[beam, None]
    if first.pose == last.pose:
        transform = first.matrix()
        transformed = points @ transform[:3, :3].T + transform[:3, 3]
    else:
        # tf2 interpolates over time, so the transforms get stamps that are one second apart.
        start = Transform(first.parent, first.child, 0, *first.pose)
        end = Transform(last.parent, last.child, NS, *last.pose)
        share = beam / max(len(ranges) - 1, 1)
        matrices = np.array([interpolate(start, end, round(part * NS)).matrix() for part in share])
        transformed = (matrices[:, :3, :3] @ points[:, :, None])[..., 0] + matrices[:, :3, 3]
    channels: dict[str, AnyArray] = dict(zip("xyz", transformed.astype(np.float32).T, strict=True))
    if len(scan.intensities) == len(ranges):
        channels["intensity"] = np.asarray(scan.intensities, np.float32)[beam]
    return channels


def _scalar_properties(
    channel: str, lowest: float, highest: float, *, inverted: bool = False
) -> tuple[Property, ...]:
    """Return the properties of a cloud with the defaults for a measured quantity.

    Args:
        channel: Name of the message's field and of the cloud's channel.
        lowest: One end of the rainbow, in the message's unit.
        highest: The other end of the rainbow.
        inverted: Whether red is the highest value.
    """
    defaults: dict[str, Any] = {
        "Channel Name": channel,
        "Autocompute Intensity Bounds": False,
        "Invert Rainbow": inverted,
        "Min Intensity": lowest,
        "Max Intensity": highest,
    }
    hidden = ("Position Transformer", "Color Transformer")
    properties = (
        replace(
            prop,
            default=defaults.get(prop.label, prop.default),
            shown_if=NEVER if prop.label in hidden else prop.shown_if,
        )
        for prop in CLOUD_PROPERTIES
    )
    return (*FILTER_PROPERTIES, *properties)


class ScalarDisplay(CloudDisplay):
    """One measured number, as a colored point at the origin of its frame."""

    queue_label = QUEUE_LABEL
    # The message's field with the measured value.
    field: ClassVar[str]

    def process(self, message: Any) -> None:
        """Show a measurement."""
        transform = self.transform_at(message.header)
        if transform is None:
            return
        channels = {axis: np.zeros(1, np.float32) for axis in "xyz"}
        values = np.array([getattr(message, self.field)], np.float64)
        self.keep(Cloud({**channels, self.field: values}, transform, self.context.now_ns))


class TemperatureDisplay(ScalarDisplay):
    """Temperatures [°C]."""

    class_name = "rviz_default_plugins/Temperature"
    type_name = "sensor_msgs/msg/Temperature"
    field = "temperature"
    properties = _scalar_properties(field, 0.0, 100.0, inverted=True)


class FluidPressureDisplay(ScalarDisplay):
    """Pressures of air or water [Pa]."""

    class_name = "rviz_default_plugins/FluidPressure"
    type_name = "sensor_msgs/msg/FluidPressure"
    field = "fluid_pressure"
    properties = _scalar_properties(field, 98000.0, 105000.0)


class IlluminanceDisplay(ScalarDisplay):
    """Illuminances [lx]."""

    class_name = "rviz_default_plugins/Illuminance"
    type_name = "sensor_msgs/msg/Illuminance"
    field = "illuminance"
    properties = _scalar_properties(field, 0.0, 1000.0)


class RelativeHumidityDisplay(ScalarDisplay):
    """Relative humidities, 0 to 1."""

    class_name = "rviz_default_plugins/RelativeHumidity"
    type_name = "sensor_msgs/msg/RelativeHumidity"
    field = "relative_humidity"
    properties = _scalar_properties(field, 0.0, 1.0)


# Minimum distance between a point and the nearer point that hides it [m].
_SHADOW = 0.01
# Encodings in [mm], in which 0 is unknown. 32FC1 is in [m], where a value that is not finite is
# unknown.
_MILLIMETER_ENCODINGS = ("16UC1", "mono16", "16SC1")
# Header of a compressedDepth image [B].
_HEADER = 12
_HINTS = {"Depth Map Topic": "Depth Map Transport Hint", "Color Image Topic": "Color Transport Hint"}
_LISTENING = ("Depth Map", "Color Image", "Color Transport", "Reliability Policy", "Queue Size")
# A larger camera motion, [m] and [rad], discards the hidden points.
_MAX_MOTION, _MAX_TURN = 0.01, np.radians(0.5)


class DepthError(ValueError):
    """Raised when RViz cannot compute points from images, with RViz's message."""


def depths(message: Any) -> Float32s:
    """Return the depths of an image in [m], NaN where unknown, shape (rows, columns).

    Raises:
        DepthError: The image has no depths.
    """
    values: AnyArray
    if hasattr(message, "format"):
        from PIL import Image, UnidentifiedImageError

        data = bytes(message.data)
        try:
            with Image.open(
                BytesIO(data[_HEADER if "compressedDepth" in message.format else 0 :])
            ) as picture:
                values = np.asarray(picture)
        except (UnidentifiedImageError, OSError, Image.DecompressionBombError) as error:
            raise DepthError(f"the data is not an image of format {message.format!r}: {error}") from error
        if message.format.startswith("32FC1"):
            # The PNG of this format contains inverse depths.
            a, b = np.frombuffer(data, "<f4", 2, 4)
            with np.errstate(divide="ignore"):
                values = np.where(values == 0, np.nan, a / (values - b))
    elif message.encoding in (*_MILLIMETER_ENCODINGS, "32FC1"):
        values = rows_of(message, "u2" if message.encoding in _MILLIMETER_ENCODINGS else "f4", 1)[..., 0]
    else:
        raise DepthError("Depth image has invalid format (only 16 bit and float are supported)!")
    if values.dtype.kind == "f":
        return np.where(np.isfinite(values), values, np.nan).astype(np.float32)
    return np.where(values == 0, np.nan, values * np.float32(0.001)).astype(np.float32)


def colors(message: Any, shape: tuple[int, ...]) -> Pixels:
    """Return the RGB pixels of an image that matches depths of the given shape.

    Raises:
        DepthError: It does not match.
    """
    if not hasattr(message, "format") and not {"rgb", "bgr"} & {message.encoding[:3]}:
        raise DepthError("Encoded type not supported!")
    decode = decode_compressed if hasattr(message, "format") else rgb_of
    pixels = decode(message, lambda values: (0.0, 255.0))
    (rows, columns), (height, width) = shape, pixels.shape[:2]
    if (rows, columns) != (height, width):
        sizes = f"({columns}x{rows}) does not match color image resolution ({width}x{height})"
        raise DepthError(f"Depth image resolution {sizes}")
    return pixels


def project_depths(depth: Float32s, info: Any) -> Float32s:
    """Project a depth image to points, shape (rows, columns, 3): z ahead, x right, y down, [m].

    Raises:
        DepthError: The sensor_msgs/msg/CameraInfo describes an image of another size.
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


def _depth_channels(points: Float32s, rgb: Pixels) -> dict[str, AnyArray]:
    """Return the channels of the finite points, with their colors packed as RGB."""
    is_finite = np.isfinite(points).all(axis=-1)
    parts = rgb[is_finite].astype(np.uint32)
    packed_colors = parts[:, 0] << 16 | parts[:, 1] << 8 | parts[:, 2]
    return dict(zip("xyz", points[is_finite].T, strict=True)) | {"rgb": packed_colors.view(np.float32)}


class Shadows:
    """The last visible point in each pixel before a nearer object hid it.

    Args:
        shape: Rows and columns of the images.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self._points = np.full((*shape, 3), np.nan, np.float32)
        self._rgb = np.zeros((*shape, 3), np.uint8)
        self._seen_at = np.zeros(shape)  # [s]

    def with_hidden(
        self, points: Float32s, rgb: Pixels, now: float, timeout: float
    ) -> tuple[Float32s, Pixels]:
        """Return the points and colors of an image, followed by the hidden points.

        Args:
            points: Points as returned by `project_depths`.
            rgb: Their colors.
            now: Time in [s].
            timeout: Time for which hidden points are kept [s].
        """
        self._points[self._seen_at < now - timeout] = np.nan
        depth, before = points[..., 2], self._points[..., 2]
        hides = np.isnan(depth) | (depth < before - np.float32(_SHADOW))
        hidden_points, hidden_rgb = self._points[hides], self._rgb[hides]
        self._points[~hides], self._rgb[~hides], self._seen_at[~hides] = points[~hides], rgb[~hides] // 2, now
        return (
            np.concatenate([points.reshape(-1, 3), hidden_points]),
            np.concatenate([rgb.reshape(-1, 3), hidden_rgb]),
        )


class DepthCloudDisplay(CloudDisplay):
    """Images of a depth camera as points, colored by images of a camera at the same pose."""

    class_name = "rviz_default_plugins/DepthCloud"
    type_name = IMAGE
    topic_label = "Depth Map Topic"
    status_label = "Depth Map"
    queue_label = "Queue Size"
    properties = (
        *Display.properties,
        Property("Reliability Policy", "Best effort", words("System Default", "Reliable", "Best effort")),
        # Filter of the topic names that RViz offers.
        Property("Topic Filter", True, flag),
        Property("Depth Map Topic", "", text),
        Property("Depth Map Transport Hint", "raw", words("raw", "compressed", "compressedDepth")),
        Property("Color Image Topic", "", text),
        Property("Color Transport Hint", "raw", words("raw", "compressed")),
        Property("Queue Size", 5, integer(1)),
        Property("Auto Size", True, flag),
        Property("Auto Size/Auto Size Factor", 1.0, number(0.0001), shown_if=(("Auto Size", True),)),
        Property("Occlusion Compensation", False, flag),
        Property(
            "Occlusion Compensation/Occlusion Time-Out",
            30.0,  # [s]
            number(),
            shown_if=(("Occlusion Compensation", True),),
        ),
        *(
            # RViz hides it here only.
            replace(prop, shown_if=NEVER) if prop.label == "Position Transformer" else prop
            for prop in CLOUD_PROPERTIES
        ),
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        # The last camera info.
        self._info: Any = None
        # The last image that was not shown yet.
        self._depth: Any = None
        self._waiting_colors: deque[Any] = deque()
        self._shadows: Shadows | None = None
        # Camera pose for which the hidden points are valid.
        self._camera = np.eye(4)

    def panel_rows(self) -> Iterator[tuple[tuple[str, ...], Property]]:
        """Yield the displayed properties. A size that follows from the camera is read-only."""
        for path, prop in super().panel_rows():
            is_measured = prop.label == "Size (m)" and self["Auto Size"]
            yield path, replace(prop, convert=read_only) if is_measured else prop

    def is_expanded(self, path: tuple[str, ...]) -> bool:
        """Return whether a row shows those below it, as in RViz for check boxes that are on."""
        return path in {("Auto Size",), ("Occlusion Compensation",)} and bool(self[path[0]])

    def on_property_change(self, label: str) -> None:
        """Subscribe again, or redraw."""
        super().on_property_change(label)
        if label.startswith(_LISTENING) and label != self.topic_label and self.is_started:
            self.start()
        if label == "Occlusion Compensation":
            self._shadows = None

    def reset(self) -> None:
        """Discard all images."""
        super().reset()
        self._info, self._depth, self._waiting_colors = None, None, deque(maxlen=self["Queue Size"])
        self._shadows = None

    def qos(self) -> Qos:
        """Return the quality of service that both image subscriptions request."""
        policy = self["Reliability Policy"]
        reliability = {} if policy == "System Default" else {"reliability": policy.lower().replace(" ", "_")}
        return Qos(depth=self["Queue Size"], **reliability)

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Subscribe to depths and camera info, and to colors if they have a topic."""
        self.statuses.set("ok", self.status_label, "0 depth maps received")
        self.statuses.set("ok", "Message", "Ok")
        sensor = Qos(depth=5, reliability="best_effort")
        info = self.subscription(info_topic(self[self.topic_label]), INFO, self._on_info, sensor)
        images = [self._images(self.topic_label, self.receive)]
        if self["Color Image Topic"]:
            images.append(self._images("Color Image Topic", self._on_colors))
            self._values["Color Transformer"] = "RGB8"
        return (info, *images)

    def process(self, message: Any) -> None:
        """Show the depths of an image as soon as matching colors are available."""
        self._depth = message
        self._match()

    def _images(self, topic: str, take: Any) -> Subscription:
        hint = self[_HINTS[topic]]
        is_compressed = hint != "raw"
        return self.subscription(
            self[topic] + f"/{hint}" * is_compressed, PACKED if is_compressed else IMAGE, take
        )

    def _on_info(self, message: Any) -> None:
        self._info = message

    def _on_colors(self, message: Any) -> None:
        self._waiting_colors.append(message)
        self._match()

    def _match(self) -> None:
        """Show the last depths with the colors nearest in time, and discard older ones."""
        depth, color = self._depth, None
        if depth is None or (self["Color Image Topic"] and not self._waiting_colors):
            return
        stamp_ns = nanoseconds(depth.header.stamp)
        if self._waiting_colors:
            color = min(self._waiting_colors, key=lambda m: abs(nanoseconds(m.header.stamp) - stamp_ns))
            while self._waiting_colors.popleft() is not color:
                pass
        self._depth = None
        self.statuses.hint("Camera Info", *self._flaws_of_info())
        transform = None if self._info is None else self.transform_at(depth.header)
        if transform is None:
            return
        try:
            self._show_images(depth, color, transform)
        except ValueError as error:
            self.statuses.set("error", "Message", f"Error updating depth cloud: {error}")

    def _flaws_of_info(self) -> Iterator[str]:
        """Yield why RViz draws no points with this camera info, and shows no status."""
        topic, info = info_topic(self[self.topic_label]), self._info
        if info is None:
            yield f"no CameraInfo was received on {topic}: RViz draws nothing."
            return
        if zeros := [f"p[{index}]" for index in (0, 5) if not info.p[index]]:
            names = " and ".join(zeros) + (" is 0" if len(zeros) == 1 else " are 0")
            what = f"{names} in the CameraInfo on {topic}"
            yield f"{what}, expected the focal length [px]: RViz draws nothing."

    def _show_images(self, image: Any, color: Any, transform: Matrix) -> None:
        depth = depths(image)
        points = project_depths(depth, self._info)
        rgb = np.full(points.shape, 255, np.uint8) if color is None else colors(color, depth.shape)
        self.statuses.set("ok", "Depth Image Size", f"{depth.shape[1]} x {depth.shape[0]}")
        if color is not None:
            self.statuses.set("ok", "Image Size", f"{rgb.shape[1]} x {rgb.shape[0]}")
            frames = image.header.frame_id, color.header.frame_id
            wrong = "Depth image frame id [{}] doesn't match color image frame id [{}]".format(*frames)
            hint = [f"RViz shows this warning briefly: {wrong}"] if len({*frames}) > 1 else []
            self.statuses.hint("Frames", *hint)
        if self["Auto Size"] and self._info.k[0]:
            # Width of a pixel at a distance of 1 m, [m].
            width = self["Auto Size Factor"] / self._info.k[0] * (self._info.binning_x or 1)
            self._values["Size (m)"] = float(width)
        if self["Occlusion Compensation"]:
            way = np.linalg.norm(transform[:3, 3] - self._camera[:3, 3])  # [m]
            turn = transform[:3, :3].T @ self._camera[:3, :3]
            angle = np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))
            has_moved = way > _MAX_MOTION or angle > _MAX_TURN
            if self._shadows is None or self._shadows.shape != depth.shape or has_moved:
                self._shadows, self._camera = Shadows(depth.shape), transform
            now, timeout = self.context.now_ns / NS, self["Occlusion Time-Out"]
            points, rgb = self._shadows.with_hidden(points, rgb, now, timeout)
        self.keep(Cloud(_depth_channels(points, rgb), transform, self.context.now_ns))
