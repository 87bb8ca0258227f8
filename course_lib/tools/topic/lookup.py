"""Options of the verbs of `ros2 topic`, and access to a topic's type, QoS and messages."""

from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import message_class
from course_lib.ros.qos import Qos
from course_lib.ros.sim_time import CLOCK, ticked
from course_lib.tools.sources import Listening, Source, TimedSample
from course_lib.tools.verb import Option, Write, value

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
    """Return the `--qos-…` options (ros2topic.api); `verb` is subscribe or publish."""
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


def asked_qos(arguments: Namespace) -> Qos | None:
    """Return the preset with the requested settings, or None if none was requested."""
    names = (*_CHOICES, "depth")
    given: dict[str, Any] = {name: getattr(arguments, f"qos_{name}") for name in names}
    changes = {name: setting for name, setting in given.items() if setting is not None}
    return replace(PRESETS[arguments.qos_profile], **changes) if changes else None


def adapted_qos(offered: list[Qos], preset: Qos, write: Write) -> Qos:
    """Return the strongest QoS that all publishers offer, as ROS requests it."""
    qos = preset
    for name, strong, weak in (
        ("reliability", "reliable", "best_effort"),
        ("durability", "transient_local", "volatile"),
    ):
        count = sum(getattr(one, name) == strong for one in offered)
        if 0 < count < len(offered):
            policy = f"QoS{name.capitalize()}Policy."
            write(
                f"Some, but not all, publishers are offering {policy}{strong.upper()}. Falling back to "
                f"{policy}{weak.upper()} as it will connect to all publishers\n"
            )
        common: dict[str, Any] = {name: strong if count == len(offered) else weak}
        qos = replace(qos, **common) if offered else qos
    return qos


SENSOR_DATA = PRESETS["sensor_data"]


def full_name(topic: str) -> str:
    """Return a topic's name with its leading slash."""
    return topic if topic.startswith("/") else f"/{topic}"


def type_of(source: Source, topic: str, write: Write, *, blocking: bool) -> str:
    """Return a topic's type; wait for the topic if `blocking`, as `hz`, `bw` and `delay` do.

    Raises:
        CourseError: There is no such topic, its type is not known here, or it has several.
    """
    there = source.topics()
    if topic not in there and source.discovery:
        source.wait(lambda: topic in source.topics(), source.discovery)
        there = source.topics()
    if topic not in there:
        write(f"WARNING: topic [{topic}] does not appear to be published yet\n")
        if blocking:
            source.wait(lambda: topic in source.topics(), source.limit())
    types = source.topics().get(topic)
    if not types:
        hint = f"{did_you_mean(topic, there) or '.'} {topics_here(source)}"
        raise CourseError(f"Could not determine the type for the passed topic{hint}")
    if len(types) > 1:
        found = ", ".join(types)
        raise CourseError(f"Cannot echo topic '{topic}', as it contains more than one type: [{found}]")
    message_class(types[0])  # says which type is not known
    return types[0]


def topics_here(source: Source) -> str:
    """Return the names that `ros2 topic list` shows, in a sentence."""
    return f"Topics here: {', '.join(source.topics(hidden=False)) or 'none'}."


def silence(source: Source, topic: str, qos: Qos, since_ns: int) -> str:
    """Return the error text for a silent topic: duration, reason, existing topics."""
    seconds = (source.graph.now_ns - since_ns) * 1e-9
    return (
        f"No message came on {topic} in {seconds:g} s of robot time.{source.why_silent(topic, qos)} "
        f"{topics_here(source)}"
    )


def listen(
    source: Source, arguments: Namespace, write: Write, *, verb: str, every: float | None = None
) -> Iterator[TimedSample]:
    """Yield the messages of a topic, and ticks, until ■; their times are those of the clock that was chosen.

    Without a page it ends after a while, and says so; raises a CourseError if nothing has come.
    """
    topic, sim = full_name(arguments.topic_name), arguments.use_sim_time
    start_ns, limit, came = source.graph.now_ns, source.limit(), False
    with until_interrupted():
        kind = type_of(source, topic, write, blocking=True)
        topics = {(topic, kind): SENSOR_DATA, **({CLOCK: SENSOR_DATA} if sim else {})}
        arrivals = source.stream(topics, Listening(limit, every=None if sim else every))
        for now_ns, arrival in _in_sim_time(arrivals, topic, every) if sim else arrivals:
            came = came or arrival is not None
            yield now_ns, arrival
        if not came:
            raise CourseError(silence(source, topic, SENSOR_DATA, start_ns))
        if limit:
            write(f"No page is watching: ros2 topic {verb} stopped after {limit:g} s of robot time.\n")


def _in_sim_time(arrivals: Iterable[TimedSample], topic: str, every: float | None) -> Iterator[TimedSample]:
    """Yield a topic's messages with the time on /clock when they came, [ns], 0 before it, and ticks by it."""
    now_ns = tick_ns = 0
    step_ns = round((every or 0.0) * 1e9)
    for _, sample in arrivals:
        time_ns = None if sample is None else ticked(sample)
        if time_ns is not None:
            now_ns = time_ns
            if step_ns and (now_ns >= tick_ns or now_ns < tick_ns - step_ns):
                tick_ns = (now_ns // step_ns + 1) * step_ns
                yield now_ns, None
        if sample is not None and sample.topic == topic:
            yield now_ns, sample


def passes(expression: str | None) -> Callable[[Any], bool]:
    """Return a predicate from a Python expression in which m is the message.

    The test raises a CourseError if the expression fails.
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
