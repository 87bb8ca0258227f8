"""A wall to be painted, and how good the paint on it is."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np
import numpy.typing as npt
from visualization_msgs.msg import Marker

from course_lib.errors import CourseError
from course_lib.robots.painting import WIDTH

CELL = 0.002  # [m]: the wall is looked at in squares
THICK = 0.1  # [m]
Points = npt.ArrayLike  # shape (N, 3), in map, [m]


@dataclass(frozen=True)
class Wall:
    """A flat wall across x, in map: where it is, and from where to where it goes, [m]."""

    x: float
    y: tuple[float, float]
    z: tuple[float, float]

    def coverage(self, stripes: Iterable[Points], *, width: float = WIDTH, reach: float = 0.3) -> float:
        """Return which part of the wall has paint, 0 … 1.

        Args:
            stripes: Where the wrist went; its paint is a round spot that it drags along.
            width: Of that spot, [m].
            reach: How far the paint flies at most, [m].
        """
        y, z = (np.arange(low + CELL / 2, high, CELL) for low, high in (self.y, self.z))
        painted = np.zeros((len(y), len(z)), bool)
        for start, end in chain.from_iterable(map(pairwise, map(_checked, stripes))):
            lines = [
                slice(*np.searchsorted(cells, (min(ends) - width / 2, max(ends) + width / 2)))
                for cells, ends in ((y, (start[1], end[1])), (z, (start[2], end[2])))
            ]
            cells = np.stack(np.meshgrid(y[lines[0]], z[lines[1]], indexing="ij"), axis=-1)
            way = end - start
            length = float(way[1:] @ way[1:]) or 1.0
            portion = np.clip((cells - start[1:]) @ way[1:] / length, 0.0, 1.0)
            nearest = start + portion[..., np.newaxis] * way
            in_spot = np.linalg.norm(cells - nearest[..., 1:], axis=-1) <= width / 2
            painted[lines[0], lines[1]] |= in_spot & (np.abs(nearest[..., 0] - self.x) <= reach)
        return float(painted.mean())

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
    return float(np.ptp(np.concatenate([_checked(stripe)[:, 0] for stripe in stripes])))


def _checked(stripe: Points) -> npt.NDArray[np.float64]:
    points = np.asarray(stripe, float)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise CourseError(f"A stripe has shape {points.shape}; give finite points x, y, z, shape (N, 3).")
    return points
