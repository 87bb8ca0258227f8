"""Conversions between image messages and numpy arrays in OpenCV's channel order."""

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
import numpy.typing as npt
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

# OpenCV's depths in numeric order, with the corresponding numpy types.
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
    """The meaning of a pixel: colors, in an order such as "bgra" or "bayer_rggb", or other numbers.

    Args:
        name: The encoding as in the message.
        order: The order of the color channels, or "" if the numbers are not colors.
        depth: OpenCV's name for the type of a channel.
        channels: The number of channels of a pixel.
    """

    name: str
    order: str
    depth: str
    channels: int

    @property
    def dtype(self) -> "np.dtype[np.generic]":
        """The numpy type of a channel."""
        return np.dtype(DEPTHS[self.depth])

    @property
    def bits(self) -> int:
        """The number of bits of a channel."""
        return self.dtype.itemsize * 8

    @property
    def cv_type(self) -> int:
        """OpenCV's number for the type of a pixel."""
        return list(DEPTHS).index(self.depth) + ((self.channels - 1) << 3)


def encoding_of(name: str) -> Encoding:
    """Return the encoding with this name. Raise a RuntimeError if there is none."""
    if color := _COLOR.fullmatch(name):
        return Encoding(name, color[1], f"{color[2]}U", _CHANNELS.get(color[1], 1))
    if name in _YUV:
        return Encoding(name, name, "8U", 2)
    if generic := _GENERIC.fullmatch(name):
        return Encoding(name, "", generic[1], int(generic[2] or 1))
    raise RuntimeError(f"Unrecognized image encoding [{name}]")


Pixels = npt.NDArray[Any]  # shape (rows, columns) or (rows, columns, channels)

# OpenCV's weights of the channels for a gray value, in units of 2**-15.
_GRAY = {"r": 9798, "g": 19235, "b": 3735}
# OpenCV's weights for Bayer patterns, in units of 2**-14.
_BAYER_GRAY = {"r": 4899, "g": 9617, "b": 1868}
# BT.601 in units of 2**-20: the weight of Y - 16, and for each color the weights of U - 128 and V
# - 128.
_LUMA, _CHROMA = 1220542, {"r": (0, 1673527), "g": (-409993, -852492), "b": (2116026, 0)}
# The index of the chroma channel (U or V) and of the luma channel Y.
_PARTS = {"yuv422": (0, 1), "yuv422_yuy2": (1, 0)}


def convert(pixels: Pixels, source: str, target: str) -> Pixels:
    """Convert pixels to another encoding. Raise a RuntimeError if the conversion makes no sense."""
    if target in ("", source):
        return pixels.copy()
    old, new = encoding_of(source), encoding_of(target)
    if old.order and new.order:
        targets = {"mono", "rgb", "bgr"}
        targets |= set() if old.order.startswith("bayer") else {"rgba", "bgra"}
        targets |= {"yuv422"} if old.order == "yuv422" else set()
        if new.order not in targets:
            raise RuntimeError(f"Unsupported conversion from [{old.name}] to [{new.name}]")
    elif new.order:
        raise RuntimeError(
            f"[{old.name}] is not a color format. but [{new.name}] is. The conversion does not make sense"
        )
    elif old.channels != new.channels and old.order:
        raise RuntimeError(
            f"[{old.name}] is a color format but [{new.name}] is not so they must have the same "
            "OpenCV type, CV_8UC3, CV16UC1 ...."
        )
    elif old.channels != new.channels:
        raise RuntimeError(f"[{old.name}] and [{new.name}] do not have the same number of channel")
    if old.order == new.order or not (old.order and new.order):
        return _convert_depth(pixels, old, new)
    converted = _convert_colors(pixels, old, new)
    return converted if old.bits == new.bits else _convert_depth(converted, old, new)


def _convert_depth(pixels: Pixels, old: Encoding, new: Encoding) -> Pixels:
    """Convert pixels to another depth.

    Between 8 and 16 bits the values are scaled to the full range.
    """
    factor = {(8, 16): 65535.0 / 255.0, (16, 8): 255.0 / 65535.0}.get((old.bits, new.bits), 1.0)
    stretched: Pixels = pixels.astype(np.float64) * factor
    if new.dtype.kind == "f":
        return stretched.astype(new.dtype)
    limits = np.iinfo(new.dtype.name)
    return np.clip(np.rint(stretched), limits.min, limits.max).astype(new.dtype)


def _convert_colors(pixels: Pixels, old: Encoding, new: Encoding) -> Pixels:
    if old.order.startswith("bayer"):
        planes = _bayer_planes(pixels, old.order.removeprefix("bayer_"))
        if new.order == "mono":
            return _gray(planes, _BAYER_GRAY, 16).astype(pixels.dtype)
        planes = {name: (plane + 2) >> 2 for name, plane in planes.items()}
    elif old.order in _PARTS:
        chroma, luma = _PARTS[old.order]
        if new.order == "mono":
            return pixels[..., luma].copy()
        # In a 4:2:2 image, two neighboring pixels share U and V.
        bright = np.maximum(pixels[..., luma].astype(np.int64) - 16, 0) * _LUMA
        u, v = (np.repeat(pixels[:, start::2, chroma].astype(np.int64) - 128, 2, axis=1) for start in (0, 1))
        sums = {name: bright + u * for_u + v * for_v for name, (for_u, for_v) in _CHROMA.items()}
        planes = {name: np.clip((total + (1 << 19)) >> 20, 0, 255) for name, total in sums.items()}
    elif old.order == "mono":
        planes = dict.fromkeys("rgb", pixels)
    else:
        planes = {name: pixels[..., place] for place, name in enumerate(old.order)}
    if new.order == "mono":
        return _gray(planes, _GRAY, 15).astype(pixels.dtype)
    planes.setdefault("a", np.full(pixels.shape[:2], np.iinfo(pixels.dtype).max))
    return np.stack([planes[name] for name in new.order], axis=-1).astype(pixels.dtype)


def _gray(planes: Mapping[str, Pixels], weights: Mapping[str, int], bits: int) -> Pixels:
    """Return the rounded weighted sum of the colors, with weights in units of 2**-bits."""
    rows = [planes[name].astype(np.int64) * weight for name, weight in weights.items()]
    total: Pixels = np.sum(rows, axis=0)
    return (total + (1 << bits - 1)) >> bits


def _bayer_planes(pixels: Pixels, pattern: str) -> dict[str, Pixels]:
    """Return four times the color planes of a Bayer pattern, as means of neighboring pixels.

    Pixels at the image's border get the values of their inner neighbors.
    """
    rows, columns = pixels.shape
    wide = pixels.astype(np.int64)
    centre, planes = wide[1:-1, 1:-1], {name: np.zeros((rows, columns), np.int64) for name in "rgb"}
    beside = 2 * (wide[1:-1, :-2] + wide[1:-1, 2:])
    above = 2 * (wide[:-2, 1:-1] + wide[2:, 1:-1])
    corners = wide[:-2, :-2] + wide[:-2, 2:] + wide[2:, :-2] + wide[2:, 2:]
    for place in range(4):
        row, column = divmod(place, 2)
        # Slices relative to the image without its border.
        cells = (slice(1 - row, None, 2), slice(1 - column, None, 2))
        color, next_to = pattern[place], pattern[place ^ 1]
        inner = {name: plane[1:-1, 1:-1] for name, plane in planes.items()}
        inner[color][cells] = 4 * centre[cells]
        if color == "g":
            inner[next_to][cells] = beside[cells]
            inner["b" if next_to == "r" else "r"][cells] = above[cells]
        else:
            inner["g"][cells] = (beside[cells] + above[cells]) // 2
            inner["b" if color == "r" else "r"][cells] = corners[cells]
    return {name: np.pad(plane[1:-1, 1:-1], 1, mode="edge") for name, plane in planes.items()}


# OpenCV's default.
JPEG_QUALITY = 95
_FORMATS = {
    **dict.fromkeys(("jpg", "jpeg", "jpe"), "JPEG"), "png": "PNG", **dict.fromkeys(("bmp", "dib"), "BMP"),
    **dict.fromkeys(("tif", "tiff"), "TIFF"), **dict.fromkeys(("pbm", "pgm", "ppm"), "PPM"), "webp": "WEBP",
    "jp2": "JPEG2000",
}  # fmt: skip


class CvBridgeError(TypeError):
    """A conversion is not possible."""


class CvBridge:
    """Converts image messages. OpenCV itself is not needed."""

    def __init__(self) -> None:
        self.numpy_type_to_cvtype = {name: depth for depth, name in DEPTHS.items()} | DEPTHS
        self.cvdepth_to_numpy_depth = dict(enumerate(DEPTHS.values()))
        # OpenCV's names for the types of pixels, such as 8UC3, by number.
        self.cvtype_to_name = {
            Encoding("", "", depth, channels).cv_type: f"{depth}C{channels}"
            for depth in DEPTHS
            for channels in range(1, 5)
        }

    def dtype_with_channels_to_cvtype2(self, dtype: "np.dtype[Any]", n_channels: int) -> str:
        """Return OpenCV's name for a type, such as 8UC3.

        Raise KeyError if OpenCV has no such type.
        """
        return f"{self.numpy_type_to_cvtype[dtype.name]}C{n_channels}"

    def cvtype2_to_dtype_with_channels(self, cvtype: int) -> tuple[str, int]:
        """Return numpy's name for the depth of an OpenCV type, and the number of channels."""
        return self.cvdepth_to_numpy_depth[cvtype & 7], (cvtype >> 3) + 1

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """Return OpenCV's number for the type of an encoding's pixels."""
        try:
            return encoding_of(encoding).cv_type
        except RuntimeError as error:
            raise CvBridgeError(error) from None

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return numpy's name for the depth of an encoding, and the number of channels."""
        return self.cvtype2_to_dtype_with_channels(self.encoding_to_cvtype2(encoding))

    def imgmsg_to_cv2(self, img_msg: Image, desired_encoding: str = "passthrough") -> Pixels:
        """Return the pixels of a message, in its own encoding or converted to another one.

        Raises:
            CvBridgeError: The encoding or the conversion does not exist.
        """
        name, channels = self.encoding_to_dtype_with_channels(img_msg.encoding)
        dtype = np.dtype(name).newbyteorder(">" if img_msg.is_bigendian else "<")
        columns = img_msg.step // dtype.itemsize // channels
        rows = np.ndarray((img_msg.height, columns, channels), dtype, buffer=img_msg.data)
        pixels = np.ascontiguousarray(rows[:, : img_msg.width], dtype.newbyteorder("="))
        pixels = pixels[..., 0] if channels == 1 else pixels
        if desired_encoding == "passthrough":
            return pixels
        return _convert(pixels, img_msg.encoding, desired_encoding)

    def compressed_imgmsg_to_cv2(
        self, cmprs_img_msg: CompressedImage, desired_encoding: str = "passthrough"
    ) -> Pixels:
        """Return the pixels of a compressed message: gray, BGR or BGRA, or in another encoding."""
        from PIL import Image as Picture
        from PIL import UnidentifiedImageError

        try:
            picture = Picture.open(BytesIO(bytes(cmprs_img_msg.data)))
            pixels = np.asarray(picture.convert("RGB") if picture.mode in ("P", "CMYK", "YCbCr") else picture)
        except (UnidentifiedImageError, OSError) as error:
            raise CvBridgeError(f"The compressed image cannot be read: {error}") from None
        if pixels.dtype == np.int32:
            pixels = pixels.astype(np.uint16)
        if pixels.ndim > 2:
            pixels = np.ascontiguousarray(pixels[..., _blue_first(pixels)])
        return pixels if desired_encoding == "passthrough" else _convert(pixels, "bgr8", desired_encoding)

    def cv2_to_imgmsg(
        self, cvim: Pixels, encoding: str = "passthrough", header: Header | None = None
    ) -> Image:
        """Convert pixels to a message. `encoding` labels the pixels but does not convert them.

        Raises:
            CvBridgeError: The pixels do not have the type of the encoding.
        """
        cv_type = self.dtype_with_channels_to_cvtype2(*_type_of(cvim))
        if encoding != "passthrough" and self.cvtype_to_name[self.encoding_to_cvtype2(encoding)] != cv_type:
            raise CvBridgeError(
                f"encoding specified as {encoding}, but image has incompatible type {cv_type}"
            )
        message = Image(height=cvim.shape[0], width=cvim.shape[1])
        if header is not None:
            message.header = header
        message.encoding = cv_type if encoding == "passthrough" else encoding
        swapped = cvim.dtype.byteorder == ">" or (cvim.dtype.byteorder == "=" and sys.byteorder == "big")
        message.is_bigendian = int(swapped)
        message.data.frombytes(cvim.tobytes())
        message.step = len(message.data) // message.height
        return message

    def cv2_to_compressed_imgmsg(self, cvim: Pixels, dst_format: str = "jpg") -> CompressedImage:
        """Compress pixels (gray, BGR or BGRA) into a message, in a format such as jpg or png."""
        from PIL import Image as Picture

        _type_of(cvim)
        if dst_format.lower() not in _FORMATS:
            raise CvBridgeError(f"could not find a writer for the specified extension .{dst_format}")
        flat = cvim[..., 0] if cvim.ndim == 3 and cvim.shape[2] == 1 else cvim
        ordered = flat if flat.ndim == 2 else flat[..., _blue_first(flat)]
        picture = Picture.fromarray(np.ascontiguousarray(ordered))
        kind, file = _FORMATS[dst_format.lower()], BytesIO()
        if kind == "JPEG":
            # A JPEG file has no transparency.
            picture = picture.convert("RGB") if picture.mode == "RGBA" else picture
            picture.save(file, kind, quality=JPEG_QUALITY)
        else:
            picture.save(file, kind)
        message = CompressedImage(format=dst_format)
        message.data.frombytes(file.getvalue())
        return message


def _type_of(cvim: Any) -> tuple["np.dtype[Any]", int]:
    if not isinstance(cvim, np.ndarray | np.generic):
        raise TypeError("Your input type is not a numpy array")
    shape: tuple[int, ...] = cvim.shape
    return cvim.dtype, 1 if len(shape) < 3 else shape[2]


def _convert(pixels: Pixels, source: str, target: str) -> Pixels:
    try:
        return convert(pixels, source, target)
    except RuntimeError as error:
        raise CvBridgeError(error) from None


def _blue_first(pixels: Pixels) -> list[int]:
    """Return the channel indices that swap red and blue."""
    return [2, 1, 0, 3][: pixels.shape[2]]
