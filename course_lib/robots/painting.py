"""A painting node, the wall that it paints, and measures of its stripes."""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Unpack

import numpy as np
import numpy.typing as npt
from geometry_msgs.msg import Point
from rclpy.node import Node, NodeOptions
from rclpy.time import Time
from tf2_ros import Buffer, TransformListener
from visualization_msgs.msg import Marker

from course_lib.arrays import Floats
from course_lib.errors import CourseError

# Side of the squares in which coverage is measured [m].
CELL = 0.002
# Thickness of the wall [m].
THICK = 0.1
# Points in map, shape (N, 3), [m].
Points = npt.ArrayLike
# Width of a stripe [m].
WIDTH = 0.2
# Period of the node's timer [s].
PERIOD = 0.1
# Minimum change of the wrist's height per period, and its minimum height above the ground [m].
LEAST_RISE, LEAST_HEIGHT = 0.01, 0.5
# Maximum distance [m] that the base may move within a time [s].
LONGEST_WAY, WINDOW = 0.1, 5.0


@dataclass(frozen=True)
class Wall:
    """A flat wall perpendicular to x, in map: its x and its extents along y and z, [m]."""

    x: float
    y: tuple[float, float]
    z: tuple[float, float]

    def __post_init__(self) -> None:
        """Raise a CourseError for invalid numbers."""
        if not (
            np.isfinite([self.x, *self.y, *self.z]).all() and self.y[0] < self.y[1] and self.z[0] < self.z[1]
        ):
            raise CourseError(f"{self} has no area; give x, (y from, y to) and (z from, z to), [m].")

    def coverage(
        self,
        stripes: Iterable[Points],
        *,
        width: float = WIDTH,
        reach: float = 0.3,
    ) -> float:
        """Return the painted fraction of the wall, 0 … 1.

        Args:
            stripes: The paths of the wrist, which moves a round spot of paint along them.
            width: Diameter of the spot, [m].
            reach: Maximum distance from which paint reaches the wall, [m].
        """
        y, z = (np.arange(low + CELL / 2, high, CELL) for low, high in (self.y, self.z))
        painted = np.zeros((len(y), len(z)), bool)
        for start, end in filter(len, (self._near(piece, reach) for piece in _segments(stripes))):
            low, high = np.minimum(start, end) - width / 2, np.maximum(start, end) + width / 2
            rows, columns = (slice(*np.searchsorted(c, (low[i], high[i]))) for i, c in enumerate((y, z)))
            cells = np.stack(np.meshgrid(y[rows], z[columns], indexing="ij"), axis=-1)
            way = end - start
            portion = np.clip((cells - start) @ way / max(way @ way, 1e-12), 0.0, 1.0)
            gap = cells - start - portion[..., np.newaxis] * way
            painted[rows, columns] |= np.linalg.norm(gap, axis=-1) <= width / 2
        return float(painted.mean())

    def _near(self, piece: Floats, reach: float) -> Floats:
        """Return the end points (y, z) of the part of a segment that is within reach.

        Returns:
            Shape (2, 2), or an empty array.
        """
        start, way = piece[0], piece[1] - piece[0]
        offset = start[0] - self.x
        # The crossings with both limits of the reach, as fractions of the segment.
        crossings = [(side - offset) / (way[0] or 1e-12) for side in (-reach, reach)]
        first, last = np.clip(sorted(crossings), 0.0, 1.0)
        portions = [first, last] if first < last else []
        return np.array([(start + portion * way)[1:] for portion in portions])

    def marker(self) -> Marker:
        """Return a marker that draws the wall."""
        marker = Marker(ns="wall", type=Marker.CUBE, action=Marker.ADD)
        marker.header.frame_id, marker.pose.orientation.w = "map", 1.0
        center, size = marker.pose.position, marker.scale
        center.x, center.y, center.z = self.x + THICK / 2, sum(self.y) / 2, sum(self.z) / 2
        size.x, size.y, size.z = THICK, self.y[1] - self.y[0], self.z[1] - self.z[0]
        marker.color.r, marker.color.g, marker.color.b, marker.color.a = 0.8, 0.8, 0.8, 1.0
        return marker


def flatness(stripes: Iterable[Points]) -> float:
    """Return the extent of all stripes along x, [m]; 0 for flat ones.

    Args:
        stripes: The points of each stripe in map, shape (N, 3), [m].
    """
    return float(np.ptp([piece[:, 0] for piece in _segments(stripes)] or 0.0))


def _segments(stripes: Iterable[Points]) -> Iterator[Floats]:
    """Yield the segments of stripes, shape (2, 3)."""
    for stripe in stripes:
        points = np.asarray(stripe, float)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise CourseError(f"A stripe has shape {points.shape}; give finite points x, y, z, shape (N, 3).")
        yield from map(np.array, pairwise(points))


class PaintNode(Node):
    """Publishes stripes on /visualization_marker while the wrist moves up or down above 0.5 m.

    A stripe ends when the wrist pauses or the base has moved more than 0.1 m within 5 s. Its
    points, in map [m], are in `stripes`.

    Args:
        wrist: The link that paints.
        options: Options of any node.
    """

    def __init__(self, wrist: str = "ur10wrist_3_link", **options: Unpack[NodeOptions]) -> None:
        super().__init__("paint_path_node", **options)
        self.stripes: list[list[Floats]] = []
        # Height of the wrist [m].
        self._wrist, self._height = wrist, np.nan
        # Whether the next point starts a stripe.
        self._is_new = True
        # Recent positions of the base: time [s], position [m].
        self._track: deque[tuple[float, Floats]] = deque()
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, self)
        self._publisher = self.create_publisher(Marker, "visualization_marker", 10)
        self.create_timer(PERIOD, self._update)

    def _update(self) -> None:
        if not self._buffer.can_transform("map", self._wrist, Time()):
            says = f"Nothing is painted: TF does not know {self._wrist} in map."
            self.get_logger().warning(says, throttle_duration_sec=5.0, skip_first=True)
            return
        before, self._height = self._height, self._base_position("base_link", self._wrist)[2]
        if self._has_base_moved() or not (
            abs(self._height - before) > LEAST_RISE and self._height > LEAST_HEIGHT
        ):
            self._is_new = True
            return
        if self._is_new:
            self.stripes.append([])
            self._is_new = False
        self.stripes[-1].append(self._base_position("map", self._wrist))
        self._publish()

    def _has_base_moved(self) -> bool:
        now = self.get_clock().now().nanoseconds / 1e9
        self._track.append((now, self._base_position("map", "base_link")))
        while now - self._track[0][0] > WINDOW:
            self._track.popleft()
        has_moved = (
            sum(float(np.linalg.norm(b - a)) for (_, a), (_, b) in pairwise(self._track)) > LONGEST_WAY
        )
        if has_moved:
            self._track.clear()
        return has_moved

    def _base_position(self, frame: str, link: str) -> Floats:
        translation = self._buffer.lookup_transform(frame, link, Time()).transform.translation
        return np.array([translation.x, translation.y, translation.z])

    def _publish(self) -> None:
        stripe = Marker(id=len(self.stripes) - 1, type=Marker.LINE_STRIP, action=Marker.ADD)
        stripe.header.frame_id, stripe.header.stamp = "map", self.get_clock().now().to_msg()
        stripe.scale.x, stripe.pose.orientation.w = WIDTH, 1.0
        # Yellow.
        stripe.color.r, stripe.color.g, stripe.color.a = 1.0, 1.0, 1.0
        stripe.points = [Point(x=x, y=y, z=z) for x, y, z in np.array(self.stripes[-1]).tolist()]
        self._publisher.publish(stripe)
