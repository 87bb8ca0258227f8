"""Conversions of images."""

import sys
from typing import Any

import numpy as np
from cv_bridge.core import encoding_of
from numpy.typing import NDArray
from sensor_msgs.msg import Image

from ros2_numpy.registry import converts_from_numpy, converts_to_numpy


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
