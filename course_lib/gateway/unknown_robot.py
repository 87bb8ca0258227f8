"""The unknown robot: an ordinary rclpy program, run by `course robot unknown`."""

import rclpy
from rclpy.executors import MultiThreadedExecutor

from course_lib.robots.unknown_robot import unknown_robot
from course_lib.tools.executables import spin


def main() -> None:
    """Run until Ctrl+C, in several threads so that no node blocks another."""
    with rclpy.init():
        nodes = unknown_robot()
        nodes[0].get_logger().info("The robot is ready. Explore it.")
        spin(*nodes, executor=MultiThreadedExecutor())


if __name__ == "__main__":
    main()
