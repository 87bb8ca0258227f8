"""`ros2 bag record` and `ros2 bag info`, and the options that they share with `ros2 bag play`."""

import time
from argparse import ArgumentTypeError, Namespace
from functools import partial
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import Recording, bag_info, read_bag, recorded, write_bag
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.sim_time import CLOCK
from course_lib.tools.sources import RecordingSource, Source, is_hidden
from course_lib.tools.tf2 import log_line
from course_lib.tools.topic.lookup import full_name
from course_lib.tools.verb import Option, Verb, Write, flag, pattern, value


def existing(text: str) -> Path:
    """Read a bag's path, with ros2bag's complaint."""
    if not Path(text).exists():
        raise ArgumentTypeError(f"Bag path '{text}' does not exist!")
    return Path(text)


def several(*flags: str, help: str, metavar: str = "Topic", exclusive: str = "") -> Option:  # noqa: A002  # argparse's own word
    """Return an option that takes a list."""
    return value(*flags, help=help, exclusive=exclusive, metavar=metavar, nargs="+", default=[])


READER = (
    value("bag_path", type=existing, help="Bag to open"),
    value("-s", "--storage", choices=("mcap", "sqlite3"), help="Storage of the bag; it is found out anyway"),
)

POLLING = 0.1  # [s] between two looks for new topics
_SELECTIONS = "--all, --all-topics, --all-services, --services, --topics, --topic-types or --regex"


def _record_bag(source: Source, arguments: Namespace, write: Write) -> None:
    """Record until ■, the end of the run, or for a while without a page; over a bag, copy the selection."""
    arguments.topics = [full_name(topic) for topic in (*arguments.topics, *arguments.topics_positional)]
    arguments.exclude_topics = [full_name(topic) for topic in arguments.exclude_topics]
    if not (arguments.all or arguments.topics or arguments.topic_types or arguments.regex):
        raise CourseError(f"[ERROR] [ros2bag]: Need to specify at least one option out of {_SELECTIONS}")
    seconds = time.gmtime(source.graph.now_ns // 10**9)
    folder = Path(arguments.output or time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S", seconds))
    if folder.is_dir():
        raise CourseError(f"[ERROR] [ros2bag]: Output folder '{folder}' already exists.")
    if isinstance(source, RecordingSource):
        samples = (s for s in source.recording.samples if _is_recorded(arguments, s.topic, s.type_name))
        write_bag(Recording(tuple(samples)), folder)
    else:
        _record_live(source, arguments, write, folder)


def _record_live(source: Source, arguments: Namespace, write: Write, folder: Path) -> None:
    def say(text: str) -> None:
        write(log_line("rosbag2_recorder", source.graph.now_ns, text))

    limit, start_ns, known = source.limit(), source.graph.now_ns, set[str]()
    source.wait(lambda: True, 0.0)  # says if rclpy is not started
    say("Listening for topics...")
    chosen = partial(_is_recorded, arguments)
    time_topic = {CLOCK[0]} if arguments.use_sim_time else set[str]()
    with recorded(source.graph, folder, chosen, lambda: known | time_topic, in_sim_time=bool(time_topic)):
        with until_interrupted():
            while not source.graph.ended and (limit is None or source.graph.now_ns - start_ns < limit * 1e9):
                for topic, types in source.topics().items():
                    if topic not in known and _is_recorded(arguments, topic, types[0]):
                        say(f"Subscribed to topic '{topic}'")
                        known.add(topic)
                if source.graph.now_ns == start_ns:
                    say("Recording...")
                    if arguments.use_sim_time:
                        say("use_sim_time set, waiting for /clock before starting recording...")
                source.wait(lambda: False, POLLING)
        say("Recording stopped")


def _is_recorded(arguments: Namespace, topic: str, type_name: str) -> bool:
    """Select as rosbag2 does (topic_filter.cpp): a regular expression may match any part of a name."""
    chosen = arguments.all or topic in arguments.topics or type_name in arguments.topic_types
    left_out = topic in arguments.exclude_topics or type_name in arguments.exclude_topic_types
    if not chosen and arguments.regex:
        chosen = bool(arguments.regex.search(topic))
    if arguments.exclude_regex and arguments.exclude_regex.search(topic):
        left_out = True
    return chosen and not left_out and (arguments.include_hidden_topics or not is_hidden(topic))


_RECORD = (
    value("topics_positional", nargs="*", metavar="Topic", help="Topics to record (deprecated)"),
    value("-o", "--output", help="Folder of the bag; default: named by the time"),
    value("-s", "--storage", choices=("mcap",), default="mcap", help="Storage of the bag"),
    several("--topics", help="Topics to record"),
    several("--topic-types", help="Types of topics to record", metavar="TopicType"),
    flag("-a", "--all", "--all-topics", help="Record all topics, except hidden ones"),
    value("-e", "--regex", type=pattern, help="Record topics whose names contain this expression"),
    value("--exclude-regex", type=pattern, help="Leave out topics whose names contain this expression"),
    several("--exclude-topics", help="Topics to leave out"),
    several("--exclude-topic-types", help="Types of topics to leave out", metavar="TopicType"),
    flag("--include-hidden-topics", help="Record hidden topics as well"),
    flag("--use-sim-time", help="Stamp messages by /clock; none is recorded before its first message"),
)
BAG_RECORD = Verb("bag", "record", "Record ROS data to a bag", _RECORD, _record_bag, from_start=True)


def _info(source: Source, arguments: Namespace, write: Write) -> None:
    if arguments.topic_name and arguments.verbose:
        write(
            "Warning! You have set both the '-t' and '-v' parameters. The '-t' parameter will be ignored.\n"
        )
    if arguments.topic_name and not arguments.verbose:
        write("".join(f"{topic.name}\n" for topic in read_bag(arguments.bag_path).topics()))
    else:
        write(bag_info(arguments.bag_path, digest=False))


_INFO = (
    *READER,
    flag("-t", "--topic-name", help="Only display topic names"),
    flag("-v", "--verbose", help="Display request/response information for services"),
)
BAG_INFO = Verb(
    "bag", "info", "Print information about a bag to the screen", _INFO, _info, from_start=True, looks=False
)
