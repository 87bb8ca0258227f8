"""A driving base with a laser scanner in a room of 8 m: an ordinary rclpy program, run by `course robot`."""

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node

from course_lib.arrays import Floats
from course_lib.robots import OmniBase, RobotStatePublisher
from course_lib.sensors import LaserScanNode, Thing, World, box, cylinder, placed
from course_lib.tools.executables import spin

LASER = (0.25, 0.0, 0.35)  # [m] in base_link
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


class Mount(Node):
    """Holds the scanner on the base: the place that /odom reports."""

    def __init__(self) -> None:
        super().__init__("laser_mount")
        self._transform_base_to_odom = placed(0.0, 0.0, 0.0)
        self.create_subscription(Odometry, "odom", self._move, 10)

    def transform_laser_to_odom(self, _: float) -> Floats:
        """Return the scanner's pose now, whatever time is asked for."""
        return self._transform_base_to_odom @ placed(*LASER)

    def _move(self, odometry: Odometry) -> None:
        pose = odometry.pose.pose
        sin, cos = pose.orientation.z, pose.orientation.w  # of half the yaw
        moved = placed(pose.position.x, pose.position.y, 0.0)
        moved[:2, :2] = [[cos**2 - sin**2, -2 * sin * cos], [2 * sin * cos, cos**2 - sin**2]]
        self._transform_base_to_odom = moved


def room() -> World:
    """Return four walls and two columns; the robot starts in the middle."""
    walls = [Thing(box(8.0, 0.2, 1.0), placed(0, y, 0.5)) for y in (-4.0, 4.0)]  # [m]
    walls += [Thing(box(0.2, 8.0, 1.0), placed(x, 0, 0.5)) for x in (-4.0, 4.0)]
    columns = [Thing(cylinder(0.3, 1.0), placed(x, y, 0.5)) for x, y in ((2.0, 1.5), (-1.5, -2.0))]
    return World([*walls, *columns])


def main() -> None:
    """Run until Ctrl+C."""
    with rclpy.init():
        mount = Mount()
        scanner = LaserScanNode(room(), mount.transform_laser_to_odom, beams=360, range_max=10.0, noise=0.005)
        mount.get_logger().info("The robot is ready. It drives by /cmd_vel.")
        spin(mount, OmniBase(), RobotStatePublisher(URDF), scanner)


if __name__ == "__main__":
    main()
