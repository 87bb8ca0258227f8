"""`ros2 bag play`."""

from argparse import ArgumentTypeError, Namespace
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import replace

from course_lib.errors import CourseError
from course_lib.recording import Recording, read_bag
from course_lib.ros import pace
from course_lib.ros.graph import Graph, Sample
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.sim_time import CLOCK, tick
from course_lib.tools.bag import READER, several
from course_lib.tools.sources import PLAYER, Source
from course_lib.tools.tf2 import log_line
from course_lib.tools.verb import Verb, Write, flag, pattern, positive, seconds, value

GRACE = 0.1  # [s] at the end, for the last message to arrive


def _play_bag(source: Source, arguments: Namespace, write: Write) -> None:
    if not source.live:
        raise CourseError(
            f"Nobody listens: course bag play --run program.py {arguments.bag_path}, "
            f"or look at it: course view --bag {arguments.bag_path}"
        )
    recording = read_bag(arguments.bag_path)
    start_ns = recording.start_ns + round(arguments.start_offset * 1e9)
    seconds = arguments.playback_duration
    until_ns = None if seconds < 0 else start_ns + round(seconds * 1e9)
    samples = list(_chosen(recording, start_ns, until_ns, arguments))
    if not samples:
        raise CourseError(
            f"Nothing of {arguments.bag_path} is left to play: see `ros2 bag info` for its topics."
        )
    source.wait(lambda: True, 0.0)  # says if rclpy is not started
    if arguments.start_paused:
        _pause(source.graph)
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
            _play(source, arguments, write, _Player(graph, node, events, arguments.rate))
    finally:
        graph.remove_node(node)


def _pause(graph: Graph) -> None:
    """Pause robot time, for `--start-paused`; raises a CourseError where nobody could let it go on."""
    if not graph.notebook or pace.wanted() == "fast":
        raise CourseError("--start-paused: nobody can start it here; in JupyterLab the Time panel's ▶ does.")
    pace.speed_of(graph).paused = True


class _Player:
    """Publishes events (delay [ns], publisher, CDR bytes) when they are due on the graph's clock."""

    def __init__(self, graph: Graph, node: int, events: list[tuple[int, int, bytes]], rate: float) -> None:
        self._graph, self._node, self._events, self._rate = graph, node, events, rate

    def play(self, source: Source) -> None:
        """Publish all events, until the end of the run or an interrupt."""
        self._start_ns, self._left = self._graph.now_ns, deque(self._events)
        self._schedule()
        try:
            source.wait(lambda: not self._left, None)
            if not self._graph.ended:
                source.wait(lambda: False, GRACE)
        finally:
            self._left.clear()

    def _schedule(self) -> None:
        if self._left:
            due_ns = self._start_ns + round(self._left[0][0] / self._rate)
            self._graph.call_at(due_ns, self._publish, node=self._node, entity=0)

    def _publish(self) -> None:
        if self._left:
            _, publisher, cdr = self._left.popleft()
            self._graph.publish(publisher, cdr)
            self._schedule()


def _play(source: Source, arguments: Namespace, write: Write, player: _Player) -> None:
    """Play once, or in a loop until ■; without a page the loop ends after a while."""
    graph, limit = source.graph, source.limit()
    zero_ns = graph.now_ns
    while True:
        source.wait(lambda: False, arguments.delay)
        player.play(source)
        if not arguments.loop or graph.ended:
            return
        if limit is not None and graph.now_ns - zero_ns >= limit * 1e9:
            write(f"No page is watching: ros2 bag play stopped after {limit:g} s of robot time.\n")
            return


def _chosen(
    recording: Recording, start_ns: int, until_ns: int | None, arguments: Namespace
) -> Iterator[Sample]:
    """Yield the selected samples and the ticks of /clock, under their new names."""
    names = dict(arguments.remap)
    selected = (
        sample
        for sample in recording.samples
        if start_ns <= sample.stamp_ns
        and (until_ns is None or sample.stamp_ns <= until_ns)
        and _is_played(arguments, sample.topic)
    )
    for sample in _with_clock(selected, start_ns, arguments):
        yield replace(sample, topic=names.get(sample.topic, sample.topic), node=0)


def _with_clock(samples: Iterable[Sample], start_ns: int, arguments: Namespace) -> Iterator[Sample]:
    """Yield samples with ticks of /clock: so often on the wall clock, or before those that cause one."""
    tick_ns = start_ns
    for sample in samples:
        while arguments.clock and tick_ns <= sample.stamp_ns:
            yield tick(tick_ns)
            tick_ns += round(1e9 / arguments.clock * arguments.rate)
        if arguments.clock_topics_all or sample.topic in arguments.clock_topics:
            yield tick(sample.stamp_ns)
        yield sample


def _is_played(arguments: Namespace, topic: str) -> bool:
    """Select as rosbag2's storages do: a regular expression must match the whole name."""
    chosen = topic in arguments.topics or not (arguments.topics or arguments.regex)
    if not chosen and arguments.regex:
        chosen = bool(arguments.regex.fullmatch(topic))
    if arguments.exclude_regex and arguments.exclude_regex.fullmatch(topic):
        return False
    return chosen and topic not in arguments.exclude_topics and not (arguments.clock and topic == CLOCK[0])


def _rule(text: str) -> tuple[str, str]:
    old, assign, new = text.partition(":=")
    if not (assign and old.startswith("/") and new.startswith("/")):
        raise ArgumentTypeError(f"{text!r}: write /old_topic:=/new_topic")
    return old, new


_PLAY = (
    *READER,
    value("-r", "--rate", type=positive(float), default=1.0, help="rate at which to play back messages"),
    several("--topics", help="Topics to play"),
    value("-e", "--regex", type=pattern, help="Play only topics that match this expression"),
    value("-x", "--exclude-regex", type=pattern, help="Leave out topics that match this expression"),
    several("--exclude-topics", help="Topics not to play"),
    flag("-l", "--loop", help="Start again at the end, until stopped"),
    value("-m", "--remap", nargs="+", type=_rule, default=[], help="Other names: /old:=/new"),
    value(
        "--clock",
        nargs="?",
        type=positive(float),
        const=40,
        help="Publish /clock so often, in Hz",
        exclusive="clock",
    ),
    several("--clock-topics", help="Publish /clock before messages of these topics", exclusive="clock"),
    flag("--clock-topics-all", help="Publish /clock before each message", exclusive="clock"),
    value(
        "-d",
        "--delay",
        type=positive(float),
        default=0.0,
        help="Sleep before play (each loop), in seconds",
    ),
    value("--start-offset", type=seconds, default=0.0, help="Start so many seconds into the bag"),
    value("--playback-duration", type=seconds, default=-1.0, help="Stop after so many seconds of the bag"),
    flag("-p", "--start-paused", help="Wait until the viewer's Time panel lets time go on"),
)
BAG_PLAY = Verb("bag", "play", "Play back ROS data from a bag", _PLAY, _play_bag)
