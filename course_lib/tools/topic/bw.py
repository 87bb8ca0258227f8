"""`ros2 topic bw`."""

from argparse import Namespace
from collections import deque

from course_lib.tools.sources import Source
from course_lib.tools.topic.lookup import full_name, listen, window_options
from course_lib.tools.verb import Verb, Write

_UNITS = (
    (1e3, 1, "B", 0),
    (1e6, 1e3, "KB", 2),
    (float("inf"), 1e6, "MB", 2),
)  # below, divided by, name, digits


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print once a second how many bytes come, as they are on the wire."""
    topic = full_name(arguments.topic_name)
    heard: deque[tuple[int, int]] = deque(maxlen=arguments.window)  # when [ns], bytes
    title = f"Subscribed to [{topic}]\n"
    for now_ns, arrival in listen(source, topic, write, verb="bw", every=1.0):
        write(title)
        title = ""
        if arrival is not None:
            heard.append((now_ns, len(arrival.cdr)))
        elif len(heard) > 1:
            write(bandwidth([size for _, size in heard], (now_ns - heard[0][0]) * 1e-9))


def bandwidth(sizes: list[int], seconds: float) -> str:
    """Write the bandwidth of messages that came in so many seconds, all in the unit that fits the rate."""
    rate = sum(sizes) / seconds
    divisor, unit, digits = next((by, name, n) for below, by, name, n in _UNITS if rate < below)
    numbers = (rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
    total, mean, least, most = (f"{number / divisor:.{digits}f} {unit}" for number in numbers)
    return f"{total}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} max: {most}\n"


TOPIC_BW = Verb("topic", "bw", "Display bandwidth used by topic", window_options(100), run, from_start=True)
