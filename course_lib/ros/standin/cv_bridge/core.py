"""Image messages as numpy arrays in OpenCV's order of channels, and back."""

import sys
from io import BytesIO
from typing import Any

import numpy as np
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from cv_bridge.colors import DEPTHS, Encoding, Pixels, convert, encoding_of

JPEG_QUALITY = 95  # OpenCV's
_FORMATS = {
    **dict.fromkeys(("jpg", "jpeg", "jpe"), "JPEG"), "png": "PNG", **dict.fromkeys(("bmp", "dib"), "BMP"),
    **dict.fromkeys(("tif", "tiff"), "TIFF"), **dict.fromkeys(("pbm", "pgm", "ppm"), "PPM"), "webp": "WEBP",
    "jp2": "JPEG2000",
}  # fmt: skip


class CvBridgeError(TypeError):
    """A conversion that is not possible."""


class CvBridge:
    """Conversions of messages; OpenCV itself is not needed."""

    def __init__(self) -> None:
        self.numpy_type_to_cvtype = {name: depth for depth, name in DEPTHS.items()} | DEPTHS
        self.cvdepth_to_numpy_depth = dict(enumerate(DEPTHS.values()))
        generic = [Encoding("", "", depth, channels) for depth in DEPTHS for channels in range(1, 5)]
        self.cvtype_to_name = {one.cv_type: one.cv_name for one in generic}

    def dtype_with_channels_to_cvtype2(self, dtype: "np.dtype[Any]", n_channels: int) -> str:
        """Return OpenCV's name for a type, like 8UC3; raises KeyError for what OpenCV has no type."""
        return f"{self.numpy_type_to_cvtype[dtype.name]}C{n_channels}"

    def cvtype2_to_dtype_with_channels(self, cvtype: int) -> tuple[str, int]:
        """Return numpy's name for the depth of an OpenCV type, and its channels."""
        return self.cvdepth_to_numpy_depth[cvtype & 7], (cvtype >> 3) + 1

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """Return OpenCV's number for the type of an encoding."""
        try:
            return encoding_of(encoding).cv_type
        except RuntimeError as error:
            raise CvBridgeError(error) from None

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return numpy's name for the depth of an encoding, and its channels."""
        return self.cvtype2_to_dtype_with_channels(self.encoding_to_cvtype2(encoding))

    def imgmsg_to_cv2(self, img_msg: Image, desired_encoding: str = "passthrough") -> Pixels:
        """Return the pixels of a message, in its own encoding or another one.

        Raises:
            CvBridgeError: There is no such encoding, or no such conversion.
        """
        name, channels = self.encoding_to_dtype_with_channels(img_msg.encoding)
        dtype = np.dtype(name).newbyteorder(">" if img_msg.is_bigendian else "<")
        columns = img_msg.step // dtype.itemsize // channels
        rows = np.ndarray((img_msg.height, columns, channels), dtype, buffer=img_msg.data)
        pixels = np.ascontiguousarray(rows[:, : img_msg.width], dtype.newbyteorder("="))
        pixels = pixels[..., 0] if channels == 1 else pixels
        if desired_encoding == "passthrough":
            return pixels
        return _converted(pixels, img_msg.encoding, desired_encoding)

    def compressed_imgmsg_to_cv2(
        self, cmprs_img_msg: CompressedImage, desired_encoding: str = "passthrough"
    ) -> Pixels:
        """Return the pixels of a compressed message: gray, BGR or BGRA, or in another encoding."""
        pixels = _decoded(bytes(cmprs_img_msg.data))
        return pixels if desired_encoding == "passthrough" else _converted(pixels, "bgr8", desired_encoding)

    def cv2_to_imgmsg(
        self, cvim: Pixels, encoding: str = "passthrough", header: Header | None = None
    ) -> Image:
        """Return pixels as a message; the encoding only names what they are.

        Raises:
            CvBridgeError: The pixels are of another type.
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
        """Return pixels, gray, BGR or BGRA, as a message in a format of files, like jpg or png."""
        _type_of(cvim)
        message = CompressedImage(format=dst_format)
        message.data.frombytes(_encoded(cvim, dst_format))
        return message


def _type_of(cvim: Any) -> tuple["np.dtype[Any]", int]:
    if not isinstance(cvim, np.ndarray | np.generic):
        raise TypeError("Your input type is not a numpy array")
    shape: tuple[int, ...] = cvim.shape
    return cvim.dtype, 1 if len(shape) < 3 else shape[2]


def _converted(pixels: Pixels, source: str, target: str) -> Pixels:
    try:
        return convert(pixels, source, target)
    except RuntimeError as error:
        raise CvBridgeError(error) from None


def _decoded(data: bytes) -> Pixels:
    from PIL import Image as Picture
    from PIL import UnidentifiedImageError

    try:
        picture = Picture.open(BytesIO(data))
        pixels = np.asarray(picture.convert("RGB") if picture.mode in ("P", "CMYK", "YCbCr") else picture)
    except (UnidentifiedImageError, OSError) as error:
        raise CvBridgeError(f"The compressed image cannot be read: {error}") from None
    if pixels.dtype == np.int32:
        pixels = pixels.astype(np.uint16)
    return pixels if pixels.ndim == 2 else np.ascontiguousarray(pixels[..., _blue_first(pixels)])


def _encoded(pixels: Pixels, name: str) -> bytes:
    from PIL import Image as Picture

    if name.lower() not in _FORMATS:
        raise CvBridgeError(f"could not find a writer for the specified extension .{name}")
    flat = pixels[..., 0] if pixels.ndim == 3 and pixels.shape[2] == 1 else pixels
    kind, file = _FORMATS[name.lower()], BytesIO()
    ordered = flat if flat.ndim == 2 else flat[..., _blue_first(flat)]
    picture = Picture.fromarray(np.ascontiguousarray(ordered))
    options = {"quality": JPEG_QUALITY} if kind == "JPEG" else {}
    (picture.convert("RGB") if kind == "JPEG" and picture.mode == "RGBA" else picture).save(
        file, kind, **options
    )
    return file.getvalue()


def _blue_first(pixels: Pixels) -> list[int]:
    """Return the order of channels that exchanges red and blue."""
    return [2, 1, 0, 3][: pixels.shape[2]]
