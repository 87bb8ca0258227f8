import os
import socket
from collections.abc import Callable
from contextlib import suppress
from dataclasses import astuple, replace
from functools import partial
from pathlib import Path

import pytest

from course_lib.ros.graph.graph import START_NS, Graph, Sample, use_graph
from course_lib.ros.graph.remote import (
    Channel,
    ChannelClosedError,
    ChannelError,
    GraphServer,
    MemoryLimitError,
    RecordingBudget,
    RemoteGraph,
)
from course_lib.ros.graph.topics import EndpointInfo, Qos, Topics
from course_lib.ros.programs.program import run_files
from course_lib.ros.time import virtual_time

SECOND = 10**9  # [ns]
END_NS = START_NS + 5 * SECOND


def talk(graph: Graph) -> None:
    """A node that counts at 1 Hz, and a second one that replies to its messages."""
    talker, echoer = graph.add_node("talker", "/"), graph.add_node("echoer", "/")
    count = graph.add_publisher(talker, "/count", "std_msgs/msg/String", Qos())
    echo = graph.add_publisher(echoer, "/echo", "std_msgs/msg/String", Qos())
    graph.add_subscription(
        echoer, 0, "/count", "std_msgs/msg/String", Qos(), lambda cdr, sent, got: graph.publish(echo, cdr)
    )

    def tick() -> None:
        graph.publish(count, str(graph.now_ns).encode())
        graph.call_at(graph.now_ns + SECOND, tick, node=talker, entity=0)

    graph.call_at(START_NS + SECOND, tick, node=talker, entity=0)
    graph.call_at(START_NS + SECOND, lambda: None, node=talker, entity=1).cancel()
    while graph.advance():
        pass


def in_a_child(program: Callable[[Channel], None]) -> Channel:
    own_end, other_end = socket.socketpair()
    if os.fork() == 0:
        own_end.close()
        program(Channel(other_end))
        os._exit(0)
    other_end.close()
    return Channel(own_end)


def recorded(run: Callable[[Graph], None]) -> list[Sample]:
    graph, samples = Graph(end_ns=END_NS), list[Sample]()
    graph.tap(samples.append)
    run(graph)
    return samples


def behind(channel: Channel, graph: Graph) -> RemoteGraph:
    return RemoteGraph(channel, start_ns=START_NS, end_ns=END_NS, last_id=graph.last_id)


def serve(graph: Graph, child: Callable[[Channel], None]) -> None:
    server = GraphServer(graph, in_a_child(child))
    server.serve()
    while graph.advance():
        pass
    server.end()
    assert server.last_frame == ["done"]


def run_in_remote_graph(graph: Graph) -> None:
    def child(channel: Channel) -> None:
        remote = behind(channel, graph)
        talk(remote)
        assert [node.name for node in remote.nodes()] == ["talker", "echoer"]
        assert [endpoint.topic for endpoint in remote.endpoints()] == ["/count", "/echo", "/count"]
        assert [end.kind for end in remote.endpoints_on("/count")] == ["pub", "sub"]
        channel.send(["done"])

    serve(graph, child)


def test_program_in_another_process_gives_the_same_recording_as_a_local_program() -> None:
    here = recorded(talk)
    assert [s.topic for s in here] == ["/count", "/echo"] * 4 + ["/count"]
    assert recorded(run_in_remote_graph) == here


@pytest.mark.parametrize(
    "frame",
    [
        ["publish", 12345, b""],
        ["publish", "1", b""],
        ["publish", 1],
        ["unnode", 1],
        ["node", 7, "n", "/"],
        ["pub", 2, 99, "/t", "x", []],
        ["sub", 2, 99, 0, "/t", "x", []],
        ["cancel", 7],
        ["endpoints_on", 7],
    ],
)
def test_frame_about_an_entity_of_another_process_is_rejected(frame: list[object]) -> None:
    server = GraphServer(Graph(end_ns=END_NS), in_a_child(lambda channel: channel.send(frame)))
    with pytest.raises(ChannelError):
        server.serve()


@pytest.mark.parametrize("number", [0, 2, 4, 10**9])
def test_out_of_sequence_number_is_rejected(number: int) -> None:
    def child(channel: Channel) -> None:
        channel.queue(["node", 2, "n", "/"])
        channel.send(["pub", number, 2, "/t", "std_msgs/msg/String", astuple(Qos())])

    graph = Graph(end_ns=END_NS)
    graph.add_node("there before", "/")
    with pytest.raises(ChannelError, match=f"endpoint {number}, which it does not own"):
        GraphServer(graph, in_a_child(child)).serve()
    assert graph.endpoints() == []


@pytest.mark.parametrize(
    "raw", [b"\xff\xff\xff\xff", b"\x00\x00\x00\x01\xc1", b"\x00\x00\x00\x02\x91\x01", b"\0\0\0\5"]
)
def test_invalid_data_on_the_pipe_is_a_channel_error(raw: bytes) -> None:
    own_end, other_end = socket.socketpair()
    other_end.sendall(raw)
    other_end.close()
    with pytest.raises(ChannelError):
        Channel(own_end).receive()


def test_exited_process_raises_channel_closed_error() -> None:
    with pytest.raises(ChannelClosedError):
        GraphServer(Graph(end_ns=END_NS), in_a_child(lambda channel: None)).serve()


PROGRAMS = Path(__file__).parents[1] / "programs"


def run_program(name: str, graph: Graph) -> None:
    virtual_time.install()
    with use_graph(graph):
        assert run_files([PROGRAMS / name], seed=0) == 0


def program_behind_the_pipe(name: str, graph: Graph) -> None:
    def child(channel: Channel) -> None:
        run_program(name, behind(channel, graph))
        channel.send(["done"])

    serve(graph, child)


@pytest.mark.parametrize(
    ("name", "topics"),
    [
        ("services.py", {"/sums", "/parameter_events", "/rosout"}),
        ("transforms.py", {"/tf", "/tf_static", "/parameter_events", "/rosout"}),
    ],
)
def test_services_and_transforms_in_another_process_give_the_same_recording_as_local_ones(
    name: str, topics: set[str]
) -> None:
    here = recorded(partial(run_program, name))
    assert {sample.topic for sample in here} == topics
    assert len(here) > 40
    assert recorded(partial(program_behind_the_pipe, name)) == recorded(partial(run_program, name)) == here


def test_encoded_qos_has_every_policy_at_its_index() -> None:
    qos = Qos("keep_all", 3, "best_effort", "transient_local", 1, 2, "manual_by_topic", 4)
    assert qos.row() == astuple(qos)
    assert Qos(*qos.row()) == qos  # type: ignore[arg-type]  # as it comes from a pipe


def test_publishing_from_a_removed_node_is_a_channel_error() -> None:
    def child(channel: Channel) -> None:
        channel.queue(["node", 1, "n", "/"])
        channel.queue(["pub", 2, 1, "/t", "std_msgs/msg/String", Qos().row()])
        channel.queue(["unnode", 1])
        channel.send(["publish", 2, b""])

    with pytest.raises(ChannelError, match="publisher 2, which it does not own"):
        GraphServer(Graph(end_ns=END_NS), in_a_child(child)).serve()


IMAGE = "sensor_msgs/msg/Image"
MEGABYTES = bytes(4 * 2**20)
LATCHED = Qos(durability="transient_local", depth=1000)


def serve_publications(
    qos: Qos, *, topics: int = 1, is_subscribed: bool = True, times: int = 20, gap_ns: int = 0
) -> Graph:
    """Serve a process that publishes 4 MB messages, on each topic in turn; return the graph afterwards."""

    def child(channel: Channel) -> None:
        remote = behind(channel, graph)
        node = remote.add_node("n", "/")
        ends = []
        for topic in (f"/t{number}" for number in range(topics)):
            ends.append(remote.add_publisher(node, topic, IMAGE, qos))
            if is_subscribed:
                remote.add_subscription(node, 0, topic, IMAGE, qos, lambda *_: None)

        def publish(number: int) -> None:
            remote.publish(ends[number % topics], MEGABYTES)
            if gap_ns and number < times:
                remote.call_at(remote.now_ns + gap_ns, partial(publish, number + 1), node=node, entity=number)

        # The other end closes the channel when it refuses to go on.
        with suppress(ChannelClosedError):
            for number in range(1 if gap_ns else times):
                publish(number)
            while remote.advance():
                pass
            channel.send(["done"])

    graph = Graph(end_ns=END_NS)
    server = GraphServer(graph, in_a_child(child), RecordingBudget(image_bytes=2**40))
    server.serve()
    while graph.advance():
        pass
    server.end()
    return graph


@pytest.mark.parametrize(
    "publish",
    [
        pytest.param(partial(serve_publications, Qos()), id="under way"),
        pytest.param(partial(serve_publications, LATCHED, is_subscribed=False), id="latched on one topic"),
        pytest.param(
            partial(serve_publications, replace(LATCHED, depth=1), topics=30, is_subscribed=False),
            id="latched on many topics",
        ),
        pytest.param(partial(serve_publications, LATCHED, gap_ns=SECOND // 40), id="latched one by one"),
    ],
)
def test_exceeding_the_limit_of_held_messages_ends_the_server(publish: Callable[[], Graph]) -> None:
    with pytest.raises(MemoryLimitError, match="64 MB were in transit or latched"):
        publish()


@pytest.mark.slow
def test_delivered_or_replaced_messages_are_not_held() -> None:
    assert serve_publications(Qos(), gap_ns=SECOND // 40).count_stored_bytes() == 0
    latched = replace(LATCHED, depth=2)
    assert serve_publications(latched, gap_ns=SECOND // 40).count_stored_bytes() == 2 * len(MEGABYTES)


def test_latched_sample_in_delivery_to_many_subscriptions_is_counted_once() -> None:
    graph = Graph()
    node = graph.add_node("n", "/")
    end = graph.add_publisher(node, "/t", IMAGE, LATCHED)
    for entity in range(5):
        graph.add_subscription(node, entity, "/t", IMAGE, Qos(), lambda *_: None)
    graph.publish(end, MEGABYTES)
    assert graph.count_stored_bytes() == len(MEGABYTES)
    graph.remove_node(node)
    assert graph.count_stored_bytes() == len(MEGABYTES)  # its events have not arrived yet
    while graph.advance():
        pass
    assert graph.count_stored_bytes() == 0


def test_removed_topics_leave_no_entries() -> None:
    topics = Topics()
    for number in range(100):
        topics.add_publisher(EndpointInfo(number, "pub", 1, f"/t{number}", IMAGE, Qos()))
        topics.remove(number)
    assert not topics._publishers_by_topic
