import pytest
import rclpy
from hypothesis import given
from hypothesis import strategies as st
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import Recording, record
from course_lib.ros.graph.graph import DELAY_NS, Graph, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.tools.sources import GraphSource, RecordingSource, StreamLimits, TimedSample, is_hidden

STRING = "std_msgs/msg/String"
TOPICS = {("/chatter", STRING): Qos(), ("/other", STRING): Qos()}


@given(st.lists(st.tuples(st.integers(0, 3 * 10**9), st.sampled_from(sorted(TOPICS)))), st.integers(1, 20))
def test_messages_and_ticks_of_a_recording_are_in_order(
    sent: list[tuple[int, tuple[str, str]]], tenths: int
) -> None:
    cdr = serialize(String())
    samples = tuple(Sample(stamp, *topic, cdr, Qos(), 1) for stamp, topic in sorted(sent))
    source = RecordingSource(Recording(samples))
    heard: list[TimedSample] = list(source.stream(TOPICS, StreamLimits(every=tenths / 10)))
    times = [now_ns for now_ns, _ in heard]
    assert times == sorted(times)
    assert [(now_ns, (one.topic, one.type_name)) for now_ns, one in heard if one] == sorted(sent)
    ticks = [now_ns for now_ns, one in heard if one is None]
    start_ns, end_ns = source.recording.start_ns, source.recording.end_ns
    assert ticks == list(range(start_ns, end_ns + 1, tenths * 10**8))


def test_live_and_recorded_streams_differ_only_by_the_transport_delay(talker: Node, graph: Graph) -> None:
    with record(graph) as recorder:
        live = list(GraphSource(graph).stream(TOPICS, StreamLimits(seconds=1.0)))
    recorded = list(RecordingSource(recorder.recording()).stream(TOPICS, StreamLimits()))
    assert len(live) == 9  # the tenth message is on its way
    assert [one.cdr for _, one in live if one] == [one.cdr for _, one in recorded if one][:9]
    assert {now_ns - one.stamp_ns for now_ns, one in live if one} == {DELAY_NS}


def test_timeout_ends_a_silent_stream(talker: Node, graph: Graph) -> None:
    start_ns = graph.now_ns
    stream = GraphSource(graph).stream(TOPICS, StreamLimits(idle_seconds=0.5))
    for number, _ in enumerate(stream):
        if number == 2:
            talker.destroy_node()
    assert number == 2
    assert graph.now_ns == start_ns + 300_000_000 + DELAY_NS + 500_000_000


def test_ticks_contain_their_time(talker: Node, graph: Graph) -> None:
    start_ns = graph.now_ns
    heard = GraphSource(graph).stream({("/chatter", STRING): Qos()}, StreamLimits(seconds=2.0, every=0.5))
    ticks = [(now_ns - start_ns) / 1e9 for now_ns, one in heard if one is None]
    assert ticks == [0.0, 0.5, 1.0, 1.5, 2.0]


def test_waiting_before_rclpy_init_is_an_error(graph: Graph) -> None:
    assert not rclpy.ok()
    with pytest.raises(CourseError, match="rclpy is not initialized"):
        GraphSource(graph).wait(lambda: True, 1.0)


def test_names_with_a_leading_underscore_are_hidden() -> None:
    assert [is_hidden(name) for name in ("/a/_b/c", "/_a", "/a_b", "_ros2cli")] == [True, True, False, True]
