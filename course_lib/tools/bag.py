"""`ros2 bag record`, `ros2 bag info` and `ros2 bag play`."""

import time
from argparse import ArgumentTypeError, Namespace
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import (
    Recording,
    bag_info,
    is_service_event,
    read_bag,
    record_to_bag,
    write_bag,
)
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.graph.topics import CLOCK, read_tick, tick
from course_lib.ros.messages.definitions import is_known
from course_lib.ros.time import pace
from course_lib.ros.time.interrupts import until_interrupted
from course_lib.tools.sources import PLAYER, RecordingSource, Source, is_hidden
from course_lib.tools.tf2 import log_line
from course_lib.tools.topic import full_name
from course_lib.tools.verb import Option, Verb, Write, flag, pattern, positive, seconds, value


def existing_path(text: str) -> Path:
    """Parse the path of a bag. Raise ros2bag's error if it does not exist."""
    if not Path(text).exists():
        raise ArgumentTypeError(f"Bag path '{text}' does not exist!")
    return Path(text)


def many_values(*flags: str, help: str, metavar: str = "Topic", exclusive: str = "") -> Option:  # noqa: A002  # argparse's own word
    """Return an option that accepts a list."""
    return value(*flags, help=help, exclusive=exclusive, metavar=metavar, nargs="+", default=[])


READER = (
    value("bag_path", type=existing_path, help="Bag to open"),
    value(
        "-s",
        "--storage",
        choices=("mcap", "sqlite3"),
        help="Storage of the bag, which is detected in any case",
    ),
)

# Polling period [s] for new topics.
POLLING = 0.1
_UNKNOWN_TYPE = (
    "Topic '{}' has unknown type '{}' associated. Only topics with known type are supported. If "
    "the package is yours, copy its interface files from the robot."
)
_SELECTIONS = "--all, --all-topics, --all-services, --services, --topics, --topic-types or --regex"


def _record_bag(source: Source, arguments: Namespace, write: Write) -> None:
    """Record until ■ or the end of the run; for a fixed time if there is no page.

    From a bag, copy the selection.
    """
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
    def say(text: str, severity: str = "INFO") -> None:
        write(log_line("rosbag2_recorder", source.graph.now_ns, text, severity))

    graph, limit, start_ns, known_topics = source.graph, source.limit(), source.graph.now_ns, set[str]()
    # A robot may have types that the kit cannot subscribe to.
    unknown_types = set[str]()
    # Raises a CourseError if rclpy is not initialized.
    source.wait(lambda: True, 0.0)
    say("Listening for topics...")

    def subscribe() -> None:
        for topic, types in source.topics().items():
            if topic in known_topics or not _is_recorded(arguments, topic, types[0]):
                continue
            if is_known(types[0]):
                say(f"Subscribed to topic '{topic}'")
                known_topics.add(topic)
            elif types[0] not in unknown_types:
                say(_UNKNOWN_TYPE.format(topic, types[0]), "WARN")
                unknown_types.add(types[0])

    # As in rosbag2, no topic but /clock is received before the clock has started.
    clock_topic = {CLOCK[0]} if arguments.use_sim_time else set[str]()
    waiting = bool(clock_topic)

    def on_sample(sample: Sample) -> None:
        nonlocal waiting
        waiting = waiting and not read_tick(sample)

    is_discovering = True
    selection = partial(_is_recorded, arguments), lambda: known_topics | clock_topic
    with record_to_bag(graph, folder, *selection, in_sim_time=waiting), ExitStack() as ends:
        ends.callback(graph.tap(on_sample, lambda: clock_topic))
        with until_interrupted():
            if not waiting:
                subscribe()
            say("Recording...")
            if waiting:
                say("use_sim_time set, waiting for /clock before starting recording...")
                source.wait(lambda: not waiting, limit)
                if not waiting:
                    say("Sim time /clock found, starting recording.")
            while not graph.ended and (limit is None or graph.now_ns - start_ns < limit * 1e9):
                if is_discovering:
                    subscribe()
                    if arguments.topics and len(known_topics) == len(arguments.topics):
                        say("All requested topics are subscribed. Stopping discovery...")
                        is_discovering = False
                source.wait(lambda: False, POLLING)
        say("Recording stopped")


def _is_recorded(arguments: Namespace, topic: str, type_name: str) -> bool:
    """Return whether a topic is recorded. A regular expression may match part of its name, as in rosbag2."""
    is_selected = arguments.all or topic in arguments.topics or type_name in arguments.topic_types
    left_out = topic in arguments.exclude_topics or type_name in arguments.exclude_topic_types
    if not is_selected and arguments.regex:
        is_selected = bool(arguments.regex.search(topic))
    if arguments.exclude_regex and arguments.exclude_regex.search(topic):
        left_out = True
    return is_selected and not left_out and (arguments.include_hidden_topics or not is_hidden(topic))


_RECORD = (
    value("topics_positional", nargs="*", metavar="Topic", help="Topics to record (deprecated)"),
    value("-o", "--output", help="Folder of the bag; default: named by the time"),
    value("-s", "--storage", choices=("mcap",), default="mcap", help="Storage of the bag"),
    many_values("--topics", help="Topics to record"),
    many_values("--topic-types", help="Types of topics to record", metavar="TopicType"),
    flag("-a", "--all", "--all-topics", help="Record all topics, except hidden ones"),
    value("-e", "--regex", type=pattern, help="Record topics whose names contain this expression"),
    value("--exclude-regex", type=pattern, help="Leave out topics whose names contain this expression"),
    many_values("--exclude-topics", help="Topics to leave out"),
    many_values("--exclude-topic-types", help="Types of topics to leave out", metavar="TopicType"),
    flag("--include-hidden-topics", help="Record hidden topics as well"),
    flag("--use-sim-time", help="Stamp messages by /clock; none is recorded before its first message"),
)
BAG_RECORD = Verb("bag", "record", "Record ROS data to a bag", _RECORD, _record_bag, is_immediate=True)


def _info(source: Source, arguments: Namespace, write: Write) -> None:
    if arguments.topic_name and arguments.verbose:
        write(
            "Warning! You have set both the '-t' and '-v' parameters. The '-t' parameter will be ignored.\n"
        )
    if arguments.topic_name and not arguments.verbose:
        topics = read_bag(arguments.bag_path).topics()
        names = [topic.name for topic in topics if not is_service_event(topic.name, topic.type_name)]
        write("".join(f"{name}\n" for name in names))
    else:
        write(bag_info(arguments.bag_path, digest=False, verbose=arguments.verbose))


_INFO = (
    *READER,
    flag("-t", "--topic-name", help="Only display topic names"),
    flag("-v", "--verbose", help="Display request/response information for services"),
)
BAG_INFO = Verb(
    "bag",
    "info",
    "Print information about a bag to the screen",
    _INFO,
    _info,
    is_immediate=True,
    needs_nodes=False,
)


# Time at the end in which the last message is delivered [s].
GRACE = 0.1


def _play_bag(source: Source, arguments: Namespace, write: Write) -> None:
    if not source.is_live:
        raise CourseError(
            f"There is no subscription: course bag play --run program.py {arguments.bag_path}, "
            f"or view it: course view --bag {arguments.bag_path}"
        )
    recording = read_bag(arguments.bag_path)
    start_ns = recording.start_ns + round(arguments.start_offset * 1e9)
    seconds = arguments.playback_duration
    until_ns = None if seconds < 0 else start_ns + round(seconds * 1e9)
    samples = list(_selected_samples(recording, start_ns, until_ns, arguments))
    if not recording.samples:
        raise CourseError(f"{arguments.bag_path} has no messages. `ros2 bag info` shows what was recorded.")
    if not samples:
        raise CourseError(
            f"The options select no message of {arguments.bag_path}. `ros2 bag info` lists its topics."
        )
    # Raises a CourseError if rclpy is not initialized.
    source.wait(lambda: True, 0.0)
    if arguments.start_paused:
        if not source.graph.notebook or pace.mode() == "fast":
            raise CourseError("--start-paused needs JupyterLab, where ▶ in the Time panel starts it.")
        pace.speed_of(source.graph).is_paused = True
    for text in (f"Set rate to {arguments.rate:g}", "Playback until timestamp: -1"):
        write(log_line(PLAYER, source.graph.now_ns, text))
    graph = source.graph
    node = graph.add_node(PLAYER, "/")
    try:
        publishers = {
            key: graph.add_publisher(node, *key)
            for key in dict.fromkeys((s.topic, s.type_name, s.qos) for s in samples)
        }
        with until_interrupted():
            events = [
                (s.stamp_ns - start_ns, publishers[s.topic, s.type_name, s.qos], s.cdr) for s in samples
            ]
            _Player(graph, node, events, arguments.rate).play(source, arguments, write)
    finally:
        graph.remove_node(node)


class _Player:
    """Publishes events (delay [ns], publisher, CDR bytes) at their times on the graph's clock."""

    def __init__(
        self,
        graph: Graph,
        node: int,
        events: list[tuple[int, int, bytes]],
        rate: float,
    ) -> None:
        self._graph, self._node, self._events, self._rate = graph, node, events, rate

    def play(self, source: Source, arguments: Namespace, write: Write) -> None:
        """Play once, or in a loop until ■. Without a page, the loop ends after a fixed time."""
        graph, limit = self._graph, source.limit()
        zero_ns = graph.now_ns
        while True:
            if arguments.delay:
                delay_ns = round(arguments.delay * 1e9)
                write(log_line(PLAYER, graph.now_ns, f"Sleep {delay_ns} ns"))
                source.wait(lambda: False, arguments.delay)
            self._start_ns, self._remaining = graph.now_ns, deque(self._events)
            self._schedule()
            try:
                source.wait(lambda: not self._remaining, None)
                if not graph.ended:
                    source.wait(lambda: False, GRACE)
            finally:
                self._remaining.clear()
            if not arguments.loop or graph.ended:
                return
            if limit is not None and graph.now_ns - zero_ns >= limit * 1e9:
                write(f"No page is watching: ros2 bag play stopped after {limit:g} s of robot time.\n")
                return

    def _schedule(self) -> None:
        if self._remaining:
            due_ns = self._start_ns + round(self._remaining[0][0] / self._rate)
            self._graph.call_at(due_ns, self._publish, node=self._node, entity=0)

    def _publish(self) -> None:
        if self._remaining:
            _, publisher, cdr = self._remaining.popleft()
            self._graph.publish(publisher, cdr)
            self._schedule()


def _selected_samples(
    recording: Recording, start_ns: int, until_ns: int | None, arguments: Namespace
) -> Iterator[Sample]:
    """Yield the selected samples and samples of /clock, with remapped topics."""
    names = dict(arguments.remap)
    played_topics = set[str]()
    # As in rosbag2, a regular expression must match the whole name of a topic.
    for topic in {sample.topic for sample in recording.samples} - set(arguments.exclude_topics):
        is_selected = topic in arguments.topics or not (arguments.topics or arguments.regex)
        if not is_selected and arguments.regex:
            is_selected = bool(arguments.regex.fullmatch(topic))
        if arguments.exclude_regex and arguments.exclude_regex.fullmatch(topic):
            is_selected = False
        if is_selected and not (arguments.clock and topic == CLOCK[0]):
            played_topics.add(topic)
    selected = (
        sample
        for sample in recording.samples
        if start_ns <= sample.stamp_ns
        and (until_ns is None or sample.stamp_ns <= until_ns)
        and sample.topic in played_topics
    )
    # Samples of /clock are periodic on the wall clock, or precede samples on certain topics.
    tick_ns = start_ns
    for sample in selected:
        stamps: list[int] = []
        while arguments.clock and tick_ns <= sample.stamp_ns:
            stamps.append(tick_ns)
            tick_ns += round(1e9 / arguments.clock * arguments.rate)
        if arguments.clock_topics_all or sample.topic in arguments.clock_topics:
            stamps.append(sample.stamp_ns)
        for played_sample in (*map(tick, stamps), sample):
            yield replace(played_sample, topic=names.get(played_sample.topic, played_sample.topic), node=0)


def _rule(text: str) -> tuple[str, str]:
    old_name, assign, new = text.partition(":=")
    if not (assign and old_name.startswith("/") and new.startswith("/")):
        raise ArgumentTypeError(f"{text!r}: write /old_topic:=/new_topic")
    return old_name, new


_PLAY = (
    *READER,
    value("-r", "--rate", type=positive(float), default=1.0, help="rate at which to play back messages"),
    many_values("--topics", help="Topics to play"),
    value("-e", "--regex", type=pattern, help="Play only topics that match this expression"),
    value("-x", "--exclude-regex", type=pattern, help="Leave out topics that match this expression"),
    many_values("--exclude-topics", help="Topics not to play"),
    flag("-l", "--loop", help="Start again at the end, until stopped"),
    value("-m", "--remap", nargs="+", type=_rule, default=[], help="Other names: /old:=/new"),
    value(
        "--clock",
        nargs="?",
        type=positive(float),
        const=40,
        help="Publish /clock at this rate, in Hz",
        exclusive="clock",
    ),
    many_values("--clock-topics", help="Publish /clock before messages of these topics", exclusive="clock"),
    flag("--clock-topics-all", help="Publish /clock before each message", exclusive="clock"),
    value(
        "-d",
        "--delay",
        type=positive(float),
        default=0.0,
        help="Sleep before play (each loop), in seconds",
    ),
    value("--start-offset", type=seconds, default=0.0, help="Time in the bag at which to start, in seconds"),
    value(
        "--playback-duration",
        type=seconds,
        default=-1.0,
        help="Duration of the part to play, in seconds of the bag",
    ),
    flag("-p", "--start-paused", help="Start paused, until the viewer's Time panel resumes time"),
)
BAG_PLAY = Verb("bag", "play", "Play back ROS data from a bag", _PLAY, _play_bag)
