"""The unknown robot: an ordinary rclpy program, run by `course robot unknown`."""

import rclpy
from rclpy.executors import MultiThreadedExecutor

from course_lib.gateway.spinning import spin_all
from course_lib.robots.unknown_robot import unknown_robot


def main() -> None:
    """Run until Ctrl+C; on several threads, so that no node waits for another."""
    rclpy.init()
    spin_all(MultiThreadedExecutor(), unknown_robot(), "The robot is ready. Explore it.")


if __name__ == "__main__":
    main()
