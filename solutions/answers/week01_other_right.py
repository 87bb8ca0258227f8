"""Right answers to week 1 that look nothing like ours: one class, arrays, time instead of counting."""

import numpy as np
from geometry_msgs.msg import Point, Quaternion, Vector3
from rclpy.node import Node
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker

from course_lib.grading import my_values


class Publisher(Node):
    """Publishes whatever `draw` yields, starting at once instead of after the first period."""

    period = 1.0

    def __init__(self) -> None:
        super().__init__(type(self).__name__)
        self.out = self.create_publisher(Marker, "/visualization_marker", 1)
        self.start = self.get_clock().now()
        self.create_timer(self.period, self.publish_all)
        self.publish_all()

    def publish_all(self) -> None:
        """Stamp and publish each marker."""
        now = self.get_clock().now()
        for number, marker in enumerate(self.draw((now - self.start).nanoseconds / 1e9)):
            marker.header = Header(frame_id="map", stamp=now.to_msg())
            marker.id = 100 + number
            self.out.publish(marker)

    def draw(self, seconds: float) -> list[Marker]:
        """The markers at a time."""
        raise NotImplementedError


def shape(kind: int, size: list[float], color: list[float], at: list[float]) -> Marker:
    """A marker in one line, from arrays."""
    marker = Marker(type=kind, scale=Vector3(x=size[0], y=size[1], z=size[2]))
    marker.color = ColorRGBA(r=color[0], g=color[1], b=color[2], a=color[3])
    marker.pose.position.x, marker.pose.position.y, marker.pose.position.z = at
    return marker


class RedCubeNode(Publisher):
    def draw(self, seconds: float) -> list[Marker]:
        return [shape(Marker.CUBE, [1.0] * 3, [1.0, 0.0, 0.0, 0.8], [0.0, 0.0, 0.5])]


class BlueCylinderNode(Publisher):
    def draw(self, seconds: float) -> list[Marker]:
        height = my_values("week01.blue_cylinder")["height"]
        at = [1.0, 0.0, 0.5 * height]
        return [shape(Marker.CYLINDER, [0.4, 0.4, height], [0.0, 0.0, 1.0, 1.0], at)]


class TrafficLightNode(Publisher):
    def draw(self, seconds: float) -> list[Marker]:
        rows = {0.8: [0.0, 1.0, 0.0, 1.0], 1.3: [1.0, 1.0, 0.0, 1.0], 1.8: [1.0, 0.0, 0.0, 1.0]}
        lamps = [shape(Marker.SPHERE, [0.4] * 3, color, [0.0, 0.0, z]) for z, color in rows.items()]
        for lamp in lamps:
            lamp.ns = "traffic_light"
        return lamps


class PurpleCircleNode(Publisher):
    period = 0.1

    def draw(self, seconds: float) -> list[Marker]:
        turn = np.exp(2j * np.pi * seconds / 10.0)
        at = [2.0 * float(turn.real), 2.0 * float(turn.imag), 0.5]
        return [shape(Marker.SPHERE, [0.5] * 3, [1.0, 0.0, 1.0, 1.0], at)]


class HeadingArrowNode(Publisher):
    def draw(self, seconds: float) -> list[Marker]:
        half = np.exp(0.5j * np.radians(my_values("week01.heading_arrow")["heading"]))
        arrow = shape(Marker.ARROW, [1.5, 0.15, 0.15], [0.0, 1.0, 1.0, 0.5], [0.0, 0.0, 0.5])
        arrow.pose.orientation = Quaternion(z=float(half.imag), w=float(half.real))
        return [arrow]


class SquareRouteNode(Publisher):
    def draw(self, seconds: float) -> list[Marker]:
        corners = np.array([[1, -1], [-1, -1], [-1, 1], [1, 1], [1, -1]], dtype=float)
        line = shape(Marker.LINE_STRIP, [0.05, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0] * 3)
        line.points = [Point(x=float(x), y=float(y)) for x, y in corners]
        return [line]
