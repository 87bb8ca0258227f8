"""The topics of a robot with Nav2, as an rclpy program: maps once, all else at 10 Hz."""

from typing import Any

import rclpy
from geometry_msgs.msg import (
    Point32,
    PolygonStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
)
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Image, LaserScan, PointCloud2, PointField
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster
from visualization_msgs.msg import Marker, MarkerArray

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
MAPS = {
    "/map": "map",
    "/global_costmap/costmap": "map",
    "/local_costmap/costmap": "odom",
}  # with their frames
STREAMS = (
    (LaserScan, "/scan", qos_profile_sensor_data),
    (PointCloud2, "/mobile_base/sensors/bumper_pointcloud", qos_profile_sensor_data),
    (Path, "/plan", 10),
    (Path, "/local_plan", 10),
    (PolygonStamped, "/local_costmap/published_footprint", 10),
    (MarkerArray, "/waypoints", 10),
    (Image, "/camera/image_raw", 10),
)


def grid(size: int) -> OccupancyGrid:
    """Return a square map of so many cells of 0.1 m a side, half of them taken."""
    grid = OccupancyGrid(data=[0, 100] * (size * size // 2))
    grid.info.width, grid.info.height, grid.info.resolution = size, size, 0.1
    grid.info.origin.orientation.w = 1.0
    return grid


def transform(parent: str, child: str, x: float) -> TransformStamped:
    """Return a transform by so much ahead, [m]."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.transform.translation.x, message.transform.rotation.w = x, 1.0
    return message


def cloud() -> PointCloud2:
    """Return one point at the origin."""
    fields = [PointField(name=name, offset=4 * i, datatype=7, count=1) for i, name in enumerate("xyz")]
    return PointCloud2(height=1, width=1, point_step=12, row_step=12, fields=fields, data=bytes(12))


def samples() -> dict[str, Any]:
    """Return one message of each stream."""
    poses = [PoseStamped(), PoseStamped()]
    poses[1].pose.position.x = 1.0  # [m]
    corners = [Point32(x=x, y=y) for x, y in ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2))]  # [m]
    footprint, waypoint = PolygonStamped(), Marker(ns="waypoints", type=Marker.SPHERE)
    footprint.polygon.points = corners
    waypoint.header.frame_id, waypoint.color.a = "map", 1.0
    waypoint.scale.x = waypoint.scale.y = waypoint.scale.z = 0.2  # [m]
    scan = LaserScan(angle_max=1.0, angle_increment=0.5, range_max=10.0, ranges=[1.0, 2.0, 3.0])
    image = Image(height=1, width=1, encoding="rgb8", step=3, data=bytes(3))
    messages = (scan, cloud(), Path(poses=poses), Path(poses=poses), footprint, MarkerArray(), image)
    messages[5].markers.append(waypoint)
    return {stream[1]: message for stream, message in zip(STREAMS, messages, strict=True)}


FRAMES = {"/scan": "base_scan", "/plan": "map", "/camera/image_raw": "camera"}


class Nav2(Node):
    """The topics that the Nav2 layout displays and its tools publish."""

    def __init__(self) -> None:
        super().__init__("nav2")
        static = StaticTransformBroadcaster(self)
        static.sendTransform([transform("map", "odom", 1.0), transform("base_link", "base_scan", 0.2)])
        self._broadcaster = TransformBroadcaster(self)
        self._streams = {topic: self.create_publisher(kind, topic, qos) for kind, topic, qos in STREAMS}
        self._samples = samples()
        for topic, frame in MAPS.items():
            latched = grid(10)
            latched.header.frame_id = frame
            self.create_publisher(OccupancyGrid, topic, LATCHED).publish(latched)
        self.create_subscription(PoseStamped, "/goal_pose", self._log, 10)
        self.create_subscription(PoseWithCovarianceStamped, "/initialpose", self._log, 10)
        self.create_timer(0.1, self._publish)

    def _publish(self) -> None:
        now = self.get_clock().now().to_msg()
        moved = transform("odom", "base_link", 0.5)
        moved.header.stamp = now
        self._broadcaster.sendTransform(moved)
        for topic, message in self._samples.items():
            if not isinstance(message, MarkerArray):
                message.header.frame_id, message.header.stamp = FRAMES.get(topic, "base_link"), now
            self._streams[topic].publish(message)

    def _log(self, message: Any) -> None:
        pose = getattr(message.pose, "pose", message.pose)
        self.get_logger().info(f"{type(message).__name__} {pose.position.x:.1f} {pose.position.y:.1f}")


def main() -> None:
    """Run until Ctrl+C."""
    rclpy.init()
    node = Nav2()
    node.get_logger().info("Nav2 is ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
