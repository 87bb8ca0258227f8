"""`tf2_echo`, and the transforms that come in on /tf and /tf_static."""

from argparse import Namespace
from collections.abc import Callable, Iterator
from math import asin, atan2, degrees, pi

from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.qos import Qos
from course_lib.ros.tf2_core import BufferCore
from course_lib.ros.tf2_errors import TransformException
from course_lib.ros.tf2_transform import Transform
from course_lib.tools.sources import Listening, Source
from course_lib.tools.verb import Verb, Write, value

TOPICS = {"/tf": Qos(depth=100), "/tf_static": Qos(depth=100, durability="transient_local")}
_NOT_NAMED = "default_authority"


class Heard:
    """A buffer that is filled from a source.

    Args:
        source: Where to listen.
        on_message: Told of each message: when it was heard, [ns], and its transforms.
    """

    def __init__(
        self, source: Source, on_message: Callable[[int, list[Transform]], object] = lambda *_: None
    ) -> None:
        self.buffer = BufferCore()
        self._source = source
        self._on_message = on_message
        self._next_wait_ns = 0

    def ticks(self, every: float, seconds: float | None) -> Iterator[int]:
        """Yield robot time [ns] at the start and once per `every` [s], the buffer filled up to then."""
        listening = Listening(every=every, seconds=seconds)
        for now_ns, arrival in self._source.stream(TOPICS, "tf2_msgs/msg/TFMessage", listening):
            if arrival is None:
                yield now_ns
                continue
            transforms = [Transform.from_message(one) for one in arrival.message().transforms]
            for transform in transforms:
                self.buffer.set_transform(transform, _NOT_NAMED, is_static=arrival.topic == "/tf_static")
            self._on_message(now_ns, transforms)

    def can_transform(self, target: str, source: str, now_ns: int, write: Write, name: str) -> bool:
        """Say whether two frames are connected; if not, log it at most once a second, as ROS does."""
        problem = self.buffer.can_transform(target, source)
        if problem is not None and now_ns >= self._next_wait_ns:
            self._next_wait_ns = now_ns + 10**9
            write(log_line(name, now_ns, f"Waiting for transform {target} ->  {source}: {problem}"))
        return problem is None


def log_line(name: str, now_ns: int, text: str) -> str:
    """Write an INFO line of a node's log."""
    return f"[INFO] [{now_ns // 10**9}.{now_ns % 10**9:09d}] [{name}]: {text}\n"


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print how one frame lies in another, again and again."""
    target, other = arguments.source_frame, arguments.target_frame  # named the wrong way round there, too
    heard, waiting = Heard(source), True
    with until_interrupted():
        for now_ns in heard.ticks(1.0 / arguments.echo_rate, source.limit()):
            waiting = waiting and not heard.can_transform(target, other, now_ns, write, "tf2_echo")
            if waiting:
                continue
            try:
                write(_text(heard.buffer.lookup(target, other)))
            except TransformException as error:
                write(f"Failure at {now_ns / 1e9:.3f}\nException thrown:{error}\n")
                write(f"The current list of frames is:\n{heard.buffer.described()}\n")


def _text(found: Transform) -> str:
    seconds, nanoseconds = divmod(found.stamp_ns, 10**9)
    angles = _roll_pitch_yaw(found)
    rows = "".join("".join(f" {number:6.3f}" for number in row) + "\n" for row in found.matrix())
    return (
        f"At time {seconds}.{nanoseconds}\n"
        f"- Translation: [{_joined(found.translation)}]\n"
        f"- Rotation: in Quaternion [{_joined(found.rotation)}]\n"
        f"- Rotation: in RPY (radian) [{_joined(angles)}]\n"
        f"- Rotation: in RPY (degree) [{_joined(tuple(map(degrees, angles)))}]\n"
        f"- Matrix:\n{rows}"
    )


def _roll_pitch_yaw(found: Transform) -> tuple[float, float, float]:
    """Return the angles, [rad], as tf2's getEulerYPR does, also straight up and down."""
    m = found.matrix()
    if abs(m[2, 0]) >= 1:
        roll, up = atan2(m[2, 1], m[2, 2]), m[2, 0] < 0
        return (roll, pi / 2, 0.0) if up else (roll, -pi / 2, 0.0)
    return atan2(m[2, 1], m[2, 2]), -asin(m[2, 0]), atan2(m[1, 0], m[0, 0])


def _joined(numbers: tuple[float, ...]) -> str:
    return ", ".join(f"{number:.3f}" for number in numbers)


def _rate(text: str) -> float:
    rate = float(text)
    if not 0 < rate <= 1000:
        raise ValueError
    return rate


_OPTIONS = (
    value("source_frame", help="Frame that the transform is expressed in"),
    value("target_frame", help="Frame whose pose it is"),
    value("echo_rate", nargs="?", type=_rate, default=1.0, help="How often to print it [Hz]"),
)
TF2_ECHO = Verb(
    "run tf2_ros", "tf2_echo", "Print how target_frame lies in source_frame, once a second", _OPTIONS, run
)
