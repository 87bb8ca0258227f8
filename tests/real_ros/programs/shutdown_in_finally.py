# mypy: ignore-errors
import rclpy
from rclpy.node import Node


def main() -> None:
    rclpy.init()
    node = Node("n")
    rclpy.get_default_context().on_shutdown(lambda: print("on_shutdown"))
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print("interrupted")
    finally:
        node.destroy_node()
        print("destroyed")
        rclpy.shutdown()
        print("shut down")


main()
