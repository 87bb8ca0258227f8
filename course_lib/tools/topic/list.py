"""`ros2 topic list`."""

from argparse import Namespace
from typing import Literal

from course_lib.tools.sources import Source
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, flag

_SIDES: tuple[tuple[str, Literal["pub", "sub"], str], ...] = (
    ("Published", "pub", "publisher"),
    ("Subscribed", "sub", "subscriber"),
)


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the topics' names."""
    topics = source.topics(hidden=arguments.include_hidden_topics)
    if arguments.count_topics:
        write(f"{len(topics)}\n")
    elif arguments.verbose:
        for title, kind, one in _SIDES:
            write(f"{title} topics:\n")
            for name, types in topics.items():
                if number := len(source.endpoints(name, kind)):
                    write(f" * {name} [{', '.join(types)}] {number} {one}{'s' if number > 1 else ''}\n")
            write("\n")
    else:
        for name, types in topics.items():
            write(f"{name} [{', '.join(types)}]\n" if arguments.show_types else f"{name}\n")


TOPIC_LIST = Verb(
    "topic",
    "list",
    "Output a list of available topics",
    (
        *NODE_OPTIONS,
        flag("-t", "--show-types", help="Additionally show the topic type"),
        flag("-c", "--count-topics", help="Only display the number of topics discovered"),
        flag("--include-hidden-topics", help="Consider hidden topics as well"),
        flag("-v", "--verbose", help="List full details about each topic"),
    ),
    run,
)
