"""The topic /clock, on which a simulation or a player sets the time."""

from typing import Any

from course_lib.ros.qos import Qos
from course_lib.ros.topics import Sample

CLOCK = ("/clock", "rosgraph_msgs/msg/Clock")
CLOCK_QOS = Qos(depth=1, reliability="best_effort")


def tick(time_ns: int) -> Sample:
    """Return a message on /clock, of no node."""
    from course_lib.ros.messages import message_class, serialize  # they need numpy

    seconds, nanoseconds = divmod(time_ns, 10**9)
    time = message_class("builtin_interfaces/msg/Time")(sec=seconds, nanosec=nanoseconds)
    return Sample(time_ns, *CLOCK, serialize(message_class(CLOCK[1])(clock=time)), CLOCK_QOS, node=0)


def ticked(sample: Sample) -> int | None:
    """Return the time [ns] that a message on /clock sets; None for any other message."""
    if (sample.topic, sample.type_name) != CLOCK:
        return None
    time: Any = sample.message().clock
    return int(time.sec * 10**9 + time.nanosec)
