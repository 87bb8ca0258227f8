"""Conversions between encodings, with OpenCV's own whole numbers: equal pictures, bit for bit."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

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


Pixels = npt.NDArray[Any]  # shape (rows, columns) or (rows, columns, channels)

_GRAY = {"r": 9798, "g": 19235, "b": 3735}  # of 2**15
_BAYER_GRAY = {"r": 4899, "g": 9617, "b": 1868}  # of 2**14
# BT.601 of 2**20: what Y - 16 gives, and for each color what U - 128 and V - 128 give.
_LUMA, _CHROMA = 1220542, {"r": (0, 1673527), "g": (-409993, -852492), "b": (2116026, 0)}
_PARTS = {"yuv422": (0, 1), "yuv422_yuy2": (1, 0)}  # the channels of U or V, and of Y


def convert(pixels: Pixels, source: str, target: str) -> Pixels:
    """Return pixels in another encoding; raises a RuntimeError where that makes no sense."""
    if target in ("", source):
        return pixels.copy()
    one, other = encoding_of(source), encoding_of(target)
    _check(one, other)
    if one.order == other.order or not (one.order and other.order):
        return _scaled(pixels, one, other)
    converted = _colored(pixels, one, other)
    return converted if one.bits == other.bits else _scaled(converted, one, other)


def _check(one: Encoding, other: Encoding) -> None:
    if one.order and other.order:
        if other.order not in _targets(one.order):
            raise RuntimeError(f"Unsupported conversion from [{one.name}] to [{other.name}]")
    elif other.order:
        raise RuntimeError(
            f"[{one.name}] is not a color format. but [{other.name}] is. The conversion does not make sense"
        )
    elif one.channels != other.channels and one.order:
        raise RuntimeError(
            f"[{one.name}] is a color format but [{other.name}] is not so they must have the same OpenCV "
            "type, CV_8UC3, CV16UC1 ...."
        )
    elif one.channels != other.channels:
        raise RuntimeError(f"[{one.name}] and [{other.name}] do not have the same number of channel")


def _targets(order: str) -> tuple[str, ...]:
    if order.startswith("bayer"):
        return ("mono", "rgb", "bgr")
    return ("mono", "rgb", "bgr", "rgba", "bgra", *(("yuv422",) if order == "yuv422" else ()))


def _scaled(pixels: Pixels, one: Encoding, other: Encoding) -> Pixels:
    """Return pixels of another depth; between 8 and 16 bits the whole range is stretched."""
    factor = {(8, 16): 65535.0 / 255.0, (16, 8): 255.0 / 65535.0}.get((one.bits, other.bits), 1.0)
    stretched: Pixels = pixels.astype(np.float64) * factor
    if other.dtype.kind == "f":
        return stretched.astype(other.dtype)
    limits = np.iinfo(other.dtype.name)
    return np.clip(np.rint(stretched), limits.min, limits.max).astype(other.dtype)


def _colored(pixels: Pixels, one: Encoding, other: Encoding) -> Pixels:
    if one.order.startswith("bayer"):
        planes = _bayer_planes(pixels, one.order.removeprefix("bayer_"))
        if other.order == "mono":
            return _gray(planes, _BAYER_GRAY, 16).astype(pixels.dtype)
        planes = {name: (plane + 2) >> 2 for name, plane in planes.items()}
    elif one.order in _PARTS:
        if other.order == "mono":
            return pixels[..., _PARTS[one.order][1]].copy()
        planes = _yuv_planes(pixels, *_PARTS[one.order])
    elif one.order == "mono":
        planes = dict.fromkeys("rgb", pixels)
    else:
        planes = {name: pixels[..., place] for place, name in enumerate(one.order)}
    if other.order == "mono":
        return _gray(planes, _GRAY, 15).astype(pixels.dtype)
    planes.setdefault("a", np.full(pixels.shape[:2], np.iinfo(pixels.dtype).max))
    return np.stack([planes[name] for name in other.order], axis=-1).astype(pixels.dtype)


def _gray(planes: Mapping[str, Pixels], weights: Mapping[str, int], bits: int) -> Pixels:
    """Return the weighted sum of the colors, rounded, in parts of 2**bits."""
    rows = [planes[name].astype(np.int64) * weight for name, weight in weights.items()]
    total: Pixels = np.sum(rows, axis=0)
    return (total + (1 << bits - 1)) >> bits


def _yuv_planes(pixels: Pixels, chroma: int, luma: int) -> dict[str, Pixels]:
    """Return the colors of pixels that share U and V in pairs."""
    bright = np.maximum(pixels[..., luma].astype(np.int64) - 16, 0) * _LUMA
    u, v = (np.repeat(pixels[:, start::2, chroma].astype(np.int64) - 128, 2, axis=1) for start in (0, 1))
    sums = {name: bright + u * for_u + v * for_v for name, (for_u, for_v) in _CHROMA.items()}
    return {name: np.clip((total + (1 << 19)) >> 20, 0, 255) for name, total in sums.items()}


def _bayer_planes(pixels: Pixels, pattern: str) -> dict[str, Pixels]:
    """Return four times the colors, as the means of neighbours; the rim is as what is next to it."""
    rows, columns = pixels.shape
    wide = pixels.astype(np.int64)
    centre, planes = wide[1:-1, 1:-1], {name: np.zeros((rows, columns), np.int64) for name in "rgb"}
    beside = 2 * (wide[1:-1, :-2] + wide[1:-1, 2:])
    above = 2 * (wide[:-2, 1:-1] + wide[2:, 1:-1])
    corners = wide[:-2, :-2] + wide[:-2, 2:] + wide[2:, :-2] + wide[2:, 2:]
    for place in range(4):
        row, column = divmod(place, 2)
        cells = (slice(1 - row, None, 2), slice(1 - column, None, 2))  # of what is within the rim
        mine, next_to = pattern[place], pattern[place ^ 1]
        inner = {name: plane[1:-1, 1:-1] for name, plane in planes.items()}
        inner[mine][cells] = 4 * centre[cells]
        if mine == "g":
            inner[next_to][cells] = beside[cells]
            inner["b" if next_to == "r" else "r"][cells] = above[cells]
        else:
            inner["g"][cells] = (beside[cells] + above[cells]) // 2
            inner["b" if mine == "r" else "r"][cells] = corners[cells]
    return {name: np.pad(plane[1:-1, 1:-1], 1, mode="edge") for name, plane in planes.items()}
