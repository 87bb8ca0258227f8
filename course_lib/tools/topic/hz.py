"""`ros2 topic hz`."""

from argparse import Namespace
from collections import deque

from course_lib.tools.sources import Source
from course_lib.tools.topic.lookup import full_name, listen, passes, spread, window_options
from course_lib.tools.verb import Verb, Write, flag, value


def run(source: Source, arguments: Namespace, write: Write) -> None:
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


def _rate(gaps: deque[int]) -> str:
    mean = sum(gaps) / len(gaps) * 1e-9
    return f"average rate: {1 / mean if mean else 0:.3f}\n{spread(gaps)}"


_OPTIONS = (
    *window_options(10000),
    value(
        "--filter",
        dest="filter_expr",
        metavar="EXPR",
        help="only measure messages matching the specified Python expression",
    ),
    flag("--wall-time", help="calculates rate using wall time; here robot time stands for it"),
)
TOPIC_HZ = Verb("topic", "hz", "Print the average publishing rate to screen", _OPTIONS, run, from_start=True)
