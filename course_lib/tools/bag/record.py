"""`ros2 bag record`; over a bag it writes what is chosen of it into another one."""

import time
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import Recording, record, write_bag
from course_lib.ros.graph import Sample
from course_lib.ros.interrupts import until_interrupted
from course_lib.tools.bag.play import pattern, several
from course_lib.tools.sources import RecordingSource, Source, is_hidden
from course_lib.tools.tf2.echo import log_line
from course_lib.tools.topic.lookup import full_name
from course_lib.tools.verb import Verb, Write, flag, value

POLLING = 0.1  # [s] between two looks for new topics
_CHOICES = "--all, --all-topics, --all-services, --services, --topics, --topic-types or --regex"


def run(source: Source, arguments: Namespace, write: Write) -> None:
    """Record until ■, the end of the run, or a while without a page.

    Raises:
        CourseError: Nothing was chosen, or the folder is there already.
    """
    arguments.topics = [full_name(topic) for topic in (*arguments.topics, *arguments.topics_positional)]
    arguments.exclude_topics = [full_name(topic) for topic in arguments.exclude_topics]
    if not (arguments.all or arguments.topics or arguments.topic_types or arguments.regex):
        raise CourseError(f"[ERROR] [ros2bag]: Need to specify at least one option out of {_CHOICES}")
    seconds = time.gmtime(source.graph.now_ns // 10**9)
    folder = Path(arguments.output or time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S", seconds))
    if folder.is_dir():
        raise CourseError(f"[ERROR] [ros2bag]: Output folder '{folder}' already exists.")
    if isinstance(source, RecordingSource):
        samples = source.recording.samples
    else:
        samples = _listen(source, arguments, write)
    write_bag(Recording(tuple(s for s in samples if _wants(arguments, s.topic, s.type_name))), folder)


def _listen(source: Source, arguments: Namespace, write: Write) -> Sequence[Sample]:
    def say(text: str) -> None:
        write(log_line("rosbag2_recorder", source.graph.now_ns, text))

    limit, start_ns, known = source.limit(), source.graph.now_ns, set[str]()
    source.wait(lambda: True, 0.0)  # says if rclpy is not started
    say("Listening for topics...")
    with record(source.graph) as recorder, until_interrupted():
        while not source.graph.ended and (limit is None or source.graph.now_ns - start_ns < limit * 1e9):
            for topic, types in source.topics().items():
                if topic not in known and _wants(arguments, topic, types[0]):
                    say(f"Subscribed to topic '{topic}'")
                    known.add(topic)
            if source.graph.now_ns == start_ns:
                say("Recording...")
            source.wait(lambda: False, POLLING)
    say("Recording stopped")
    # What was latched before comes as the recorder begins to listen.
    return [replace(s, stamp_ns=max(s.stamp_ns, start_ns)) for s in recorder.recording().samples]


def _wants(arguments: Namespace, topic: str, type_name: str) -> bool:
    """Choose as rosbag2 does (topic_filter.cpp): a regular expression may fit any part of a name."""
    chosen = arguments.all or topic in arguments.topics or type_name in arguments.topic_types
    left_out = topic in arguments.exclude_topics or type_name in arguments.exclude_topic_types
    if not chosen and arguments.regex:
        chosen = bool(arguments.regex.search(topic))
    if arguments.exclude_regex and arguments.exclude_regex.search(topic):
        left_out = True
    return chosen and not left_out and (arguments.include_hidden_topics or not is_hidden(topic))


_OPTIONS = (
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
)
BAG_RECORD = Verb("bag", "record", "Record ROS data to a bag", _OPTIONS, run, from_start=True)
