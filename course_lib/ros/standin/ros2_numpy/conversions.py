"""Conversions of points, transforms, images and maps, and the registry by message type."""

import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from cv_bridge.core import encoding_of
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from nav_msgs.msg import MapMetaData, OccupancyGrid
from numpy.typing import NDArray
from sensor_msgs.msg import Image
from tf_transformations import quaternion_from_matrix, quaternion_matrix

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
