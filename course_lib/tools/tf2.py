"""Tools of the package tf2_ros: `tf2_echo` and `tf2_monitor`."""

from argparse import Namespace
from collections import defaultdict, deque
from collections.abc import Callable, Collection, Iterator
from functools import partial
from math import asin, atan2, degrees, pi

from course_lib.errors import CourseError
from course_lib.ros import tf2_core
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.qos import Qos
from course_lib.ros.tf2_core import BufferCore
from course_lib.ros.tf2_transform import Transform, TransformException
from course_lib.tools.sources import Listening, Source
from course_lib.tools.verb import Verb, Write, positive, value

TF = "tf2_msgs/msg/TFMessage"
TOPICS = {("/tf", TF): Qos(depth=100), ("/tf_static", TF): Qos(depth=100, durability="transient_local")}
_NOT_NAMED = "default_authority"


class TransformStream:
    """A transform buffer that is filled from a source.

    Args:
        source: Where to listen.
        on_message: Told of each message: when it was stream, [ns], and its transforms.
    """

    def __init__(
        self, source: Source, on_message: Callable[[int, list[Transform]], object] = lambda *_: None
    ) -> None:
        self.buffer = BufferCore()
        self._source = source
        self._on_message = on_message
        self._next_wait_ns = 0

    def ticks(self, every: float, seconds: float | None) -> Iterator[int]:
        """Yield robot time [ns] at the start and once per `every` [s]; the buffer is filled up to it."""
        listening = Listening(every=every, seconds=seconds)
        for now_ns, arrival in self._source.stream(TOPICS, listening):
            if arrival is None:
                yield now_ns
                continue
            transforms = [Transform.from_message(one) for one in arrival.message().transforms]
            for transform in transforms:
                self.buffer.set_transform(transform, _NOT_NAMED, is_static=arrival.topic == "/tf_static")
            self._on_message(now_ns, transforms)

    def can_transform(self, target: str, source: str, now_ns: int, write: Write, name: str) -> bool:
        """Return whether two frames are connected; if not, log it at most once a second, as ROS does."""
        problem = self.buffer.can_transform(target, source)
        if problem is not None and now_ns >= self._next_wait_ns:
            self._next_wait_ns = now_ns + 10**9
            write(log_line(name, now_ns, f"Waiting for transform {target} ->  {source}: {problem}"))
        return problem is None


def log_line(name: str, now_ns: int, text: str) -> str:
    """Return an INFO line of a node's log."""
    return f"[INFO] [{now_ns // 10**9}.{now_ns % 10**9:09d}] [{name}]: {text}\n"


def _echo(source: Source, arguments: Namespace, write: Write) -> None:
    target, other = arguments.source_frame, arguments.target_frame  # ROS's tf2_echo swaps the names likewise
    stream, waiting = TransformStream(source), True
    with until_interrupted():
        for now_ns in stream.ticks(1.0 / arguments.echo_rate, source.limit()):
            waiting = waiting and not stream.can_transform(target, other, now_ns, write, "tf2_echo")
            if waiting:
                continue
            try:
                write(_pose_text(stream.buffer.lookup(target, other)))
            except TransformException as error:
                write(f"Failure at {now_ns / 1e9:.3f}\nException thrown:{error}\n")
                write(f"The current list of frames is:\n{stream.buffer.described()}\n")


def _pose_text(found: Transform) -> str:
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
    """Return the angles [rad] as tf2's getEulerYPR computes them, also at a pitch of ±90°."""
    m = found.matrix()
    if abs(m[2, 0]) >= 1:
        roll, up = atan2(m[2, 1], m[2, 2]), m[2, 0] < 0
        return (roll, pi / 2, 0.0) if up else (roll, -pi / 2, 0.0)
    return atan2(m[2, 1], m[2, 2]), -asin(m[2, 0]), atan2(m[1, 0], m[0, 0])


def _joined(numbers: tuple[float, ...]) -> str:
    return ", ".join(f"{number:.3f}" for number in numbers)


_ECHO = (
    value("source_frame", help="Frame that the transform is expressed in"),
    value("target_frame", help="Frame whose pose it is"),
    value("echo_rate", nargs="?", type=positive(float), default=1.0, help="How often to print it [Hz]"),
)
TF2_ECHO = Verb(
    "run tf2_ros", "tf2_echo", "Print how target_frame lies in source_frame, once a second", _ECHO, _echo
)


EVERY = 0.5  # [s] between two looks
LOOKS = 21  # before the results are printed
_LOWPASS = 0.01
_NOBODY = "<no authority available>"  # the middleware's, which tf2 does not ask


class TransformDelays:
    """Delays of the last 1000 transforms, by frame and in all."""

    def __init__(self) -> None:
        self.delays: dict[str, deque[float]] = defaultdict(partial(deque, maxlen=1000))  # [s]
        self._messages: deque[tuple[float, float]] = deque(maxlen=1000)  # arrival, mean delay [s]
        self._average = self._longest = 0.0  # [s] of the chain

    def note(self, now_ns: int, transforms: list[Transform]) -> None:
        """Record the arrival of transforms."""
        delays = [(now_ns - transform.stamp_ns) * 1e-9 for transform in transforms]
        for transform, delay in zip(transforms, delays, strict=True):
            self.delays[transform.child].append(delay)
        self._messages.append((now_ns * 1e-9, sum(delays) / max(1, len(delays))))

    def note_chain(self, delay: float) -> None:
        """Record the age [s] of the newest transform of the chain."""
        self._average = _LOWPASS * delay + (1 - _LOWPASS) * self._average
        self._longest = max(self._longest, delay)

    def text(self, chain: list[str]) -> str:
        """Return the results, of all frames if the chain is empty."""
        title = "for all Frames\n"
        if chain:
            title = (
                f"for {chain[0]} to {chain[-1]}\nChain is: {' -> '.join(chain)}\n"
                f"Net delay     avg = {self._average:g}: max = {self._longest:g}\n"
            )
        frames = "".join(
            f"Frame: {frame}, published by {_NOBODY}, {_delays(self.delays[frame], ', ')}"
            for frame in sorted(self.delays)
            if not chain or frame in chain
        )
        return f"\n\n\nRESULTS: {title}\nFrames:\n{frames}\nAll Broadcasters:\n{self._broadcasters()}"

    def _broadcasters(self) -> str:
        if not self._messages:
            return ""
        arrivals, delays = zip(*self._messages, strict=True)
        rate = len(arrivals) / max(1e-8, arrivals[-1] - arrivals[0])
        return f"Node: {_NOBODY} {rate:g} Hz, {_delays(delays, ' ')}"


def _monitor(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the delays of all transforms, or of those between two frames, every 10 s."""
    start, end = arguments.framea, arguments.frameb
    if start and not end:
        raise CourseError("tf2_monitor needs two frames or none: ros2 run tf2_ros tf2_monitor framea frameb")
    delays, chain, looks, shown = TransformDelays(), list[str](), 0, False
    stream = TransformStream(source, delays.note)
    what = f"{start} -> {end}" if start else "all frames"
    with until_interrupted():
        for now_ns in stream.ticks(EVERY, source.limit(EVERY * LOOKS)):
            if start and not chain:
                if not stream.can_transform(start, end, now_ns, write, "tf2_monitor_main"):
                    continue
                chain = tf2_core.chain(stream.buffer, start, end)
            if looks == 0 and what:
                write(f"Gathering data on {what} for 10 seconds...\n")
                what = ""
            if looks == LOOKS:
                write(delays.text(chain))
                looks, shown = 0, True
            if chain:
                delays.note_chain((now_ns - stream.buffer.lookup(start, end).stamp_ns) * 1e-9)
            looks += 1
        if looks and not shown:  # it ended earlier
            write(delays.text(chain))


def _delays(delays: Collection[float], between: str) -> str:
    average, longest = sum(delays) / len(delays), max(0.0, *delays)
    return f"Average Delay: {average:g}{between}Max Delay: {longest:g}\n"


_MONITOR = (
    value("framea", nargs="?", help="First frame of a chain; default: all frames"),
    value("frameb", nargs="?", help="Last frame of the chain"),
)
TF2_MONITOR = Verb("run tf2_ros", "tf2_monitor", "Print how late transforms come", _MONITOR, _monitor)
