"""`ros2 topic`: list, info, type and find; echo, hz, bw and delay; pub."""

import sys
from argparse import Namespace
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from statistics import pstdev
from typing import TYPE_CHECKING, Any, Literal

from course_lib.errors import CourseError, did_you_mean, format_count
from course_lib.ros.graph.graph import EndpointInfo, NodeInfo
from course_lib.ros.graph.topics import CLOCK, Qos, read_tick
from course_lib.ros.messages import RosMessage, message_class, type_name
from course_lib.ros.messages.conversions import PrintOptions, to_csv, to_yaml
from course_lib.ros.time.interrupts import until_interrupted
from course_lib.tools.sources import NODE_NAME, Source, StreamLimits, TimedSample, own_node
from course_lib.tools.verb import (
    NODE_OPTIONS,
    Option,
    Verb,
    Write,
    check_type,
    count,
    fill,
    flag,
    hidden,
    kind_of,
    make_find_verb,
    make_type_verb,
    parse_unsigned,
    positive,
    show_types,
    value,
    write_names,
)

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

PRESETS: Mapping[str, Qos] = {
    "system_default": Qos(depth=1),
    "sensor_data": Qos(depth=5, reliability="best_effort"),
    "services_default": Qos(),
    "parameters": Qos(depth=1000),
    "parameter_events": Qos(depth=1000),
    "action_status_default": Qos(depth=1, durability="transient_local"),
    "default": Qos(),
}
_CHOICES: Mapping[str, tuple[str, ...]] = {
    "history": ("keep_last", "keep_all"),
    "reliability": ("reliable", "best_effort"),
    "durability": ("transient_local", "volatile"),
    "liveliness": ("automatic", "manual_by_topic"),
}


def qos_options(verb: str, preset: str) -> tuple[Option, ...]:
    """Return ros2topic's `--qos-…` options. `verb` is subscribe or publish."""
    return (
        value(
            "--qos-profile",
            choices=tuple(PRESETS),
            default=preset,
            help=f"Quality of service preset profile to {verb} with (default: {preset})",
        ),
        value("--qos-depth", type=int, metavar="N", help=f"Queue size setting to {verb} with"),
        *(
            value(f"--qos-{name}", choices=names, help=f"Quality of service {name} setting to {verb} with")
            for name, names in _CHOICES.items()
        ),
    )


def requested_qos(arguments: Namespace) -> Qos | None:
    """Return the preset with the settings of the command line, or None if there are none."""
    names = (*_CHOICES, "depth")
    settings: dict[str, Any] = {name: getattr(arguments, f"qos_{name}") for name in names}
    changes = {name: setting for name, setting in settings.items() if setting is not None}
    return replace(PRESETS[arguments.qos_profile], **changes) if changes else None


def match_qos(offered: list[Qos], preset: Qos, write: Write) -> Qos:
    """Return the strongest QoS that is compatible with all publishers, as ros2topic chooses it."""
    qos = preset
    for name, strong, weak in (
        ("reliability", "reliable", "best_effort"),
        ("durability", "transient_local", "volatile"),
    ):
        count = sum(getattr(profile, name) == strong for profile in offered)
        if 0 < count < len(offered):
            policy = f"QoS{name.capitalize()}Policy."
            write(
                f"Some, but not all, publishers are offering {policy}{strong.upper()}. Falling "
                f"back to {policy}{weak.upper()} as it will connect to all publishers\n"
            )
        common: dict[str, Any] = {name: strong if count == len(offered) else weak}
        qos = replace(qos, **common) if offered else qos
    return qos


SENSOR_DATA = PRESETS["sensor_data"]


def full_name(topic: str) -> str:
    """Return a topic's name with a leading slash."""
    return topic if topic.startswith("/") else f"/{topic}"


def type_of(source: Source, topic: str, write: Write, *, blocking: bool) -> str:
    """Return a topic's type. If `blocking`, wait for the topic, as `hz`, `bw` and `delay` do.

    Raises:
        CourseError: The topic does not exist, its type is unknown, or it has several types.
    """
    known_topics = source.topics()
    if topic not in known_topics and source.discovery:
        source.wait(lambda: topic in source.topics(), source.discovery)
        known_topics = source.topics()
    if topic not in known_topics:
        write(f"WARNING: topic [{topic}] does not appear to be published yet\n")
        if blocking:
            source.wait(lambda: topic in source.topics(), source.limit())
    types = source.topics().get(topic)
    if not types:
        hint = f"{did_you_mean(topic, known_topics) or '.'} {describe_topics(source)}"
        raise CourseError(f"Could not determine the type for the passed topic{hint}")
    if len(types) > 1:
        type_list = ", ".join(types)
        raise CourseError(f"Cannot echo topic '{topic}', as it contains more than one type: [{type_list}]")
    # This raises a CourseError if the type is unknown.
    message_class(types[0])
    return types[0]


def describe_topics(source: Source) -> str:
    """Return a sentence with the names that `ros2 topic list` prints."""
    return f"Topics here: {', '.join(source.topics(with_hidden=False)) or 'none'}."


def silence_message(source: Source, topic: str, qos: Qos, since_ns: int) -> str:
    """Return the error text for a topic without messages: duration, reason, existing topics."""
    seconds = (source.graph.now_ns - since_ns) * 1e-9
    return (
        f"No message came on {topic} in {seconds:.4g} s of robot "
        f"time.{source.silence_reason(topic, qos)} {describe_topics(source)}"
    )


def listen(
    source: Source, arguments: Namespace, write: Write, *, verb: str, every: float | None = None
) -> Iterator[TimedSample]:
    """Yield the messages of a topic, and ticks, until ■. Their times are from the selected clock.

    Without a page it ends after a fixed time with a notice. If no message was received, it raises a
    CourseError.
    """
    topic, sim = full_name(arguments.topic_name), arguments.use_sim_time
    start_ns, limit, has_received = source.graph.now_ns, source.limit(), False
    with until_interrupted():
        kind = type_of(source, topic, write, blocking=True)
        topics = {(topic, kind): SENSOR_DATA, **({CLOCK: SENSOR_DATA} if sim else {})}
        arrivals = source.stream(topics, StreamLimits(limit, every=None if sim else every))
        for now_ns, arrival in _with_sim_time(arrivals, topic, every) if sim else arrivals:
            has_received = has_received or arrival is not None
            yield now_ns, arrival
        if not has_received:
            raise CourseError(silence_message(source, topic, SENSOR_DATA, start_ns))
        if limit:
            write(f"No page is watching: ros2 topic {verb} stopped after {limit:g} s of robot time.\n")


def _with_sim_time(
    arrivals: Iterable[TimedSample],
    topic: str,
    every: float | None,
) -> Iterator[TimedSample]:
    """Yield a topic's messages and ticks, timed by /clock [ns].

    Before the first message on /clock the time is 0.
    """
    now_ns = tick_ns = 0
    step_ns = round((every or 0.0) * 1e9)
    for _, sample in arrivals:
        time_ns = None if sample is None else read_tick(sample)
        if time_ns is not None:
            now_ns = time_ns
            if step_ns and (now_ns >= tick_ns or now_ns < tick_ns - step_ns):
                tick_ns = (now_ns // step_ns + 1) * step_ns
                yield now_ns, None
        if sample is not None and sample.topic == topic:
            yield now_ns, sample


def filter_function(expression: str | None) -> Callable[[Any], bool]:
    """Return a predicate from a Python expression in which m is the message.

    The predicate raises a CourseError if the expression fails.
    """
    if expression is None:
        return lambda _: True
    try:
        code = compile(expression, "--filter", "eval")
    except SyntaxError as error:
        raise CourseError(f"--filter {expression!r} is not a Python expression: {error.msg}.") from error

    def test(message: Any) -> bool:
        try:
            return bool(eval(code, {"m": message}))
        except Exception as error:
            raise CourseError(f"--filter {expression!r} fails: {type(error).__name__}: {error}") from error

    return test


_SIDES: tuple[tuple[str, Literal["pub", "sub"], str], ...] = (
    ("Published", "pub", "publisher"),
    ("Subscribed", "sub", "subscriber"),
)


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    topics = source.topics(with_hidden=arguments.hidden)
    if arguments.count or not arguments.verbose:
        write_names(topics, arguments, write)
        return
    for title, kind, noun in _SIDES:
        write(f"{title} topics:\n")
        for name, types in topics.items():
            if number := len(source.endpoints(name, kind)):
                write(f" * {name} [{', '.join(types)}] {format_count(number, noun)}\n")
        write("\n")


def _print_info(source: Source, arguments: Namespace, write: Write) -> None:
    topic, separator = arguments.topic_name, "\n\n" if arguments.verbose else "\n"
    types = source.topics().get(topic)
    if not types:
        raise CourseError(f"Unknown topic '{topic}'{did_you_mean(topic, source.topics())}")
    write(f"Type: {types[0] if len(types) == 1 else types}{separator}")
    nodes = {node.id: node for node in source.graph.nodes()}
    for title, endpoints in (
        ("Publisher", source.endpoints(topic, "pub")),
        ("Subscription", source.endpoints(topic, "sub")),
    ):
        write(f"{title} count: {len(endpoints)}{separator}")
        for endpoint in endpoints if arguments.verbose else ():
            write(f"{describe(endpoint, nodes[endpoint.node], title.upper())}{separator}")


def describe(endpoint: EndpointInfo, node: NodeInfo, kind: str) -> str:
    """Describe an endpoint in the format of rclpy's TopicEndpointInfo."""
    gid = ".".join(f"{byte:02x}" for byte in endpoint.gid)
    qos = endpoint.qos
    depth = f" ({qos.depth})" if qos.history == "keep_last" else ""
    policies = {
        "Reliability": qos.reliability.upper(),
        "History (Depth)": f"{qos.history.upper()}{depth}",
        "Durability": qos.durability.upper(),
        "Lifespan": _duration(qos.lifespan_ns),
        "Deadline": _duration(qos.deadline_ns),
        "Liveliness": qos.liveliness.upper(),
        "Liveliness lease duration": _duration(qos.lease_ns),
    }
    profile = "\n".join(f"  {name}: {setting}" for name, setting in policies.items())
    return (
        f"Node name: {node.name}\nNode namespace: {node.namespace}\nTopic type: {endpoint.type_name}\n"
        f"Topic type hash: {endpoint.type_hash() or 'INVALID'}\n"
        f"Endpoint type: {kind}\nGID: {gid}\nQoS profile:\n{profile}"
    )


def _duration(limit_ns: int | None) -> str:
    return "Infinite" if limit_ns is None else f"{limit_ns} nanoseconds"


def _topics(source: Source, with_hidden: bool) -> dict[str, list[str]]:
    return source.topics(with_hidden=with_hidden)


_NAME = value("topic_name", help="Name of the ROS topic (e.g. '/chatter')")
_TYPE = "Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')"
_VERBOSE = flag(
    "-v", "--verbose", help="Show full details of each topic, or of its publishers and subscriptions"
)
_LIST = (*NODE_OPTIONS, show_types("topic"), count("topic"), hidden("topic"), _VERBOSE)
TOPIC_LISTS = (
    Verb("topic", "list", "Output a list of available topics", _LIST, _list_all),
    Verb("topic", "info", "Print information about a topic", (*NODE_OPTIONS, _NAME, _VERBOSE), _print_info),
    make_type_verb("topic", "Print a topic's type", _topics, _NAME),
    make_find_verb("topic", _topics, _TYPE),
)


# Maximum robot time without a message [s].
SILENCE_LIMIT = 10.0


def _echo(source: Source, arguments: Namespace, write: Write) -> None:
    topic = full_name(arguments.topic_name)
    if arguments.message_type:
        kind = type_name(kind_of(message_class, arguments.message_type, "msg"))
        check_type(topic, kind, source.topics())
    else:
        kind = type_of(source, topic, write, blocking=False)
    matches = filter_function(arguments.filter_expr)
    qos = requested_qos(arguments) or match_qos(
        [endpoint.qos for endpoint in source.endpoints(topic, "pub")], PRESETS[arguments.qos_profile], write
    )
    start_ns, has_received, limit = source.graph.now_ns, False, None if arguments.once else source.limit()
    limits = StreamLimits(idle_seconds=SILENCE_LIMIT, seconds=arguments.timeout or limit)
    with until_interrupted():
        for received_ns, arrival in source.stream({(topic, kind): qos}, limits):
            has_received = True
            # These limits have no ticks, and only ticks are None.
            assert arrival is not None
            selected = arrival.cdr if arguments.raw else _field(arrival.message(), arguments.field)
            if not matches(selected):
                continue
            info: dict[str, int | None] = {}
            if arguments.include_message_info:
                # Times [ns] and sequence numbers, in the order of ROS. The numbers are None, as for
                # RMWs without them.
                info = {"source_timestamp": arrival.stamp_ns, "received_timestamp": received_ns}
                info |= {"publication_sequence_number": None, "reception_sequence_number": None}
            write(_text(selected, arguments, info))
            if arguments.once:
                return
        if not has_received:
            raise CourseError(silence_message(source, topic, qos, start_ns))
        if source.is_live and not arguments.timeout and not source.graph.ended:
            why = "No page is watching" if limit else "No further message came"
            write(f"{why}: ros2 topic echo stopped after {limit or SILENCE_LIMIT:g} s of robot time.\n")


def _text(selected: Any, arguments: Namespace, info: Mapping[str, int | None]) -> str:
    """Format a message or one of its fields, preceded by its info if requested."""
    style = PrintOptions(
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
    value("--truncate-length", "-l", type=parse_unsigned, default=128, help="The length to truncate them to"),
    flag("--no-arr", help="Don't print array fields of messages"),
    flag("--no-str", help="Don't print string fields of messages"),
    flag("--no-lost-messages", help="Don't report when a message is lost"),
    flag("-i", "--include-message-info", help="Shows the associated message info."),
    flag("--raw", help="Echo the raw binary representation"),
    value("--filter", dest="filter_expr", help="Python expression to filter messages; m is the message"),
    *qos_options("subscribe", "sensor_data"),
)
TOPIC_ECHO = Verb("topic", "echo", "Output messages from a topic", _ECHO, _echo, is_immediate=True)


# Upper limit, divisor, unit and digits.
_UNITS = (
    (1e3, 1, "B", 0),
    (1e6, 1e3, "KB", 2),
    (float("inf"), 1e6, "MB", 2),
)


def _hz(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the rate at most once per second, and at the end if it was never printed."""
    # Times between messages [ns].
    gaps: deque[int] = deque(maxlen=arguments.window)
    first_ns = printed_ns = None
    last_ns = 0
    matches, is_shown = filter_function(arguments.filter_expr), False
    for now_ns, arrival in listen(source, arguments, write, verb="hz"):
        if not now_ns:
            _discard_measurements(gaps, write)
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
            printed_ns, is_shown = now_ns, True
    if gaps and not is_shown:
        write(_rate(gaps))


def _bw(source: Source, arguments: Namespace, write: Write) -> None:
    topic = full_name(arguments.topic_name)
    # Time [ns] and size [bytes].
    sizes: deque[tuple[int, int]] = deque(maxlen=arguments.window)
    title = f"Subscribed to [{topic}]\n"
    for now_ns, arrival in listen(source, arguments, write, verb="bw", every=1.0):
        write(title)
        title = ""
        if arrival is not None and now_ns:
            sizes.append((now_ns, len(arrival.cdr)))
        elif len(sizes) > 1 and now_ns <= sizes[0][0]:
            sys.stderr.write("WARNING: time is reset!\n")
            sizes.clear()
        elif len(sizes) > 1:
            write(bandwidth([size for _, size in sizes], (now_ns - sizes[0][0]) * 1e-9))


def _delay(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the age of messages on arrival, from their headers.

    As in ROS, the first is skipped.
    """
    # In nanoseconds.
    delays: deque[int] = deque(maxlen=arguments.window)
    topic, new, first_ns = full_name(arguments.topic_name), False, None
    for now_ns, arrival in listen(source, arguments, write, verb="delay", every=1.0):
        if not now_ns:
            _discard_measurements(delays, write)
        elif arrival is None:
            if new:
                write(f"average delay: {sum(delays) / len(delays) * 1e-9:.3f}\n{_spread(delays)}")
            elif delays:
                write("no new messages\n")
            new = False
        elif not hasattr(message := arrival.message(), "header"):
            raise CourseError(
                f"msg does not have header: {arrival.type_name} has no time stamp. "
                f"`ros2 topic hz {topic}` measures its rate."
            )
        elif first_ns is None or first_ns > now_ns:
            first_ns = now_ns
            delays.clear()
        else:
            stamp = message.header.stamp
            delays.append(now_ns - stamp.sec * 10**9 - stamp.nanosec)
            new = True


def _discard_measurements(values_ns: deque[int], write: Write) -> None:
    """Discard the measurements, because simulation time was reset to 0."""
    if values_ns:
        write("time has reset, resetting counters\n")
        values_ns.clear()


def bandwidth(sizes: list[int], seconds: float) -> str:
    """Return the bandwidth and message sizes over a time [s] as text, in a unit that suits the bandwidth."""
    rate = sum(sizes) / seconds
    total, mean, smallest, largest = format_byte_sizes(rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
    return (
        f"{total}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {smallest} max: {largest}\n"
    )


def format_byte_sizes(*numbers: float) -> list[str]:
    """Return numbers of bytes as text, in a unit that suits the first number."""
    divisor, unit, digits = next((by, name, n) for below, by, name, n in _UNITS if numbers[0] < below)
    return [f"{number / divisor:.{digits}f} {unit}" for number in numbers]


def _rate(gaps: Sequence[int]) -> str:
    mean = sum(gaps) / len(gaps) * 1e-9
    return f"average rate: {1 / mean if mean > 0 else 0:.3f}\n{_spread(gaps)}"


def _spread(values_ns: Sequence[int]) -> str:
    """Return minimum, maximum and population standard deviation of durations [ns] as text."""
    shortest, longest, deviation = (n * 1e-9 for n in (min(values_ns), max(values_ns), pstdev(values_ns)))
    window = len(values_ns)
    return f"\tmin: {shortest:.3f}s max: {longest:.3f}s std dev: {deviation:.5f}s window: {window}\n"


def _options(window: int) -> tuple[Option, ...]:
    return (
        value("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')"),
        value("-w", "--window", type=positive(int), default=window, help="window size, in # of messages"),
        *NODE_OPTIONS[:2],
    )


_HZ_OPTIONS = (
    value("--filter", dest="filter_expr", metavar="EXPR", help="only measure messages that this Python fits"),
    flag("--wall-time", help="calculates rate using wall time; here robot time stands for it"),
)
_verb = partial(Verb, "topic", is_immediate=True)
TOPIC_MEASURES = (
    _verb("hz", "Print the average publishing rate to screen", (*_options(10000), *_HZ_OPTIONS), _hz),
    _verb("bw", "Display bandwidth used by topic", _options(100), _bw),
    _verb("delay", "Display delay of topic from timestamp in header", _options(10000), _delay),
)


# Polling period for subscriptions [s]. Every tenth poll is reported.
LOOK_EVERY = 0.1


def _run(source: Source, arguments: Namespace, write: Write) -> None:
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.impl.graph_queries import to_profile

    kind = kind_of(message_class, arguments.message_type, "msg")
    qos = requested_qos(arguments) or PRESETS[arguments.qos_profile]
    message: Any = kind()
    set_times = fill(message, sys.stdin.read() if arguments.stdin else arguments.values)
    name, sim = arguments.node_name or NODE_NAME, arguments.use_sim_time
    with until_interrupted(), own_node(source, name, use_sim_time=sim) as node:
        try:
            publisher = node.create_publisher(kind, arguments.topic_name, to_profile(qos))
        except InvalidTopicNameException as error:
            raise CourseError(str(error)) from error
        _wait_for_subscriptions(source, publisher, arguments, write)
        write("publisher: beginning loop\n")
        for count in _publication_counts(source, node, arguments, write):
            for set_time in set_times:
                set_time(node.get_clock().now().to_msg())
            if arguments.print and count % arguments.print == 0:
                write(f"publishing #{count}: {message!r}\n\n")
            publisher.publish(message)


def _wait_for_subscriptions(
    source: Source, publisher: "Publisher[Any]", arguments: Namespace, write: Write
) -> None:
    expected, longest = arguments.wait_matching_subscriptions, arguments.max_wait_time_secs
    if expected is None:
        expected = int(arguments.once or arguments.times > 0)
    if not expected and longest is not None:
        raise CourseError(
            "--max-wait-time-secs option is only effective with --wait-matching-subscriptions, "
            "--once or --times"
        )
    longest, looks = longest or source.limit(), 0
    while (count := publisher.get_subscription_count()) < expected and not source.graph.ended:
        if looks % 10 == 0:
            write(f"Waiting for at least {expected} matching subscription(s)...\n")
        if longest is not None and looks * LOOK_EVERY >= longest:
            raise CourseError(
                f"Timed out waiting for subscribers: Expected {expected} subcribers but only got "
                f"{count} subscribers. `-w 0` publishes without subscribers."
            )
        looks += 1
        source.wait(lambda: False, LOOK_EVERY)


def _publication_counts(
    source: Source,
    node: "Node",
    arguments: Namespace,
    write: Write,
) -> Iterator[int]:
    times = 1 if arguments.once else arguments.times
    limit = None if times else source.limit()
    start_ns, count = source.graph.now_ns, 0
    if arguments.use_sim_time:
        source.wait(lambda: node.get_clock().now().nanoseconds > 0, source.limit())
    while not source.graph.ended and (not times or count < times):
        count += 1
        yield count
        if limit is not None and source.graph.now_ns - start_ns >= limit * 1e9:
            write(f"No page is watching: ros2 topic pub stopped after {limit:g} s of robot time.\n")
            return
        if arguments.use_sim_time and count != times:
            _sleep_by_clock(source, node, 1 / arguments.rate)
        else:
            source.wait(lambda: False, arguments.keep_alive if count == times else 1 / arguments.rate)


def _sleep_by_clock(source: Source, node: "Node", seconds: float) -> None:
    """Sleep for a duration that is measured by /clock."""
    calls = list[None]()
    timer = node.create_timer(seconds, lambda: calls.append(None))
    source.wait(lambda: bool(calls), source.limit())
    node.destroy_timer(timer)


_OPTIONS = (
    value("topic_name", help="Name of the ROS topic to publish to (e.g. '/chatter')"),
    value("message_type", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"),
    value("values", nargs="?", default="{}", help="Values to fill the message with in YAML format"),
    flag("--stdin", help="Read values from standard input"),
    value("-r", "--rate", metavar="N", type=positive(float), default=1.0, help="Publishing rate in Hz"),
    value("-p", "--print", metavar="N", type=int, default=1, help="Only print every N-th message"),
    flag("-1", "--once", help="Publish one message and exit", exclusive="count"),
    value(
        "-t",
        "--times",
        type=parse_unsigned,
        default=0,
        help="Publish this number of times and exit",
        exclusive="count",
    ),
    value(
        "-w",
        "--wait-matching-subscriptions",
        type=parse_unsigned,
        help="Number of matching subscriptions to wait for",
    ),
    value(
        "--max-wait-time-secs",
        type=positive(float),
        help="Maximum time to wait for matching subscriptions, in seconds",
    ),
    value(
        "--keep-alive",
        type=positive(float),
        default=0.1,
        help="Keep publishing node alive for N seconds after the last msg (default: 0.1)",
    ),
    value("-n", "--node-name", help="Name of the created publishing node"),
    *qos_options("publish", "default"),
    *NODE_OPTIONS[:2],
)
TOPIC_PUB = Verb("topic", "pub", "Publish a message to a topic", _OPTIONS, _run)
