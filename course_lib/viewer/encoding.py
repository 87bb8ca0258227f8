"""The format of all messages between Python and a page.

Scenes are msgpack, with arrays in the extension types of meshcat's own decoder. Other messages are
JSON; in Python they are subclasses of `Message`, which msgspec encodes, decodes and checks.

Text is sent as an image, drawn with a font of the kit, because machines have no font in common.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.util import find_spec
from math import isfinite
from pathlib import Path
from typing import Any

import msgpack
import msgspec
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from course_lib.arrays import Bytes, Float32s
from course_lib.errors import CourseError
from course_lib.viewer.drawables import Drawable, Inset, MeshcatObject, Sheet, Solids, Text
from course_lib.viewer.scene import ChangeKind, Node, Scene

# Height of a capital letter of the font in use [px].
_CAPITAL = 46
# Margin around the letters, for descenders and accents [px].
_MARGIN = 16
_LINE = 74  # [px] line spacing
_WIDEST_SPACE = 20.0  # width relative to the height of a capital letter
# Texture size that every graphics card supports [px].
_LARGEST = 4096
# The maximum number of letters.
_LONGEST = 5000
# meshcat's msgpack extension types.
_UINT8, _UINT32, _FLOAT32 = 0x12, 0x16, 0x17


def pack(value: Any) -> bytes:
    """Encode plain values, arrays and meshcat's packed arrays as msgpack."""
    data: bytes = msgpack.packb(value, default=_encode_value)
    return data


def snapshot(scene: Scene) -> bytes:
    """Encode a whole scene as one batch."""
    return pack(scene_batch(scene))


def encode_snapshot(scene: Scene) -> bytes:
    """Encode a whole scene for one picture, replacing objects whose textures a page loads later."""
    batch = scene_batch(scene)
    for command in batch["commands"]:
        node = scene.find(command["path"]) if command["type"] == "object" else None
        if node is not None and isinstance(node.object, MeshcatObject) and node.object.stand_in is not None:
            command["object"] = _fields_of(node.object.stand_in)
    return pack(batch)


def scene_batch(scene: Scene) -> dict[str, Any]:
    """Return the batch that creates a scene."""
    with scene.lock:
        batch = commands(scene, "background", "") + commands(scene, "camera", "")
        moved_nodes = []
        for node in scene.nodes():
            if node.object is not None:
                batch += commands(scene, "object", node.path)
            if not node.is_visible:
                batch += commands(scene, "visible", node.path)
            if not np.array_equal(node.matrix, np.eye(4)):
                moved_nodes.append(node)
        batch += commands(scene, "animation", "")
        return {"commands": batch, **placements(moved_nodes)}


def placements(nodes: list[Node]) -> dict[str, Any]:
    """Return the transforms of nodes. A node whose transform is not finite is not moved."""
    matrices = np.array([node.matrix for node in nodes], np.float32).reshape(-1, 4, 4)
    somewhere = np.flatnonzero(np.isfinite(matrices).all(axis=(1, 2)))
    if len(somewhere) < len(nodes):
        nodes, matrices = [nodes[number] for number in somewhere], matrices[somewhere]
    return {"paths": [node.path for node in nodes], "matrices": columns(matrices)}


def commands(scene: Scene, kind: ChangeKind, path: str) -> list[dict[str, Any]]:
    """Return the commands that set the present value of one item of the scene."""
    node = scene.find(path)
    if kind == "delete":
        return [{"type": "delete", "path": path}]
    if kind in ("background", "look"):
        look = {} if scene.look == "RViz" else {"look": scene.look}
        return [{"type": "background", "color": scene.background, **look}]
    if kind == "camera":
        return [{"type": "camera", **vars(scene.camera)}]
    if kind == "animation" and scene.animation is not None:
        return [{"type": "animation", **scene.animation}]
    if kind == "object" and node is not None and node.object is not None:
        return [{"type": "object", "path": path, "object": _fields_of(node.object)}]
    if kind == "visible" and node is not None:
        return [{"type": "visible", "path": path, "value": node.is_visible}]
    return []


def columns(matrices: Float32s) -> Float32s:
    """Return the upper three rows of affine matrices in column-major order, shape (N, 4, 3)."""
    return np.ascontiguousarray(matrices[:, :3].transpose(0, 2, 1))


def _encode_value(value: Any) -> Any:
    """Encode values that msgpack does not support; meshcat's umsgpack.Ext has two fields."""
    if isinstance(value, np.ndarray):
        for dtype, code in ((np.float32, _FLOAT32), (np.uint32, _UINT32), (np.uint8, _UINT8)):
            if value.dtype == dtype:
                return msgpack.ExtType(code, value.tobytes())
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "type") and hasattr(value, "data"):
        return msgpack.ExtType(value.type, value.data)
    raise TypeError(f"{value!r} cannot be sent to a page: expected numbers, strings, lists, dicts or arrays.")


def _fields_of(drawable: Drawable) -> dict[str, Any]:
    """Return the kind and the fields of an object, as the page's builders read them."""
    if isinstance(drawable, MeshcatObject):
        return {"kind": "meshcat", "json": drawable.json}
    fields = dict(vars(drawable))
    for name in {"colors", "color"} & fields.keys():
        fields[name] = np.rint(fields[name] * 255).astype(np.uint8)
    if isinstance(drawable, Solids):
        fields["placements"] = columns(drawable.placements)
    if isinstance(drawable, Text):
        glyphs = rasterize(drawable.text, drawable.space_width)
        rows, cols = glyphs.mask.shape
        size = drawable.height / glyphs.pixels_per_height  # [m] per pixel
        fields["text"] = drawable.text[:_LONGEST]
        fields.update(mask=glyphs.mask, rows=rows, columns=cols, pixel=size)
    if isinstance(drawable, Sheet):
        fields.update(rows=drawable.cells.shape[0], columns=drawable.cells.shape[1])
    if isinstance(drawable, Inset):
        fields.update(rows=drawable.pixels.shape[0], columns=drawable.pixels.shape[1])
        fields["camera"] = drawable.camera and vars(drawable.camera)
    return {"kind": type(drawable).__name__.lower(), **fields}


@dataclass(frozen=True)
class Glyphs:
    """Rendered text, white on black."""

    # Coverage of each pixel, 0..255, shape (rows, columns).
    mask: Bytes
    # Pixels in the height of a capital letter.
    pixels_per_height: float


@lru_cache(maxsize=512)
def rasterize(text: str, space_width: float = 0.0) -> Glyphs:
    """Draw text whose lines begin at the same position.

    Very long text is drawn smaller, or truncated.

    Args:
        text: One or more lines.
        space_width: Width of a space in heights of a capital letter; 0 uses that of the font.
    """
    lines = text[:_LONGEST].split("\n")
    font = _font_for(text[:_LONGEST])
    # Without a width of its own, a line is drawn in one piece.
    words = [line.split(" ") if space_width else [line] for line in lines]
    # A wider space would leave no pixels for the letters.
    space = min(max(space_width, 0.0), _WIDEST_SPACE) * _CAPITAL
    starts = [np.cumsum([0.0, *(font.getlength(word) + space for word in line)]) for line in words]
    columns = max(float(line[-1]) for line in starts) - space + 2 * _MARGIN
    rows = _CAPITAL + _LINE * (len(lines) - 1) + 2 * _MARGIN
    scale = min(1.0, _LARGEST / max(columns, rows))
    if scale < 1:
        font = font.font_variant(size=font.size * scale)
    image = Image.new("L", (max(round(columns * scale), 1), max(round(rows * scale), 1)))
    draw = ImageDraw.Draw(image)
    for row, line in enumerate(words):
        baseline = (_MARGIN + _CAPITAL + _LINE * row) * scale
        for word, start in zip(line, starts[row], strict=False):
            draw.text(((_MARGIN + start) * scale, baseline), word, fill=255, font=font, anchor="ls")
    return Glyphs(np.asarray(image), _CAPITAL * scale)


def _font_for(text: str) -> ImageFont.FreeTypeFont:
    """Return RViz's own font or, for characters it lacks, the font with the widest coverage."""
    fonts = _fonts()
    return next((font for font in fonts if not _missing_in(font, text)), fonts[-1])


@lru_cache(maxsize=512)
def missing_characters(text: str) -> str:
    """Return the characters for which `rasterize` draws boxes, because no font has them."""
    return _missing_in(_font_for(text), text)


def _missing_in(font: ImageFont.FreeTypeFont, text: str) -> str:
    box = bytes(font.getmask("\uffff"))
    # A font without a box draws a missing character like a space.
    characters = dict.fromkeys(
        character for character in text if character.isprintable() and character != " "
    )
    return "".join(character for character in characters if bytes(font.getmask(character)) == box)


@cache
def _fonts() -> tuple[ImageFont.FreeTypeFont, ...]:
    paths = [Path(__file__).parent / "fonts" / "CourseSans-Regular.ttf"]
    matplotlib = find_spec("matplotlib")
    if matplotlib is not None and matplotlib.origin is not None:
        paths.append(Path(matplotlib.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf")
    fonts = []
    for path in (path for path in paths if path.exists()):
        # The size at which the font's capital letters have the right height.
        _, top, _, bottom = ImageFont.truetype(path, 1000).getbbox("H", anchor="ls")
        fonts.append(ImageFont.truetype(path, 1000 * _CAPITAL / (bottom - top)))
    return tuple(fonts)


# The fields of every message of a page, which `PageLink` reads.
ENVELOPE = frozenset({"type", "page", "number"})


class Message(msgspec.Struct, frozen=True, rename="camel", omit_defaults=True, forbid_unknown_fields=True):
    """Base class of the JSON messages of Python and pages; there, fields have JavaScript's names."""


class MessageError(CourseError):
    """Raised for a message of a page that does not match its class."""


def to_json(message: Message) -> dict[str, Any]:
    """Return a message as JSON values, without fields that have their defaults."""
    content: dict[str, Any] = msgspec.to_builtins(message, enc_hook=_plain_number)
    return content


def from_json(kind: Any, content: Mapping[str, Any]) -> Any:
    """Build a message from the JSON values of a page.

    Args:
        kind: A class of messages, or a union of such classes.
        content: The values; those of the envelope are left out.

    Raises:
        MessageError: If a field is missing, unknown or of another type; names it.
    """
    fields = {name: value for name, value in content.items() if name not in ENVELOPE}
    if not _is_finite(fields):
        raise MessageError(f"The page sent {str(fields)[:200]}: expected numbers that are finite.")
    try:
        return msgspec.convert(fields, kind)
    except msgspec.ValidationError as error:
        raise MessageError(f"The page sent {str(fields)[:200]}: {error}.") from None


def _is_finite(value: Any) -> bool:
    """Return whether JSON values hold neither NaN nor an infinite number."""
    if isinstance(value, Mapping):
        return all(map(_is_finite, value.values()))
    if isinstance(value, list):
        return all(map(_is_finite, value))
    return not isinstance(value, float) or isfinite(value)


def _plain_number(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise NotImplementedError(f"{type(value).__name__} is not sent to a page")
