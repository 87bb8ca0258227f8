"""Paint that a robot's wrist leaves behind."""

from collections import deque
from itertools import pairwise
from typing import Unpack

import numpy as np
from geometry_msgs.msg import Point
from rclpy.node import Node, NodeOptions
from rclpy.time import Time
from tf2_ros import Buffer, TransformListener
from visualization_msgs.msg import Marker

from course_lib.robots.spline import Floats

WIDTH = 0.2  # [m] of a stripe
PERIOD = 0.1  # [s]
LEAST_RISE, LEAST_HEIGHT = 0.01, 0.5  # [m] of the wrist in base_link: per period, and above the ground
LONGEST_WAY, WINDOW = 0.1, 5.0  # [m] of the base within [s]


class PaintNode(Node):
    """Publishes stripes on /visualization_marker, where the wrist moves up or down above 0.5 m.

    A stripe ends when the wrist pauses, or once the base has moved more than 0.1 m within 5 s. Its points, in
    map, are in `stripes`, [m].

    Args:
        wrist: The link that paints.
        options: What any node takes.
    """

    def __init__(self, wrist: str = "ur10wrist_3_link", **options: Unpack[NodeOptions]) -> None:
        super().__init__("paint_path_node", **options)
        self.stripes: list[list[Floats]] = []
        self._wrist, self._height = wrist, np.nan  # [m]
        self._is_new = True  # whether the next point begins a stripe
        self._way: deque[tuple[float, Floats]] = deque()  # of the base: time [s], place [m]
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, self)
        self._publisher = self.create_publisher(Marker, "visualization_marker", 10)
        self.create_timer(PERIOD, self._update)

    def _update(self) -> None:
        if not self._buffer.can_transform("map", self._wrist, Time()):
            says = f"Nothing is painted: TF does not know {self._wrist} in map."
            self.get_logger().warning(says, throttle_duration_sec=5.0, skip_first=True)
            return
        before, self._height = self._height, self._place("base_link", self._wrist)[2]
        if self._base_has_moved() or not (
            abs(self._height - before) > LEAST_RISE and self._height > LEAST_HEIGHT
        ):
            self._is_new = True
            return
        if self._is_new:
            self.stripes.append([])
            self._is_new = False
        self.stripes[-1].append(self._place("map", self._wrist))
        self._publish()

    def _base_has_moved(self) -> bool:
        now = self.get_clock().now().nanoseconds / 1e9  # [s]
        self._way.append((now, self._place("map", "base_link")))
        while now - self._way[0][0] > WINDOW:
            self._way.popleft()
        moved = sum(float(np.linalg.norm(b - a)) for (_, a), (_, b) in pairwise(self._way)) > LONGEST_WAY
        if moved:
            self._way.clear()
        return moved

    def _place(self, frame: str, link: str) -> Floats:
        found = self._buffer.lookup_transform(frame, link, Time()).transform.translation
        return np.array([found.x, found.y, found.z])

    def _publish(self) -> None:
        stripe = Marker(id=len(self.stripes) - 1, type=Marker.LINE_STRIP, action=Marker.ADD)
        stripe.header.frame_id, stripe.header.stamp = "map", self.get_clock().now().to_msg()
        stripe.scale.x, stripe.pose.orientation.w = WIDTH, 1.0
        stripe.color.r, stripe.color.g, stripe.color.a = 1.0, 1.0, 1.0  # yellow
        stripe.points = [Point(x=x, y=y, z=z) for x, y, z in np.array(self.stripes[-1]).tolist()]
        self._publisher.publish(stripe)
