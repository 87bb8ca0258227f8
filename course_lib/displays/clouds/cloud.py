"""Point clouds from messages: positions and colours by RViz's transformers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import AnyArray, Float32s, Matrix, Reals
from course_lib.displays.properties import Property, PropertyHolder, color, flag, number, text, words

# By the constants of sensor_msgs/msg/PointField; RViz reads signed whole numbers as if they had no sign.
_TYPES = {1: "u1", 2: "u1", 3: "u2", 4: "u2", 5: "u4", 6: "u4", 7: "f4", 8: "f8"}
_XYZ = ("x", "y", "z")
AXES = ("X", "Y", "Z")
COLOR_PROPERTIES = (
    Property("Channel Name", "intensity", text),
    Property("Use rainbow", True, flag),
    Property("Invert Rainbow", False, flag),
    Property("Min Color", (0, 0, 0), color),
    Property("Max Color", (255, 255, 255), color),
    Property("Autocompute Intensity Bounds", True, flag),
    Property("Min Intensity", 0.0, number()),
    Property("Max Intensity", 4096.0, number()),
    Property("Axis", "Z", words(*AXES)),
    Property("Autocompute Value Bounds", True, flag),
    Property("Autocompute Value Bounds/Min Value", -10.0, number()),  # [m]
    Property("Autocompute Value Bounds/Max Value", 10.0, number()),  # [m]
    Property("Use Fixed Frame", True, flag),
    Property("Color", (255, 255, 255), color),
)
# Which third of the rainbow: what stays (red, green, blue), and which of them changes.
_RAINBOW = np.array([(0, 0, 1), (0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0)], np.float32)
_CHANGING = np.array([0, 1, 2, 0, 1])
Bounds: TypeAlias = dict[str, float]  # properties that RViz sets to what it has found


@dataclass(frozen=True)
class Cloud:
    """Points of one message.

    Args:
        channels: The fields by name, of shape (N,) each.
        transform_cloud_to_fixed: Where it is, shape (4, 4).
        received_ns: When it came, [ns].
    """

    channels: Mapping[str, AnyArray]
    transform_cloud_to_fixed: Matrix
    received_ns: int

    @property
    def positions(self) -> Float32s:
        """The points in the frame of the cloud, shape (N, 3), [m]."""
        return np.stack([self.channels[axis] for axis in _XYZ], axis=-1).astype(np.float32)

    def is_single(self, name: str, *, or_whole: bool = False) -> bool:
        """Return whether a channel of that name is in single precision, or also of 32-bit integers."""
        kinds = ("f", "u") if or_whole else ("f",)
        return name in self.channels and _is_32_bits(self.channels[name], kinds)


def has_positions(message: Any) -> bool:
    """Return whether a sensor_msgs/msg/PointCloud2 has fields x, y and z."""
    return set(_XYZ) <= {field.name for field in message.fields}


def size_problem(message: Any) -> str | None:
    """Describe in RViz's words how the sizes of a sensor_msgs/msg/PointCloud2 disagree."""
    width, height, step, size = message.width, message.height, message.point_step, len(message.data)
    if width * height * step == size:
        return None
    return (
        f"Data size ({size} bytes) does not match width ({width}) times height ({height}) times "
        f"point_step ({step}).  Dropping message."
    )


def channels_of(message: Any) -> tuple[dict[str, AnyArray], list[str]]:
    """Return the fields of a sensor_msgs/msg/PointCloud2 by name, only of points whose place is finite.

    Returns:
        Also what is wrong with fields that are left out.
    """
    count, step = message.width * message.height, message.point_step
    channels: dict[str, AnyArray] = {}
    wrong = []
    for field in reversed(message.fields):  # of two of one name the first one counts
        dtype = np.dtype(_TYPES.get(field.datatype, "V1")).newbyteorder(">" if message.is_bigendian else "<")
        if field.datatype not in _TYPES or field.offset + dtype.itemsize > step:
            wrong.append(
                f"field {field.name!r} (datatype {field.datatype}, offset {field.offset}) is not a number "
                f"within the {step} bytes of a point."
            )
            continue
        place = (memoryview(message.data), field.offset, (step,))
        channels[field.name] = np.ndarray(count, dtype, *place) if count else np.empty(0, dtype)
    return finite(channels), wrong


def finite(channels: dict[str, AnyArray]) -> dict[str, AnyArray]:
    """Drop the points that are nowhere."""
    known = [np.isfinite(channels[axis]) for axis in _XYZ if axis in channels]
    if not known or all(axis.all() for axis in known):
        return channels
    kept = np.logical_and.reduce(known)
    return {name: channel[kept] for name, channel in channels.items()}


def _is_32_bits(channel: AnyArray, kinds: tuple[str, ...]) -> bool:
    return channel.dtype.itemsize == 4 and channel.dtype.kind in kinds


class Transformer(NamedTuple):
    """One way to colour a cloud."""

    supports: Callable[[Cloud], bool]
    score: int  # of those that can, the highest is taken if none is asked for
    # returns colours RGB or RGBA in 0..1, shape (N, 3) or (N, 4), and the bounds that were found
    colors: Callable[[Cloud, PropertyHolder], tuple[Reals, Bounds]]


def best_transformer(cloud: Cloud, wanted: str) -> str:
    """Return the transformer that RViz takes: the wanted one if the cloud has what it needs, else RGB8."""
    able = {name for name, transformer in TRANSFORMERS.items() if transformer.supports(cloud)}
    if wanted in able:
        return wanted
    return "RGB8" if "RGB8" in able else max(able, key=lambda name: (TRANSFORMERS[name].score, name))


def rainbow(value: npt.ArrayLike) -> Float32s:
    """Return colours from red at 1 by way of green to violet at 0, shape (N, 3)."""
    hue = np.clip(np.nan_to_num(np.asarray(value, np.float32)), 0, 1) * 5 + 1
    part = np.minimum(hue.astype(int), 5)
    rest = hue - part
    rgb: Float32s = _RAINBOW[part - 1]
    falls = np.where(part % 2 == 1, 1 - rest, rest)
    rgb[np.arange(len(rgb)), _CHANGING[part - 1]] = np.where(hue >= 6, 0, falls)
    return rgb


def _intensity(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    name = holder["Channel Name"]
    if name == "intensity" and name not in cloud.channels:
        name = "intensities"
    if name not in cloud.channels:
        return np.ones((len(cloud.positions), 3), np.float32), {}
    values = cloud.channels[name].astype(np.float32)
    found = {}
    if holder["Autocompute Intensity Bounds"]:
        low, high = _bounds(values, 999999.0)
        found = {"Min Intensity": low, "Max Intensity": high}
    else:
        low, high = holder["Min Intensity"], holder["Max Intensity"]
    share = (values - low) / ((high - low) or 1e20)
    if holder["Use rainbow"]:
        return rainbow(share if holder["Invert Rainbow"] else 1 - share), found
    share = np.clip(np.nan_to_num(share), 0, 1)[:, None]
    dark, bright = (np.array(holder[label]) / 255 for label in ("Min Color", "Max Color"))
    return (bright * share + dark * (1 - share)).astype(np.float32), found


def _axis(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    axis, points = AXES.index(holder["Axis"]), cloud.positions
    values = points[:, axis]
    if holder["Use Fixed Frame"]:
        row = cloud.transform_cloud_to_fixed[axis]
        values = (points @ row[:3] + row[3]).astype(np.float32)
    found = {}
    if holder["Autocompute Value Bounds"]:
        low, high = _bounds(values, 9999.0)
        found = {f"Autocompute Value Bounds/{name} Value": v for name, v in (("Min", low), ("Max", high))}
    else:
        low, high = holder["Min Value"], holder["Max Value"]
    return rainbow(1 - (values - low) / ((high - low) or 0.001)), found


def _flat(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    rgb = np.array(holder["Color"], np.float32) / 255
    return np.broadcast_to(rgb, (len(cloud.positions), 3)), {}


def _rgb8(cloud: Cloud, holder: PropertyHolder) -> tuple[Reals, Bounds]:
    name = "rgb" if "rgb" in cloud.channels else "rgba"
    channel = np.ascontiguousarray(cloud.channels[name])
    packed = channel.view(channel.dtype.str.replace("f", "u")).astype("<u4")
    bgra = packed.view(np.uint8).reshape(-1, 4)
    return bgra[:, [2, 1, 0] if name == "rgb" else [2, 1, 0, 3]] / np.float32(255), {}


def _rgbf32(cloud: Cloud, holder: PropertyHolder) -> tuple[Float32s, Bounds]:
    return np.stack([cloud.channels[name] for name in "rgb"], axis=-1).astype(np.float32), {}


def _bounds(values: Float32s, limit: float) -> tuple[float, float]:
    """Return the least and the greatest value, as RViz searches them: from and within some limit."""
    known = values[~np.isnan(values)]
    low, high = min(known.min(initial=limit), limit), max(known.max(initial=-limit), -limit)
    return max(float(low), -limit), min(float(high), limit)


TRANSFORMERS: Mapping[str, Transformer] = {
    "AxisColor": Transformer(lambda cloud: True, 255, _axis),
    "FlatColor": Transformer(lambda cloud: True, 0, _flat),
    "Intensity": Transformer(lambda cloud: True, 255, _intensity),
    "RGB8": Transformer(
        lambda cloud: any(cloud.is_single(name, or_whole=True) for name in ("rgb", "rgba")), 0, _rgb8
    ),
    "RGBF32": Transformer(
        lambda cloud: cloud.is_single("r") and {"g", "b"} <= cloud.channels.keys(), 0, _rgbf32
    ),
}
