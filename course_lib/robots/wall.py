"""A wall to be painted, and how good the paint on it is."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from visualization_msgs.msg import Marker

from course_lib.errors import CourseError
from course_lib.robots.painting import WIDTH
from course_lib.robots.spline import Floats

CELL = 0.002  # [m]: the wall is looked at in squares
THICK = 0.1  # [m]
Points = npt.ArrayLike  # shape (N, 3), in map, [m]


@dataclass(frozen=True)
class Wall:
    """A flat wall across x, in map: where it is, and from where to where it goes, [m]."""

    x: float
    y: tuple[float, float]
    z: tuple[float, float]

    def __post_init__(self) -> None:
        """Check the numbers; raises a CourseError."""
        if not (
            np.isfinite([self.x, *self.y, *self.z]).all() and self.y[0] < self.y[1] and self.z[0] < self.z[1]
        ):
            raise CourseError(f"{self} has no area; give x, (y from, y to) and (z from, z to), [m].")

    def coverage(self, stripes: Iterable[Points], *, width: float = WIDTH, reach: float = 0.3) -> float:
        """Return which part of the wall has paint, 0 … 1.

        Args:
            stripes: Where the wrist went; its paint is a round spot that it drags along.
            width: Of that spot, [m].
            reach: How far the paint flies at most, [m].
        """
        y, z = (np.arange(low + CELL / 2, high, CELL) for low, high in (self.y, self.z))
        painted = np.zeros((len(y), len(z)), bool)
        for start, end in filter(len, (self._near(piece, reach) for piece in _pieces(stripes))):
            low, high = np.minimum(start, end) - width / 2, np.maximum(start, end) + width / 2
            rows, columns = (slice(*np.searchsorted(c, (low[i], high[i]))) for i, c in enumerate((y, z)))
            cells = np.stack(np.meshgrid(y[rows], z[columns], indexing="ij"), axis=-1)
            way = end - start
            portion = np.clip((cells - start) @ way / max(way @ way, 1e-12), 0.0, 1.0)
            gap = cells - start - portion[..., np.newaxis] * way
            painted[rows, columns] |= np.linalg.norm(gap, axis=-1) <= width / 2
        return float(painted.mean())

    def _near(self, piece: Floats, reach: float) -> Floats:
        """The ends, y and z, of the part of a piece that is near enough, shape (2, 2); or none."""
        start, way = piece[0], piece[1] - piece[0]
        away = start[0] - self.x
        crossings = [(side - away) / (way[0] or 1e-12) for side in (-reach, reach)]  # portions of the way
        first, last = np.clip(sorted(crossings), 0.0, 1.0)
        portions = [first, last] if first < last else []
        return np.array([(start + portion * way)[1:] for portion in portions])

    def marker(self) -> Marker:
        """Return what draws it."""
        marker = Marker(ns="wall", type=Marker.CUBE, action=Marker.ADD)
        marker.header.frame_id, marker.pose.orientation.w = "map", 1.0
        center, size = marker.pose.position, marker.scale
        center.x, center.y, center.z = self.x + THICK / 2, sum(self.y) / 2, sum(self.z) / 2
        size.x, size.y, size.z = THICK, self.y[1] - self.y[0], self.z[1] - self.z[0]
        marker.color.r, marker.color.g, marker.color.b, marker.color.a = 0.8, 0.8, 0.8, 1.0
        return marker


def flatness(stripes: Iterable[Points]) -> float:
    """Return how far apart two planes across x are that have all the paint between them, [m]; 0 is flat."""
    return float(np.ptp([piece[:, 0] for piece in _pieces(stripes)] or 0.0))


def _pieces(stripes: Iterable[Points]) -> Iterator[Floats]:
    """Yield the straight pieces of stripes, shape (2, 3)."""
    for stripe in stripes:
        points = np.asarray(stripe, float)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise CourseError(f"A stripe has shape {points.shape}; give finite points x, y, z, shape (N, 3).")
        yield from map(np.array, pairwise(points))
