"""The executable `static_transform_publisher` of the package tf2_ros."""

import random
import string
from argparse import SUPPRESS, Namespace

from course_lib.errors import CourseError
from course_lib.tools.sources import Source
from course_lib.tools.tf2 import log_line
from course_lib.tools.verb import Verb, Write, value

_NUMBERS = {
    **{name: f"{name} component of translation [m]" for name in "xyz"},
    **{f"q{name}": f"{name} component of quaternion rotation" for name in "xyzw"},
    **{name: f"{name} component Euler rotation [rad]" for name in ("roll", "pitch", "yaw")},
}


def _publish_static(source: Source, arguments: Namespace, write: Write) -> None:
    """Start a node that publishes a static transform; it stays until the kernel or the run ends."""
    if not source.live:
        raise CourseError("A recording cannot be published to. Use it in a notebook, beside your nodes.")
    _read_old_style(arguments, source.graph.now_ns, write)
    for name, frame in (("Frame id", arguments.frame_id), ("Child frame id", arguments.child_frame_id)):
        if not frame:
            raise CourseError(f"error parsing command line arguments: {name} must not be empty")
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


def _read_old_style(arguments: Namespace, now_ns: int, write: Write) -> None:
    """Set the flags from x y z yaw pitch roll frame child, or from a quaternion, and warn of that style."""
    words, wrong = arguments.old_style, "error parsing command line arguments: "
    if not words:
        return
    if len(words) not in (8, 9):
        raise CourseError(f"{wrong}Extra unparsed arguments on command-line")
    write(f"[WARN] [{now_ns // 10**9}.{now_ns % 10**9:09d}] []: {_OLD_STYLE}\n")
    turn = ("yaw", "pitch", "roll") if len(words) == 8 else ("qx", "qy", "qz", "qw")
    if any(getattr(arguments, name) is not None for name in (*_NUMBERS, "frame_id", "child_frame_id")):
        raise CourseError(f"{wrong}Cannot specify both new-style (flags) and old-style (arguments)")
    for name, word in zip((*"xyz", *turn), words, strict=False):
        try:
            setattr(arguments, name, float(word))
        except ValueError:
            raise CourseError(f"{wrong}Failed to parse {name} argument as float") from None
    arguments.frame_id, arguments.child_frame_id = words[-2:]


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
    """Start the node; return its name and the robot time [ns]."""
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


_STATIC = (
    value("--frame-id", help="parent frame"),
    value("--child-frame-id", help="child frame id"),
    *(value(f"--{name}", type=float, metavar=name.upper(), help=text) for name, text in _NUMBERS.items()),
    value("old_style", nargs="*", metavar="", help=SUPPRESS),
)
_OLD_STYLE = "Old-style arguments are deprecated; see --help for new-style arguments"
STATIC_TRANSFORM_PUBLISHER = Verb(
    "run tf2_ros",
    "static_transform_publisher",
    "Publish a transform that never changes",
    _STATIC,
    _publish_static,
)
