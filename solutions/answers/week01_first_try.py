"""Answers to week 1 as students write them at first: each of the six is wrong in its own way."""

import math

from geometry_msgs.msg import Point
from rclpy.node import Node
from visualization_msgs.msg import Marker

from course_lib.grading import my_values


class MarkerNode(Node):
    """Base of the six nodes."""

    def __init__(self, period: float = 1.0) -> None:
        super().__init__("first_try")
        self.publisher = self.create_publisher(Marker, "/visualization_marker", 10)
        self.timer = self.create_timer(period, self.publish_marker)  # [s]
        self.angle = 0.0

    def publish_marker(self) -> None:
        """Publish what the task asks for."""

    def marker(self, kind: int, size: float) -> Marker:
        """An opaque black marker."""
        marker = Marker(ns="try", type=kind)
        marker.header.frame_id = "map"
        marker.header.stamp = self.get_clock().now().to_msg()
        marker.scale.x = marker.scale.y = marker.scale.z = size
        marker.color.a = 1.0
        return marker


class RedCubeNode(MarkerNode):
    """Mistake: the position is that of the upper face."""

    def publish_marker(self) -> None:
        marker = self.marker(Marker.CUBE, 1.0)
        marker.pose.position.z = 1.0
        marker.color.r = 1.0
        marker.color.a = 0.8
        self.publisher.publish(marker)


class BlueCylinderNode(MarkerNode):
    """Mistake: the scale is a radius."""

    def publish_marker(self) -> None:
        height = my_values("week01.blue_cylinder")["height"]
        marker = self.marker(Marker.CYLINDER, 0.2)
        marker.scale.z = height
        marker.pose.position.x = 1.0
        marker.pose.position.z = height / 2
        marker.color.b = 1.0
        self.publisher.publish(marker)


class TrafficLightNode(MarkerNode):
    """All three lamps have the id 0: only the last one stays."""

    def publish_marker(self) -> None:
        for color, height in [((1.0, 0.0, 0.0), 1.8), ((1.0, 1.0, 0.0), 1.3), ((0.0, 1.0, 0.0), 0.8)]:
            marker = self.marker(Marker.SPHERE, 0.4)
            marker.ns = "traffic_light"
            marker.pose.position.z = height
            marker.color.r, marker.color.g, marker.color.b = color
            self.publisher.publish(marker)


class PurpleCircleNode(MarkerNode):
    """Mistake: the step is the lesson's, a turn of 12.6 s."""

    def __init__(self) -> None:
        super().__init__(period=0.1)

    def publish_marker(self) -> None:
        marker = self.marker(Marker.SPHERE, 0.5)
        marker.pose.position.x = 2.0 * math.cos(self.angle)
        marker.pose.position.y = 2.0 * math.sin(self.angle)
        marker.pose.position.z = 0.5
        marker.color.r = marker.color.b = 1.0
        self.publisher.publish(marker)
        self.angle += 0.05


class HeadingArrowNode(MarkerNode):
    """Mistake: the heading stays in degrees."""

    def publish_marker(self) -> None:
        heading = my_values("week01.heading_arrow")["heading"]
        marker = self.marker(Marker.ARROW, 0.15)
        marker.scale.x = 1.5
        marker.pose.position.z = 0.5
        marker.pose.orientation.z = math.sin(heading / 2)
        marker.pose.orientation.w = math.cos(heading / 2)
        self.publisher.publish(marker)


class SquareRouteNode(MarkerNode):
    """Forgets the way back."""

    def publish_marker(self) -> None:
        marker = self.marker(Marker.LINE_STRIP, 0.05)
        marker.points = [Point(x=x, y=y) for x, y in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]]
        self.publisher.publish(marker)
