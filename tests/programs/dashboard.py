# %%
import math
import random

import rclpy
from geometry_msgs.msg import Point, TransformStamped
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from tf2_ros import TransformBroadcaster
from visualization_msgs.msg import Marker, MarkerArray

from course_lib import spin_for

# %%
# colours of classes, RGBA
COLORS = {"person": (0.0, 1.0, 0.0, 0.5)}
COLORS["car"] = (1.0, 0.0, 0.0, 0.5)
RADIUS = 3.0  # [m]
UNUSED = 1


def circle(angle: float) -> Point:
    """Place a point on the circle"""
    return Point(x=RADIUS * math.cos(angle), y=RADIUS * math.sin(angle))


# %%
class PerceptionNode(Node):
    """Publishes boxes."""

    def __init__(self) -> None:
        super().__init__("perception_node")
        self.declare_parameter("marker_update_rate", 10.0)
        self.declare_parameter("world_frame", "world")
        self.publisher = self.create_publisher(MarkerArray, "/perception/markers", 10)
        self.create_timer(1 / self.get_parameter("marker_update_rate").value, self.publish)

    def publish(self) -> None:
        """Publish all boxes"""
        array = MarkerArray()
        for number, (name, color) in enumerate(COLORS.items()):
            marker = Marker(id=number, ns=name, type=Marker.CUBE)
            marker.header.frame_id = self.get_parameter("world_frame").value
            marker.header.stamp = self.get_clock().now().to_msg()
            marker.pose.position = circle(random.random())
            marker.color.r, marker.color.g, marker.color.b, marker.color.a = color
            marker.scale.x = marker.scale.y = marker.scale.z = 1.0
            array.markers.append(marker)
        self.publisher.publish(array)


# %%
class TFPublisher(Node):
    def __init__(self) -> None:
        super().__init__("tf_publisher")
        self.broadcaster = TransformBroadcaster(self)
        self.create_timer(0.05, self.send)
        self.counter = 0.0

    def send(self) -> None:
        transform = TransformStamped()
        transform.header.stamp = self.get_clock().now().to_msg()
        transform.header.frame_id = "world"
        transform.child_frame_id = "base_link"
        place = circle(self.counter)
        transform.transform.translation.x = place.x
        transform.transform.translation.y = place.y
        self.broadcaster.sendTransform(transform)
        self.counter += 0.05


# %%
class SensorPublisher(Node):
    def __init__(self) -> None:
        super().__init__("sensor_publisher")
        self.scans = self.create_publisher(LaserScan, "scan", 10)
        self.create_timer(0.1, self.measure)

    def measure(self) -> None:
        scan = LaserScan()
        scan.header.frame_id = "base_link"
        scan.header.stamp = self.get_clock().now().to_msg()
        scan.ranges = [random.uniform(1.0, 2.0) for _ in range(5)]
        self.scans.publish(scan)


# %%
rclpy.init()
nodes = PerceptionNode(), TFPublisher(), SensorPublisher()
spin_for(5.0, *nodes)
