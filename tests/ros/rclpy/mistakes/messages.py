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
]
