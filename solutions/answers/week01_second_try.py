"""Other wrong answers to week 1, again one mistake in each."""

import math

from geometry_msgs.msg import Point
from rclpy.node import Node
from visualization_msgs.msg import Marker

from course_lib.grading import my_values

TOPIC = "/visualization_marker"


def stamped(node: Node, kind: int, color: tuple[float, float, float]) -> Marker:
    """A marker of 0.4 m in the frame map."""
    marker = Marker(ns="traffic_light", type=kind)
    marker.header.frame_id = "map"
    marker.header.stamp = node.get_clock().now().to_msg()
    marker.scale.x = marker.scale.y = marker.scale.z = 0.4
    marker.color.r, marker.color.g, marker.color.b = color
    marker.color.a = 1.0
    return marker


class RedCubeNode(Node):
    """Forgets alpha."""

    def __init__(self) -> None:
        super().__init__("red_cube")
        self.publisher = self.create_publisher(Marker, TOPIC, 10)
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self) -> None:
        marker = stamped(self, Marker.CUBE, (1.0, 0.0, 0.0))
        marker.scale.x = marker.scale.y = marker.scale.z = 1.0
        marker.pose.position.z = 0.5
        marker.color.a = 0.0
        self.publisher.publish(marker)


class BlueCylinderNode(Node):
    """Types the number that a friend got."""

    def __init__(self) -> None:
        super().__init__("blue_cylinder")
        self.publisher = self.create_publisher(Marker, TOPIC, 10)
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self) -> None:
        marker = stamped(self, Marker.CYLINDER, (0.0, 0.0, 1.0))
        marker.scale.z = 1.0
        marker.pose.position.x = 1.0
        marker.pose.position.z = 0.5
        self.publisher.publish(marker)


class TrafficLightNode(Node):
    """Hangs the lamps upside down."""

    def __init__(self) -> None:
        super().__init__("traffic_light")
        self.publisher = self.create_publisher(Marker, TOPIC, 10)
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self) -> None:
        colors = [(1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)]
        for number, color in enumerate(colors):
            marker = stamped(self, Marker.SPHERE, color)
            marker.id = number
            marker.pose.position.z = 0.8 + 0.5 * number
            self.publisher.publish(marker)


class PurpleCircleNode(Node):
    """Counts the angle in degrees, and gives it to sine and cosine as it is."""

    def __init__(self) -> None:
        super().__init__("purple_circle")
        self.publisher = self.create_publisher(Marker, TOPIC, 10)
        self.timer = self.create_timer(0.1, self.tick)
        self.angle = 0.0

    def tick(self) -> None:
        marker = stamped(self, Marker.SPHERE, (1.0, 0.0, 1.0))
        marker.scale.x = marker.scale.y = marker.scale.z = 0.5
        marker.pose.position.x = 2.0 * math.cos(self.angle)
        marker.pose.position.y = 2.0 * math.sin(self.angle)
        marker.pose.position.z = 0.5
        self.publisher.publish(marker)
        self.angle += 3.6


class HeadingArrowNode(Node):
    """Writes the angle itself into the quaternion."""

    def __init__(self) -> None:
        super().__init__("heading_arrow")
        self.publisher = self.create_publisher(Marker, TOPIC, 10)
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self) -> None:
        marker = stamped(self, Marker.ARROW, (1.0, 1.0, 0.0))
        marker.scale.x, marker.scale.y, marker.scale.z = 1.5, 0.15, 0.15
        marker.pose.position.z = 0.5
        marker.pose.orientation.z = math.radians(my_values("week01.heading_arrow")["heading"])
        self.publisher.publish(marker)


class SquareRouteNode(Node):
    """Joins the corners crosswise."""

    def __init__(self) -> None:
        super().__init__("square_route")
        self.publisher = self.create_publisher(Marker, TOPIC, 10)
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self) -> None:
        marker = stamped(self, Marker.LINE_STRIP, (1.0, 1.0, 0.0))
        marker.scale.x = 0.05
        for x, y in [(1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]:
            marker.points.append(Point(x=x, y=y))
        self.publisher.publish(marker)
