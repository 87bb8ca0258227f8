"""The ground under turtlesim's turtles: what their pens have drawn."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from PIL import Image, ImageDraw

PIXELS = 500  # of the ground's edge
METER = 45  # [px]
SIZE = (PIXELS - 1) / METER  # [m] of the ground's edge
LONGEST = 500  # points of a strip
Point = tuple[float, float]  # x to the right, y up, [m]
Color = tuple[int, int, int]  # 0..255


@dataclass(frozen=True)
class Pen:
    """A pen; turtlesim's own is light and 3 pixels wide."""

    color: Color = (0xB3, 0xB8, 0xFF)
    width: int = 3  # [px]
    on: bool = True


@dataclass
class Strip:
    """Points that a pen has joined, one after the other."""

    pen: Pen
    points: list[Point] = field(default_factory=list)


class Canvas:
    """Lines as strips, for the view, and as pixels, for the turtles' color sensors."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Remove all lines."""
        self.strips: list[Strip] = []
        self._image = Image.new("RGBA", (PIXELS, PIXELS), (255, 255, 255, 0))
        self._painter = ImageDraw.Draw(self._image)

    def line(self, pen: Pen, start: Point, end: Point) -> None:
        """Draw a line, as part of the strip that it goes on."""
        if not pen.on:
            return
        ends = [strip for strip in self.strips[-8:] if strip.pen == pen and strip.points[-1] == start]
        if ends and len(ends[-1].points) < LONGEST:
            ends[-1].points.append(end)
        else:
            self.strips.append(Strip(pen, [start, end]))
        self._painter.line([_pixel(start), _pixel(end)], fill=(*pen.color, 255), width=pen.width)

    def color_at(self, place: Point) -> Sequence[int]:
        """Return red, green and blue of the line at a place; white where there is none."""
        found = self._image.getpixel(_pixel(place))
        assert isinstance(found, tuple)  # it has channels
        return found[:3]


def _pixel(place: Point) -> tuple[int, int]:
    x, y = (round(min(max(number, 0.0), SIZE) * METER) for number in place)
    return x, PIXELS - 1 - y
