"""`ros2 topic delay`."""

from argparse import Namespace
from collections import deque

from course_lib.errors import CourseError
from course_lib.tools.sources import Source
from course_lib.tools.topic.lookup import full_name, listen, spread, window_options
from course_lib.tools.verb import Verb, Write


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print once a second how old messages are when they come, by their headers; the first does not count.

    Raises:
        CourseError: The messages have no header.
    """
    delays: deque[int] = deque(maxlen=arguments.window)  # [ns]
    topic, first, new = full_name(arguments.topic_name), True, False
    for now_ns, arrival in listen(source, topic, write, verb="delay", every=1.0):
        if arrival is None:
            if new:
                write(f"average delay: {sum(delays) / len(delays) * 1e-9:.3f}\n{spread(delays)}")
            elif delays:
                write("no new messages\n")
            new = False
        elif not hasattr(message := arrival.message(), "header"):
            raise CourseError(
                f"msg does not have header: {arrival.type_name} says nothing of when it was made. "
                f"`ros2 topic hz {topic}` shows how often it comes."
            )
        elif first:
            first = False
        else:
            stamp = message.header.stamp
            delays.append(now_ns - stamp.sec * 10**9 - stamp.nanosec)
            new = True


TOPIC_DELAY = Verb(
    "topic",
    "delay",
    "Display delay of topic from timestamp in header",
    window_options(10000),
    run,
    from_start=True,
)
