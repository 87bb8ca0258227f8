import os
import socket
from collections.abc import Callable
from dataclasses import astuple
from functools import partial
from pathlib import Path

import pytest

from course_lib.ros import virtual_time
from course_lib.ros.channel import Channel, ChannelClosedError, ChannelError
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, Sample, use_graph
from course_lib.ros.graph_server import GraphServer
from course_lib.ros.program import run_files
from course_lib.ros.qos import Qos
from course_lib.ros.remote_graph import RemoteGraph

SECOND = 10**9  # [ns]
END_NS = START_NS + 5 * SECOND


def talk(graph: Graph) -> None:
    """A node that counts at 1 Hz, and a second one that answers what it hears."""
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
    ours, theirs = socket.socketpair()
    if os.fork() == 0:
        ours.close()
        program(Channel(theirs))
        os._exit(0)
    theirs.close()
    return Channel(ours)


def recorded(run: Callable[[Graph], None]) -> list[Sample]:
    graph, samples = Graph(end_ns=END_NS), list[Sample]()
    graph.tap(samples.append)
    run(graph)
    return samples


def behind(channel: Channel, graph: Graph) -> RemoteGraph:
    return RemoteGraph(channel, start_ns=START_NS, end_ns=END_NS, last_id=graph.last_id)


def behind_the_pipe(graph: Graph) -> None:
    def child(channel: Channel) -> None:
        remote = behind(channel, graph)
        talk(remote)
        assert [node.name for node in remote.nodes()] == ["talker", "echoer"]
        assert [endpoint.topic for endpoint in remote.endpoints()] == ["/count", "/echo", "/count"]
        assert [end.kind for end in remote.endpoints_on("/count")] == ["pub", "sub"]
        channel.send(["done"])

    server = GraphServer(graph, in_a_child(child))
    server.serve()
    while graph.advance():
        pass
    server.end()
    assert server.last_frame == ["done"]


def test_a_program_behind_the_pipe_gives_the_same_recording_as_here() -> None:
    here = recorded(talk)
    assert [s.topic for s in here] == ["/count", "/echo"] * 4 + ["/count"]
    assert recorded(behind_the_pipe) == here


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
def test_a_frame_about_what_is_not_its_own_is_refused(frame: list[object]) -> None:
    server = GraphServer(Graph(end_ns=END_NS), in_a_child(lambda channel: channel.send(frame)))
    with pytest.raises(ChannelError):
        server.serve()


@pytest.mark.parametrize("number", [0, 2, 4, 10**9])
def test_a_number_that_is_not_the_next_is_refused(number: int) -> None:
    def child(channel: Channel) -> None:
        channel.queue(["node", 2, "n", "/"])
        channel.send(["pub", number, 2, "/t", "std_msgs/msg/String", astuple(Qos())])

    graph = Graph(end_ns=END_NS)
    graph.add_node("there before", "/")
    with pytest.raises(ChannelError, match=f"endpoint {number}, which is not its own"):
        GraphServer(graph, in_a_child(child)).serve()
    assert graph.endpoints() == []


@pytest.mark.parametrize(
    "raw", [b"\xff\xff\xff\xff", b"\x00\x00\x00\x01\xc1", b"\x00\x00\x00\x02\x91\x01", b"\0\0\0\5"]
)
def test_garbage_on_the_pipe_is_a_channel_error(raw: bytes) -> None:
    ours, theirs = socket.socketpair()
    theirs.sendall(raw)
    theirs.close()
    with pytest.raises(ChannelError):
        Channel(ours).receive()


def test_a_process_that_is_gone_is_said_to_be_gone() -> None:
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

    server = GraphServer(graph, in_a_child(child))
    server.serve()
    while graph.advance():
        pass
    server.end()
    assert server.last_frame == ["done"]


@pytest.mark.parametrize(
    ("name", "topics"),
    [
        ("services.py", {"/sums", "/parameter_events", "/rosout"}),
        ("transforms.py", {"/tf", "/tf_static", "/parameter_events", "/rosout"}),
    ],
)
def test_services_and_transforms_behind_the_pipe_give_the_same_recording_as_here(
    name: str, topics: set[str]
) -> None:
    here = recorded(partial(run_program, name))
    assert {sample.topic for sample in here} == topics
    assert len(here) > 40
    assert recorded(partial(program_behind_the_pipe, name)) == recorded(partial(run_program, name)) == here


def test_a_row_has_every_policy_in_its_place() -> None:
    qos = Qos("keep_all", 3, "best_effort", "transient_local", 1, 2, "manual_by_topic", 4)
    assert qos.row() == astuple(qos)
    assert Qos(*qos.row()) == qos  # type: ignore[arg-type]  # as it comes from a pipe
