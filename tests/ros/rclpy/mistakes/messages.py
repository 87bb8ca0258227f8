"""Messages and their fields."""

# (program, last line of the error, hint below it)
MESSAGES = [
    (
        "from rclpy.serialization import serialize_message\nserialize_message(String()).data",
        "AttributeError: 'bytes' object has no attribute 'data'",
        "these are the bytes of a message: deserialize_message(data, String), of rclpy.serialization, "
        "makes a message of them.",
    ),
    (
        "Marker.CUBE = Marker.SPHERE",
        "AttributeError: property 'CUBE' of 'Metaclass_Marker' object has no setter",
        "a constant cannot be changed. Assign it to the field: `marker.type = Marker.CUBE`.",
    ),
    (
        "float(Twist)",
        "TypeError: float() argument must be a string or a real number, not 'Metaclass_Twist'",
        "Twist is a class, and a message is needed: create one with ( ), Twist(…).",
    ),
    (
        "Marker('a', 1)",
        "TypeError: Marker.__init__() takes 1 positional argument but 3 were given",
        "pass each value with the name of its field: Marker(ns=…, id=…).",
    ),
    (
        "from geometry_msgs.msg import Twist\nTwist(0.3, 0.2)",
        "TypeError: Twist.__init__() takes 1 positional argument but 3 were given",
        "Twist takes its fields by name: linear and angular.",
    ),
    (
        "from visualization_msgs.msg import MarkerArray\nMarkerArray([Marker()])",
        "TypeError: MarkerArray.__init__() takes 1 positional argument but 2 were given",
        "pass each value with the name of its field: MarkerArray(markers=…).",
    ),
    (
        "pose = PoseStamped()\npose.position.x = 1.0",
        "AttributeError: 'PoseStamped' object has no attribute 'position'",
        "did you mean `pose.pose.position`? `%ros2 interface show geometry_msgs/msg/PoseStamped` "
        "lists its fields.",
    ),
    (
        "marker, pose = Marker(), PoseStamped()\nmarker.header.frame_id = pose.frame_id",
        "AttributeError: 'PoseStamped' object has no attribute 'frame_id'",
        "did you mean `header.frame_id`? `%ros2 interface show geometry_msgs/msg/PoseStamped` "
        "lists its fields.",
    ),
    (
        "Marker().id = (1.0, 0.0, 0.0)",
        "AssertionError: The 'id' field must be of type 'int'",
        "this is 3 numbers, (1.0, 0.0, 0.0), but the field takes one: select it, like [0].",
    ),
    (
        "PoseStamped().header.seq",
        "AttributeError: 'Header' object has no attribute 'seq'",
        "seq is from ROS 1. To count messages, write `self.count += 1` in the callback.",
    ),
    (
        "Twist().linear.x = 1",
        "AssertionError: The 'x' field must be of type 'float'",
        "write the number with a decimal point: 1.0, or float(x).",
    ),
    (
        "Twist(linear=(1.0, 0.0, 0.0))",
        "AssertionError: The 'linear' field must be a sub message of type 'Vector3'",
        "create one, with named fields: `Vector3(x=1.0, y=0.0, z=0.0)`.",
    ),
    (
        "Int32(data=1.5)",
        "AssertionError: The 'data' field must be of type 'int'",
        "write int(x), or round(x).",
    ),
    (
        "UInt8(data=300)",
        "AssertionError: The 'data' field must be an unsigned integer in [0, 255]",
        "this number is negative or too large for the field: print it.",
    ),
    (
        "String(data=5)",
        "AssertionError: The 'data' field must be of type 'str'",
        "write str(x), or an f-string.",
    ),
    (
        "ColorRGBA(r=255)",
        "AssertionError: The 'r' field must be of type 'float'",
        "colors go from 0.0 to 1.0: write 1.0, not 1 and not 255.",
    ),
    (
        "DiagnosticStatus(level=0)",
        "AssertionError: The 'level' field must be of type 'bytes' or 'ByteString' with length 1",
        "write `DiagnosticStatus.OK`, WARN, ERROR or STALE.",
    ),
    (
        "String('hello')",
        "TypeError: String.__init__() takes 1 positional argument but 2 were given",
        "pass the argument by name: `String(data='text')`.",
    ),
    (
        "Marker().color.a = 0,8",
        "AssertionError: The 'a' field must be of type 'float'",
        "this is 2 numbers, (0, 8): a decimal number has a point, 0.8, not a comma.",
    ),
    (
        "Marker().scale.x = '1.0'",
        "AssertionError: The 'x' field must be of type 'float'",
        "this is the string '1.0': remove the quotes, or convert it with float(…).",
    ),
    (
        "Marker().pose.position = PoseStamped().pose",
        "AssertionError: The 'position' field must be a sub message of type 'Point'",
        "this is a Pose: take its field position.",
    ),
    (
        "Marker().pose.position = Marker().scale",
        "AssertionError: The 'position' field must be a sub message of type 'Point'",
        "this is a Vector3: `Point(x=v.x, y=v.y, z=v.z)` has its numbers, where v is the Vector3.",
    ),
    (
        "Marker().header.stamp = Node('a').get_clock().now().to_msg",
        "AssertionError: The 'stamp' field must be a sub message of type 'Time'",
        "this is the function to_msg, which is not called: are its ( ) missing?",
    ),
    (
        "String(dta='hello')",
        "AssertionError: Invalid arguments passed to constructor: dta",
        "did you mean `data`?",
    ),
    (
        "message = String()\nmessage.dta = 'hello'",
        "AttributeError: 'String' object has no attribute 'dta'",
        "did you mean `data`? `%ros2 interface show std_msgs/msg/String` lists its fields.",
    ),
    (
        "Marker().scal.x = 1.0",
        "AttributeError: 'Marker' object has no attribute 'scal'",
        "did you mean `scale`? `%ros2 interface show visualization_msgs/msg/Marker` lists its fields.",
    ),
    (
        "Marker().position.z = 1.0",
        "AttributeError: 'Marker' object has no attribute 'position'",
        "did you mean `pose.position`? "
        "`%ros2 interface show visualization_msgs/msg/Marker` lists its fields.",
    ),
    (
        "Marker.CUB",
        "AttributeError: type object 'Marker' has no attribute 'CUB'",
        "did you mean `CUBE`? `%ros2 interface show visualization_msgs/msg/Marker` lists its fields.",
    ),
    (
        "Marker(type='CUBE')",
        "AssertionError: The 'type' field must be of type 'int'",
        "use the constant: `Marker.CUBE`.",
    ),
    (
        "PoseStamped().pose.position = (1.0, 2.0, 3.0)",
        "AssertionError: The 'position' field must be a sub message of type 'Point'",
        "create one, with named fields: `Point(x=1.0, y=2.0, z=3.0)`.",
    ),
    (
        "PoseStamped().pose.orientation = 1.57",
        "AssertionError: The 'orientation' field must be a sub message of type 'Quaternion'",
        "a rotation by yaw about z is `Quaternion(z=sin(yaw / 2), w=cos(yaw / 2))`.",
    ),
    (
        "Marker().lifetime = Duration(seconds=1.0)",
        "AssertionError: The 'lifetime' field must be a sub message of type 'Duration'",
        "write `Duration(seconds=1.0).to_msg()`, with rclpy's Duration.",
    ),
    (
        "Marker().points.x",
        "AttributeError: 'list' object has no attribute 'x'",
        "this is a list: select one of its items, like [0], or loop over it with for. If you expected "
        "neither, look where it was set.",
    ),
    (
        "open('no_such.rviz')",
        "FileNotFoundError: [Errno 2] No such file or directory: 'no_such.rviz'",
        "save the layout there first: `viewer.save_rviz('a_name.rviz')`, or Ctrl+S.",
    ),
    (
        "import subprocess\nsubprocess.run(['ros2', 'topic', 'list'])",
        "FileNotFoundError: [Errno 2] No such file or directory: 'ros2'",
        "the kit has no program ros2. In a notebook write `%ros2 topic list`, in a terminal: "
        "course ros2 topic list.",
    ),
    (
        "PoseStamped().header.stamp = node.get_clock().now()",
        "AssertionError: The 'stamp' field must be a sub message of type 'Time'",
        "write `self.get_clock().now().to_msg()`, where self is the node.",
    ),
    (
        "PoseStamped().header.frame_id = None",
        "AssertionError: The 'frame_id' field must be of type 'str'",
        "this is None: is it a parameter without a value, or a function that returns nothing?",
    ),
    (
        "marker = Marker()\n"
        "marker.points.append((1.0, 2.0, 3.0))\n"
        "node.create_publisher(Marker, 'marker', 10).publish(marker)",
        "AssertionError: The 'points' field must be a set or sequence and each value of type 'Point'",
        "item 0 is only numbers. Make a message of each: Point(x=item[0], y=item[1], z=item[2]).",
    ),
    (
        "Marker().points = Point()",
        "AssertionError: The 'points' field must be a set or sequence and each value of type 'Point'",
        "use a list of them: `[Point(x=1.0, y=1.0, z=1.0)]`.",
    ),
    (
        "Marker().color = (1.0, 0.0, 0.0)",
        "AssertionError: The 'color' field must be a sub message of type 'ColorRGBA'",
        "create one, with named fields: `ColorRGBA(r=1.0, g=0.0, b=0.0, a=1.0)`.",
    ),
    (
        "Marker().scale = 0.2",
        "AssertionError: The 'scale' field must be a sub message of type 'Vector3'",
        "create one, with named fields: `Vector3(x=0.2, y=0.2, z=0.2)`.",
    ),
    (
        "Marker().pose.position = [0.0, 0, 1.0]",
        "AssertionError: The 'position' field must be a sub message of type 'Point'",
        "create one, with named fields: `Point(x=0.0, y=0.0, z=1.0)`.",
    ),
    (
        "Twist().linear = 0.5",
        "AssertionError: The 'linear' field must be a sub message of type 'Vector3'",
        "a Vector3 has three numbers. Set one of them: linear.x = 0.5.",
    ),
    (
        "Marker().header = 'map'",
        "AssertionError: The 'header' field must be a sub message of type 'Header'",
        "a header has a stamp and a frame: `message.header.frame_id = 'map'`.",
    ),
    (
        "String(data='3') + 1",
        "TypeError: unsupported operand type(s) for +: 'String' and 'int'",
        "one side is a message, String: use its field data.",
    ),
    (
        "Twist() * 2",
        "TypeError: unsupported operand type(s) for *: 'Twist' and 'int'",
        "one side is a message, Twist: use its fields linear and angular.",
    ),
    (
        "'speed: ' + String(data='3')",
        'TypeError: can only concatenate str (not "String") to str',
        "one side is a message, String: use its field data.",
    ),
    (
        "Int32(data=3) > 2",
        "TypeError: '>' not supported between instances of 'Int32' and 'int'",
        "one side is a message, Int32: use its field data.",
    ),
    (
        "PoseStamped().pose.orientation = [0.0, 0.0, 0.3826834, 0.9238795]",
        "AssertionError: The 'orientation' field must be a sub message of type 'Quaternion'",
        "create one, with named fields: `Quaternion(x=numbers[0], y=numbers[1], z=numbers[2], "
        "w=numbers[3])`, where numbers is the list.",
    ),
    (
        "from nav_msgs.msg import OccupancyGrid\nOccupancyGrid().data = [0, 255]",
        "AssertionError: The 'data' field must be a set or sequence and each value of type 'int'"
        " and each integer in [-128, 127]",
        "item 1 of the list is 255, outside of -128 to 127.",
    ),
    (
        "from nav_msgs.msg import OccupancyGrid\nOccupancyGrid().data = [0.0, 1.0]",
        "AssertionError: The 'data' field must be a set or sequence and each value of type 'int'"
        " and each integer in [-128, 127]",
        "item 0 of the list is 0.0, with a point: write int(…) or round(…).",
    ),
    (
        "PoseStamped().pose.orientation.yaw",
        "AttributeError: 'Quaternion' object has no attribute 'yaw'",
        "a quaternion does not contain an angle: a rotation by yaw about z is "
        "`Quaternion(z=sin(yaw / 2), w=cos(yaw / 2))`, and the inverse is `yaw = 2 * atan2(q.z, "
        "q.w)`.",
    ),
    (
        "PoseStamped().header = str(PoseStamped().header)",
        "AssertionError: The 'header' field must be a sub message of type 'Header'",
        "a header has a stamp and a frame: `message.header.frame_id = 'map'`.",
    ),
    (
        "from trajectory_msgs.msg import JointTrajectoryPoint\nJointTrajectoryPoint(positions={'arm': 1.0})",
        "TypeError: must be real number, not str",
        "this is a dictionary, and the field takes a list: list its values in the right order.",
    ),
    (
        "from trajectory_msgs.msg import JointTrajectoryPoint\nJointTrajectoryPoint(positions=['1.0'])",
        "TypeError: must be real number, not str",
        "item 0 of the list is '1.0', not a number.",
    ),
    (
        "from visualization_msgs.msg import MarkerArray\nMarkerArray().markers = [None]",
        "AssertionError: The 'markers' field must be a set or sequence and each value of type 'Marker'",
        "item 0 is None: does the function that created it end with a return?",
    ),
    (
        "from visualization_msgs.msg import MarkerArray\ndef red():\n    return Marker()\n"
        "MarkerArray().markers = [red]",
        "AssertionError: The 'markers' field must be a set or sequence and each value of type 'Marker'",
        "item 0 is the function red, which is not called: are its ( ) missing?",
    ),
    (
        "Marker().pose.position.z = 1 // 2",
        "AssertionError: The 'z' field must be of type 'float'",
        "// rounds down to a whole number: / divides with the fraction.",
    ),
    (
        "Marker().scale.x = round(0.8)",
        "AssertionError: The 'x' field must be of type 'float'",
        "round( ) makes a whole number, without the fraction: leave it out.",
    ),
    (
        "import numpy as np\nMarker().scale.x = np.array([1.0])",
        "AssertionError: The 'x' field must be of type 'float'",
        "this is of type ndarray, but the field takes one number: print it.",
    ),
    (
        "Marker().scale.x = 1j",
        "AssertionError: The 'x' field must be of type 'float'",
        "this is of type complex, but the field takes one number: print it.",
    ),
    (
        "Point().append(1.0)",
        "AttributeError: 'Point' object has no attribute 'append'",
        "`%ros2 interface show geometry_msgs/msg/Point` lists its fields.",
    ),
    (
        "marker = Marker()\n"
        "marker.points.append([Point(), Point()])\n"
        "node.create_publisher(Marker, '/marker', 10).publish(marker)",
        "AssertionError: The 'points' field must be a set or sequence and each value of type 'Point'",
        "item 0 is a list in the list: does it have [ ] of its own, or is a * missing?",
    ),
    (
        "Marker().points = {Point()}",
        "TypeError: unhashable type: 'Point'",
        "{ } makes a set or a dictionary, which cannot contain a Point: use [ ] for a list.",
    ),
    (
        "from sensor_msgs.msg import JointState\nJointState().position.append([0.1, 0.2])",
        "TypeError: must be real number, not list",
        "append adds one number. To set all of them, write = and the list; extend adds them.",
    ),
    (
        "from sensor_msgs.msg import JointState\nstate = JointState()\nstate.position += [0.1, 0.2]",
        'TypeError: can only extend array with array (not "list")',
        "a field of numbers is an array: extend adds a list to it, `state.position.extend([0.1, 0.2])`.",
    ),
    (
        "from std_msgs.msg import Bool\nBool().data = 1",
        "AssertionError: The 'data' field must be of type 'bool'",
        "write True or False, without quotes. A comparison gives one of them, too.",
    ),
    (
        "from std_msgs.msg import Bool\nBool().data = 'True'",
        "AssertionError: The 'data' field must be of type 'bool'",
        "write True or False, without quotes. A comparison gives one of them, too.",
    ),
    (
        "String().data = b'text'",
        "AssertionError: The 'data' field must be of type 'str'",
        "this is of type bytes, and the field takes a string: print it. Text in bytes has decode( ).",
    ),
    (
        "String().data = ['a', 'b']",
        "AssertionError: The 'data' field must be of type 'str'",
        "this is a list, and the field takes one string: `', '.join(['a', 'b'])` joins strings.",
    ),
    (
        "from sensor_msgs.msg import Image\nimport numpy as np\nImage().encoding = np.uint8",
        "AssertionError: The 'encoding' field must be of type 'str'",
        "an encoding is a name in quotes, like 'rgb8' or 'mono8'.",
    ),
    (
        "from builtin_interfaces.msg import Time\nTime().sec = 1.5",
        "AssertionError: The 'sec' field must be of type 'int'",
        "sec is a whole number like 1, and nanosec the rest. A duration: "
        "`Duration(seconds=1.5).to_msg()`. The time of now: `self.get_clock().now().to_msg()`.",
    ),
    (
        "from geometry_msgs.msg import PoseWithCovariance\nPoseWithCovariance().covariance = [0.0] * 6",
        "AssertionError: The 'covariance' field must be a set or sequence with length 36 and each "
        "value of type 'float' and each double in "
        "[-17976931348623157081452742373170435679807056752584499659891747680315726078002853"
        "8760589558632766878171540458953514382464234321326889464182768467546703537516986049"
        "910576",
        "the field takes 36 numbers, and this list has 6.",
    ),
    (
        "from geometry_msgs.msg import PoseWithCovariance\n"
        "import numpy as np\n"
        "PoseWithCovariance().covariance = np.eye(6)",
        "AssertionError: The 'covariance' numpy.ndarray() must have a size of 36",
        "this is an array of 2 dimensions, and the field takes one: `matrix.ravel()` is flat.",
    ),
    (
        "from visualization_msgs.msg import MarkerArray\nMarkerArray().markers = [Marker]",
        "AssertionError: The 'markers' field must be a set or sequence and each value of type 'Marker'",
        "item 0 is the class Marker: create an object, with `Marker()`.",
    ),
    (
        "Float64MultiArray().layout.dim = [('rows', 2, 2)]",
        "AssertionError: The 'dim' field must be a set or sequence and each value of type "
        "'MultiArrayDimension'",
        "use a list of them: `[MultiArrayDimension(label='text', size=1, stride=1)]`.",
    ),
    (
        "from std_msgs.msg import Byte\nByte().data = 1",
        "AssertionError: The 'data' field must be of type 'bytes' or 'ByteString' with length 1",
        "this field takes one byte: `bytes([1])`.",
    ),
    (
        "Marker().action = 'DELETE'",
        "AssertionError: The 'action' field must be of type 'int'",
        "use the constant: `Marker.DELETE`.",
    ),
    (
        "feedback = Fibonacci.Feedback()\nfeedback.partial_sequence = [1]",
        "AttributeError: 'Fibonacci_Feedback' object has no attribute 'partial_sequence'",
        "did you mean `sequence`? `%ros2 interface show example_interfaces/action/Fibonacci` "
        "lists its fields.",
    ),
    (
        "from geometry_msgs.msg import TransformStamped\nTransformStamped().pose",
        "AttributeError: 'TransformStamped' object has no attribute 'pose'",
        "did you mean `transform`? `%ros2 interface show geometry_msgs/msg/TransformStamped` "
        "lists its fields.",
    ),
    (
        "from geometry_msgs.msg import Point\nx, y, z = Point()",
        "TypeError: cannot unpack non-iterable Point object",
        "a Point is a single object: read its fields by their names.",
    ),
    (
        "from sensor_msgs.msg import JointState\nJointState(position=[1.0, 2.0]).position + 1.0",
        'TypeError: can only append array (not "float") to array',
        "numbers in a message are in an array of Python, which does not compute: "
        "`np.array(state.position) * 2.0`.",
    ),
    (
        "from sensor_msgs.msg import LaserScan\nscan = LaserScan(ranges=[1.0] * 10)\nscan.ranges[180]",
        "IndexError: array index out of range",
        "scan.ranges has 10 items, from [0] to [9], so not [180].",
    ),
    (
        "from sensor_msgs.msg import LaserScan\nscan = LaserScan(ranges=[1.0] * 10)\nscan.ranges < 1.5",
        "TypeError: '<' not supported between instances of 'array.array' and 'float'",
        "numbers in a message are in an array of Python, which does not compute: "
        "`np.array(state.position) * 2.0`.",
    ),
    (
        "class Arm:\n"
        "    def __init__(self):\n"
        "        self.__pose = None\n"
        "    def on_pose(self, msg):\n"
        "        self.__pose = msg.pose\n"
        "    def move(self):\n"
        "        print(self.__pose.position)\n"
        "Arm().move()",
        "AttributeError: 'NoneType' object has no attribute 'position'",
        "self.__pose is None until on_pose has run: write `if self.__pose is None: return` before this line.",
    ),
    (
        "latest = None\n"
        "def on_point(msg):\n"
        "    global latest\n"
        "    latest = msg\n"
        "node.create_publisher(Point, 'points', 10).publish(latest)",
        "TypeError: Expected <class 'geometry_msgs.msg._point.Point'>, got <class 'NoneType'>",
        "latest is None until on_point has run: write `if latest is None: return` before this line.",
    ),
    (
        "class Arm:\n    def __init__(self, pose=None):\n        self.pose = pose\nArm().pose.position",
        "AttributeError: 'NoneType' object has no attribute 'position'",
        "this is None: does the function that created it return something?",
    ),
    (
        "Marker(type='sphere')",
        "AssertionError: The 'type' field must be of type 'int'",
        "use the constant: `Marker.SPHERE`.",
    ),
    (
        "copied = Marker().copy()",
        "AttributeError: 'Marker' object has no attribute 'copy'",
        "a message has no method for this: `import copy`, then copy.deepcopy(message).",
    ),
    (
        "import numpy as np\nmarker = Marker()\nmarker.points = np.zeros((3, 3))",
        "AssertionError: The 'points' field must be a set or sequence and each value of type 'Point'",
        "item 0 is only numbers. Make a message of each: Point(x=item[0], y=item[1], z=item[2]).",
    ),
    (
        "from nav_msgs.msg import Path\nfrom geometry_msgs.msg import Pose\npath = Path(poses=[Pose()])",
        "AssertionError: The 'poses' field must be a set or sequence and each value of type 'PoseStamped'",
        "item 0 is of type Pose, and the list takes a PoseStamped for each item.",
    ),
    (
        "from visualization_msgs.msg import MarkerArray\narray = MarkerArray()\narray.markers[0] = Marker()",
        "IndexError: list assignment index out of range",
        "array.markers is empty here: array.markers.append(…) adds an item.",
    ),
    (
        "marker = Marker()\nmarker.header.frame_id = PoseStamped().header",
        "AssertionError: The 'frame_id' field must be of type 'str'",
        "this is a Header: take its field frame_id.",
    ),
    (
        "status = DiagnosticStatus()\nstatus.level = DiagnosticStatus.OK, 'normal'",
        "AssertionError: The 'level' field must be of type 'bytes' or 'ByteString' with length 1",
        "this is a tuple of 2 values: write a name for each of them on the left of =.",
    ),
    (
        "status = DiagnosticStatus()\nstatus.message, status.level = DiagnosticStatus.OK, 'normal'",
        "AssertionError: The 'message' field must be of type 'str'",
        "this is of type bytes: are the names on the left of = in the order of the values?",
    ),
    (
        "from sensor_msgs.msg import Image\nImage(width=-1)",
        "AssertionError: The 'width' field must be an unsigned integer in [0, 4294967295]",
        "this number is negative or too large for the field: print it.",
    ),
    (
        "node.create_publisher(Marker, 'marker', 10).publish({'type': 1})",
        "TypeError: Expected <class 'visualization_msgs.msg._marker.Marker'>, got <class 'dict'>",
        "publish a message: create one with `Marker()`, and set its fields.",
    ),
    (
        "status = DiagnosticStatus()\nstatus.level, status.message = 'OK', 'normal'",
        "AssertionError: The 'level' field must be of type 'bytes' or 'ByteString' with length 1",
        "write `DiagnosticStatus.OK`, WARN, ERROR or STALE.",
    ),
]
