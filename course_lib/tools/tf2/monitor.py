"""`ros2 run tf2_ros tf2_monitor` (geometry2, tf2_ros/src/tf2_monitor.cpp)."""

from argparse import Namespace
from collections import defaultdict, deque
from collections.abc import Collection
from functools import partial

from course_lib.errors import CourseError
from course_lib.ros import tf2_frames
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.tf2_transform import Transform
from course_lib.tools.sources import Source
from course_lib.tools.tf2.echo import Heard
from course_lib.tools.verb import Verb, Write, value

EVERY = 0.5  # [s] between two looks
LOOKS = 21  # before the results are printed
_LOWPASS = 0.01
_NOBODY = "<no authority available>"  # the middleware's, which tf2 does not ask


class Monitor:
    """How late transforms come, by frame and in all; the last 1000 count."""

    def __init__(self) -> None:
        self.delays: dict[str, deque[float]] = defaultdict(partial(deque, maxlen=1000))  # [s]
        self._messages: deque[tuple[float, float]] = deque(maxlen=1000)  # arrival, mean delay [s]
        self._average = self._longest = 0.0  # [s] of the chain

    def note(self, now_ns: int, transforms: list[Transform]) -> None:
        """Note when transforms were heard."""
        delays = [(now_ns - transform.stamp_ns) * 1e-9 for transform in transforms]
        for transform, delay in zip(transforms, delays, strict=True):
            self.delays[transform.child].append(delay)
        self._messages.append((now_ns * 1e-9, sum(delays) / max(1, len(delays))))

    def note_chain(self, delay: float) -> None:
        """Note how old, [s], the newest transform of the chain is."""
        self._average = _LOWPASS * delay + (1 - _LOWPASS) * self._average
        self._longest = max(self._longest, delay)

    def text(self, chain: list[str]) -> str:
        """Write the results; of all frames if there is no chain."""
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


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the delays of all transforms, or of those between two frames, every 10 s."""
    start, end = arguments.framea, arguments.frameb
    if start and not end:
        raise CourseError("tf2_monitor needs two frames or none: ros2 run tf2_ros tf2_monitor framea frameb")
    monitor, chain, looks, shown = Monitor(), list[str](), 0, False
    heard = Heard(source, monitor.note)
    what = f"{start} -> {end}" if start else "all frames"
    with until_interrupted():
        for now_ns in heard.ticks(EVERY, source.limit(EVERY * LOOKS)):
            if start and not chain:
                if not heard.can_transform(start, end, now_ns, write, "tf2_monitor_main"):
                    continue
                chain = tf2_frames.chain(heard.buffer, start, end)
            if looks == 0 and what:
                write(f"Gathering data on {what} for 10 seconds...\n")
                what = ""
            if looks == LOOKS:
                write(monitor.text(chain))
                looks, shown = 0, True
            if chain:
                monitor.note_chain((now_ns - heard.buffer.lookup(start, end).stamp_ns) * 1e-9)
            looks += 1
        if looks and not shown:  # it ended earlier
            write(monitor.text(chain))


def _delays(delays: Collection[float], between: str) -> str:
    average, longest = sum(delays) / len(delays), max(0.0, *delays)
    return f"Average Delay: {average:g}{between}Max Delay: {longest:g}\n"


_OPTIONS = (
    value("framea", nargs="?", help="First frame of a chain; default: all frames"),
    value("frameb", nargs="?", help="Last frame of the chain"),
)
TF2_MONITOR = Verb("run tf2_ros", "tf2_monitor", "Print how late transforms come", _OPTIONS, run)
