"""Messages and their fields."""

# (program, the last line of what it says, the hint below it)
MESSAGES = [
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
        "colours go from 0.0 to 1.0: write 1.0, not 1.",
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
        "the message has no such field: %ros2 interface show lists them.",
    ),
    (
        "message = String()\nmessage.dta = 'hello'",
        "AttributeError: 'String' object has no attribute 'dta'",
        "did you mean data? %ros2 interface show example_interfaces/msg/String or std_msgs/msg/String "
        "lists its fields.",
    ),
    (
        "Marker().scal.x = 1.0",
        "AttributeError: 'Marker' object has no attribute 'scal'",
        "did you mean scale? %ros2 interface show visualization_msgs/msg/Marker lists its fields.",
    ),
    (
        "Marker().position.z = 1.0",
        "AttributeError: 'Marker' object has no attribute 'position'",
        "did you mean pose.position? %ros2 interface show visualization_msgs/msg/Marker lists its fields.",
    ),
    (
        "Marker.CUB",
        "AttributeError: type object 'Marker' has no attribute 'CUB'",
        "did you mean CUBE? %ros2 interface show visualization_msgs/msg/Marker lists its fields.",
    ),
    (
        "Marker(type='CUBE')",
        "AssertionError: The 'type' field must be of type 'int'",
        "give a constant, like Marker.CUBE.",
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
        "Marker().lifetime = Duration(seconds=1.0)",
        "AssertionError: The 'lifetime' field must be a sub message of type 'Duration'",
        "write Duration(seconds=1.0).to_msg(), with rclpy's Duration.",
    ),
    (
        "Marker().points.x",
        "AttributeError: 'list' object has no attribute 'x'",
        "it holds several: take one, like [0], or go through it with for.",
    ),
    (
        "open('no_such.rviz')",
        "FileNotFoundError: [Errno 2] No such file or directory: 'no_such.rviz'",
        "save the layout there first: viewer.save_rviz('a_name.rviz'), or Ctrl+S.",
    ),
    (
        "PoseStamped().header.stamp = node.get_clock().now()",
        "AssertionError: The 'stamp' field must be a sub message of type 'Time'",
        "write self.get_clock().now().to_msg(), where self is the node.",
    ),
    (
        "PoseStamped().header.frame_id = None",
        "AssertionError: The 'frame_id' field must be of type 'str'",
        'write the name of the frame in quotes: "map".',
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
]
