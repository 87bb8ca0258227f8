"""Point clouds as the displays keep them: named channels of numbers, whatever layout they came in."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.displays.frames import Matrix
from course_lib.viewer.arrays import Floats

Channel = npt.NDArray[Any]

# By the constants of sensor_msgs/msg/PointField; RViz reads signed whole numbers as if they had no sign.
_TYPES = {1: "u1", 2: "u1", 3: "u2", 4: "u2", 5: "u4", 6: "u4", 7: "f4", 8: "f8"}
_XYZ = ("x", "y", "z")


@dataclass(frozen=True)
class Cloud:
    """Points of one message.

    Args:
        channels: The fields by name, of shape (N,) each.
        transform_cloud_to_fixed: Where it is, shape (4, 4).
        received_ns: When it came, [ns].
    """

    channels: Mapping[str, Channel]
    transform_cloud_to_fixed: Matrix
    received_ns: int

    @property
    def positions(self) -> Floats:
        """The points in the frame of the cloud, shape (N, 3), [m]."""
        return np.stack([self.channels[axis] for axis in _XYZ], axis=-1).astype(np.float32)

    def is_single(self, name: str, *, or_whole: bool = False) -> bool:
        """Say whether there is a channel of that name in single precision, or also of 32-bit numbers."""
        kinds = ("f", "u") if or_whole else ("f",)
        return name in self.channels and _is_32_bits(self.channels[name], kinds)


def has_positions(message: Any) -> bool:
    """Say whether a sensor_msgs/msg/PointCloud2 has fields x, y and z."""
    return set(_XYZ) <= {field.name for field in message.fields}


def size_problem(message: Any) -> str | None:
    """Say in RViz's words how the sizes of a sensor_msgs/msg/PointCloud2 disagree."""
    width, height, step, size = message.width, message.height, message.point_step, len(message.data)
    if width * height * step == size:
        return None
    return (
        f"Data size ({size} bytes) does not match width ({width}) times height ({height}) times "
        f"point_step ({step}).  Dropping message."
    )


def channels_of(message: Any) -> tuple[dict[str, Channel], list[str]]:
    """Return the fields of a sensor_msgs/msg/PointCloud2 by name, only of points whose place is finite.

    Returns:
        Also what is wrong with fields that are left out.
    """
    count, step = message.width * message.height, message.point_step
    channels: dict[str, Channel] = {}
    wrong = []
    for field in reversed(message.fields):  # of two of one name the first one counts
        dtype = np.dtype(_TYPES.get(field.datatype, "V1")).newbyteorder(">" if message.is_bigendian else "<")
        if field.datatype not in _TYPES or field.offset + dtype.itemsize > step:
            wrong.append(
                f"field {field.name!r} (datatype {field.datatype}, offset {field.offset}) is no number "
                f"within the {step} bytes of a point."
            )
            continue
        place = (memoryview(message.data), field.offset, (step,))
        channels[field.name] = np.ndarray(count, dtype, *place) if count else np.empty(0, dtype)
    return _finite(channels), wrong


def _finite(channels: dict[str, Channel]) -> dict[str, Channel]:
    """Drop the points that are nowhere."""
    known = [np.isfinite(channels[axis]) for axis in _XYZ if axis in channels]
    if not known or all(axis.all() for axis in known):
        return channels
    kept = np.logical_and.reduce(known)
    return {name: channel[kept] for name, channel in channels.items()}


def _is_32_bits(channel: Channel, kinds: tuple[str, ...]) -> bool:
    return channel.dtype.itemsize == 4 and channel.dtype.kind in kinds
