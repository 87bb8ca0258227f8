"""`ros2 topic echo`."""

from argparse import Namespace
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import Message, message_class, type_name
from course_lib.tools.asking import check_type, kind_of
from course_lib.tools.message_text import Style, to_csv, to_yaml
from course_lib.tools.sources import Listening, Source
from course_lib.tools.topic.lookup import full_name, passes, silence, type_of
from course_lib.tools.topic.qos import PRESETS, adapted_qos, asked_qos, qos_options
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, flag, positive, value

PATIENCE = 10.0  # [s] of robot time without a message


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the messages of a topic.

    Raises:
        CourseError: There is no such topic or field, it is of another type, or no message comes in time.
    """
    topic = full_name(arguments.topic_name)
    if arguments.message_type:
        kind = type_name(kind_of(message_class, arguments.message_type, "msg"))
        check_type(topic, kind, source.topics())
    else:
        kind = type_of(source, topic, write, blocking=False)
    matches = passes(arguments.filter_expr)
    qos = asked_qos(arguments) or adapted_qos(source.offered(topic), PRESETS[arguments.qos_profile], write)
    start_ns, came, limit = source.graph.now_ns, False, None if arguments.once else source.limit()
    listening = Listening(patience=PATIENCE, seconds=arguments.timeout or limit)
    with until_interrupted():
        for _, arrival in source.stream({topic: qos}, kind, listening):
            came = True
            assert arrival is not None  # no ticks were asked for
            selected = arrival.cdr if arguments.raw else _field(arrival.message(), arguments.field)
            if not matches(selected):
                continue
            write(_text(selected, arguments))
            if arguments.once:
                return
        if not came:
            raise CourseError(silence(source, topic, qos, start_ns))
        if source.live and not arguments.timeout and not source.graph.ended:
            why = "No page is watching" if limit else "No further message came"
            write(f"{why}: ros2 topic echo stopped after {limit or PATIENCE:g} s of robot time.\n")


def _text(selected: Any, arguments: Namespace) -> str:
    """Write one message, or the field that was asked for."""
    style = Style(
        truncate=None if arguments.full_length else arguments.truncate_length,
        no_arrays=arguments.no_arr,
        no_strings=arguments.no_str,
        flow=arguments.flow_style,
    )
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


_OPTIONS = (
    *NODE_OPTIONS,
    value("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')"),
    value("message_type", nargs="?", help="Type of the ROS message (e.g. 'std_msgs/msg/String')"),
    flag("--once", help="Print the first message received and then exit"),
    value("--field", help="Echo a selected field of a message; '.' selects sub-fields"),
    value("--timeout", type=positive(float), metavar="N", help="Set a timeout in seconds for waiting"),
    flag("--csv", help="Output all recursive fields separated by commas"),
    flag("--flow-style", help="Print collections in one line"),
    flag("-f", "--full-length", help="Output all elements of arrays, bytes and strings"),
    value("-l", "--truncate-length", type=int, default=128, help="The length to truncate them to"),
    flag("--no-arr", help="Don't print array fields of messages"),
    flag("--no-str", help="Don't print string fields of messages"),
    flag("--no-lost-messages", help="Don't report when a message is lost"),
    flag("--raw", help="Echo the raw binary representation"),
    value("--filter", dest="filter_expr", help="Python expression to filter messages; m is the message"),
    *qos_options("subscribe", "sensor_data"),
)
TOPIC_ECHO = Verb("topic", "echo", "Output messages from a topic", _OPTIONS, run, from_start=True)
