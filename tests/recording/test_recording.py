from std_msgs.msg import String

from course_lib.recording import Recording, record
from course_lib.ros.graph.graph import START_NS, Graph, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize

STRING = "std_msgs/msg/String"
LATCHED = Qos(durability="transient_local")


def sample(stamp_ns: int, topic: str, text: str, qos: Qos | None = None) -> Sample:
    return Sample(stamp_ns, topic, STRING, serialize(String(data=text)), qos or Qos(), node=1)


def test_recording_has_topics_messages_and_times() -> None:
    recording = Recording([sample(5, "/b", "x"), sample(6, "/a", "y"), sample(8, "/b", "z", LATCHED)])
    assert [(topic.name, topic.type_name, topic.count) for topic in recording.topics()] == [
        ("/a", STRING, 1),
        ("/b", STRING, 2),
    ]
    assert recording.topics()[1].offered == (Qos(), LATCHED)
    assert list(recording.messages("/b")) == [(5, String(data="x")), (8, String(data="z"))]
    assert (recording.start_ns, recording.end_ns) == (5, 8)


def test_empty_recording_has_no_topics() -> None:
    empty = Recording(())
    assert (empty.topics(), empty.start_ns, empty.end_ns) == ([], 0, 0)


def test_digest_depends_only_on_topic_stamp_and_bytes() -> None:
    digest = Recording([sample(5, "/a", "x")]).digest()
    assert len(digest) == 64
    assert Recording([sample(5, "/a", "x", LATCHED)]).digest() == digest
    for other in (sample(6, "/a", "x"), sample(5, "/b", "x"), sample(5, "/a", "y")):
        assert Recording([other]).digest() != digest


def test_recorder_keeps_messages_until_stopped() -> None:
    graph = Graph()
    node = graph.add_node("talker", "/")
    latched = graph.add_publisher(node, "/map", STRING, LATCHED)
    graph.publish(latched, serialize(String(data="before")))
    with record(graph) as recorder:
        graph.publish(latched, serialize(String(data="during")))
    graph.publish(latched, serialize(String(data="after")))
    recorder.stop()
    recording = recorder.recording()
    assert [message.data for _, message in recording.messages("/map")] == ["before", "during"]  # type: ignore[attr-defined]
    assert recording.start_ns == START_NS
