# mypy: ignore-errors
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger


def try_to(name, call):
    try:
        print(name, call())
    except Exception as error:
        print(name, type(error).__name__, str(error).split(", at /")[0].split(", at ./")[0])


rclpy.init()
node = Node("n")
node.declare_parameter("p", 1)
publisher = node.create_publisher(String, "t", 10)
client = node.create_client(Trigger, "s")
timer = node.create_timer(10.0, print)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("interrupted")
try_to("publish", lambda: publisher.publish(String()))
try_to("call_async", lambda: type(client.call_async(Trigger.Request())).__name__)
try_to("wait_for_service", lambda: client.wait_for_service(timeout_sec=0.1))
try_to("create_publisher", lambda: node.create_publisher(String, "u", 1))
try_to("create_subscription", lambda: node.create_subscription(String, "u", print, 1))
try_to("create_service", lambda: node.create_service(Trigger, "u", print))
try_to("create_client", lambda: node.create_client(Trigger, "u"))
try_to("create_timer", lambda: node.create_timer(1.0, print))
try_to("create_guard_condition", lambda: node.create_guard_condition(print))
try_to("create_node", lambda: Node("second"))
try_to("set_parameters", lambda: node.set_parameters([Parameter("p", value=2)])[0].successful)
try_to("get_parameter", lambda: node.get_parameter("p").value)
try_to("declare_parameter", lambda: node.declare_parameter("q", 2).value)
try_to("topics", lambda: len(node.get_topic_names_and_types()) > 0)
try_to("count", lambda: node.count_publishers("t"))
try_to("name", node.get_name)
try_to("timer", timer.is_canceled)
try_to("cancel", timer.cancel)
try_to("clock", lambda: node.get_clock().now().nanoseconds > 0)
try_to("ok", rclpy.ok)
try_to("spin_once", lambda: rclpy.spin_once(node))
try_to("spin_once in time", lambda: rclpy.spin_once(node, timeout_sec=0.1))
try_to("spin_once at once", lambda: rclpy.spin_once(node, timeout_sec=0))
try_to("spin", lambda: rclpy.spin(node))
try_to("until", lambda: rclpy.spin_until_future_complete(node, rclpy.Future(), timeout_sec=0.1))
try_to("executor", lambda: type(rclpy.executors.SingleThreadedExecutor()).__name__)
try_to("destroy_timer", lambda: node.destroy_timer(timer))
try_to("destroy_publisher", lambda: node.destroy_publisher(publisher))
try_to("destroy_node", node.destroy_node)
try_to("shutdown", rclpy.shutdown)
try_to("init", lambda: rclpy.init() and None)
try_to("again", lambda: Node("third").get_name())
