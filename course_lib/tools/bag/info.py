"""`ros2 bag info`."""

from argparse import Namespace

from course_lib.recording import bag_info, read_bag
from course_lib.tools.bag.play import READER
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, flag


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Print what a bag holds, or its topics' names; raises a CourseError if it is no bag."""
    if arguments.topic_name and arguments.verbose:
        write(
            "Warning! You have set both the '-t' and '-v' parameters. The '-t' parameter will be ignored.\n"
        )
    if arguments.topic_name and not arguments.verbose:
        write("".join(f"{topic.name}\n" for topic in read_bag(arguments.bag_path).topics()))
    else:
        write(bag_info(arguments.bag_path, digest=False))


_OPTIONS = (
    *READER,
    flag("-t", "--topic-name", help="Only display topic names"),
    flag("-v", "--verbose", help="Display request/response information for services"),
)
BAG_INFO = Verb(
    "bag", "info", "Print information about a bag to the screen", _OPTIONS, run, from_start=True, looks=False
)
