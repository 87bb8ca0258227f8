"""What the tools for transforms hear on /tf and /tf_static."""

from collections.abc import Callable, Iterator

from course_lib.ros.qos import Qos
from course_lib.ros.tf2_core import BufferCore
from course_lib.ros.tf2_transform import Transform
from course_lib.tools.sources import Listening, Source
from course_lib.tools.verb import Write

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
