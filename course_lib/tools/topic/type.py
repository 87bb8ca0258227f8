"""`ros2 topic type` and `ros2 topic find`: from a topic to its type, and back."""

from argparse import Namespace

from course_lib.tools.sources import Source
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, flag, value


def types_of(source: Source, arguments: Namespace, write: Write) -> None:
    """Print a topic's types; as in ROS nothing if there is no such topic."""
    for name in source.topics().get(arguments.topic_name, ()):
        write(f"{name}\n")


def topics_of(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the topics of a type."""
    topics = source.topics(hidden=arguments.include_hidden_topics)
    found = [name for name, types in topics.items() if arguments.topic_type in types]
    write(f"{len(found)}\n" if arguments.count_topics else "".join(f"{name}\n" for name in found))


TOPIC_TYPE = Verb(
    "topic",
    "type",
    "Print a topic's type",
    (*NODE_OPTIONS, value("topic_name", help="Name of the ROS topic to get type (e.g. '/chatter')")),
    types_of,
)
TOPIC_FIND = Verb(
    "topic",
    "find",
    "Output a list of available topics of a given type",
    (
        *NODE_OPTIONS,
        value("topic_type", help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')"),
        flag("-c", "--count-topics", help="Only display the number of topics discovered"),
        flag("--include-hidden-topics", help="Consider hidden topics as well"),
    ),
    topics_of,
)
