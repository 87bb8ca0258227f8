"""Misspelled names: variables, classes, functions, attributes and `self.`."""

ROBOT = """class Robot(Node):
    def __init__(self):
        super().__init__('a')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.angle = 0.0
        self.create_timer(0.1, self.tick)
    def tick(self):
        {line}
rclpy.spin(Robot())"""


def undefined(name: str) -> str:
    return f"NameError: name '{name}' is not defined"


# (program, last line of the error, hint below it)
NAMES = [
    (
        "main()",
        undefined("main"),
        "main is not defined: write `def main()` with the lines to run, or call your own function.",
    ),
    (
        "import time as wall\ntime.time()",
        undefined("time"),
        "the module time is imported as wall: write wall in place of time.",
    ),
    (
        "def run():\n    robot = 3\nrun()\nrobot",
        undefined("robot"),
        "robot is set in the function run, and exists only there: return it from run.",
    ),
    (
        "class Robot(Node):\n    timer = create_timer(1.0, print)",
        undefined("create_timer"),
        "write self.create_timer(…) in def __init__: it is a method of a node.",
    ),
    (
        "class Robot(rclpy.node):\n    pass",
        "TypeError: module() takes at most 2 arguments (3 given)",
        "rclpy.node is a module: write Node in ( ), as in class Robot(Node): ….",
    ),
    (
        "marker = Marker()\nm\u0430rker.id = 1",
        undefined("m\u0430rker"),
        "the letter \u0430 in m\u0430rker is Cyrillic and only looks like a Latin one: type the name again.",
    ),
    (
        "speed == 3.0 * 2.0",
        undefined("speed"),
        "== compares. To set a value, write a single =, as in speed = 1.0.",
    ),
    (
        "def draw():\n    worl = 'map'\n    print('world')\n    return [world]\ndraw()",
        undefined("world"),
        'did you mean the variable worl, or the string "world" with quotes?',
    ),
    (
        ROBOT.format(line="self.publisher.send(String())"),
        "AttributeError: 'Publisher' object has no attribute 'send'",
        "a publisher sends a message with publish(): `self.publisher.publish(message)`.",
    ),
    (
        "from vision_msgs.msg import BoundingBox3D\nBoundingBox3D().dimensions",
        "AttributeError: 'BoundingBox3D' object has no attribute 'dimensions'",
        "did you mean `size`? `%ros2 interface show vision_msgs/msg/BoundingBox3D` lists its fields.",
    ),
    (
        "tf_transformations.quaternion_from_euler(0, 0, 1.5)",
        "NameError: name 'tf_transformations' is not defined",
        "import it: `import tf_transformations`; in a notebook run the first cells again.",
    ),
    (
        ROBOT.format(line="self.last = String()\n        self.data"),
        "AttributeError: 'Robot' object has no attribute 'data'",
        "did you mean `self.last.data`?",
    ),
    (
        "rclpy.publish(String())",
        "AttributeError: module 'rclpy' has no attribute 'publish'",
        "publish() is a method of a publisher: `self.publisher.publish(message)`.",
    ),
    (
        "def helped():\n    return 1\n" + ROBOT.format(line="self.helped()"),
        "AttributeError: 'Robot' object has no attribute 'helped'",
        "helped is a function outside of the class: call it without `self.`",
    ),
    (
        ROBOT.format(line="self.declare_parameter('speed', 1.0)\n        print(self.speed)"),
        "AttributeError: 'Robot' object has no attribute 'speed'",
        "speed is a parameter: read it with `self.get_parameter('speed').value`.",
    ),
    (
        ROBOT.format(line="self.timers = []"),
        "AttributeError: property 'timers' of 'Robot' object has no setter",
        "timers exists already and cannot be set: choose another name for your attribute.",
    ),
    (
        "Parameter('speed', value=1.0).get_name()",
        "AttributeError: 'Parameter' object has no attribute 'get_name'",
        "its name is `parameter.name`, its value `parameter.value`.",
    ),
    (
        "Parameter('speed', value=1.0).value.value",
        "AttributeError: 'float' object has no attribute 'value'",
        "this is the value already: leave out .value.",
    ),
    (
        "String().publish(node)",
        "AttributeError: 'String' object has no attribute 'publish'",
        "this is a message: a publisher sends it, `self.publisher.publish(message)`.",
    ),
    (
        "node.get_clock().now().header",
        "AttributeError: 'Time' object has no attribute 'header'",
        "this is a Time and not a message: are the values of the call in the right order?",
    ),
    (
        "1 - node.get_clock().now()",
        "TypeError: unsupported operand type(s) for -: 'int' and 'Time'",
        "one side is a plain number, the other a Time: both must have the same type, as in "
        "`self.get_clock().now() - Duration(seconds=1.0)`.",
    ),
    (
        "from nav_msgs.msg import Path\nPath('a.rviz')",
        "TypeError: Path.__init__() takes 1 positional argument but 2 were given",
        "this Path is the message of nav_msgs. For the path of a file, write "
        "`from pathlib import Path as File`, then File(…).",
    ),
    (
        "from sensor_msgs.msg import Image\nImage(data='000')",
        "TypeError: cannot use a str to initialize an array with typecode 'B'",
        "the field takes numbers: `bytes(12)`, or a list like `[0] * 12`.",
    ),
    (
        "String(data={'text': 'a'})",
        "AssertionError: The 'data' field must be of type 'str'",
        "this is a dictionary: take one of its values, like ['text'].",
    ),
    (
        "import numpy as np\nnp.array([])[:, 0]",
        "IndexError: too many indices for array: array is 1-dimensional, but 2 were indexed",
        "there are more indices than dimensions: print the array's shape first. Is the array empty?",
    ),
    ("a = null", undefined("null"), "Python's name for it is `None`."),
    ("printf('a')", undefined("printf"), "Python's name for it is `print`."),
    ("this.angle = 0.0", undefined("this"), "Python's name for it is `self`."),
    (
        "import rclpy.node.Node",
        "ModuleNotFoundError: No module named 'rclpy.node.Node'; 'rclpy.node' is not a package",
        "Node is not a module: `from rclpy.node import Node`.",
    ),
    ("CUBE", undefined("CUBE"), "did you mean `Marker.CUBE`?"),
    ("Markers()", undefined("Markers"), "did you mean `Marker`?"),
    ("time.time()", undefined("time"), "import it: `import time`; in a notebook run the first cells again."),
    (
        "Marker.cylinder",
        "AttributeError: type object 'Marker' has no attribute 'cylinder'",
        "did you mean `CYLINDER`? `%ros2 interface show visualization_msgs/msg/Marker` lists its fields.",
    ),
    (
        "Marker.TEXT",
        "AttributeError: type object 'Marker' has no attribute 'TEXT'",
        "did you mean `TEXT_VIEW_FACING`? `%ros2 interface show visualization_msgs/msg/Marker` "
        "lists its fields.",
    ),
    (
        "Marker().size.x = 1.0",
        "AttributeError: 'Marker' object has no attribute 'size'",
        "did you mean `scale`? `%ros2 interface show visualization_msgs/msg/Marker` lists its fields.",
    ),
    (
        "Marker().alpha = 1.0",
        "AttributeError: 'Marker' object has no attribute 'alpha'",
        "did you mean `color.a`? `%ros2 interface show visualization_msgs/msg/Marker` lists its fields.",
    ),
    (
        "Marker().pose.orientation.yaw = 1.0",
        "AttributeError: 'Quaternion' object has no attribute 'yaw'",
        "a quaternion does not contain an angle: a rotation by yaw about z is "
        "`Quaternion(z=sin(yaw / 2), w=cos(yaw / 2))`, and the inverse is `yaw = 2 * atan2(q.z, "
        "q.w)`.",
    ),
    (
        ROBOT.format(line="self.publish(String())"),
        "AttributeError: 'Robot' object has no attribute 'publish'",
        "did you mean `self.publisher.publish`?",
    ),
    (
        ROBOT.replace("self.tick)", "self.callback)").format(line="pass"),
        "AttributeError: 'Robot' object has no attribute 'callback'",
        "Robot has publisher, angle and tick. Which of them do you mean, or is one missing?",
    ),
    ("Markr()", undefined("Markr"), "did you mean `Marker`?"),
    ("marker = Marker()\nmarkr.id = 1", undefined("markr"), "did you mean `marker`?"),
    ("def draw():\n    green = 1.0\n    return gren\ndraw()", undefined("gren"), "did you mean `green`?"),
    ("class First(Nod): ...", undefined("Nod"), "did you mean `Node`?"),
    ("pint(1)", undefined("pint"), "did you mean `print`?"),
    ("true", undefined("true"), "did you mean `True`?"),
    ("u = 1.0\nU", undefined("U"), "did you mean `u`?"),
    (
        "run_live(node)",
        undefined("run_live"),
        "import it: `from course_lib import run_live`; in a notebook run the first cells again.",
    ),
    (
        "run_liv(node)",
        undefined("run_liv"),
        "did you mean run_live? Then import it: `from course_lib import run_live`.",
    ),
    (
        "math.pi",
        undefined("math"),
        "import it: `import math`; in a notebook run the first cells again.",
    ),
    (
        "def generate_launch_description():\n    return LaunchDescription([])\ngenerate_launch_description()",
        undefined("LaunchDescription"),
        "import it: `from launch import LaunchDescription`.",
    ),
    (
        ROBOT.format(line="publisher.publish(String())"),
        undefined("publisher"),
        "did you mean `self.publisher`?",
    ),
    (
        ROBOT.format(line="publsher.publish(String())"),
        undefined("publsher"),
        "did you mean `self.publisher`?",
    ),
    (
        ROBOT.format(line="self.publsher.publish(String())"),
        "AttributeError: 'Robot' object has no attribute 'publsher'",
        "did you mean `publisher`?",
    ),
    (
        ROBOT.format(line="self.get_loger().info('x')"),
        "AttributeError: 'Robot' object has no attribute 'get_loger'",
        "did you mean `get_logger`?",
    ),
    (
        ROBOT.format(line="angle += 0.1"),
        "UnboundLocalError: cannot access local variable 'angle' where it is not associated with a value",
        "did you mean `self.angle`?",
    ),
    (
        "count = 0\ndef heard():\n    count += 1\nheard()",
        "UnboundLocalError: cannot access local variable 'count' where it is not associated with a value",
        "a function that assigns count has a count of its own. Keep the value in the node, as "
        "`self.count`, or write `global count` first.",
    ),
    (
        "def level(x):\n    if x > 1:\n        y = 2\n    return y\nlevel(0)",
        "UnboundLocalError: cannot access local variable 'y' where it is not associated with a value",
        "give y a value before this line, on every path that leads here.",
    ),
    (
        "rclpy.spn(node)",
        "AttributeError: module 'rclpy' has no attribute 'spn'",
        "did you mean `spin`?",
    ),
    (
        "rclpy.Time()",
        "AttributeError: module 'rclpy' has no attribute 'Time'",
        "import it: `from rclpy.time import Time`.",
    ),
    (
        "rclpy.Rate(10)",
        "AttributeError: module 'rclpy' has no attribute 'Rate'",
        "a timer repeats work: `self.create_timer(0.1, self.tick)`.",
    ),
    (
        "rclpy.init_node('a')",
        "AttributeError: module 'rclpy' has no attribute 'init_node'",
        "call `rclpy.init()` first, then create an object of your class, in which "
        "`super().__init__('a_name')` sets the node's name.",
    ),
    (
        "rclpy.get_time()",
        "AttributeError: module 'rclpy' has no attribute 'get_time'",
        "a node's clock has the time: `self.get_clock().now()`.",
    ),
    (
        "rclpy.is_shutdown()",
        "AttributeError: module 'rclpy' has no attribute 'is_shutdown'",
        "`rclpy.ok()` is True until the shutdown.",
    ),
    (
        "rclpy.logging.info('a')",
        "AttributeError: module 'rclpy.logging' has no attribute 'info'",
        "a node's logger has this method: `self.get_logger().info('a text')`.",
    ),
    (
        "rclpy.Publisher('a', String)",
        "AttributeError: module 'rclpy' has no attribute 'Publisher'",
        "write `self.create_publisher(Marker, '/a_topic', 10)`.",
    ),
    (
        "node.subscribe('a', String, print)",
        "AttributeError: 'Node' object has no attribute 'subscribe'",
        "write `self.create_subscription(Marker, '/a_topic', self.on_message, 10)`.",
    ),
    (
        "node.publish(String())",
        "AttributeError: 'Node' object has no attribute 'publish'",
        "publish() is a method of a publisher: `self.publisher.publish(message)`.",
    ),
    (
        "node.spin()",
        "AttributeError: 'Node' object has no attribute 'spin'",
        "write rclpy.spin(node); in a notebook spin_for(2.0, node).",
    ),
    (
        "def f():\n    message = String()\n    m.data = 'a'\nf()",
        undefined("m"),
        "did you mean `message`?",
    ),
    (
        "def f():\n    msg = String()\n    message.data = 'a'\nf()",
        undefined("message"),
        "did you mean `msg`?",
    ),
    (
        "week01.red_cube",
        undefined("week01"),
        'the name of a task is in quotes, as in check("week01.red_cube", RedCubeNode).',
    ),
    (
        "LookupException",
        undefined("LookupException"),
        "import it: `from tf2_ros import LookupException`; in a notebook run the first cells again.",
    ),
    (
        "import numpy as np\nMarker().scale.x = np.float32(0.5)",
        "AssertionError: The 'x' field must be of type 'float'",
        "this is numpy's float32: convert it with float(…).",
    ),
    (
        "q = quaternion_from_euler(0.0, 0.0, 1.0)",
        "NameError: name 'quaternion_from_euler' is not defined",
        "import it: `from tf_transformations import quaternion_from_euler`; in a notebook run the "
        "first cells again.",
    ),
    (
        "tf2_ros.Buffer()",
        "NameError: name 'tf2_ros' is not defined",
        "import it: `import tf2_ros`; in a notebook run the first cells again.",
    ),
    (
        "visualization_msgs.msg.Marker()",
        "NameError: name 'visualization_msgs' is not defined",
        "import it: `import visualization_msgs.msg`; in a notebook run the first cells again.",
    ),
    (
        "import visualization_msgs\nvisualization_msgs.Marker()",
        "AttributeError: module 'visualization_msgs' has no attribute 'Marker'",
        "write `from visualization_msgs.msg import Marker`.",
    ),
    (
        "def confidence_color(score):\n    return 1 - confidence\nconfidence_color(1.0)",
        "NameError: name 'confidence' is not defined",
        "confidence_color can use score, and names that cells of this notebook define. "
        "Where is confidence from?",
    ),
    (
        "twist.linear.x = 1.0",
        "NameError: name 'twist' is not defined",
        "create it first: `twist = Twist()`.",
    ),
]
