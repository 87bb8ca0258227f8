"""The unknown robot: an ordinary rclpy program, run by `course robot unknown`."""

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

from course_lib.robots.unknown_robot import unknown_robot


def main() -> None:
    """Run until Ctrl+C; on several threads, so that no node waits for another."""
    rclpy.init()
    executor = MultiThreadedExecutor()
    nodes = unknown_robot()
    for node in nodes:
        executor.add_node(node)
    nodes[0].get_logger().info("The robot is ready. Explore it.")
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
