"""The demo's node: an ordinary rclpy program that shows a red cube."""

import rclpy
from rclpy.node import Node
from visualization_msgs.msg import Marker


class RedCubeNode(Node):
    """Publishes a 1 m cube on the ground plane every second."""

    # Height of the centre [m].
    height = 0.5

    def __init__(self) -> None:
        super().__init__("red_cube")
        self.publisher = self.create_publisher(Marker, "/visualization_marker", 10)
        self.timer = self.create_timer(1.0, self.publish_cube)  # [s]

    def publish_cube(self) -> None:
        """Publish the cube."""
        cube = Marker(ns="basic_shapes", id=0, type=Marker.CUBE, action=Marker.ADD)
        cube.header.frame_id = "map"
        cube.header.stamp = self.get_clock().now().to_msg()
        cube.pose.position.z = self.height  # [m]
        cube.scale.x = cube.scale.y = cube.scale.z = 1.0  # [m]
        cube.color.r, cube.color.a = 1.0, 0.8
        self.publisher.publish(cube)
        self.get_logger().info("Published a red cube")


def main() -> None:
    """Run until Ctrl+C."""
    rclpy.init()
    node = RedCubeNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
