"""Conversions between point clouds and numpy arrays (sensor_msgs_py of common_interfaces)."""

import sys
from array import array
from collections import namedtuple
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured, unstructured_to_structured
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

DUMMY_FIELD_PREFIX = "unnamed_field"
_DATATYPES = {
    getattr(PointField, kind.upper()): np.dtype(kind)
    for kind in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")
}


def read_points(
    cloud: PointCloud2,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> "np.ndarray[Any, Any]":
    """Read points as a structured array with one column per field.

    Args:
        cloud: The message.
        field_names: The fields to read; None: all.
        skip_nans: Whether points with a NaN are left out. Has no effect if the cloud is marked as
            dense.
        uvs: Indices of the points to read; None: all.
        reshape_organized_cloud: Whether an organized cloud is returned in the shape (width,
            height), as in ROS.
    """
    assert isinstance(cloud, PointCloud2), "Cloud is not a sensor_msgs.msg.PointCloud2"
    kind = dtype_from_fields(cloud.fields, point_step=cloud.point_step)
    points = np.ndarray(shape=(cloud.width * cloud.height,), dtype=kind, buffer=cloud.data)
    if field_names is not None:
        names = list(field_names)
        available_names = points.dtype.names or ()
        assert all(name in available_names for name in names), (
            "Requests field is not in the fields of the PointCloud!"
        )
        points = points[names]
    if cloud.is_bigendian != (sys.byteorder != "little"):
        points = points.byteswap()
    if skip_nans and not cloud.is_dense:
        for name in points.dtype.names or ():
            points = points[~np.isnan(points[name])]
    if uvs is not None:
        points = points[uvs if isinstance(uvs, np.ndarray) else np.fromiter(uvs, int)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.width, cloud.height)
    return points


def read_points_numpy(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> "np.ndarray[Any, Any]":
    """Read points as an array of shape (points, fields). All fields must have the same type."""
    assert all(
        field.datatype == cloud.fields[0].datatype
        for field in cloud.fields[1:]
        if field_names is None or field.name in field_names
    ), "All fields need to have the same datatype. Use `read_points()` otherwise."
    return structured_to_unstructured(
        read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    )


def read_points_list(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
) -> list[Any]:
    """Read points as named tuples."""
    names = [field.name for field in cloud.fields] if field_names is None else field_names
    # The field names are known at run time only.
    point: Any = namedtuple("Point", names)  # type: ignore[misc]
    return [point._make(values) for values in read_points(cloud, names, skip_nans, uvs)]


def dtype_from_fields(
    fields: Iterable[PointField],
    point_step: int | None = None,
) -> "np.dtype[Any]":
    """Return the numpy type of one point, `point_step` bytes long, with a column for each value."""
    columns: dict[str, tuple[str, int]] = {}
    for number, field in enumerate(fields):
        kind = _DATATYPES[field.datatype]
        name = field.name or f"{DUMMY_FIELD_PREFIX}_{number}"
        assert field.count > 0, "Can't process fields with count = 0."
        for part in range(field.count):
            column = f"{name}_{part}" if field.count > 1 else name
            assert column not in columns, "Duplicate field names are not allowed!"
            columns[column] = kind.str, field.offset + part * kind.itemsize
    formats, offsets = zip(*columns.values(), strict=True) if columns else ((), ())
    layout: dict[str, Any] = {"names": list(columns), "formats": list(formats), "offsets": list(offsets)}
    return np.dtype(layout if point_step is None else {**layout, "itemsize": point_step})  # type: ignore[call-overload,no-any-return]  # numpy's stubs know no such dict


def create_cloud(
    header: Header,
    fields: Sequence[PointField],
    points: Iterable[Any],
    point_step: int | None = None,
) -> PointCloud2:
    """Create a cloud from an array (points, fields), a structured array, or rows of values."""
    kind = dtype_from_fields(fields, point_step)
    if not isinstance(points, np.ndarray):
        structured = np.array([tuple(point) for point in points], dtype=kind)
    elif points.dtype.names is None:
        same = all(field.datatype == fields[0].datatype for field in fields[1:])
        assert same, "All fields need to have the same datatype. Pass a structured NumPy array otherwise."
        structured = unstructured_to_structured(points, dtype=kind)
    else:
        assert points.dtype == kind, (
            "PointFields and structured NumPy array dtype do not match for all fields! Check their "
            "field order, names and types."
        )
        structured = points
    assert structured.ndim <= 2, "Too many dimensions for organized cloud!"
    cloud = PointCloud2(
        header=header,
        height=structured.shape[1] if structured.ndim == 2 else 1,
        width=structured.shape[0],
        is_dense=False,
        is_bigendian=sys.byteorder != "little",
        fields=list(fields),
        point_step=structured.dtype.itemsize,
        row_step=structured.dtype.itemsize * structured.shape[0],
    )
    cloud.data = array("B", structured.tobytes())
    return cloud


def create_cloud_xyz32(header: Header, points: Iterable[Any]) -> PointCloud2:
    """Create a cloud from points (x, y, z), [m]."""
    fields = [
        PointField(name=name, offset=4 * number, datatype=PointField.FLOAT32, count=1)
        for number, name in enumerate("xyz")
    ]
    return create_cloud(header, fields, points)
