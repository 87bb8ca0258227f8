"""Conversions between messages and numpy arrays: `numpify(message)` and `msgify(Type, array)`.

Messages are points, transforms, images, maps and point clouds. ROS's modules for them have the names
of this one; see `HOME_MODULES` and `SUBMODULES` of `course_lib.ros.programs.import_path`.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from cv_bridge.core import encoding_of
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from nav_msgs.msg import MapMetaData, OccupancyGrid
from numpy.typing import NDArray
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import Header
from tf_transformations import quaternion_from_matrix, quaternion_matrix

__all__ = ["geometry", "image", "msgify", "numpify", "occupancy_grid", "point_cloud2", "registry"]
Floats = NDArray[np.float64]
Converter = Callable[..., Any]
_Key = tuple[type[Any], bool]
_to_numpy: dict[_Key, Converter] = {}
_from_numpy: dict[_Key, Converter] = {}


def converts_to_numpy(msgtype: type[Any], plural: bool = False) -> Callable[[Converter], Converter]:
    """Register the decorated function with `numpify` for a type, or for lists of it if `plural`."""
    return lambda function: _to_numpy.setdefault((msgtype, plural), function)


def converts_from_numpy(
    msgtype: type[Any],
    plural: bool = False,
) -> Callable[[Converter], Converter]:
    """Register the decorated function with `msgify` for a type, or for lists of it if `plural`."""
    return lambda function: _from_numpy.setdefault((msgtype, plural), function)


def numpify(msg: Any, *args: Any, **kwargs: Any) -> Any:
    """Convert a message to an array. Further arguments are passed to the converter of its type.

    Raises:
        ValueError: There is no converter for the type, or the list is empty.
    """
    if msg is None:
        return None
    key: _Key = (type(msg), False)
    if key not in _to_numpy and isinstance(msg, Sequence):
        if not msg:
            raise ValueError("Cannot determine the type of an empty Collection")
        key = (type(msg[0]), True)
    if key not in _to_numpy:
        raise ValueError(
            f"Unable to convert message {key[0].__name__} - only supports {_list_names(_to_numpy)}"
        )
    return _to_numpy[key](msg, *args, **kwargs)


def msgify(
    msg_type: type[Any],
    numpy_obj: Any,
    *args: Any,
    plural: bool = False,
    **kwargs: Any,
) -> Any:
    """Convert an array to a message. Further arguments are passed to the converter of the type.

    Raises:
        ValueError: There is no converter for the type.
    """
    key = (msg_type, plural)
    if key not in _from_numpy:
        raise ValueError(
            f"Unable to build message {msg_type.__name__} - only supports {_list_names(_from_numpy)}"
        )
    return _from_numpy[key](numpy_obj, *args, **kwargs)


def _list_names(converters: dict[_Key, Converter]) -> str:
    return ", ".join(cls.__name__ + ("[]" if plural else "") for cls, plural in converters)


@converts_to_numpy(Vector3)
def vector3_to_numpy(msg: Vector3, hom: bool = False) -> Floats:
    """Return [x, y, z] or, if `hom` is true, the homogeneous coordinates [x, y, z, 0]."""
    return np.array([msg.x, msg.y, msg.z, 0.0] if hom else [msg.x, msg.y, msg.z])


@converts_from_numpy(Vector3)
def numpy_to_vector3(arr: Any) -> Any:
    """Convert 3 or 4 numbers to a vector, or an array with more axes to nested lists of vectors."""
    return _of_last_axis(Vector3, arr, homogeneous=0.0)


@converts_to_numpy(Point)
def point_to_numpy(msg: Point, hom: bool = False) -> Floats:
    """Return [x, y, z] or, if `hom` is true, the homogeneous coordinates [x, y, z, 1]."""
    return np.array([msg.x, msg.y, msg.z, 1.0] if hom else [msg.x, msg.y, msg.z])


@converts_from_numpy(Point)
def numpy_to_point(arr: Any) -> Any:
    """Convert 3 or 4 numbers to a point, or an array with more axes to a nested list of points."""
    return _of_last_axis(Point, arr, homogeneous=1.0)


@converts_to_numpy(Quaternion)
def quat_to_numpy(msg: Quaternion) -> Floats:
    """Return [x, y, z, w]."""
    return np.array([msg.x, msg.y, msg.z, msg.w])


@converts_from_numpy(Quaternion)
def numpy_to_quat(arr: Any) -> Any:
    """Convert [x, y, z, w] to a quaternion, or more axes to a nested list of quaternions."""
    values = np.asarray(arr, dtype=float)
    if values.shape[-1:] != (4,):
        raise ValueError(f"a quaternion has the four numbers x, y, z, w, not the shape {values.shape}")
    if values.ndim > 1:
        return [numpy_to_quat(value) for value in values]
    x, y, z, w = map(float, values)
    return Quaternion(x=x, y=y, z=z, w=w)


@converts_to_numpy(Transform)
def transform_to_numpy(msg: Transform) -> Floats:
    """Return the transformation matrix, shape (4, 4)."""
    return _matrix(vector3_to_numpy(msg.translation), quat_to_numpy(msg.rotation))


@converts_from_numpy(Transform)
def numpy_to_transform(arr: Any) -> Transform:
    """Convert a transformation matrix of shape (4, 4) to a Transform."""
    matrix = _as_transform(arr)
    return Transform(
        translation=numpy_to_vector3(matrix[:3, 3]), rotation=numpy_to_quat(quaternion_from_matrix(matrix))
    )


@converts_to_numpy(Pose)
def pose_to_numpy(msg: Pose) -> Floats:
    """Return the transformation matrix, shape (4, 4)."""
    return _matrix(point_to_numpy(msg.position), quat_to_numpy(msg.orientation))


@converts_from_numpy(Pose)
def numpy_to_pose(arr: Any) -> Pose:
    """Convert a transformation matrix of shape (4, 4) to a Pose."""
    matrix = _as_transform(arr)
    return Pose(
        position=numpy_to_point(matrix[:3, 3]), orientation=numpy_to_quat(quaternion_from_matrix(matrix))
    )


def _of_last_axis(cls: type[Any], arr: Any, homogeneous: float) -> Any:
    values = np.asarray(arr, dtype=float)
    if values.ndim > 1:
        return [_of_last_axis(cls, value, homogeneous) for value in values]
    if values.shape not in ((3,), (4,)):
        raise ValueError(f"a {cls.__name__} has three or four numbers, not the shape {values.shape}")
    if len(values) == 4:
        if homogeneous and values[3] == 0:
            raise ValueError("the fourth number of a point must not be 0")
        if not homogeneous and values[3] != 0:
            raise ValueError("the fourth number of a vector must be 0")
        values = values[:3] / values[3] if homogeneous else values[:3]
    x, y, z = map(float, values)
    return cls(x=x, y=y, z=z)


def _matrix(translation: Floats, quaternion: Floats) -> Floats:
    matrix = np.array(quaternion_matrix(quaternion))
    matrix[:3, 3] = translation
    return matrix


def _as_transform(arr: Any) -> Floats:
    matrix = np.asarray(arr, dtype=float)
    if matrix.shape != (4, 4):
        raise ValueError(f"a transform is a (4, 4) matrix, not of the shape {matrix.shape}")
    return matrix


@converts_to_numpy(Image)
def image_to_numpy(msg: Image) -> NDArray[Any]:
    """Return the pixels, shape (height, width) for one channel, else (height, width, channels).

    Raises:
        TypeError: The encoding is unknown.
    """
    dtype, channels = _format_of(msg.encoding)
    dtype = dtype.newbyteorder(">" if msg.is_bigendian else "<")
    rows = np.frombuffer(bytes(msg.data), np.uint8).reshape(msg.height, msg.step)
    image_bytes = np.ascontiguousarray(rows[:, : msg.width * channels * dtype.itemsize])
    pixels = image_bytes.view(dtype).reshape(msg.height, msg.width, channels)
    return pixels[..., 0] if channels == 1 else pixels


@converts_from_numpy(Image)
def numpy_to_image(arr: Any, encoding: str) -> Image:
    """Convert pixels of shape (height, width) or (height, width, channels) to an image.

    Raises:
        TypeError: The encoding is unknown, or the array does not have its type and number of
            channels.
    """
    dtype, expected = _format_of(encoding)
    pixels = np.asarray(arr)
    if pixels.ndim not in (2, 3):
        raise TypeError("Array must be two or three dimensional")
    height, width, channels = (*pixels.shape, 1)[:3]
    if channels != expected:
        raise TypeError(f"Array has {channels} channels, {encoding} requires {expected}")
    if pixels.dtype.type is not dtype.type:
        raise TypeError(f"Array is {pixels.dtype.type}, {encoding} requires {dtype.type}")
    is_native_big = pixels.dtype.byteorder == "=" and sys.byteorder == "big"
    return Image(
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=int(pixels.dtype.byteorder == ">" or is_native_big),
        step=width * channels * dtype.itemsize,
        data=np.ascontiguousarray(pixels).tobytes(),
    )


def _format_of(encoding: str) -> tuple["np.dtype[Any]", int]:
    try:
        parsed = encoding_of(encoding)
    except RuntimeError as error:
        raise TypeError(f"Unrecognized encoding {encoding}") from error
    return parsed.dtype, parsed.channels


@converts_to_numpy(OccupancyGrid)
def occupancygrid_to_numpy(msg: OccupancyGrid) -> "np.ma.MaskedArray[Any, np.dtype[np.int8]]":
    """Return the cells, shape (height, width). Unknown cells, with the value -1, are masked."""
    cells = np.asarray(msg.data, dtype=np.int8).reshape(msg.info.height, msg.info.width)
    return np.ma.array(cells, mask=cells == -1, fill_value=-1)


@converts_from_numpy(OccupancyGrid)
def numpy_to_occupancy_grid(arr: Any, info: MapMetaData | None = None) -> OccupancyGrid:
    """Convert cells of type int8, shape (height, width), to a map. Masked cells are unknown.

    Raises:
        TypeError: The array has another shape or type.
    """
    if np.ndim(arr) != 2:
        raise TypeError("Array must be 2D")
    if arr.dtype != np.int8:
        raise TypeError("Array must be of int8s")
    cells = arr.filled(-1) if isinstance(arr, np.ma.MaskedArray) else arr
    about = info or MapMetaData()
    about.height, about.width = map(int, cells.shape)
    return OccupancyGrid(info=about, data=cells.ravel().tolist())


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
