"""Transforms and tf2's buffer."""

# (program, last line of the error, hint below it)
FRAMES = [
    (
        "from tf2_ros import TransformListener\n"
        "TransformListener(Buffer(), node).lookupTransform('map', 'base', Time())",
        "AttributeError: 'TransformListener' object has no attribute 'lookupTransform'",
        "the listener only fills the buffer. Query the buffer: "
        "`self.buffer.lookup_transform('map', "
        "'base_link', Time())`.",
    ),
    (
        "buffer = Buffer()\n"
        "buffer.set_transform(transform('map', 'base', 1), 'me')\n"
        "place, turn = buffer.lookup_transform('map', 'base', Time())",
        "TypeError: cannot unpack non-iterable TransformStamped object",
        "a lookup returns one message: its numbers are in .transform.translation and .transform.rotation.",
    ),
    (
        "Buffer().lookup_transform('map', 'base', Time())",
        'tf2.LookupException: "map" passed to lookupTransform argument target_frame does not exist. ',
        "the buffer is still empty. A listener fills it while its node is spun, so the first "
        "lookups "
        "of a node fail. A node that can continue without the frame catches TransformException.",
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
        "a transform between two trees is missing: `%ros2 run tf2_tools view_frames`.",
    ),
    (
        "buffer = Buffer()\n"
        "for second in (1, 2):\n"
        "    buffer.set_transform(transform('map', 'base', second), 'me')\n"
        "buffer.lookup_transform('map', 'base', Time(seconds=3))",
        "tf2.ExtrapolationException: Lookup would require extrapolation into the future.  "
        "Requested time 3.000000 but the latest data is at time 2.000000, when looking up "
        "transform from frame [base] to frame [map]",
        "request the transform at the stamp of the message, or the latest one with `Time()`, "
        "or pass a timeout.",
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
        "`import tf2_geometry_msgs`, which supports points and poses.",
    ),
    (
        "TransformBroadcaster(node).sendTransform(PoseStamped())",
        "AssertionError: The 'transforms' field must be a set or sequence and each value of type "
        "'TransformStamped'",
        "sendTransform takes a TransformStamped, or a list of them.",
    ),
    (
        "from tf2_ros import TransformListener\nTransformListener(node)",
        "TypeError: TransformListener.__init__() missing 1 required positional argument: 'node'",
        "a listener fills a buffer: `TransformListener(self.buffer, self)`, after `self.buffer = Buffer()`.",
    ),
    (
        "Buffer(10.0)",
        "TypeError: duration must have sec and nanosec, or nanoseconds.",
        "pass a Duration of rclpy: `Buffer(Duration(seconds=10.0))`.",
    ),
    (
        "Buffer(node)",
        "TypeError: duration must have sec and nanosec, or nanoseconds.",
        "a buffer takes no node: `Buffer()`. The listener does, `TransformListener(self.buffer, self)`.",
    ),
    (
        "from tf2_ros import TransformListener\n"
        "TransformListener(Buffer(), node).sendTransform(transform('map', 'base', 1))",
        "AttributeError: 'TransformListener' object has no attribute 'sendTransform'",
        "a listener receives transforms. To send them, write `TransformBroadcaster(self)`.",
    ),
    (
        "from geometry_msgs.msg import PointStamped\n"
        "import tf2_geometry_msgs\n"
        "tf2_geometry_msgs.do_transform_point(transform('map', 'base', 1), PointStamped())",
        "AttributeError: 'TransformStamped' object has no attribute 'point'",
        "the first argument is a message with a header, the second one the transform: "
        "`tf2_geometry_msgs.do_transform_point(point, transform)`.",
    ),
    (
        "buffer = Buffer()\n"
        "buffer.set_transform(transform('map', 'base_link', 0), 'test')\n"
        "buffer.lookup_transform('map', 'base_lnk', Time())",
        'tf2.LookupException: "base_lnk" passed to lookupTransform argument source_frame does not exist.',
        "did you mean 'base_link'? The buffer contains it.",
    ),
    (
        "buffer = Buffer()\n"
        "buffer.set_transform(transform('map', 'base_link', 0), 'test')\n"
        "buffer.lookup_transform('map', 'camera', Time())",
        'tf2.LookupException: "camera" passed to lookupTransform argument source_frame does not exist.',
        "the buffer contains base_link and map, but not camera. A node that can continue without "
        "the frame catches TransformException.",
    ),
    (
        "Buffer().lookup_transform('map', 'base', Time(), timeout=1.0)",
        "TypeError: unsupported operand type(s) for +: 'Time' and 'float'",
        "the timeout is a Duration and not a number: `Duration(seconds=1.0)`.",
    ),
    (
        "Buffer().lookup_transform('map', 'base', Time)",
        "TypeError: int() argument must be a string, a bytes-like object or a real number, not 'property'",
        "a class stands where an object is needed: create one with ( ), as in `Time()`.",
    ),
    (
        "transform('map', 'base_link', 1).header.child_frame_id = 'base_link'",
        "AttributeError: 'Header' object has no attribute 'child_frame_id'",
        "child_frame_id is a field of the TransformStamped itself, next to its header: "
        "`transform.child_frame_id = 'base_link'`.",
    ),
    (
        "Buffer().lookup_transform('map', PoseStamped().header, Time())",
        "TypeError: argument 2 must be str, not Header",
        "a frame is a string: take header.frame_id.",
    ),
    (
        "node.declare_parameter('world', 'map')\n"
        "Buffer().can_transform(node.get_parameter('world'), 'base_link', Time())",
        "TypeError: argument 1 must be str, not Parameter",
        "a frame is a string, and this is a parameter: read its value, `self.get_parameter('a_name').value`.",
    ),
    (
        "Buffer().can_transform('map', 'base_link')",
        "TypeError: Buffer.can_transform() missing 1 required positional argument: 'time'",
        "can_transform also needs a time: `self.buffer.can_transform('map', 'base_link', "
        "Time())` requests the newest transform.",
    ),
    (
        "import tf2_geometry_msgs\n"
        "tf2_geometry_msgs.do_transform_pose(PoseStamped(), transform('map', 'base_link', 1))",
        "AttributeError: 'PoseStamped' object has no attribute 'position'",
        "do_transform_pose takes a Pose. A PoseStamped is transformed by do_transform_pose_stamped.",
    ),
    (
        "try:\n"
        "    Buffer().lookup_transform('map', 'base_link', Time())\n"
        "except 'LookupException':\n"
        "    pass",
        "TypeError: catching classes that do not inherit from BaseException is not allowed",
        "except takes the class of an exception, without quotes and without ( ).",
    ),
]
