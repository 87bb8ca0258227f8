"""Encodings of images by name."""

import re
from dataclasses import dataclass

import numpy as np

# OpenCV's depths in the order of their numbers, and numpy's names for them.
DEPTHS = {
    "8U": "uint8", "8S": "int8", "16U": "uint16", "16S": "int16", "32S": "int32", "32F": "float32",
    "64F": "float64",
}  # fmt: skip
_CHANNELS = {"mono": 1, "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}
_COLOR = re.compile(r"(mono|rgba?|bgra?|bayer_(?:rggb|bggr|gbrg|grbg))(8|16)")
_GENERIC = re.compile(rf"({'|'.join(DEPTHS)})(?:C(\d+))?")
_YUV = ("yuv422", "yuv422_yuy2")


@dataclass(frozen=True)
class Encoding:
    """The meaning of a pixel: the order of its colors, like "bgra", "bayer_rggb" or "yuv422", or any numbers.

    Args:
        name: As in the message.
        order: Of the color's channels, or "".
        depth: OpenCV's name for the type of a channel.
        channels: In a pixel.
    """

    name: str
    order: str
    depth: str
    channels: int

    @property
    def dtype(self) -> "np.dtype[np.generic]":
        """The type of a channel."""
        return np.dtype(DEPTHS[self.depth])

    @property
    def bits(self) -> int:
        """Of a channel."""
        return self.dtype.itemsize * 8

    @property
    def cv_type(self) -> int:
        """OpenCV's number for the type of a pixel."""
        return list(DEPTHS).index(self.depth) + ((self.channels - 1) << 3)

    @property
    def cv_name(self) -> str:
        """OpenCV's name for the type of a pixel, like 8UC3."""
        return f"{self.depth}C{self.channels}"


def encoding_of(name: str) -> Encoding:
    """Return the encoding of a name; raises a RuntimeError for any other."""
    if color := _COLOR.fullmatch(name):
        return Encoding(name, color[1], f"{color[2]}U", _CHANNELS.get(color[1], 1))
    if name in _YUV:
        return Encoding(name, name, "8U", 2)
    if generic := _GENERIC.fullmatch(name):
        return Encoding(name, "", generic[1], int(generic[2] or 1))
    raise RuntimeError(f"Unrecognized image encoding [{name}]")
