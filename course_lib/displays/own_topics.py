"""The topics that a session listens to itself: tf, and with `use_sim_time` the clock."""

from collections.abc import Callable
from functools import partial
from typing import Any

from course_lib.displays.display import Interest
from course_lib.displays.frames import Frames, nanoseconds
from course_lib.displays.statuses import Statuses
from course_lib.displays.view_time import ViewTime
from course_lib.ros.qos import Qos
from course_lib.ros.sim_time import CLOCK, CLOCK_QOS

TF = "tf2_msgs/msg/TFMessage"
_TF_TOPICS = {"/tf": Qos(depth=100), "/tf_static": Qos(depth=100, durability="transient_local")}


class OwnTopics:
    """Keeps the frames and the time of a session up to date.

    Args:
        frames: Get the transforms.
        time: Gets the time of /clock.
        statuses: Show what is wrong with transforms.
        reset: Is called with the reason when time jumps back.
    """

    def __init__(
        self, frames: Frames, time: ViewTime, statuses: Statuses, reset: Callable[[str], None]
    ) -> None:
        self._frames, self._time, self._statuses, self._reset = frames, time, statuses, reset
        self._transforms = [
            Interest(topic, TF, qos, partial(self._take_transforms, topic == "/tf_static"), statuses)
            for topic, qos in _TF_TOPICS.items()
        ]
        self._clock = Interest(*CLOCK, CLOCK_QOS, self._take_clock, statuses)

    @property
    def interests(self) -> list[Interest]:
        """The subscriptions; the clock's only with `use_sim_time`."""
        return [*self._transforms, *([self._clock] if self._time.use_sim_time else [])]

    def _take_transforms(self, is_static: bool, message: Any) -> None:
        complaints = self._frames.take(message.transforms, is_static)
        if complaints:
            self._statuses.hint("TF", *complaints)

    def _take_clock(self, message: Any) -> None:
        if self._time.follow(nanoseconds(message.clock)):
            self._reset("Detected jump back in time.")
