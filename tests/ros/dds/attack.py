"""A program that publishes and calls without permission, and a robot that detects it."""

SPEED = 6.5  # [m/s] of the commands that are tried
ATTEMPTS = 1000
ATTACK = f"""
import rclpy
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Twist
from lifecycle_msgs.srv import ChangeState
from rclpy.action import ActionClient, ActionServer
from rclpy.lifecycle import LifecycleNode
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.serialization import serialize_message
from std_msgs.msg import String
from std_srvs.srv import SetBool

rclpy.init()
namespaces = enumerate(("/", "/lab", "/lab/robot", "/allowed"))
nodes = [rclpy.create_node(f"attacker{{number}}", namespace=name) for number, name in namespaces]
nodes.append(LifecycleNode("alive"))
nodes[-1].trigger_configure()
nodes[-1].trigger_activate()
attempts, found = 0, False
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
command = Twist()
command.linear.x = {SPEED}


def attempt(action):
    global attempts
    attempts += 1
    try:
        action()
    except Exception as error:
        print(type(error).__name__, flush=True)


def publish(node, kind, topic, qos, message, keeps):
    publisher = node.create_publisher(kind, topic, qos)
    publisher.publish(message)
    publisher.publish(serialize_message(message))
    if not keeps:
        node.destroy_publisher(publisher)


def call(node, kind, name, request):
    client = node.create_client(kind, name)
    client.wait_for_service(timeout_sec=0.2)
    client.call_async(request)


def set_parameters(node):
    AsyncParameterClient(node, "/lab/robot").set_parameters([Parameter("speed", value=6.5)])


def send_goal(node):
    ActionClient(node, Fibonacci, "/fib").send_goal_async(Fibonacci.Goal(order=6))


topics = ("/cmd_vel", "cmd_vel", "/lab/cmd_vel", "/chatter", "/allowe", "/allowed/more", "/tf")
topics += ("/lab/robot/set", "/reset/_action/feedback", "/cmd_vel/_action/feedback", "/fib/_action/feedback")
rounds = 0
while attempts < {ATTEMPTS}:
    rounds += 1
    for node in nodes:
        for topic in topics:
            for qos in (10, latched, qos_profile_sensor_data):
                attempt(lambda: publish(node, Twist, topic, qos, command, rounds % 2))
        attempt(lambda: publish(node, String, "/robot_description", latched, String(data="evil"), False))
        for name in ("/reset", "/private"):
            attempt(lambda: call(node, SetBool, name, SetBool.Request(data=True)))
            attempt(lambda: node.create_service(SetBool, f"{{name}}{{rounds}}", lambda q, a: a))
        attempt(lambda: call(node, ChangeState, "/lab/robot/change_state", ChangeState.Request()))
        attempt(lambda: set_parameters(node))
        attempt(lambda: send_goal(node))
        attempt(lambda: ActionServer(node, Fibonacci, f"/stolen{{rounds}}", lambda goal: None))
        rclpy.spin_once(node, timeout_sec=0.02)
publish(nodes[0], String, "/allowed", 10, String(), True)
said = nodes[0].create_publisher(String, "/allowed", 10)
nodes[0].create_timer(0.1, lambda: said.publish(String(data=f"{{attempts}} attempts")))
rclpy.spin(nodes[0])
"""
VICTIM = """
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String
from std_srvs.srv import SetBool

rclpy.init()
node = rclpy.create_node("robot", namespace="/lab")
node.declare_parameter("speed", 0.5)
topics = ["/cmd_vel", "/lab/cmd_vel", "/chatter", "/allowe", "/allowed/more", "/tf", "/lab/robot/set"]
topics += ["/reset/_action/feedback", "/cmd_vel/_action/feedback", "/fib/_action/feedback"]
for topic in topics:
    on_command = lambda m, t=topic: print("hit", t, flush=True)
    node.create_subscription(Twist, topic, on_command, qos_profile_sensor_data)
node.create_subscription(String, "/robot_description", lambda m: print("hit", m, flush=True), 10)
for name in ("/reset", "/private"):
    node.create_service(SetBool, name, lambda q, a, n=name: (print("hit", n, flush=True), a)[1])


def on_parameters(parameters):
    print("hit parameters", flush=True)
    return SetParametersResult(successful=True)


def look():
    # Only what the kit has on the network is listed beside the robot's own.
    for topic, _ in node.get_topic_names_and_types():
        for info in node.get_publishers_info_by_topic(topic):
            if info.node_name != "robot" and topic != "/allowed":
                print("hit publisher", topic, info.node_name, flush=True)
    for name, namespace in node.get_node_names_and_namespaces():
        if name != "robot":
            ends = node.get_client_names_and_types_by_node(name, namespace)
            ends += node.get_service_names_and_types_by_node(name, namespace)
            if ends:
                print("hit services", name, ends, flush=True)


node.add_on_set_parameters_callback(on_parameters)
node.create_subscription(String, "/allowed", lambda m: print("allowed", m.data, flush=True), 10)
node.create_timer(0.5, look)
print("up", flush=True)
rclpy.spin(node)
"""
