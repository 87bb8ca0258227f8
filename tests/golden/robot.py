"""The robot that the golden outputs of `ros2` look at: two nodes with one of everything."""

import rclpy
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import TransformStamped
from rclpy.action import ActionServer
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from std_srvs.srv import SetBool
from tf2_ros import StaticTransformBroadcaster


class Robot(Node):
    """Publishes a scan and a name, and offers a service, an action and parameters."""

    def __init__(self) -> None:
        super().__init__("robot", namespace="lab")
        self.declare_parameter("speed", 0.5)
        self.declare_parameter("frames", ["map", "base"])
        self.scans = self.create_publisher(LaserScan, "scan", 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.names = self.create_publisher(String, "name", latched)
        self.names.publish(String(data="Ada"))
        self.create_subscription(String, "order", lambda order: self.get_logger().info(order.data), 10)
        self.create_service(SetBool, "lamp", self.on_lamp)
        self.counter = ActionServer(self, Fibonacci, "count", self.on_goal)
        self.create_timer(0.1, self.on_timer)
        self.frames = StaticTransformBroadcaster(self)
        transform_base_to_map = TransformStamped(child_frame_id="base")
        transform_base_to_map.header.frame_id = "map"
        transform_base_to_map.transform.translation.x = 1.5
        self.frames.sendTransform(transform_base_to_map)

    def on_timer(self) -> None:
        """Publish a scan of three ranges."""
        scan = LaserScan(range_max=10.0, ranges=[1.0, 2.0, 3.0])
        scan.header.stamp = self.get_clock().now().to_msg()
        scan.header.frame_id = "base"
        self.scans.publish(scan)

    def on_lamp(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Switch the lamp."""
        response.success = True
        response.message = "on" if request.data else "off"
        return response

    def on_goal(self, goal: object) -> Fibonacci.Result:
        """Return the beginning of Fibonacci's sequence."""
        goal.succeed()  # type: ignore[attr-defined]  # rclpy does not annotate the callback's argument
        return Fibonacci.Result(sequence=[0, 1, 1])


def start() -> list[Node]:
    """Return the robot's nodes, which spin once robot time passes."""
    rclpy.init()
    return [Robot(), LifecycleNode("camera")]
