"""The executables of tf2_ros and tf2_tools, like `tf2_echo` and `view_frames`."""

import os
import random
import string
import time
from argparse import SUPPRESS, Namespace
from base64 import b64encode
from collections import defaultdict, deque
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from html import escape
from io import BytesIO
from math import asin, atan2, degrees, pi
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.ros import tf2
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.tf2 import BufferCore, Transform, TransformException
from course_lib.ros.time.interrupts import until_interrupted
from course_lib.tools.sources import Source, StreamLimits
from course_lib.tools.verb import Verb, Write, positive, seconds, value

TF = "tf2_msgs/msg/TFMessage"
TOPICS = {("/tf", TF): Qos(depth=100), ("/tf_static", TF): Qos(depth=100, durability="transient_local")}
_DEFAULT_AUTHORITY = "default_authority"


class TransformStream:
    """A transform buffer that is filled from a source.

    Args:
        source: The source of the messages.
        on_message: Called for each message, with its time of arrival [ns] and its transforms.
    """

    def __init__(
        self, source: Source, on_message: Callable[[int, list[Transform]], object] = lambda *_: None
    ) -> None:
        self.buffer = BufferCore()
        self._source = source
        self._on_message = on_message
        self._next_wait_ns = 0

    def ticks(self, every: float, seconds: float | None) -> Iterator[int]:
        """Yield robot time [ns] at the start and every `every` seconds.

        The buffer contains the transforms up to the yielded time.
        """
        limits = StreamLimits(every=every, seconds=seconds)
        for now_ns, arrival in self._source.stream(TOPICS, limits):
            if arrival is None:
                yield now_ns
                continue
            transforms = [Transform.from_message(transform) for transform in arrival.message().transforms]
            for transform in transforms:
                self.buffer.set_transform(
                    transform, _DEFAULT_AUTHORITY, is_static=arrival.topic == "/tf_static"
                )
            self._on_message(now_ns, transforms)

    def can_transform(self, target: str, source: str, now_ns: int, write: Write, name: str) -> bool:
        """Return whether two frames are connected.

        If not, log it at most once per second, as ROS does.
        """
        problem = self.buffer.can_transform(target, source)
        if problem is not None and now_ns >= self._next_wait_ns:
            self._next_wait_ns = now_ns + 10**9
            write(log_line(name, now_ns, f"Waiting for transform {target} ->  {source}: {problem}"))
        return problem is None


def log_line(name: str, now_ns: int, text: str, severity: str = "INFO") -> str:
    """Return a line of a node's log."""
    return f"[{severity}] [{now_ns // 10**9}.{now_ns % 10**9:09d}] [{name}]: {text}\n"


def _echo(source: Source, arguments: Namespace, write: Write) -> None:
    # As in ROS's tf2_echo, the names are swapped.
    target_frame, source_frame = arguments.source_frame, arguments.target_frame
    stream, waiting = TransformStream(source), True
    with until_interrupted():
        for now_ns in stream.ticks(1.0 / arguments.echo_rate, source.limit()):
            waiting = waiting and not stream.can_transform(
                target_frame, source_frame, now_ns, write, "tf2_echo"
            )
            if waiting:
                continue
            try:
                transform = stream.buffer.lookup(target_frame, source_frame)
            except TransformException as error:
                write(f"Failure at {now_ns / 1e9:.3f}\nException thrown:{error}\n")
                write(f"The current list of frames is:\n{stream.buffer.describe_frames()}\n")
                continue
            seconds, nanoseconds = divmod(transform.stamp_ns, 10**9)
            m = transform.matrix()
            # Roll, pitch and yaw [rad] as tf2's getEulerYPR computes them, even at a pitch of ±90°.
            roll = atan2(m[2, 1], m[2, 2])
            if abs(m[2, 0]) >= 1:
                angles = (roll, pi / 2 if m[2, 0] < 0 else -pi / 2, 0.0)
            else:
                angles = (roll, -asin(m[2, 0]), atan2(m[1, 0], m[0, 0]))
            rows = "".join("".join(f" {number:6.3f}" for number in row) + "\n" for row in m)
            write(
                f"At time {seconds}.{nanoseconds}\n"
                f"- Translation: [{_format_numbers(transform.translation)}]\n"
                f"- Rotation: in Quaternion [{_format_numbers(transform.rotation)}]\n"
                f"- Rotation: in RPY (radian) [{_format_numbers(angles)}]\n"
                f"- Rotation: in RPY (degree) [{_format_numbers(tuple(map(degrees, angles)))}]\n"
                f"- Matrix:\n{rows}"
            )


def _format_numbers(numbers: tuple[float, ...]) -> str:
    return ", ".join(f"{number:.3f}" for number in numbers)


_ECHO = (
    value("source_frame", help="Frame that the transform is expressed in"),
    value("target_frame", help="Frame whose pose it is"),
    value("echo_rate", nargs="?", type=positive(float), default=1.0, help="How often to print it [Hz]"),
)
TF2_ECHO = Verb(
    "run tf2_ros", "tf2_echo", "Print how target_frame lies in source_frame, once a second", _ECHO, _echo
)


# Polling period [s].
EVERY = 0.5
# Number of polls before the results are printed.
POLLS = 21
_LOWPASS = 0.01
# Printed instead of the publisher's name, because tf2 does not receive it from the middleware.
_NO_AUTHORITY = "<no authority available>"


class TransformDelays:
    """The delays of the last 1000 transforms, by frame and for all frames."""

    def __init__(self) -> None:
        # Delays by frame [s].
        self.delays: dict[str, deque[float]] = defaultdict(partial(deque, maxlen=1000))
        # Arrival and mean delay [s].
        self._messages: deque[tuple[float, float]] = deque(maxlen=1000)
        # Mean and maximum delay of the chain [s].
        self._average = self._longest = 0.0

    def record(self, now_ns: int, transforms: list[Transform]) -> None:
        """Record the arrival of transforms."""
        delays = [(now_ns - transform.stamp_ns) * 1e-9 for transform in transforms]
        for transform, delay in zip(transforms, delays, strict=True):
            self.delays[transform.child].append(delay)
        self._messages.append((now_ns * 1e-9, sum(delays) / max(1, len(delays))))

    def record_chain(self, delay: float) -> None:
        """Record the age [s] of the newest transform of the chain."""
        self._average = _LOWPASS * delay + (1 - _LOWPASS) * self._average
        self._longest = max(self._longest, delay)

    def text(self, chain: list[str]) -> str:
        """Return the results for the frames of a chain, or for all frames if the chain is empty."""
        title = "for all Frames\n"
        if chain:
            title = (
                f"for {chain[0]} to {chain[-1]}\nChain is: {' -> '.join(chain)}\n"
                f"Net delay     avg = {self._average:g}: max = {self._longest:g}\n"
            )
        frames = "".join(
            f"Frame: {frame}, published by {_NO_AUTHORITY}, {_delays(self.delays[frame], ', ')}"
            for frame in sorted(self.delays)
            if not chain or frame in chain
        )
        broadcasters = ""
        if self._messages:
            arrivals, delays = zip(*self._messages, strict=True)
            rate = len(arrivals) / max(1e-8, arrivals[-1] - arrivals[0])
            broadcasters = f"Node: {_NO_AUTHORITY} {rate:g} Hz, {_delays(delays, ' ')}"
        return f"\n\n\nRESULTS: {title}\nFrames:\n{frames}\nAll Broadcasters:\n{broadcasters}"


def _monitor(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the delays of all transforms, or of the chain between two frames, every 10 s."""
    frame_a, frame_b = arguments.framea, arguments.frameb
    if frame_a and not frame_b:
        raise CourseError("tf2_monitor needs two frames or none: ros2 run tf2_ros tf2_monitor framea frameb")
    delays, chain, looks, is_shown = TransformDelays(), list[str](), 0, False
    stream = TransformStream(source, delays.record)
    subject = f"{frame_a} -> {frame_b}" if frame_a else "all frames"
    with until_interrupted():
        for now_ns in stream.ticks(EVERY, source.limit(EVERY * POLLS)):
            if frame_a and not chain:
                if not stream.can_transform(frame_a, frame_b, now_ns, write, "tf2_monitor_main"):
                    continue
                chain = tf2.chain(stream.buffer, frame_a, frame_b)
            if looks == 0 and subject:
                write(f"Gathering data on {subject} for 10 seconds...\n")
                subject = ""
            if looks == POLLS:
                write(delays.text(chain))
                looks, is_shown = 0, True
            if chain:
                delays.record_chain((now_ns - stream.buffer.lookup(frame_a, frame_b).stamp_ns) * 1e-9)
            looks += 1
        # The run has ended before the results were printed.
        if looks and not is_shown:
            write(delays.text(chain))


def _delays(delays: Collection[float], between: str) -> str:
    average, longest = sum(delays) / len(delays), max(0.0, *delays)
    return f"Average Delay: {average:g}{between}Max Delay: {longest:g}\n"


_MONITOR = (
    value("framea", nargs="?", help="First frame of a chain; default: all frames"),
    value("frameb", nargs="?", help="Last frame of the chain"),
)
TF2_MONITOR = Verb("run tf2_ros", "tf2_monitor", "Print how late transforms come", _MONITOR, _monitor)


_NUMBERS = {
    **{name: f"{name} component of translation [m]" for name in "xyz"},
    **{f"q{name}": f"{name} component of quaternion rotation" for name in "xyzw"},
    **{name: f"{name} component Euler rotation [rad]" for name in ("roll", "pitch", "yaw")},
}


def _publish_static(source: Source, arguments: Namespace, write: Write) -> None:
    """Start a node that publishes a static transform, and keep it until the kernel or the run ends."""
    if not source.is_live:
        raise CourseError("A recording cannot receive messages. Use this in a notebook, with your nodes.")
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
    """Set the flags from the deprecated positional arguments, and print a warning.

    The arguments are x y z yaw pitch roll frame child, or x y z qx qy qz qw frame child.
    """
    values, prefix = arguments.old_style, "error parsing command line arguments: "
    if not values:
        return
    if len(values) not in (8, 9):
        raise CourseError(f"{prefix}Extra unparsed arguments on command-line")
    write(f"[WARN] [{now_ns // 10**9}.{now_ns % 10**9:09d}] []: {_OLD_STYLE}\n")
    turn = ("yaw", "pitch", "roll") if len(values) == 8 else ("qx", "qy", "qz", "qw")
    if any(getattr(arguments, name) is not None for name in (*_NUMBERS, "frame_id", "child_frame_id")):
        raise CourseError(f"{prefix}Cannot specify both new-style (flags) and old-style (arguments)")
    for name, argument in zip((*"xyz", *turn), values, strict=False):
        try:
            setattr(arguments, name, float(argument))
        except ValueError:
            raise CourseError(f"{prefix}Failed to parse {name} argument as float") from None
    arguments.frame_id, arguments.child_frame_id = values[-2:]


def _rotation(arguments: Namespace) -> tuple[float, ...]:
    """Return the quaternion (x, y, z, w) that the flags describe."""
    quaternion = [getattr(arguments, name) for name in ("qx", "qy", "qz", "qw")]
    angles = [getattr(arguments, name) for name in ("roll", "pitch", "yaw")]
    if any(component is not None for component in angles):
        from tf_transformations import quaternion_from_euler

        if any(component is not None for component in quaternion):
            raise CourseError("Cannot specify both quaternion and Euler rotations")
        roll, pitch, yaw = (angle or 0.0 for angle in angles)
        x, y, z, w = quaternion_from_euler(roll, pitch, yaw)
        return float(x), float(y), float(z), float(w)
    return tuple(
        component if component is not None else default
        for component, default in zip(quaternion, (0.0, 0.0, 0.0, 1.0), strict=True)
    )


def _publish(
    parent: str,
    child: str,
    shift: tuple[float, ...],
    turn: tuple[float, ...],
) -> tuple[str, int]:
    """Start a node that broadcasts a static transform. Return its name and the robot time [ns]."""
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


# Size of a frame with its arrow [inches].
_WIDTH, _HEIGHT = 2.3, 1.7
# As wide as the cell.
_IMAGE = '<img style="max-width: 100%" alt="{}" src="data:image/svg+xml;base64,{}">'
_LABELS = {
    "broadcaster": "Broadcaster",
    "rate": "Average rate",
    "buffer_length": "Buffer length",
    "most_recent_transform": "Most recent transform",
    "oldest_transform": "Oldest transform",
}


def _view_frames(source: Source, arguments: Namespace, write: Write) -> None:
    """Receive transforms for a fixed time, then draw the frames below the cell or into .gv and .pdf files."""
    import yaml

    stream, now_ns = TransformStream(source), current_graph().now_ns
    write(log_line("view_frames", now_ns, f"Listening to tf data for {arguments.wait_time} seconds..."))
    now_ns = max(stream.ticks(0.1, arguments.wait_time), default=now_ns)
    write(log_line("view_frames", now_ns, "Generating graph..."))
    text = tf2.as_yaml(stream.buffer)
    result = f"tf2_msgs.srv.FrameGraph_Response(frame_yaml={text!r})"
    write(log_line("view_frames", now_ns, f"Result:{result}"))
    frames: dict[str, Any] = yaml.safe_load(text) or {}
    if current_graph().notebook and source.is_live:
        from IPython.display import HTML, display

        tree = "; ".join(f"{frame} in {about['parent']}" for frame, about in frames.items())
        encoded = b64encode(picture(frames, now_ns, "svg")).decode()
        display(HTML(_IMAGE.format(escape(f"The tree of frames: {tree}"), encoded)))
        return
    name = arguments.output or f"frames_{time.strftime('%Y-%m-%d_%H.%M.%S')}"
    write(log_line("view_frames", now_ns, f"Exporting graph in {name}.pdf file..."))
    write_atomically(Path(os.path.realpath(f"{name}.gv")), dot(frames, now_ns).encode())
    write_atomically(Path(os.path.realpath(f"{name}.pdf")), picture(frames, now_ns, "pdf"))


def dot(frames: Mapping[str, Any], now_ns: int) -> str:
    """Return the tree in Graphviz's DOT language, as view_frames writes it."""
    if not frames:
        return 'digraph G { "No tf data received" }'
    edges = "".join(
        f'"{about["parent"]}" -> "{frame}"[label=" {_label(about, ending=chr(92) + "n")}"];\n'
        for frame, about in frames.items()
    )
    root = _roots(frames)[-1]
    return (
        f"digraph G {{\n{edges}edge [style=invis];\n"
        ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";\n'
        f'"Recorded at time: {now_ns // 10**9 + now_ns % 10**9 / 1e9}"[ shape=plaintext ] ;\n'
        f'}}->"{root}";\n}}'
    )


def picture(frames: Mapping[str, Any], now_ns: int, kind: str) -> bytes:
    """Draw the tree as SVG or PDF. Frames that belong to no tree with a root are omitted."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    positions = _frame_positions(frames)
    wide = 1 + max((x for x, _ in positions.values()), default=0)
    deep = 2 + max((depth for _, depth in positions.values()), default=0)
    figure = Figure(figsize=(wide * _WIDTH, (deep - 0.8) * _HEIGHT))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(-0.5, wide - 0.5), ylim=(deep - 0.6, 0.2))
    axes.axis("off")
    legend = f"view_frames Result\nRecorded at time: {now_ns / 1e9}"
    axes.text(-0.45, 0.3, legend if frames else "No tf data received", va="top", bbox={"fc": "white"})
    for frame, (x, depth) in positions.items():
        about = frames.get(frame)
        if about:
            parent_x, above = positions[about["parent"]]
            # First horizontal, then vertical through the label.
            corner = "angle,angleA=0,angleB=90"
            arrow = {"arrowstyle": "-|>", "fc": "black", "shrinkB": 12, "connectionstyle": corner}
            axes.annotate("", (x, depth + 1), (parent_x, above + 1), arrowprops=arrow)
            label, blank = _label(about, ending="\n").rstrip(), {"fc": "white", "ec": "none", "pad": 1}
            axes.text(x, depth + 0.55, label, fontsize=8, ha="center", va="center", bbox=blank)
        axes.text(
            x, depth + 1, frame, ha="center", va="center", bbox={"fc": "white", "boxstyle": "round"}, zorder=4
        )
    file = BytesIO()
    with rc_context({"svg.hashsalt": "view_frames", "svg.fonttype": "none"}):
        figure.savefig(file, format=kind, metadata={"Date" if kind == "svg" else "CreationDate": None})
    return file.getvalue()


def _frame_positions(frames: Mapping[str, Any]) -> dict[str, tuple[float, int]]:
    """Return column and depth of each frame.

    Leaves get consecutive columns, parents are centered above.
    """
    positions: dict[str, tuple[float, int]] = {}
    columns = iter(range(len(frames) + 1))

    def place_frame(frame: str, depth: int) -> float:
        # Set before the descent, because in a loop a frame is its own descendant.
        positions[frame] = 0.0, depth
        below = (name for name, about in frames.items() if about["parent"] == frame and name not in positions)
        children = [place_frame(name, depth + 1) for name in below]
        x = (children[0] + children[-1]) / 2 if children else float(next(columns))
        positions[frame] = x, depth
        return x

    for root in _roots(frames):
        place_frame(root, 0)
    return positions


def _roots(frames: Mapping[str, Any]) -> list[str]:
    """List the frames without a parent, or, if all frames form a loop, the parent of the first one."""
    parents = [str(about["parent"]) for about in frames.values()]
    return list(dict.fromkeys(parent for parent in parents if parent not in frames)) or parents[:1]


def _label(about: Mapping[str, Any], ending: str) -> str:
    return "".join(f"{title}: {about[name]}{ending}" for name, title in _LABELS.items())


_OPTIONS = (
    value("-t", "--wait-time", type=seconds, default=5.0, help="Listen for this many seconds"),
    value("-o", "--output", help="Output filename"),
)
VIEW_FRAMES = Verb("run tf2_tools", "view_frames", "Draw the tree of frames", _OPTIONS, _view_frames)
