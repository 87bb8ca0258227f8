"""What students get wrong most often: each with the class and the text that ROS 2 gives it, and a hint.

Texts: ROS 2 Jazzy's rclpy, rosidl, tf2 and Python's own; where ROS hangs, the kit's DeadlockError.
"""

from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph
from course_lib.ros.tracebacks import print_error

PROGRAM = """
from diagnostic_msgs.msg import DiagnosticStatus
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Point, PoseStamped, Twist
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.action import ActionClient, ActionServer
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from std_msgs.msg import ColorRGBA, Float64MultiArray, Int32, String, UInt8
from tf2_ros import Buffer, TransformBroadcaster
from visualization_msgs.msg import Marker
"""
CODE = compile(PROGRAM, "program", "exec")
# (program, the last line of what it says, the hint below it)
MISTAKES = [
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        self.publisher = self.create_publisher(String, 'chatter', 10)\n"
        "Robot()",
        "AttributeError: 'Robot' object has no attribute '_default_callback_group'",
        "call super().__init__('a_name') first in Robot.__init__().",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__()\nRobot()",
        "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'",
        "name the node: super().__init__('a_name').",
    ),
    (
        "node.create_subscription(String, 'chatter', lambda: None, 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "write def heard(self, msg), and give self.heard, without ().",
    ),
    (
        "class Robot(Node):\n"
        "    def heard(msg):\n"
        "        pass\n"
        "robot = Robot('arm')\n"
        "robot.create_subscription(String, 'chatter', robot.heard, 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "write def heard(self, msg), and give self.heard, without ().",
    ),
    (
        "node.create_subscription(String, 'chatter', print('heard'), 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "write def heard(self, msg), and give self.heard, without ().",
    ),
    (
        "node.create_timer(0.1, lambda event: None)\nrclpy.spin(node)",
        "TypeError: <lambda>() missing 1 required positional argument: 'event'",
        "a timer gives no argument.",
    ),
    (
        "node.create_timer(0.1, print('tick'))\nrclpy.spin(node)",
        "TypeError: 'NoneType' object is not callable",
        "give the function itself, without ().",
    ),
    (
        "node.create_timer(-0.1, lambda: None)",
        "rclpy.exceptions.RCLError: failed to create timer: timer period must be non-negative",
        "give the period in seconds, like 0.1 for 10 Hz.",
    ),
    (
        "node.create_timer('0.1 s', lambda: None)",
        "ValueError: could not convert string to float: '0.1 s'",
        "give the period in seconds, as a number.",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish('hello')",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'str'>",
        "put it into a message: String(data=...).",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish(String)",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'type'>",
        "make an object: String(), with ().",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish(Twist())",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class "
        "'geometry_msgs.msg._twist.Twist'>",
        "publish a String, or make the publisher for the other type.",
    ),
    (
        "node.create_publisher(String, 'chatter')",
        "TypeError: Node.create_publisher() missing 1 required positional argument: 'qos_profile'",
        "say how many messages are kept, like 10, as the last argument.",
    ),
    (
        "node.create_publisher(String, 'chatter', '10')",
        "TypeError: Expected QoSProfile or int, but received <class 'str'>",
        "say how many messages are kept, like 10.",
    ),
    (
        "node.create_publisher(String, 'chatter', -1)",
        "ValueError: history depth must be greater than or equal to zero",
        "",
    ),
    (
        "node.create_publisher('std_msgs/msg/String', 'chatter', 10)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 "
        "message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "give the class: from std_msgs.msg import String.",
    ),
    (
        "node.create_publisher(AddTwoInts, 'chatter', 10)",
        "RuntimeError: The message type provided is not valid (<class "
        "'example_interfaces.srv._add_two_ints.AddTwoInts'>), this might be a service or action",
        "they are in .msg, .srv and .action.",
    ),
    (
        "node.create_publisher(String, 'my chatter', 10)",
        "rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name must not "
        "contain characters other than alphanumerics, '_', '~', '{', or '}':",
        "use letters, digits and underscores, and begin with a letter, like robot/front_camera.",
    ),
    (
        "node.create_publisher(String, 'chatter/', 10)",
        "rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name must not end "
        "with a forward slash:",
        "use letters, digits and underscores, and begin with a letter, like robot/front_camera.",
    ),
    (
        "node.create_publisher(String, '2nd/chatter', 10)",
        "rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name token must not "
        "start with a number:",
        "use letters, digits and underscores, and begin with a letter, like robot/front_camera.",
    ),
    (
        "node.create_publisher(String, '', 10)",
        "rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name must not be "
        "empty string:",
        "use letters, digits and underscores, and begin with a letter, like robot/front_camera.",
    ),
    (
        "publisher = node.create_publisher(String, 'chatter', 10)\n"
        "node.destroy_publisher(publisher)\n"
        "publisher.publish(String())",
        "rclpy.exceptions.InvalidHandle: cannot use Destroyable because destruction was requested",
        "it was destroyed before; make a new one, or destroy it later.",
    ),
    (
        "rclpy.shutdown()\nNode('late')",
        "rclpy.exceptions.NotInitializedException: rclpy.init() has not been called. msg:cannot create node",
        "call rclpy.init() first.",
    ),
    (
        "rclpy.init()",
        "RuntimeError: Context.init() must only be called once",
        "one rclpy.init() per program; rclpy.ok() says if it was.",
    ),
    (
        "rclpy.shutdown()\nrclpy.shutdown()",
        "RuntimeError: Context must be initialized before it can be shutdown",
        "rclpy.try_shutdown() never complains.",
    ),
    (
        "Node('my robot')",
        "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not contain "
        "characters other than alphanumerics or '_':",
        "use letters, digits and underscores, like front_camera; the rest is for namespace=.",
    ),
    (
        "Node('2nd')",
        "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not start "
        "with a number:",
        "use letters, digits and underscores, like front_camera; the rest is for namespace=.",
    ),
    (
        "Node('/robot')",
        "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not contain "
        "characters other than alphanumerics or '_':",
        "use letters, digits and underscores, like front_camera; the rest is for namespace=.",
    ),
    (
        "Node('robot', namespace='my ns')",
        "rclpy.exceptions.InvalidNamespaceException: Invalid namespace: namespace must not contain "
        "characters other than alphanumerics, '_', or '/':",
        "use letters, digits and underscores, and begin with a letter, like /robot_1.",
    ),
    (
        "Twist().linear.x = 1",
        "AssertionError: The 'x' field must be of type 'float'",
        "write the number with a point: 1.0, or float(x).",
    ),
    (
        "Twist(linear=(1.0, 0.0, 0.0))",
        "AssertionError: The 'linear' field must be a sub message of type 'Vector3'",
        "make one, with names: Vector3(x=1.0, ...).",
    ),
    (
        "Int32(data=1.5)",
        "AssertionError: The 'data' field must be of type 'int'",
        "write int(x), or round(x).",
    ),
    (
        "UInt8(data=300)",
        "AssertionError: The 'data' field must be an unsigned integer in [0, 255]",
        "",
    ),
    (
        "String(data=5)",
        "AssertionError: The 'data' field must be of type 'str'",
        "write str(x), or an f-string.",
    ),
    (
        "ColorRGBA(r=255)",
        "AssertionError: The 'r' field must be of type 'float'",
        "colours go from 0.0 to 1.0.",
    ),
    (
        "DiagnosticStatus(level=0)",
        "AssertionError: The 'level' field must be of type 'bytes' or 'ByteString' with length 1",
        "write DiagnosticStatus.OK, WARN, ERROR or STALE.",
    ),
    (
        "String('hello')",
        "TypeError: String.__init__() takes 1 positional argument but 2 were given",
        "name what you give: String(data=...).",
    ),
    (
        "String(dta='hello')",
        "AssertionError: Invalid arguments passed to constructor: dta",
        "%ros2 interface show lists them.",
    ),
    (
        "message = String()\nmessage.dta = 'hello'",
        "AttributeError: 'String' object has no attribute 'dta'",
        "%ros2 interface show example_interfaces/msg/String or std_msgs/msg/String lists its fields.",
    ),
    (
        "PoseStamped().pose.position = (1.0, 2.0, 3.0)",
        "AssertionError: The 'position' field must be a sub message of type 'Point'",
        "make one, with names: Point(x=1.0, ...).",
    ),
    (
        "PoseStamped().pose.orientation = 1.57",
        "AssertionError: The 'orientation' field must be a sub message of type 'Quaternion'",
        "Quaternion(z=sin(yaw / 2), w=cos(yaw / 2)).",
    ),
    (
        "PoseStamped().header.stamp = node.get_clock().now()",
        "AssertionError: The 'stamp' field must be a sub message of type 'Time'",
        "write node.get_clock().now().to_msg().",
    ),
    (
        "PoseStamped().header.frame_id = None",
        "AssertionError: The 'frame_id' field must be of type 'str'",
        "write str(x), or an f-string.",
    ),
    (
        "marker = Marker()\n"
        "marker.points.append((1.0, 2.0, 3.0))\n"
        "node.create_publisher(Marker, 'marker', 10).publish(marker)",
        "AssertionError: The 'points' field must be a set or sequence and each value of type 'Point'",
        "give a list of them: [Point(x=1.0, ...)].",
    ),
    (
        "Marker().points = Point()",
        "AssertionError: The 'points' field must be a set or sequence and each value of type 'Point'",
        "give a list of them: [Point(x=1.0, ...)].",
    ),
    (
        "node.declare_parameter('speed', 1)\nnode.declare_parameter('speed', 2)",
        "rclpy.exceptions.ParameterAlreadyDeclaredException: Parameter(s) already declared: ['speed']",
        "declare it once, in __init__; set_parameters changes it.",
    ),
    (
        "node.get_parameter('speed')",
        "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): speed",
        "declare it first: self.declare_parameter('a_name', 1.0).",
    ),
    (
        "node.set_parameters([Parameter('speed', value=1)])",
        "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): []",
        "declare it first: self.declare_parameter('a_name', 1.0).",
    ),
    (
        "node.declare_parameter('speed', 1.0)\nprint(node.get_parameter('speed') * 2)",
        "TypeError: unsupported operand type(s) for *: 'Parameter' and 'int'",
        "ask for its value: get_parameter('a_name').value.",
    ),
    (
        "node.declare_parameter('speed', {'max': 1.0})",
        "TypeError: The given value is not one of the allowed types '{'max': 1.0}'.",
        "bool, int, float, str, or lists.",
    ),
    (
        "node.declare_parameter('speeds', [1, 'fast'])",
        "TypeError: The given value is not a list of one of the allowed types '[1, 'fast']'.",
        "bool, int, float, str, or lists.",
    ),
    (
        "node.declare_parameter('speed', Parameter.Type.DOUBLE)\nnode.get_parameter('speed').value",
        "rclpy.exceptions.ParameterUninitializedException: The parameter 'speed' is not initialized: speed",
        "declare it with a default value, or set it before.",
    ),
    (
        "client = node.create_client(AddTwoInts, 'add')\nclient.call_async(AddTwoInts.Request()).sum",
        "AttributeError: 'Future' object has no attribute 'sum'",
        "it comes later: await it, or add_done_callback(f).",
    ),
    (
        "client = node.create_client(AddTwoInts, 'add')\nclient.call_async(AddTwoInts)",
        "TypeError",
        "give a request, with (): AddTwoInts.Request(a=1, b=2).",
    ),
    (
        "node.create_client(AddTwoInts.Request, 'add')",
        "RuntimeError: The service type provided is not valid (<class "
        "'example_interfaces.srv._add_two_ints.AddTwoInts_Request'>), this might be a message or "
        "action",
        "they are in .msg, .srv and .action.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: None)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin(node)",
        "TypeError",
        "end the service's callback with: return response.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: request.a + request.b)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin(node)",
        "TypeError",
        "end the service's callback with: return response.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request: None)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin(node)",
        "TypeError: <lambda>() takes 1 positional argument but 2 were given",
        "write def answer(self, request, response).",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: response)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "node.create_timer(0.1, lambda: client.call(AddTwoInts.Request()))\n"
        "rclpy.spin(node)",
        "course_lib.ros.baton.DeadlockError: call() on /add waits for a response that is taken "
        "only after this callback has ended. Use call_async() with add_done_callback() or await; "
        "or a MultiThreadedExecutor, with the client in another callback group.",
        "",
    ),
    (
        "AddTwoInts()",
        "NotImplementedError: Service classes can not be instantiated",
        "make its request: AddTwoInts.Request(a=1).",
    ),
    (
        "rate = node.create_rate(10)\nnode.create_timer(0.1, rate.sleep)\nrclpy.spin(node)",
        "course_lib.ros.baton.DeadlockError: Rate.sleep() waits for a tick that comes only after "
        "this callback has ended. Use a timer, or a MultiThreadedExecutor.",
        "",
    ),
    (
        "node.create_timer(0.1, lambda: rclpy.spin(node))\nrclpy.spin(node)",
        "ValueError: generator already executing",
        "a callback must not spin: use await, or add_done_callback.",
    ),
    (
        "rclpy.spin()",
        "TypeError: spin() missing 1 required positional argument: 'node'",
        "say which node: rclpy.spin(node).",
    ),
    (
        "node.get_logger().info(5)",
        "TypeError: rclpy_logging_rcutils_log(): incompatible function arguments: the message must "
        "be a str, not int; write str(...) or an f-string",
        "write one f-string: info(f'speed: {speed}').",
    ),
    (
        "node.get_logger().info('speed:', 5)",
        "TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given",
        "write one f-string: info(f'speed: {speed}').",
    ),
    (
        "for say in ('info', 'error'):\n    getattr(node.get_logger(), say)('hello')",
        "ValueError: Logger severity cannot be changed between calls.",
        "write one line for each severity.",
    ),
    (
        "node.get_clock().now() - Time()",
        "TypeError: Can't subtract times with different clock types",
        "write Time(clock_type=ClockType.ROS_TIME).",
    ),
    (
        "node.get_clock().now() > 5.0",
        "TypeError: '>' not supported between instances of 'Time' and 'float'",
        "compare with a Time or a Duration: Duration(seconds=5.0).",
    ),
    (
        "stamp = node.get_clock().now().to_msg()\nstamp - stamp",
        "TypeError: unsupported operand type(s) for -: 'Time' and 'Time'",
        "messages cannot be subtracted: Time.from_msg(stamp) can.",
    ),
    (
        "node.get_clock().now() - 1.0",
        "TypeError: unsupported operand type(s) for -: 'Time' and 'float'",
        "add or subtract a Duration: Duration(seconds=1.0).",
    ),
    (
        "Duration(1.0)",
        "TypeError: Duration.__init__() takes 1 positional argument but 2 were given",
        "name what you give: Duration(seconds=1.0).",
    ),
    (
        "Time(seconds=-1)",
        "ValueError: Seconds value must not be negative",
        "",
    ),
    (
        "QoSProfile()",
        "rclpy.qos.InvalidQoSProfileException: ('Invalid QoSProfile', 'History and/or depth "
        "settings are required.')",
        "say how many messages are kept: depth=10.",
    ),
    (
        "QoSProfile(dept=10)",
        "AssertionError: Invalid arguments passed to constructor: dict_keys(['dept'])",
        "it takes depth, reliability, ...",
    ),
    (
        "best = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)\n"
        "node.create_publisher(String, 'chatter', best)\n"
        "node.create_subscription(String, 'chatter', print, 10)",
        "[WARN] [robot]: New publisher discovered on topic 'chatter', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: RELIABILITY",
        "",
    ),
    (
        "node.create_publisher(String, 'latched', 1)\n"
        "latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n"
        "node.create_subscription(String, 'latched', print, latched)",
        "[WARN] [robot]: New publisher discovered on topic 'latched', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: DURABILITY",
        "",
    ),
    (
        "node.create_publisher(String, 'chatter', 1)\nnode.create_subscription(Int32, 'chatter', print, 1)",
        "[WARN] [robot]: Incompatible type on topic 'chatter', no messages will be sent to it.",
        "",
    ),
    (
        "Buffer().lookup_transform('map', 'base', Time())",
        'tf2.LookupException: "map" passed to lookupTransform argument target_frame does not exist. ',
        "is the frame published, spelt so? %ros2 run tf2_tools view_frames.",
    ),
    (
        "Buffer().lookup_transform('/map', 'base', Time())",
        'tf2.InvalidArgumentException: Invalid argument "/map" passed to lookupTransform argument '
        "target_frame - in tf2 frame_ids cannot start with a '/'",
        "write the frame's name without the slash.",
    ),
    (
        "buffer = Buffer()\n"
        "for parent, child in (('map', 'odom'), ('world', 'base')):\n"
        "    buffer.set_transform(transform(parent, child, 1), 'me')\n"
        "buffer.lookup_transform('map', 'base', Time())",
        "tf2.ConnectivityException: Could not find a connection between 'map' and 'base' because "
        "they are not part of the same tree.Tf has two or more unconnected trees.",
        "a transform between two trees is missing: %ros2 run tf2_tools view_frames.",
    ),
    (
        "buffer = Buffer()\n"
        "for second in (1, 2):\n"
        "    buffer.set_transform(transform('map', 'base', second), 'me')\n"
        "buffer.lookup_transform('map', 'base', Time(seconds=3))",
        "tf2.ExtrapolationException: Lookup would require extrapolation into the future.  "
        "Requested time 3.000000 but the latest data is at time 2.000000, when looking up "
        "transform from frame [base] to frame [map]",
        "ask for the latest one, Time(), or give a timeout.",
    ),
    (
        "Buffer().set_transform(transform('', 'base', 1), 'me')",
        '[ERROR] []: TF_NO_FRAME_ID: Ignoring transform with child_frame_id "base"  from authority '
        '"me" because frame_id not set',
        "",
    ),
    (
        "Buffer().set_transform(transform('base', 'base', 1), 'me')",
        '[ERROR] []: TF_SELF_TRANSFORM: Ignoring transform from authority "me" with frame_id and  '
        'child_frame_id "base" because they are the same',
        "",
    ),
    (
        "Buffer().transform(Marker(), 'map')",
        "tf2_ros.buffer_interface.TypeException: Type <class "
        "'visualization_msgs.msg._marker.Marker'> is not loaded or supported",
        "import tf2_geometry_msgs: it knows points and poses.",
    ),
    (
        "from std_msgs.msg import string",
        "ImportError: cannot import name 'string' from 'std_msgs.msg'",
        "%ros2 interface package std_msgs lists its types.",
    ),
    (
        "from geometry_msgs import Twist",
        "ImportError: cannot import name 'Twist' from 'geometry_msgs'",
        "write from geometry_msgs.msg import Twist, or .srv, or .action.",
    ),
    (
        "from my_msgs.msg import Speed",
        "ModuleNotFoundError: No module named 'my_msgs'",
        "put the folder my_msgs with its msg beside the program.",
    ),
    (
        "import ros2",
        "ModuleNotFoundError: No module named 'ros2'",
        "",
    ),
    (
        "ActionServer(node, Fibonacci, 'count', lambda goal: goal.succeed())\n"
        "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\n"
        "rclpy.spin(node)",
        "AssertionError: The 'result' field must be a sub message of type 'Fibonacci_Result'",
        "end the callback with return MyAction.Result().",
    ),
    (
        "ActionClient(node, Fibonacci, 'count').send_goal_async(5)",
        "TypeError",
        "give a goal, with (): Fibonacci.Goal(order=5).",
    ),
    (
        "ActionServer(node, AddTwoInts, 'count', print)",
        "RuntimeError: The action type provided is not valid (<class "
        "'example_interfaces.srv._add_two_ints.AddTwoInts'>), this might be a message or service",
        "they are in .msg, .srv and .action.",
    ),
]


def transform(parent: str, child: str, second: int) -> TransformStamped:
    """Make a transform for the programs."""
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id, made.header.stamp.sec = parent, second
    return made


@pytest.fixture
def robot(graph: Graph) -> Iterator[Node]:
    """A run with a node, which a program may end itself."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    yield Node("robot")
    rclpy.try_shutdown()


def test_there_are_sixty_of_them_most_with_a_hint() -> None:
    assert len(MISTAKES) >= 60
    assert sum(bool(hint) for _, _, hint in MISTAKES) >= 60


@pytest.mark.parametrize(("program", "said", "hint"), MISTAKES)
def test_a_mistake_gets_ros_2_s_words_and_a_hint(
    robot: Node, capfd: pytest.CaptureFixture[str], program: str, said: str, hint: str
) -> None:
    names = {"rclpy": rclpy, "node": robot, "transform": transform}
    exec(CODE, names)
    with baton.known():
        try:
            exec(compile(program, "program.py", "exec"), names)
        except Exception as error:
            print_error(error)
    shown = capfd.readouterr().err
    assert said in shown.replace(f"[{robot.get_clock().now().nanoseconds / 1e9:.9f}] ", "")
    assert (f"\nhint: {hint}\n" in shown) if hint else "hint:" not in shown
