"""`ros2 topic list`."""

from argparse import Namespace

from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, flag


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the topics' names."""
    topics = {
        name: types
        for name, types in source.topics().items()
        if arguments.include_hidden_topics or not is_hidden(name)
    }
    if arguments.count_topics:
        write(f"{len(topics)}\n")
    elif arguments.verbose:
        for title, side, one in (("Published", 0, "publisher"), ("Subscribed", 1, "subscriber")):
            write(f"{title} topics:\n")
            for name, types in topics.items():
                number = source.count(name)[side]
                if number:
                    write(f" * {name} [{', '.join(types)}] {number} {one}{'s' if number > 1 else ''}\n")
            write("\n")
    else:
        for name, types in topics.items():
            write(f"{name} [{', '.join(types)}]\n" if arguments.show_types else f"{name}\n")


def is_hidden(topic: str) -> bool:
    """Say whether ROS hides a name: a part of it begins with an underscore."""
    return any(part.startswith("_") for part in topic.split("/"))


TOPIC_LIST = Verb(
    "topic",
    "list",
    "Output a list of available topics",
    (
        flag("-t", "--show-types", help="Additionally show the topic type"),
        flag("-c", "--count-topics", help="Only display the number of topics discovered"),
        flag("--include-hidden-topics", help="Consider hidden topics as well"),
        flag("-v", "--verbose", help="List full details about each topic"),
    ),
    run,
)
