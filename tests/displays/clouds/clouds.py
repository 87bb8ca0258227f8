"""Point clouds of any layout, for tests."""

from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt
from sensor_msgs.msg import PointCloud2, PointField

from course_lib.displays.display import Display
from course_lib.viewer.drawables import Points
from tests.displays.bench import Bench

TYPES = {"u1": 2, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}
TOPIC = "/cloud"
Order: TypeAlias = Literal["<", ">"]


def cloud(points: npt.NDArray[np.void], frame: str = "map", stamp_ns: int = 0) -> PointCloud2:
    """Create a cloud of a structured array: its fields, with their offsets and byte order."""
    dtype = points.dtype
    assert dtype.names
    assert dtype.fields
    message = PointCloud2(height=1, width=len(points), point_step=dtype.itemsize, data=points.tobytes())
    message.row_step = len(message.data)
    for name in dtype.names:
        kind, offset = dtype.fields[name][:2]
        message.is_bigendian |= kind.byteorder == ">"
        number = TYPES[f"{kind.kind}{kind.itemsize}"]
        message.fields.append(PointField(name=name, offset=offset, datatype=number, count=1))
    message.header.frame_id = frame
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, 10**9)
    return message


def plain(positions: npt.ArrayLike, order: Order = "<", **channels: Any) -> npt.NDArray[np.void]:
    """Join positions, shape (N, 3), and further channels to a structured array."""
    xyz = np.asarray(positions, np.float32).reshape(-1, 3)
    more = {name: np.asarray(values) for name, values in channels.items()}
    kinds = [(axis, f"{order}f4") for axis in "xyz"]
    kinds += [(name, values.dtype.newbyteorder(order).str) for name, values in more.items()]
    points = np.zeros(len(xyz), np.dtype(kinds))
    for name, values in {**dict(zip("xyz", xyz.T, strict=True)), **more}.items():
        points[name] = values
    return points


def points_of(bench: Bench, display: Display) -> list[Points]:
    """Return the drawables of a display, the oldest cloud first."""
    objects = bench.scene.objects()
    found = [drawable for path, drawable in objects.items() if path.startswith(display.path + "/")]
    assert all(isinstance(drawable, Points) for drawable in found)
    return found  # type: ignore[return-value]  # just looked at


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/PointCloud2", "Cloud", {"Topic": TOPIC}, **properties)
