"""`ros2 topic echo`."""

from argparse import Namespace
from dataclasses import replace
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros import pace
from course_lib.ros.driving import SECONDS_WITHOUT_A_PAGE, until_interrupted
from course_lib.ros.messages import Message, message_class
from course_lib.ros.qos import Qos
from course_lib.tools.message_text import Style, to_csv, to_yaml
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, flag, value

PATIENCE = 10.0  # [s] of robot time without a message
SENSOR_DATA = Qos(depth=5, reliability="best_effort")
_QOS_OPTIONS = ("reliability", "durability", "depth")


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the messages of a topic.

    Raises:
        CourseError: There is no such topic or field, or no message comes in time.
    """
    topic = "/" + arguments.topic_name.lstrip("/")
    type_name = arguments.message_type or _type_of(source, topic, write)
    message_class(type_name)  # says which type is not known
    qos = _choose_qos(source.offered(topic), arguments, write)
    endless = source.live and pace.wanted() == "fast" and not arguments.once
    seconds = arguments.timeout or (SECONDS_WITHOUT_A_PAGE if endless else None)
    with until_interrupted():
        shown = 0
        for message in source.messages(topic, type_name, qos, patience=PATIENCE, seconds=seconds):
            write(_text(message, arguments))
            shown += 1
            if arguments.once:
                return
        limit = f"{min(seconds or PATIENCE, PATIENCE):g} s of robot time"
        if not shown:
            here = ", ".join(source.topics())
            raise CourseError(
                f"No message came on {topic} in {limit}.{source.why_silent(topic, qos)} Topics here: {here}."
            )
        if source.live and not arguments.timeout:
            why = "No page is watching" if endless else "No further message came"
            write(f"{why}: ros2 topic echo stopped after {limit}.\n")


def _type_of(source: Source, topic: str, write: Write) -> str:
    types = source.topics().get(topic)
    if not types:
        write(f"WARNING: topic [{topic}] does not appear to be published yet\n")
        raise CourseError(
            "Could not determine the type for the passed topic. "
            f"Topics here: {', '.join(source.topics()) or 'none'}."
        )
    if len(types) > 1:
        found = ", ".join(types)
        raise CourseError(f"Cannot echo topic '{topic}', as it contains more than one type: [{found}]")
    return types[0]


def _choose_qos(offered: list[Qos], arguments: Namespace, write: Write) -> Qos:
    """Request what all publishers offer, as ROS does, or what was asked for."""
    qos = SENSOR_DATA
    asked: dict[str, Any] = {name: getattr(arguments, f"qos_{name}") for name in _QOS_OPTIONS}
    if given := {name: setting for name, setting in asked.items() if setting is not None}:
        return replace(qos, **given)
    if not offered:
        return qos
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
        qos = replace(qos, **common)
    return qos


def _text(message: Message, arguments: Namespace) -> str:
    """Write one message, or the field that was asked for."""
    style = Style(
        truncate=None if arguments.full_length else arguments.truncate_length,
        no_arrays=arguments.no_arr,
        no_strings=arguments.no_str,
        flow=arguments.flow_style,
    )
    selected = _field(message, arguments.field)
    if not isinstance(selected, Message):
        return f"{selected}\n---\n"
    return f"{to_csv(selected, style)}\n" if arguments.csv else f"{to_yaml(selected, style)}---\n"


def _field(message: Message, path: str | None) -> Any:
    selected: Any = message
    for name in filter(None, (path or "").split(".")):
        try:
            selected = getattr(selected, name)
        except AttributeError as error:
            fields = selected.get_fields_and_field_types() if isinstance(selected, Message) else ()
            hint = f". It has {', '.join(fields)}." if fields else ""
            raise CourseError(f"Invalid field '{path}': {error}{hint}") from error
    return selected


TOPIC_ECHO = Verb(
    "topic",
    "echo",
    "Output messages from a topic",
    (
        value("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')"),
        value("message_type", nargs="?", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"),
        flag("--once", help="Print the first message received and then exit"),
        value("--field", help="Echo a selected field of a message; '.' selects sub-fields"),
        value("--timeout", type=float, metavar="N", help="Set a timeout in seconds for waiting"),
        flag("--csv", help="Output all recursive fields separated by commas"),
        flag("--flow-style", help="Print collections in one line"),
        flag("-f", "--full-length", help="Output all elements of arrays, bytes and strings"),
        value("-l", "--truncate-length", type=int, default=128, help="The length to truncate them to"),
        flag("--no-arr", help="Don't print array fields of messages"),
        flag("--no-str", help="Don't print string fields of messages"),
        flag("--no-lost-messages", help="Don't report when a message is lost"),
        value("--qos-reliability", choices=("reliable", "best_effort"), help="Reliability to subscribe with"),
        value(
            "--qos-durability", choices=("transient_local", "volatile"), help="Durability to subscribe with"
        ),
        value("--qos-depth", type=int, metavar="N", help="Queue size to subscribe with"),
    ),
    run,
)
