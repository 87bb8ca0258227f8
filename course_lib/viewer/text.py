"""Words as pictures: machines have no font in common, so the viewer draws with its own."""

from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from course_lib.arrays import Bytes

_CAPITAL = 46  # [px] height of a capital letter of the font in use
_MARGIN = 16  # [px] room around the letters, for what hangs below and stands above them
_LINE = 74  # [px] from one line to the next
_LARGEST = 4096  # [px] that any graphics card takes
_LONGEST = 5000  # letters


@dataclass(frozen=True)
class Glyphs:
    """A text in white on black."""

    mask: Bytes  # how much of each pixel is ink, 0..255, shape (rows, columns)
    pixels_per_height: float  # pixels in the height of a capital letter


@lru_cache(maxsize=512)
def rasterized(text: str) -> Glyphs:
    """Draw a text, line by line, each in the middle; a very long one is drawn smaller, or cut."""
    lines = text[:_LONGEST].split("\n")
    font = _font_for(text[:_LONGEST])
    columns = max(font.getlength(line) for line in lines) + 2 * _MARGIN
    rows = _CAPITAL + _LINE * (len(lines) - 1) + 2 * _MARGIN
    scale = min(1.0, _LARGEST / max(columns, rows))
    if scale < 1:
        font = font.font_variant(size=font.size * scale)
    image = Image.new("L", (round(columns * scale), round(rows * scale)))
    draw = ImageDraw.Draw(image)
    for row, line in enumerate(lines):
        baseline = (_MARGIN + _CAPITAL + _LINE * row) * scale
        draw.text((columns * scale / 2, baseline), line, fill=255, font=font, anchor="ms")
    return Glyphs(np.asarray(image), _CAPITAL * scale)


def _font_for(text: str) -> ImageFont.FreeTypeFont:
    """Return RViz's own font, or, for signs that it lacks, the widest one that the kit depends on."""
    fonts = _fonts()
    for font in fonts:
        missing = bytes(font.getmask("\uffff"))
        if not any(bytes(font.getmask(sign)) == missing for sign in set(text) if sign.isprintable()):
            return font
    return fonts[-1]


@cache
def _fonts() -> tuple[ImageFont.FreeTypeFont, ...]:
    paths = [Path(__file__).parent / "fonts" / "CourseSans-Regular.ttf"]
    matplotlib = find_spec("matplotlib")
    if matplotlib is not None and matplotlib.origin is not None:
        paths.append(Path(matplotlib.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf")
    return tuple(_with_capitals(path) for path in paths if path.exists())


def _with_capitals(path: Path) -> ImageFont.FreeTypeFont:
    """Load a font in the size at which its capital letters have the right height."""
    _, top, _, bottom = ImageFont.truetype(path, 1000).getbbox("H", anchor="ls")
    return ImageFont.truetype(path, 1000 * _CAPITAL / (bottom - top))
