"""Conversions of point clouds: structured arrays, or separate arrays for coordinates and colors."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

from ros2_numpy.conversions import converts_from_numpy, converts_to_numpy

_DATATYPES = {
    np.dtype(name): getattr(PointField, name.upper())
    for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")
}


class CloudArray(np.ndarray[Any, np.dtype[Any]]):
    """A structured array of points with the keys "xyz" and "rgb", as newer versions of the package return.

    `["xyz"]` is an array of shape (N, 3). `["rgb"]` is the packed field if the cloud has one.
    """

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str) and key == "xyz" and "xyz" not in (self.dtype.names or ()):
            return get_xyz_points(np.asarray(self), remove_nans=False)
        item = super().__getitem__(key)
        return np.asarray(item) if isinstance(key, str) else item


@converts_to_numpy(PointCloud2)
def pointcloud2_to_array(cloud_msg: PointCloud2, squeeze: bool = True) -> CloudArray:
    """Convert a cloud to a structured array with its fields.

    The shape is (N,) for an unorganized cloud (one row) and (height, width) for an organized one.
    """
    dtype = fields_to_dtype(cloud_msg.fields, cloud_msg.point_step)
    dtype = dtype.newbyteorder(">" if cloud_msg.is_bigendian else "<")
    rows = np.frombuffer(bytes(cloud_msg.data), np.uint8)
    rows = rows.reshape(cloud_msg.height, cloud_msg.row_step or cloud_msg.width * cloud_msg.point_step)
    point_bytes = np.ascontiguousarray(rows[:, : cloud_msg.width * cloud_msg.point_step])
    points = point_bytes.view(dtype).reshape(cloud_msg.height, cloud_msg.width)
    return (points[0] if squeeze and cloud_msg.height == 1 else points).view(CloudArray)


@converts_from_numpy(PointCloud2)
def array_to_pointcloud2(
    cloud_arr: Any,
    stamp: Any = None,
    frame_id: str | None = None,
) -> PointCloud2:
    """Convert a structured array, or a mapping with `xyz`, `rgb` and `intensity`, to a cloud."""
    points = _structured_array(cloud_arr) if isinstance(cloud_arr, Mapping) else np.asarray(cloud_arr)
    if points.dtype.names is None:
        raise TypeError("a cloud is a structured array with the fields x, y and z, or a mapping with xyz")
    rows = np.atleast_2d(points)
    header = Header(frame_id=frame_id or "")
    if stamp is not None:
        header.stamp = stamp
    return PointCloud2(
        header=header,
        height=rows.shape[0],
        width=rows.shape[1],
        fields=dtype_to_fields(points.dtype),
        is_bigendian=False,
        point_step=points.dtype.itemsize,
        row_step=points.dtype.itemsize * rows.shape[1],
        data=np.ascontiguousarray(rows).tobytes(),
        is_dense=all(
            bool(np.isfinite(points[name]).all())
            for name in points.dtype.names
            if points.dtype[name].base.kind == "f"
        ),
    )


def fields_to_dtype(fields: Sequence[PointField], point_step: int) -> "np.dtype[Any]":
    """Return the structured type of one point, which is `point_step` bytes long."""
    kinds = {number: kind for kind, number in _DATATYPES.items()}
    formats: list[Any] = [
        kinds[field.datatype] if field.count == 1 else (kinds[field.datatype], (field.count,))
        for field in fields
    ]
    layout: Any = {
        "names": [field.name for field in fields],
        "formats": formats,
        "offsets": [field.offset for field in fields],
        "itemsize": point_step,
    }
    dtype: np.dtype[Any] = np.dtype(layout)
    return dtype


def dtype_to_fields(dtype: "np.dtype[Any]") -> list[PointField]:
    """Return the fields of a structured type.

    Names that begin with "_" are padding and left out.
    """
    fields = []
    places: Any = dtype.fields
    for name in dtype.names or ():
        kind, offset = places[name][:2]
        if name.startswith("_"):
            continue
        count = int(np.prod(kind.shape)) if kind.shape else 1
        datatype = _DATATYPES[kind.base.newbyteorder("=")]
        fields.append(PointField(name=name, offset=offset, datatype=datatype, count=count))
    return fields


def get_xyz_points(
    cloud_array: Any,
    remove_nans: bool = True,
    dtype: Any = np.float64,
) -> NDArray[Any]:
    """Return the coordinates of a structured array, shape (…, 3).

    With `remove_nans`, points with coordinates that are not finite are left out.
    """
    if remove_nans:
        finite = [np.isfinite(cloud_array[name]) for name in ("x", "y", "z")]
        cloud_array = cloud_array[np.logical_and.reduce(finite)]
    return np.stack([cloud_array[name] for name in ("x", "y", "z")], axis=-1).astype(dtype)


def pointcloud2_to_xyz_array(cloud_msg: PointCloud2, remove_nans: bool = True) -> NDArray[Any]:
    """Return the coordinates of a cloud, shape (N, 3)."""
    return get_xyz_points(np.asarray(pointcloud2_to_array(cloud_msg)), remove_nans=remove_nans)


def split_rgb_field(cloud_arr: Any) -> NDArray[Any]:
    """Return a copy in which the uint8 fields r, g and b replace the field rgb."""
    packed_colors = np.ascontiguousarray(cloud_arr["rgb"]).view(np.uint32)
    names = [name for name in cloud_arr.dtype.names if name != "rgb"]
    kinds = [(name, cloud_arr.dtype[name]) for name in names] + [(name, np.uint8) for name in "rgb"]
    split = np.zeros(cloud_arr.shape, dtype=kinds)
    for name in names:
        split[name] = cloud_arr[name]
    for name, shift in (("r", 16), ("g", 8), ("b", 0)):
        split[name] = (packed_colors >> shift) & 255
    return split


def merge_rgb_fields(cloud_arr: Any) -> NDArray[Any]:
    """Return a copy whose field rgb, packed into a float32, replaces the fields r, g and b."""
    names = [name for name in cloud_arr.dtype.names if name not in ("r", "g", "b")]
    merged: Any = np.zeros(
        cloud_arr.shape, dtype=[(name, cloud_arr.dtype[name]) for name in names] + [("rgb", np.float32)]
    )
    for name in names:
        merged[name] = cloud_arr[name]
    shifted: list[Any] = [
        np.asarray(cloud_arr[name]).astype(np.uint32) << shift
        for name, shift in zip("rgb", (16, 8, 0), strict=True)
    ]
    packed_colors = shifted[0] | shifted[1] | shifted[2]
    merged["rgb"] = packed_colors.view(np.float32)
    # numpy's type stubs support one element type only.
    return merged  # type: ignore[no-any-return]


def _structured_array(parts: Mapping[str, Any]) -> NDArray[Any]:
    if "xyz" not in parts:
        raise ValueError('a mapping needs the coordinates: {"xyz": array of the shape (N, 3)}')
    xyz = np.asarray(parts["xyz"], dtype=np.float32).reshape(-1, 3)
    split = {name: xyz[:, column] for column, name in enumerate("xyz")}
    if "rgb" in parts:
        r, g, b = np.asarray(parts["rgb"]).reshape(-1, 3).astype(np.uint32).T
        packed_colors: Any = (r << 16) | (g << 8) | b
        split["rgb"] = packed_colors
    if "intensity" in parts:
        split["intensity"] = np.asarray(parts["intensity"], dtype=np.float32).ravel()
    points = np.zeros(len(xyz), dtype=[(name, values.dtype) for name, values in split.items()])
    for name, values in split.items():
        points[name] = values
    return points
