"""`ros2 topic echo`, `hz`, `bw` and `delay`: messages, and statistics of the last ones."""

from argparse import Namespace
from collections import deque
from collections.abc import Mapping, Sequence
from functools import partial
from statistics import pstdev
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import RosMessage, message_class, type_name
from course_lib.ros.messages.conversions import Style, to_csv, to_yaml
from course_lib.tools.message_yaml import check_type, kind_of
from course_lib.tools.sources import Listening, Source
from course_lib.tools.topic.lookup import (
    PRESETS,
    adapted_qos,
    asked_qos,
    full_name,
    listen,
    passes,
    qos_options,
    silence,
    type_of,
)
from course_lib.tools.verb import NODE_OPTIONS, Option, Verb, Write, flag, positive, unsigned, value

SILENCE_LIMIT = 10.0  # [s] of robot time without a message


def _echo(source: Source, arguments: Namespace, write: Write) -> None:
    topic = full_name(arguments.topic_name)
    if arguments.message_type:
        kind = type_name(kind_of(message_class, arguments.message_type, "msg"))
        check_type(topic, kind, source.topics())
    else:
        kind = type_of(source, topic, write, blocking=False)
    matches = passes(arguments.filter_expr)
    qos = asked_qos(arguments) or adapted_qos(source.offered(topic), PRESETS[arguments.qos_profile], write)
    start_ns, came, limit = source.graph.now_ns, False, None if arguments.once else source.limit()
    listening = Listening(patience=SILENCE_LIMIT, seconds=arguments.timeout or limit)
    with until_interrupted():
        for heard_ns, arrival in source.stream({(topic, kind): qos}, listening):
            came = True
            assert arrival is not None  # no ticks were asked for
            selected = arrival.cdr if arguments.raw else _field(arrival.message(), arguments.field)
            if not matches(selected):
                continue
            info = _info(arrival.stamp_ns, heard_ns) if arguments.include_message_info else {}
            write(_text(selected, arguments, info))
            if arguments.once:
                return
        if not came:
            raise CourseError(silence(source, topic, qos, start_ns))
        if source.live and not arguments.timeout and not source.graph.ended:
            why = "No page is watching" if limit else "No further message came"
            write(f"{why}: ros2 topic echo stopped after {limit or SILENCE_LIMIT:g} s of robot time.\n")


def _info(source_ns: int, received_ns: int) -> dict[str, int | None]:
    """Return the fields of a message's info in ROS's order; messages are not numbered here."""
    numbers = {"publication_sequence_number": None, "reception_sequence_number": None}
    return {"source_timestamp": source_ns, "received_timestamp": received_ns, **numbers}


def _text(selected: Any, arguments: Namespace, info: Mapping[str, int | None]) -> str:
    """Return the printed form of a message or of one field, behind its info if that is wanted."""
    style = Style(
        truncate=None if arguments.full_length else arguments.truncate_length,
        no_arrays=arguments.no_arr,
        no_strings=arguments.no_str,
        flow=arguments.flow_style,
    )
    if not isinstance(selected, RosMessage):
        title = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if info else ""
        return f"{title}{selected}\n---\n"
    if arguments.csv:
        return f"{','.join([*map(str, info.values()), to_csv(selected, style)])}\n"
    lines = [f"{name}: {'null' if number is None else number}\n" for name, number in sorted(info.items())]
    return "".join([*lines, *(["---\n"] if info else []), to_yaml(selected, style), "---\n"])


def _field(message: RosMessage, path: str | None) -> Any:
    selected: Any = message
    for name in filter(None, (path or "").split(".")):
        try:
            selected = getattr(selected, name)
        except AttributeError as error:
            fields = selected.get_fields_and_field_types() if isinstance(selected, RosMessage) else ()
            hint = f". It has {', '.join(fields)}." if fields else ""
            raise CourseError(f"Invalid field '{path}': {error}{hint}") from error
    return selected


_ECHO = (
    *NODE_OPTIONS,
    value("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')"),
    value("message_type", nargs="?", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"),
    flag("--once", help="Print the first message received and then exit"),
    value("--field", help="Echo a selected field of a message; '.' selects sub-fields"),
    value("--timeout", type=positive(float), metavar="N", help="Set a timeout in seconds for waiting"),
    flag("--csv", help="Output all recursive fields separated by commas"),
    flag("--flow-style", help="Print collections in one line"),
    flag("--full-length", "-f", help="Output all elements of arrays, bytes and strings"),
    value("--truncate-length", "-l", type=unsigned, default=128, help="The length to truncate them to"),
    flag("--no-arr", help="Don't print array fields of messages"),
    flag("--no-str", help="Don't print string fields of messages"),
    flag("--no-lost-messages", help="Don't report when a message is lost"),
    flag("-i", "--include-message-info", help="Shows the associated message info."),
    flag("--raw", help="Echo the raw binary representation"),
    value("--filter", dest="filter_expr", help="Python expression to filter messages; m is the message"),
    *qos_options("subscribe", "sensor_data"),
)
TOPIC_ECHO = Verb("topic", "echo", "Output messages from a topic", _ECHO, _echo, from_start=True)


_UNITS = (  # below, divided by, name, digits
    (1e3, 1, "B", 0),
    (1e6, 1e3, "KB", 2),
    (float("inf"), 1e6, "MB", 2),
)


def _hz(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the rate at most once a second, and at the end if there was no second."""
    gaps: deque[int] = deque(maxlen=arguments.window)  # [ns] between two messages
    first_ns = printed_ns = None
    last_ns = 0
    matches, shown = passes(arguments.filter_expr), False
    for now_ns, arrival in listen(source, arguments, write, verb="hz"):
        if not now_ns:
            _restart(gaps, write)
            continue
        if arguments.filter_expr and arrival is not None and not matches(arrival.message()):
            continue
        if first_ns is None or first_ns > now_ns:
            first_ns = now_ns
            gaps.clear()
        else:
            gaps.append(now_ns - last_ns)
            printed_ns = printed_ns or now_ns
        last_ns = now_ns
        if printed_ns is not None and now_ns >= printed_ns + 10**9:
            write(_rate(gaps))
            printed_ns, shown = now_ns, True
    if gaps and not shown:
        write(_rate(gaps))


def _bw(source: Source, arguments: Namespace, write: Write) -> None:
    topic = full_name(arguments.topic_name)
    heard: deque[tuple[int, int]] = deque(maxlen=arguments.window)  # when [ns], bytes
    title = f"Subscribed to [{topic}]\n"
    for now_ns, arrival in listen(source, arguments, write, verb="bw", every=1.0):
        write(title)
        title = ""
        if arrival is not None and now_ns:
            heard.append((now_ns, len(arrival.cdr)))
        elif len(heard) > 1 and now_ns <= heard[0][0]:
            write("WARNING: time is reset!\n")
            heard.clear()
        elif len(heard) > 1:
            write(bandwidth([size for _, size in heard], (now_ns - heard[0][0]) * 1e-9))


def _delay(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the age of messages at their arrival, by their headers; the first one is not counted."""
    delays: deque[int] = deque(maxlen=arguments.window)  # [ns]
    topic, new, first_ns = full_name(arguments.topic_name), False, None
    for now_ns, arrival in listen(source, arguments, write, verb="delay", every=1.0):
        if not now_ns:
            _restart(delays, write)
        elif arrival is None:
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
        elif first_ns is None or first_ns > now_ns:
            first_ns = now_ns
            delays.clear()
        else:
            stamp = message.header.stamp
            delays.append(now_ns - stamp.sec * 10**9 - stamp.nanosec)
            new = True


def _restart(values_ns: deque[int], write: Write) -> None:
    """Forget what was measured: simulation time stands at 0."""
    if values_ns:
        write("time has reset, resetting counters\n")
        values_ns.clear()


def bandwidth(sizes: list[int], seconds: float) -> str:
    """Return the bandwidth and the sizes of messages within so many seconds, in the unit of the rate."""
    rate = sum(sizes) / seconds
    total, mean, least, most = in_bytes(rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
    return f"{total}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} max: {most}\n"


def in_bytes(*numbers: float) -> list[str]:
    """Return numbers of bytes as text, in the unit that fits the first one."""
    divisor, unit, digits = next((by, name, n) for below, by, name, n in _UNITS if numbers[0] < below)
    return [f"{number / divisor:.{digits}f} {unit}" for number in numbers]


def _rate(gaps: Sequence[int]) -> str:
    mean = sum(gaps) / len(gaps) * 1e-9
    return f"average rate: {1 / mean if mean > 0 else 0:.3f}\n{_spread(gaps)}"


def _spread(values_ns: Sequence[int]) -> str:
    """Return minimum, maximum and population standard deviation of durations [ns] as text."""
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
    _verb("hz", "Print the average publishing rate to screen", (*_options(10000), *_OF_HZ), _hz),
    _verb("bw", "Display bandwidth used by topic", _options(100), _bw),
    _verb("delay", "Display delay of topic from timestamp in header", _options(10000), _delay),
)
