"""A driving base with a laser scanner in a room of 8 m: a ROS 2 program, run by `course robot`.

It does not import the kit, so the same file runs on the kit's rclpy and on the real one.
"""

import contextlib
import math
import random

import rclpy
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

# Position of the laser in base_link [m].
LASER = (0.25, 0.0, 0.35)
URDF = f"""<robot name="driving_robot">
<material name="blue"><color rgba="0.2 0.4 0.8 1"/></material>
<material name="dark"><color rgba="0.2 0.2 0.2 1"/></material>
<link name="base_link">
 <visual><origin xyz="0 0 0.15"/><geometry><box size="0.6 0.4 0.3"/></geometry>
  <material name="blue"/></visual>
</link>
<link name="laser">
 <visual><geometry><cylinder radius="0.06" length="0.1"/></geometry><material name="dark"/></visual>
</link>
<joint name="laser_mount" type="fixed"><parent link="base_link"/><child link="laser"/>
 <origin xyz="{LASER[0]} {LASER[1]} {LASER[2]}"/></joint>
</robot>"""
# Distance from the middle of the room, where the robot starts, to the walls [m].
HALF_ROOM = 3.9
# x, y and radius of the columns [m].
COLUMNS = ((2.0, 1.5, 0.3), (-1.5, -2.0, 0.3))
# Number of beams, maximum range and noise [m].
BEAMS, RANGE_MAX, NOISE = 360, 10.0, 0.005
# In [m/s] and [rad/s].
MAX_LINEAR, MAX_ANGULAR = 1.0, 2.0
# The base stops after this time without a command [s].
TIMEOUT = 0.5
# In seconds.
BASE_PERIOD, SCAN_PERIOD = 0.05, 0.1


def transform(node: Node, parent: str, child: str) -> TransformStamped:
    """Return an identity transform with the current stamp."""
    result = TransformStamped(child_frame_id=child)
    result.header.frame_id, result.header.stamp = parent, node.get_clock().now().to_msg()
    return result


class Base(Node):
    """Follows /cmd_vel, and publishes /odom and the transform from base_link to odom."""

    def __init__(self) -> None:
        super().__init__("base")
        # Pose in odom [m, rad].
        self.x = self.y = self.yaw = 0.0
        self.command, self.age = Twist(), math.inf
        self.odometry_publisher = self.create_publisher(Odometry, "odom", 10)
        self.broadcaster = TransformBroadcaster(self)
        self.create_subscription(Twist, "cmd_vel", self.on_command, 10)
        self.create_timer(BASE_PERIOD, self.update)

    def on_command(self, command: Twist) -> None:
        """Store a command, limited to the base's maximum speeds. Ignore it if it is not finite."""
        velocities = (command.linear.x, command.linear.y, command.angular.z)
        if not all(map(math.isfinite, velocities)):
            self.get_logger().error(f"A command with numbers that are not finite is ignored: {velocities}.")
            return
        limits = (MAX_LINEAR, MAX_LINEAR, MAX_ANGULAR)
        x, y, yaw = (max(-limit, min(limit, v)) for v, limit in zip(velocities, limits, strict=True))
        self.command.linear.x, self.command.linear.y, self.command.angular.z = x, y, yaw
        self.age = 0.0

    def update(self) -> None:
        """Move for one period, and publish the new pose."""
        if self.age >= TIMEOUT:
            self.command = Twist()
        self.age += BASE_PERIOD
        forward_step, left_step = self.command.linear.x * BASE_PERIOD, self.command.linear.y * BASE_PERIOD
        self.x += math.cos(self.yaw) * forward_step - math.sin(self.yaw) * left_step
        self.y += math.sin(self.yaw) * forward_step + math.cos(self.yaw) * left_step
        self.yaw += self.command.angular.z * BASE_PERIOD
        odom_to_base = transform(self, "odom", "base_link")
        odom_to_base.transform.translation.x, odom_to_base.transform.translation.y = self.x, self.y
        odom_to_base.transform.rotation.z, odom_to_base.transform.rotation.w = (
            math.sin(self.yaw / 2),
            math.cos(self.yaw / 2),
        )
        self.broadcaster.sendTransform(odom_to_base)
        odometry = Odometry(header=odom_to_base.header, child_frame_id="base_link")
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.x, self.y
        odometry.pose.pose.orientation = odom_to_base.transform.rotation
        odometry.twist.twist = self.command
        self.odometry_publisher.publish(odometry)


class LaserScanner(Node):
    """Measures the distances to walls and columns of the room from the base's pose."""

    def __init__(self, base: Base) -> None:
        super().__init__("laser_scanner")
        self.base = base
        self.publisher = self.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.create_timer(SCAN_PERIOD, self.measure)

    def measure(self) -> None:
        """Publish one scan."""
        base, step = self.base, 2 * math.pi / BEAMS
        scan = LaserScan(angle_min=-math.pi, angle_max=math.pi - step, angle_increment=step)
        scan.header.frame_id, scan.header.stamp = "laser", self.get_clock().now().to_msg()
        scan.scan_time, scan.range_min, scan.range_max = SCAN_PERIOD, 0.05, RANGE_MAX
        x = base.x + LASER[0] * math.cos(base.yaw)
        y = base.y + LASER[0] * math.sin(base.yaw)
        distances = (distance(x, y, base.yaw - math.pi + beam * step) for beam in range(BEAMS))
        scan.ranges = [r + random.gauss(0.0, NOISE) if r < RANGE_MAX else math.inf for r in distances]
        self.publisher.publish(scan)


def distance(x: float, y: float, angle: float) -> float:
    """Return the distance from a point to the first wall or column in a direction [m]."""
    along_x, along_y = math.cos(angle), math.sin(angle)
    nearest = math.inf
    for place, along in ((x, along_x), (y, along_y)):
        if abs(along) > 1e-9:
            to_wall = (math.copysign(HALF_ROOM, along) - place) / along
            nearest = min(nearest, to_wall if to_wall > 0 else math.inf)
    for column_x, column_y, radius in COLUMNS:
        forward_distance = (column_x - x) * along_x + (column_y - y) * along_y
        beside = (column_x - x) * along_y - (column_y - y) * along_x
        if forward_distance > 0 and abs(beside) < radius:
            nearest = min(nearest, forward_distance - math.sqrt(radius**2 - beside**2))
    return max(nearest, 0.0)


class Description(Node):
    """Publishes the robot's description and its static transforms, both latched."""

    def __init__(self) -> None:
        super().__init__("robot_state_publisher")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, "robot_description", latched)
        self.publisher.publish(String(data=URDF))
        laser = transform(self, "base_link", "laser")
        shift = laser.transform.translation
        shift.x, shift.y, shift.z = LASER
        self.broadcaster = StaticTransformBroadcaster(self)
        # Odometry has no drift, so map and odom are the same.
        self.broadcaster.sendTransform([laser, transform(self, "map", "odom")])


def main() -> None:
    """Run until Ctrl+C."""
    rclpy.init()
    executor = SingleThreadedExecutor()
    base = Base()
    for node in (base, LaserScanner(base), Description()):
        executor.add_node(node)
    base.get_logger().info("The robot is ready. It drives by /cmd_vel.")
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
