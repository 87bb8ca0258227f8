"""`ros2 run tf2_ros static_transform_publisher`, with the flags that ROS 2 has had since Humble."""

import random
import string
from argparse import Namespace

from course_lib.errors import CourseError
from course_lib.tools.sources import Source
from course_lib.tools.tf2.echo import log_line
from course_lib.tools.verb import Verb, Write, value

_NUMBERS = {
    **{name: f"{name} component of translation [m]" for name in "xyz"},
    **{f"q{name}": f"{name} component of quaternion rotation" for name in "xyzw"},
    **{name: f"{name} component Euler rotation [rad]" for name in ("roll", "pitch", "yaw")},
}


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Start a node that publishes a static transform; it stays until the kernel or the run ends.

    Raises:
        CourseError: The arguments contradict each other, or there are no nodes to publish to.
    """
    if not source.live:
        raise CourseError("A recording cannot be published to. Use it in a notebook, beside your nodes.")
    parent, child = arguments.frame_id, arguments.child_frame_id
    if parent == child:
        raise CourseError(f"cannot publish static transform from '{parent}' to '{child}', exiting")
    shift = tuple(getattr(arguments, name) or 0.0 for name in "xyz")
    turn = _rotation(arguments)
    node, now_ns = _publish(parent, child, shift, turn)
    numbers = [", ".join(f"'{number:f}'" for number in numbers) for numbers in (shift, turn)]
    text = (
        f"Spinning until stopped - publishing transform\ntranslation: ({numbers[0]})\n"
        f"rotation: ({numbers[1]})\nfrom '{parent}' to '{child}'"
    )
    write(log_line(node, now_ns, text))


def _rotation(arguments: Namespace) -> tuple[float, ...]:
    """Return the quaternion (x, y, z, w) that the flags ask for."""
    quaternion = [getattr(arguments, name) for name in ("qx", "qy", "qz", "qw")]
    angles = [getattr(arguments, name) for name in ("roll", "pitch", "yaw")]
    if any(part is not None for part in angles):
        from tf_transformations import quaternion_from_euler

        if any(part is not None for part in quaternion):
            raise CourseError("Cannot specify both quaternion and Euler rotations")
        roll, pitch, yaw = (angle or 0.0 for angle in angles)
        x, y, z, w = quaternion_from_euler(roll, pitch, yaw)
        return float(x), float(y), float(z), float(w)
    return tuple(
        part if part is not None else default
        for part, default in zip(quaternion, (0.0, 0.0, 0.0, 1.0), strict=True)
    )


def _publish(parent: str, child: str, shift: tuple[float, ...], turn: tuple[float, ...]) -> tuple[str, int]:
    """Start the node; returns its name and the robot time, [ns]."""
    from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
    from rclpy.node import Node
    from std_msgs.msg import Header
    from tf2_ros import StaticTransformBroadcaster

    unique = "".join(random.choices(string.ascii_letters + string.digits, k=16))
    node = Node(f"static_transform_publisher_{unique}")
    now = node.get_clock().now()
    (x, y, z), (qx, qy, qz, qw) = shift, turn
    StaticTransformBroadcaster(node).sendTransform(
        TransformStamped(
            header=Header(stamp=now.to_msg(), frame_id=parent),
            child_frame_id=child,
            transform=Transform(
                translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)
            ),
        )
    )
    return node.get_name(), now.nanoseconds


_OPTIONS = (
    value("--frame-id", required=True, help="parent frame"),
    value("--child-frame-id", required=True, help="child frame id"),
    *(value(f"--{name}", type=float, metavar=name.upper(), help=text) for name, text in _NUMBERS.items()),
)
STATIC_TRANSFORM_PUBLISHER = Verb(
    "run tf2_ros", "static_transform_publisher", "Publish a transform that never changes", _OPTIONS, run
)
