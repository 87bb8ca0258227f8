"""`ros2 topic hz`, `bw` and `delay`: they print, once a second, numbers of a topic's last messages."""

from argparse import Namespace
from collections import deque
from collections.abc import Sequence
from functools import partial
from statistics import pstdev

from course_lib.errors import CourseError
from course_lib.tools.sources import Source
from course_lib.tools.topic.lookup import full_name, listen, passes
from course_lib.tools.verb import NODE_OPTIONS, Option, Verb, Write, flag, positive, value

_UNITS = (  # below, divided by, name, digits
    (1e3, 1, "B", 0),
    (1e6, 1e3, "KB", 2),
    (float("inf"), 1e6, "MB", 2),
)


def hz(source: Source, arguments: Namespace, write: Write) -> None:
    """Print how often messages come, at most once a second; at the end if there was no second."""
    gaps: deque[int] = deque(maxlen=arguments.window)  # [ns] between two messages
    last_ns = printed_ns = None
    matches, shown = passes(arguments.filter_expr), False
    for now_ns, arrival in listen(source, full_name(arguments.topic_name), write, verb="hz"):
        if arguments.filter_expr and arrival is not None and not matches(arrival.message()):
            continue
        if last_ns is not None:
            gaps.append(now_ns - last_ns)
            printed_ns = printed_ns or now_ns
        last_ns = now_ns
        if printed_ns is not None and now_ns >= printed_ns + 10**9:
            write(_rate(gaps))
            printed_ns, shown = now_ns, True
    if gaps and not shown:
        write(_rate(gaps))


def bw(source: Source, arguments: Namespace, write: Write) -> None:
    """Print how many bytes come, as they are on the wire."""
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


def delay(source: Source, arguments: Namespace, write: Write) -> None:
    """Print how old messages are when they come, by their headers; the first does not count.

    Raises:
        CourseError: The messages have no header.
    """
    delays: deque[int] = deque(maxlen=arguments.window)  # [ns]
    topic, first, new = full_name(arguments.topic_name), True, False
    for now_ns, arrival in listen(source, topic, write, verb="delay", every=1.0):
        if arrival is None:
            if new:
                write(f"average delay: {sum(delays) / len(delays) * 1e-9:.3f}\n{_spread(delays)}")
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


def bandwidth(sizes: list[int], seconds: float) -> str:
    """Write the bandwidth of messages that came in so many seconds, all in the unit that fits the rate."""
    rate = sum(sizes) / seconds
    total, mean, least, most = in_bytes(rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
    return f"{total}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} max: {most}\n"


def in_bytes(*numbers: float) -> list[str]:
    """Write numbers of bytes, all in the unit that fits the first one."""
    divisor, unit, digits = next((by, name, n) for below, by, name, n in _UNITS if numbers[0] < below)
    return [f"{number / divisor:.{digits}f} {unit}" for number in numbers]


def _rate(gaps: Sequence[int]) -> str:
    mean = sum(gaps) / len(gaps) * 1e-9
    return f"average rate: {1 / mean if mean else 0:.3f}\n{_spread(gaps)}"


def _spread(values_ns: Sequence[int]) -> str:
    """Write the least, the greatest and the population's standard deviation of durations [ns]."""
    least, most, deviation = (n * 1e-9 for n in (min(values_ns), max(values_ns), pstdev(values_ns)))
    window = len(values_ns)
    return f"\tmin: {least:.3f}s max: {most:.3f}s std dev: {deviation:.5f}s window: {window}\n"


def _options(window: int) -> tuple[Option, ...]:
    return (
        value("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')"),
        value("-w", "--window", type=positive(int), default=window, help="window size, in # of messages"),
        *NODE_OPTIONS[:2],
    )


_OF_HZ = (
    value("--filter", dest="filter_expr", metavar="EXPR", help="only measure messages that this Python fits"),
    flag("--wall-time", help="calculates rate using wall time; here robot time stands for it"),
)
_verb = partial(Verb, "topic", from_start=True)
TOPIC_MEASURES = (
    _verb("hz", "Print the average publishing rate to screen", (*_options(10000), *_OF_HZ), hz),
    _verb("bw", "Display bandwidth used by topic", _options(100), bw),
    _verb("delay", "Display delay of topic from timestamp in header", _options(10000), delay),
)
