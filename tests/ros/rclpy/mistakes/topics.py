"""Publishers, subscriptions and their QoS."""

# (program, last line of the error, hint below it)
TOPICS = [
    (
        "node.create_subscription(String, 'chatter', 'heard', 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "the callback is a function and not its name: write self.heard, without quotes.",
    ),
    (
        "node.create_subscription(String, 'chatter', lambda: None, 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "the callback gets the message: write `def on_message(self, msg)`, and pass "
        "`self.on_message`, without ().",
    ),
    (
        "class Robot(Node):\n"
        "    def heard(msg):\n"
        "        pass\n"
        "robot = Robot('arm')\n"
        "robot.create_subscription(String, 'chatter', robot.heard, 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "the callback gets the message: write `def heard(self, msg)`, and pass `self.heard`, without ().",
    ),
    (
        "node.create_subscription(String, 'chatter', print('heard'), 10)",
        "RuntimeError: Subscription.__init__(): callback should be either be callable with one "
        "argument(to get only the message) or two (to get message and message info)",
        "the callback gets the message: write `def on_message(self, msg)`, and pass "
        "`self.on_message`, without ().",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish('hello')",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'str'>",
        "put it into a message: String(data=…).",
    ),
    (
        "node.create_publisher(Marker, 'cubes', 10).publish('marker')",
        "TypeError: Expected <class 'visualization_msgs.msg._marker.Marker'>, got <class 'str'>",
        "publish a message: create one with `Marker()`, and set its fields.",
    ),
    (
        "node.create_publisher('chatter', String, 10)",
        "TypeError: rclpy_resolve_name(): incompatible function arguments.",
        "pass the type first, then the name in quotes: `self.create_publisher(Marker, '/a_topic', 10)`.",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish(String)",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got "
        "<class 'std_msgs.msg._string.Metaclass_String'>",
        "create an object: `String()`, with ().",
    ),
    (
        "node.create_publisher(String(), 'chatter', 10).publish(String())",
        "TypeError: isinstance() arg 2 must be a type, a tuple of types, or a union",
        "pass the class and not an object of it: String, without ( ).",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish(Twist())",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class "
        "'geometry_msgs.msg._twist.Twist'>",
        "publish a String, or create a publisher for the other type.",
    ),
    (
        "node.create_publisher(String, 'chatter')",
        "TypeError: Node.create_publisher() missing 1 required positional argument: 'qos_profile'",
        "pass the number of messages to keep, like 10, as the last argument.",
    ),
    (
        "node.create_publisher(String, 'chatter', '10')",
        "TypeError: Expected QoSProfile or int, but received <class 'str'>",
        "pass the number of messages to keep, like 10.",
    ),
    (
        "node.create_publisher(String, 'chatter', -1)",
        "ValueError: history depth must be greater than or equal to zero",
        "the depth is the number of messages to keep: 1 or more, like 10.",
    ),
    (
        "node.create_publisher('std_msgs/msg/String', 'chatter', 10)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 "
        "message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "pass the class and not its name in quotes: `from std_msgs.msg import String`, then String.",
    ),
    (
        "node.create_publisher(AddTwoInts, 'chatter', 10)",
        "RuntimeError: The message type provided is not valid (<class "
        "'example_interfaces.srv._add_two_ints.AddTwoInts'>), this might be a service or action",
        "import types from .msg, .srv or .action.",
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
        "rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was requested",
        "the object has already been destroyed: create a new one, or destroy it later.",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).destroy()\nrclpy.spin_once(node)",
        "rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was requested",
        "a publisher or subscription was destroyed by its own method, and the node still uses it: "
        "call `node.destroy_publisher(publisher)` or `node.destroy_subscription(subscription)` instead.",
    ),
    (
        "QoSProfile()",
        "rclpy.qos.InvalidQoSProfileException: ('Invalid QoSProfile', 'History and/or depth "
        "settings are required.')",
        "pass the number of messages to keep: `QoSProfile(depth=10)`.",
    ),
    (
        "QoSProfile(dept=10)",
        "AssertionError: Invalid arguments passed to constructor: dict_keys(['dept'])",
        "did you mean `depth`?",
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
        "rclpy._rclpy_pybind11.RCLError: Failed to create subscription: invalid allocator",
        "the program already uses this name with another type. One topic or service has one type: "
        "`%ros2 topic info /a_topic` and `%ros2 service type /a_service` show it.",
    ),
    (
        "node.create_subscription(String, print, 'chatter', 10)",
        "TypeError: rclpy_resolve_name(): incompatible function arguments.",
        "pass the type first, then the name in quotes: "
        "`self.create_subscription(Marker, '/a_topic', self.on_message, 10)`.",
    ),
    (
        "node.create_publisher(String, 'chatter', 10).publish(print())",
        "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'NoneType'>",
        "this is None, not a String: does the function that creates the message end with return?",
    ),
    (
        "node.create_publisher('Marker', '/chatter', 10)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS "
        "1 message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "pass the class and not its name: Marker, without quotes.",
    ),
    (
        "node.create_publisher('visualization_msgs/Marker', '/chatter', 10)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS "
        "1 message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "pass the class and not its name in quotes: `from visualization_msgs.msg import "
        "Marker`, then Marker.",
    ),
    (
        "node.create_subscription(Marker, '/chatter', 10)",
        "TypeError: Node.create_subscription() missing 1 required positional argument: 'qos_profile'",
        "the callback is missing before the depth: `self.create_subscription(Marker, "
        "'/a_topic', self.on_message, 10)`.",
    ),
    (
        "class Robot(Node):\n"
        "    def heard(self, message):\n"
        "        print(message.data)\n"
        "node.create_subscription(String, '/chatter', Robot.heard, 10)\n"
        "node.create_publisher(String, '/chatter', 10).publish(String())\n"
        "rclpy.spin_once(node)",
        "AttributeError: 'dict' object has no attribute 'data'",
        "self is the String here: pass the method of the object, self.heard.",
    ),
    (
        "QoSProfile(10)",
        "TypeError: QoSProfile.__init__() takes 1 positional argument but 2 were given",
        "pass each value by its name: `QoSProfile(depth=10)`.",
    ),
    (
        "QoSProfile(depth=10, reliability='best_effort')",
        "AssertionError",
        "a policy is a constant of ReliabilityPolicy in rclpy.qos, as in `ReliabilityPolicy.BEST_EFFORT`.",
    ),
    (
        "QoSProfile(depth=10, deadline=1.0)",
        "AssertionError",
        "pass a Duration: `Duration(seconds=1.0)`.",
    ),
    (
        "from rclpy.qos import QoSPresetProfiles\n"
        "node.create_subscription(String, 'x', print, QoSPresetProfiles.SENSOR_DATA)",
        "TypeError: Expected QoSProfile or int, but received <enum 'QoSPresetProfiles'>",
        "the profile of a preset is its value: `QoSPresetProfiles.SENSOR_DATA.value`.",
    ),
    (
        "QoSProfile(depth=10, speed=1)",
        "AssertionError: Invalid arguments passed to constructor: dict_keys(['depth', 'speed'])",
        "a QoSProfile has history, depth, reliability, durability, lifespan, deadline, "
        "liveliness, liveliness_lease_duration and avoid_ros_namespace_conventions.",
    ),
]
