"""`ros2 topic list`, `ros2 topic type` and `ros2 topic find`."""

from argparse import Namespace
from typing import Literal

from course_lib.tools.listing import count, find_verb, hidden, show_types, type_verb, write_names
from course_lib.tools.sources import Source
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, flag, value

_SIDES: tuple[tuple[str, Literal["pub", "sub"], str], ...] = (
    ("Published", "pub", "publisher"),
    ("Subscribed", "sub", "subscriber"),
)


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the topics' names."""
    topics = source.topics(hidden=arguments.hidden)
    if arguments.count or not arguments.verbose:
        write_names(topics, arguments, write)
        return
    for title, kind, one in _SIDES:
        write(f"{title} topics:\n")
        for name, types in topics.items():
            if number := len(source.endpoints(name, kind)):
                write(f" * {name} [{', '.join(types)}] {number} {one}{'s' if number > 1 else ''}\n")
        write("\n")


def _topics(source: Source, with_hidden: bool) -> dict[str, list[str]]:
    return source.topics(hidden=with_hidden)


_NAME = value("topic_name", help="Name of the ROS topic to get type (e.g. '/chatter')")
_TYPE = "Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')"
_VERBOSE = flag("-v", "--verbose", help="List full details about each topic")
_OPTIONS = (*NODE_OPTIONS, show_types("topic"), count("topic"), hidden("topic"), _VERBOSE)
TOPIC_LIST = Verb("topic", "list", "Output a list of available topics", _OPTIONS, run)
TOPIC_TYPE = type_verb("topic", "Print a topic's type", _topics, _NAME)
TOPIC_FIND = find_verb("topic", _topics, _TYPE)
