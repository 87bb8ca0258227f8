"""Two kits that are linked by DDS. Behavior shared with Zenoh is tested by the same functions."""

import _thread
import os
import random
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any, Literal

import pytest
import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.impl.graph_queries import describe
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import Image
from std_msgs.msg import ColorRGBA, String
from visualization_msgs.msg import Marker

from course_lib.displays.viewer import Viewer
from course_lib.errors import CourseError
from course_lib.ros.dds import participant, wire
from course_lib.ros.dds.endpoints import FRAGMENT_SIZE, Reader, Writer
from course_lib.ros.dds.link import dds_names, user_data
from course_lib.ros.dds.wire import Buffer, Locator
from course_lib.ros.graph.graph import use_graph
from course_lib.ros.graph.topics import Qos, Sample
from course_lib.ros.messages import deserialize, serialize
from course_lib.ros.robot import robot_graph
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.time import wall
from course_lib.ros.time.time_lock import time_lock
from tests.patience import PATIENCE
from tests.processes import Program
from tests.ros.dds.conftest import DdsKits, dds_link
from tests.ros.zenoh.test_two_kits import (  # noqa: F401  # pytest collects the tests here with this folder's fixtures
    BEST_EFFORT,
    LATCHED,
    STRING,
    TWIST,
    VOLATILE,
    connect,
    listener,
    say,
    talker,
    test_latched_messages_reach_early_and_late_joining_subscriptions,
    test_late_joining_subscription_receives_latched_messages_up_to_its_depth,
    test_message_reaches_the_other_kit_once_and_is_not_returned,
    test_messages_that_are_not_allowed_are_counted_and_reported_once_instead_of_forwarded,
    test_messages_to_remote_subscriptions_do_not_wait_while_a_program_publishes,
    test_remote_nodes_and_endpoints_are_listed_until_they_leave,
    test_robot_stops_when_its_commands_stop,
    test_robot_stops_when_the_link_is_closed_or_interrupted,
    test_second_node_that_drives_the_robot_is_reported_once,
    test_service_calls_that_are_not_allowed_are_not_forwarded,
    test_service_is_called_over_the_link,
    test_service_is_not_offered_unless_it_is_allowed,
    test_simulated_time_of_the_robot_is_reported,
    texts,
    topics,
)

IMAGE, SET_BOOL = "sensor_msgs/msg/Image", "std_srvs/srv/SetBool"
RELIABLE = Qos(history="keep_all", durability="transient_local")
RELIABLE_VOLATILE = Qos(history="keep_all")


def drop_datagrams(graph: RobotGraph, share: float, seed: int) -> None:
    """Lose a share of the datagrams that a graph's link sends."""
    participant, chance = dds_link(graph).participant, random.Random(seed)
    send: Callable[..., None] = participant.send

    def lossy_send(parts: Iterable[Buffer], locators: Iterable[Locator], prefix: bytes = b"") -> None:
        send(parts, [one for one in locators if chance.random() > share], prefix)

    participant.send = lossy_send  # type: ignore[method-assign]  # the network loses them


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("qos", [RELIABLE, RELIABLE_VOLATILE], ids=["latched", "volatile"])
def test_reliable_messages_arrive_once_and_in_order_despite_lost_datagrams(
    kits: DdsKits, qos: Qos, seed: int
) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    for number, graph in enumerate((robot, student)):
        drop_datagrams(graph, 0.3, 2 * seed + number)
    out = talker(robot, "/chatter", qos=qos)
    received = listener(student, "/chatter", qos=qos)
    # From here on, the publisher is matched, but the subscription does not have its state yet.
    kits.until(lambda: writer_of(robot, "rt/chatter").matched, "the subscription")
    expected = [f"message {number}" for number in range(100)]
    for text in expected:
        say(robot, out, text)
    kits.until(lambda: len(received) >= len(expected), "all messages")
    assert texts(received) == expected


def writer_of(graph: RobotGraph, topic: str) -> Writer:
    """Return the GUID of a link's writer on a topic."""
    own = dds_link(graph).participant._own_endpoints.values()
    return next(one for one in own if isinstance(one, Writer) and one.endpoint.topic == topic)


class Service:
    """A service in one kit and a client in another one, with the received messages."""

    def __init__(self, robot: RobotGraph, student: RobotGraph) -> None:
        self.requests: list[bytes] = []
        self.replies: list[bytes | None] = []
        server = robot.link.endpoint(robot.link.node("robot", "/"), "server", "/double", SET_BOOL, Qos())
        self.server = robot.link.service(server, self._on_request)
        caller = student.link.endpoint(student.link.node("caller", "/"), "client", "/double", SET_BOOL, Qos())
        self.client = dds_link(student).client(caller)

    def _on_request(self, cdr: bytes, send_reply: Callable[[bytes], None]) -> None:
        self.requests.append(cdr)
        send_reply(cdr)


CDR_LE = b"\0\1\0\0"
REQUESTS = [CDR_LE + bytes([number, 0, 0, 0]) for number in range(40)]


@pytest.mark.parametrize("lost", [0.0, pytest.param(0.3, marks=pytest.mark.slow)])
def test_service_calls_before_the_match_are_answered_once_despite_lost_datagrams(
    kits: DdsKits, lost: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.ros.dds.link.MATCH_SECONDS", PATIENCE)
    robot, student = kits.join(), kits.join()
    for seed, graph in enumerate((robot, student)):
        drop_datagrams(graph, lost, seed)
    service = Service(robot, student)
    for number, request in enumerate(REQUESTS, start=1):
        service.client.call(request, service.replies.append)
        kits.until(partial(has_items, service.replies, number), f"reply {number}")
    assert (service.requests, service.replies) == (REQUESTS, REQUESTS)


def test_reply_is_delayed_until_the_client_reader_is_discovered(kits: DdsKits) -> None:
    robot, student = kits.join(), kits.join()
    participant = dds_link(student).participant
    send: Callable[..., None] = participant.send
    is_open = False

    def send_late(parts: Iterable[Buffer], locators: Iterable[Locator], prefix: bytes = b"") -> None:
        # The network loses the description of the client's reader.
        whole = b"".join(parts)
        if is_open or b"rr/doubleReply" not in whole:
            send([whole], locators, prefix)

    participant.send = send_late  # type: ignore[method-assign]  # the network loses them
    service = Service(robot, student)
    service.client.call(REQUESTS[1], service.replies.append)
    kits.until(lambda: service.requests, "the request")
    assert service.replies == []
    is_open = True
    kits.until(lambda: service.replies, "the reply")
    assert service.replies == [REQUESTS[1]]


def test_call_expires_if_no_server_is_matched_in_time(kits: DdsKits, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.ros.dds.link.MATCH_SECONDS", 0.0)
    robot, student = kits.join(), kits.join()
    service = Service(robot, student)
    assert not service.client.is_matched()
    service.client.call(REQUESTS[1], service.replies.append)
    kits.until(service.client.is_matched, "the server")
    monkeypatch.undo()
    service.client.call(REQUESTS[2], service.replies.append)
    kits.until(lambda: service.replies, "the reply")
    assert service.requests == [REQUESTS[2]]


def has_items(items: list[bytes | None], count: int) -> bool:
    return len(items) >= count


def test_thread_that_waits_receives_by_itself_and_another_one_while_it_is_busy(kits: DdsKits) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    out, received = talker(robot, "/chatter"), listener(student, "/chatter")
    kits.until(lambda: writer_of(robot, "rt/chatter").matched, "the subscription")
    participant, threads = dds_link(student).participant, set[int]()
    process: Callable[..., None] = participant.receive

    def receive(data: bytes, host: str = "") -> None:
        threads.add(_thread.get_ident())
        process(data, host)

    participant.receive = receive  # type: ignore[method-assign]  # records the threads
    deadline = wall.monotonic() + PATIENCE
    while _thread.get_ident() not in threads and wall.monotonic() < deadline:
        say(robot, out, "to a waiting kit")
        student.advance()
    threads.clear()
    say(robot, out, "to a busy kit")
    received.clear()
    while writer_of(robot, "rt/chatter").unacknowledged_readers() and wall.monotonic() < deadline:
        robot.advance()
    assert threads
    assert _thread.get_ident() not in threads
    assert not received
    kits.until(lambda: ends_with(received, "to a busy kit"), "the message")


def test_large_message_arrives_complete_despite_lost_fragments(kits: DdsKits) -> None:
    robot, student = kits.join(send="/image"), kits.join()
    drop_datagrams(robot, 0.2, 3)
    out = talker(robot, "/image", IMAGE, LATCHED)
    received = listener(student, "/image", IMAGE, LATCHED)
    pixels = random.Random(4).randbytes(1_000_000)
    robot.publish(out, serialize(Image(height=1000, width=1000, step=1000, encoding="mono8", data=pixels)))
    kits.until(lambda: received, "the image")
    image: Any = deserialize(received[0], Image)
    assert bytes(image.data) == pixels


def test_topic_with_mostly_incomplete_messages_is_reported(kits: DdsKits) -> None:
    robot, student = kits.join(send="/image"), kits.join()
    participant = dds_link(robot).participant
    send: Callable[..., None] = participant.send

    def lose_last_fragments(
        parts: Iterable[Buffer], locators: Iterable[Locator], prefix: bytes = b""
    ) -> None:
        # Fragments are full but for the last one, which the network loses.
        whole = b"".join(parts)
        if len(whole) < 2000 or len(whole) > FRAGMENT_SIZE:
            send([whole], locators, prefix)

    participant.send = lose_last_fragments  # type: ignore[method-assign]  # the network loses them
    out = talker(robot, "/image", IMAGE, BEST_EFFORT)
    received = listener(student, "/image", IMAGE, BEST_EFFORT)
    kits.until(lambda: writer_of(robot, "rt/image").matched, "the subscription")
    image = serialize(Image(height=100, width=1000, step=1000, encoding="mono8", data=bytes(100_000)))

    def is_reported() -> bool:
        robot.publish(out, image)
        return any("messages of 0.1 MB have arrived only in part" in line for line in kits.lines)

    kits.until(is_reported, "a line about the image")
    assert received == []


def test_subscriptions_with_different_qos_receive_each_message_once(kits: DdsKits) -> None:
    robot, student = kits.join(send="/name"), kits.join()
    out = talker(robot, "/name", qos=LATCHED)
    received = {qos: listener(student, "/name", qos=qos) for qos in (BEST_EFFORT, VOLATILE)}
    connect(kits, robot, out, received[VOLATILE], String())
    say(robot, out, "Ada")
    kits.until(lambda: all("Ada" in texts(each) for each in received.values()), "the name")
    late = listener(student, "/name", qos=LATCHED)
    kits.until(lambda: late, "the latched message")
    say(robot, out, "end")
    kits.until(lambda: all("end" in texts(each) for each in (*received.values(), late)), "the end")
    assert texts(late) == ["Ada", "end"]
    assert [texts(each).count("Ada") for each in received.values()] == [1, 1]


def test_incompatible_qos_is_reported_for_each_node_and_nothing_is_delivered(kits: DdsKits) -> None:
    robot, student = kits.join(send="/scan"), kits.join()
    out, received = talker(robot, "/scan", qos=BEST_EFFORT), listener(student, "/scan")
    matched = listener(student, "/scan", qos=BEST_EFFORT)
    connect(kits, robot, out, matched, String())
    line = (
        "/scan: the publisher of /talker and the subscription of {} have incompatible QoS "
        "(RELIABILITY). DDS does not connect them, so no message arrives. Give both the same "
        "RELIABILITY."
    )
    kits.until(lambda: line.format("/listener") in kits.lines, line)
    late = student.add_node("late", "/")
    student.add_subscription(late, 0, "/scan", STRING, VOLATILE, lambda *_: received.append(b""))
    kits.until(lambda: line.format("/late") in kits.lines, line)
    kits.until(lambda: len(kits.lines) == 3, "the line of the robot, which is a kit as well")
    robot.remove_endpoint(out)
    matched.clear()
    connect(kits, robot, talker(robot, "/scan", qos=BEST_EFFORT), matched, String())
    assert (len(kits.lines), received) == (3, [])


def test_publisher_of_another_type_than_the_robots_subscription_is_reported(kits: DdsKits) -> None:
    robot, student = kits.join(send="/cmd"), kits.join(send="/cmd")
    talker(robot, "/other")
    node = robot.add_node("base", "/")
    robot.add_subscription(node, 0, "/cmd", "std_msgs/msg/Bool", VOLATILE, lambda *_: None)
    talker(student, "/cmd")
    line = (
        "/cmd: /talker publishes std_msgs/msg/String, and /base subscribes to std_msgs/msg/Bool, so no "
        "message arrives. Use the robot's type."
    )
    kits.until(lambda: line in kits.lines, line)


def test_events_of_a_subscription_include_remote_publishers_that_join_and_leave(
    kits: DdsKits, capfd: pytest.CaptureFixture[str]
) -> None:
    student, events = kits.join(), list[tuple[int, int]]()
    with use_graph(student), time_lock.hold():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node("student")
        callbacks = SubscriptionEventCallbacks(
            matched=lambda info: events.append((info.current_count, info.current_count_change))
        )
        node.create_subscription(String, "/chatter", print, 10, event_callbacks=callbacks)
        robot = kits.join(send="/chatter")
        reliable = talker(robot, "/chatter")

        def received(expected: list[tuple[int, int]]) -> bool:
            rclpy.spin_once(node, timeout_sec=0.0)
            return events == expected

        kits.until(lambda: received([(1, 1)]), "the publisher")
        talker(robot, "/chatter", qos=BEST_EFFORT)
        kits.until(lambda: topics(student, "pub").count("/chatter") == 2, "the second publisher")
        robot.remove_endpoint(reliable)
        kits.until(lambda: received([(1, 1), (0, -1)]), "its end")
        rclpy.shutdown()
    warning = "New publisher discovered on topic '/chatter', offering incompatible QoS. No messages will"
    assert capfd.readouterr().err.count(warning) == 1


# Python's default for these signals ends a process without the functions of `atexit`.
@pytest.mark.slow
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_robot_stops_when_the_command_that_drives_it_ends_by_a_signal(kits: DdsKits, name: str) -> None:
    robot = kits.join()
    received = listener(robot, "/cmd_vel", TWIST)
    link = ["--robot", "dds/127.0.0.1", "--domain", str(kits.domain), "--send", "/cmd_vel"]
    words = ["topic", "pub", "-r", "20", "/cmd_vel", TWIST, "{linear: {x: 0.5}}"]
    command = [sys.executable, "-m", "course_lib", "ros2", *link, *words]
    with Program(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        kits.until(lambda: received, "a command")
        process.send_signal(getattr(signal, name))
        kits.until(lambda: not any(received[-1][4:]), "the stop")
        process.communicate(timeout=PATIENCE)


def test_nodes_in_another_domain_are_not_discovered(kits: DdsKits) -> None:
    other, student, robot = kits.join(domain=1), kits.join(), kits.join(send="/here")
    talker(other, "/there")
    talker(robot, "/here")
    kits.until(lambda: "/here" in topics(student, "pub"), "the robot of this domain")
    assert "/there" not in topics(student, "pub")


def ends_with(received: list[bytes], text: str) -> bool:
    return texts(received)[-1:] == [text]


def test_robot_with_several_networks_is_discovered_in_the_network_of_its_given_address(
    kits: DdsKits, monkeypatch: pytest.MonkeyPatch
) -> None:
    encode = wire.parameter_list

    def list_with_two_networks(*parameters: tuple[int, bytes]) -> bytes:
        # Nothing listens at this address of the robot's first network.
        other = wire.locator(("127.7.7.7", 7400))
        addresses = (wire.Pid.METATRAFFIC, wire.Pid.DEFAULT_UNICAST)
        return encode(*[(pid, other) for pid, _ in parameters if pid in addresses], *parameters)

    monkeypatch.setattr(wire, "parameter_list", list_with_two_networks)
    robot, student = kits.join(send="/chatter"), kits.join()
    talker(robot, "/chatter")
    kits.until(lambda: "/chatter" in topics(student, "pub"), "the robot")


def test_restarted_robot_is_discovered_again(kits: DdsKits) -> None:
    student = kits.join()
    received = listener(student, "/name", qos=LATCHED)
    for name in ("first", "second", "third"):
        robot = kits.join(send="/name")
        out = talker(robot, "/name", qos=LATCHED)
        say(robot, out, name)
        kits.until(partial(ends_with, received, name), name)
        kits.leave(robot)
        kits.until(lambda: "/name" not in topics(student, "pub"), "the end of the robot")


def test_robot_that_starts_with_another_address_is_found_by_its_name(
    kits: DdsKits, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(participant, "ANNOUNCE_SECONDS", 0.1)
    hosts = {"robot.local": "127.0.0.9"}

    def find(host: str) -> str:
        return hosts.get(host, host)

    monkeypatch.setattr(socket, "gethostbyname", find)
    # The robot does not contact the student's computer by itself.
    robot, student = kits.join(send="/chatter", host="127.0.0.9"), kits.join(host="robot.local")
    talker(robot, "/chatter")
    announced = dds_link(student).participant
    kits.until(lambda: not announced._eager_count, "the first announcements")
    assert not student.link.is_up()
    hosts["robot.local"] = "127.0.0.1"
    kits.until(lambda: "/chatter" in topics(student, "pub"), "the robot")
    line = "The robot dds/robot.local now has the address 127.0.0.1, and the link follows it."
    kits.until(lambda: line in kits.lines, "the line")


def test_display_with_incompatible_qos_receives_nothing_and_names_the_policy(kits: DdsKits) -> None:
    robot, student = kits.join(send="/marker"), kits.join()
    out = talker(robot, "/marker", "visualization_msgs/msg/Marker", BEST_EFFORT)
    with use_graph(student):
        viewer = Viewer("map")
    viewer.add("Marker", "/marker", name="Strict")
    loose = viewer.add("Marker", "/marker", name="Loose")
    loose["Topic/Reliability Policy"] = "Best Effort"
    marker = Marker(type=Marker.CUBE, color=ColorRGBA(r=1.0, a=1.0))
    marker.header.frame_id = "map"
    marker.scale.x = marker.scale.y = marker.scale.z = 1.0

    def arrived() -> bool:
        robot.publish(out, serialize(marker))
        return "received" in texts_of("Loose")

    def texts_of(name: str) -> str:
        return " ".join(row.text for row in viewer.statuses() if row.display == name)

    kits.until(arrived, "the first marker")
    assert "received" not in texts_of("Strict")
    assert "another RELIABILITY than this display requests" in texts_of("Strict")
    viewer.close()


def robot_errors(viewer: Viewer) -> list[str]:
    return [row.text for row in viewer.statuses() if (row.name, row.level) == ("Robot", "error")]


def test_robot_that_stops_answering_is_reported_and_shown_in_the_view(
    kits: DdsKits, monkeypatch: pytest.MonkeyPatch
) -> None:
    # An idle participant sends nothing by itself in the meantime.
    monkeypatch.setattr(participant, "ANNOUNCE_SECONDS", 60.0)
    monkeypatch.setattr(participant, "ASK_SECONDS", 0.2)
    monkeypatch.setattr(robot_graph, "SILENT_SECONDS", 1.5)
    student, robot = kits.join(), kits.join(send="/chatter")
    with use_graph(student):
        viewer = Viewer()
        talker(robot, "/chatter")
        kits.until(lambda: "/chatter" in topics(student, "pub"), "the robot")
        quiet_until = wall.monotonic() + 3.0
        kits.until(lambda: wall.monotonic() > quiet_until, "the time of an idle robot")
        assert (robot_errors(viewer), kits.lines) == ([], [])
        send = dds_link(robot).participant.send
        monkeypatch.setattr(dds_link(robot).participant, "send", lambda *_: None)
        kits.until(lambda: robot_errors(viewer), "the error in the view")
        silent = re.compile(rf"{kits.address} has not answered for \d s\.")
        assert silent.fullmatch(robot_errors(viewer)[0])
        assert any(silent.fullmatch(line) for line in kits.lines)
        assert "no answer for" in str(student.link_report()[0][1])
        monkeypatch.setattr(dds_link(robot).participant, "send", send)
        kits.until(lambda: not robot_errors(viewer), "the end of the error")
        viewer.close()


@pytest.mark.slow
def test_display_receives_its_topic_again_after_each_of_twenty_publisher_restarts(kits: DdsKits) -> None:
    student = kits.join()
    received: list[str] = []

    def show(sample: Sample) -> None:
        received.append(deserialize(sample.cdr, String).data)

    # Like a display, it subscribes while its topic is being published.
    student.tap(show, lambda: {"/name"})
    for number in range(20):
        robot = kits.join(send="/name")
        out = talker(robot, "/name", qos=LATCHED)
        say(robot, out, f"robot {number}")
        kits.until(partial(ends_with_text, received, f"robot {number}"), f"robot {number}")
        kits.leave(robot)
        kits.until(lambda: "/name" not in topics(student, "pub"), "the end of the robot")
    assert received == [f"robot {number}" for number in range(20)]


def ends_with_text(received: list[str], text: str) -> bool:
    return received[-1:] == [text]


def resident_bytes() -> int:
    """Return the memory of this process, [B]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def test_sender_yields_after_each_large_datagram(kits: DdsKits, monkeypatch: pytest.MonkeyPatch) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    received = listener(student, "/chatter")
    out = talker(robot, "/chatter")
    connect(kits, robot, out, received, String(data="first"))
    yields: list[float] = []
    monkeypatch.setattr(wall, "sleep", yields.append)
    say(robot, out, "x" * (2 * FRAGMENT_SIZE))
    # The message and its header need three datagrams, of which the last one is small.
    assert yields.count(0.0) == 2
    monkeypatch.undo()
    kits.until(lambda: len(texts(received)[-1]) == 2 * FRAGMENT_SIZE, "the large message")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from Linux's /proc")
def test_memory_use_stays_constant_during_an_image_flood_to_a_busy_kit(kits: DdsKits) -> None:
    robot, student = kits.join(send="/image"), kits.join()
    out = talker(robot, "/image", IMAGE, BEST_EFFORT)
    received = 0

    def count(cdr: bytes, source_ns: int, received_ns: int) -> None:
        nonlocal received
        received += 1
        # Slower than the rate of the images.
        wall.sleep(0.05)

    node = student.add_node("listener", "/")
    student.add_subscription(node, 0, "/image", IMAGE, BEST_EFFORT, count)
    image = serialize(Image(height=480, width=640, step=640, encoding="mono8", data=bytes(307_200)))
    memory: list[int] = []
    end = wall.monotonic() + float(os.environ.get("COURSE_FLOOD_SECONDS", "30"))
    while wall.monotonic() < end:
        for _ in range(5):
            robot.publish(out, image)
        for graph in kits.graphs:
            graph.advance()
        memory.append(resident_bytes())
    assert received > 100
    # Inboxes, which hold 64 MiB, are full after the first part.
    filled = max(memory[: len(memory) // 3])
    assert max(memory) < filled + 32 * 2**20, (filled, max(memory))


@pytest.mark.parametrize("attempts", [100])
def test_messages_and_calls_that_are_not_allowed_are_not_sent(kits: DdsKits, attempts: int) -> None:
    robot, student = kits.join(), kits.join()
    received = [listener(robot, topic) for topic in ("/cmd_vel", "/chatter")]
    outs = [talker(student, topic) for topic in ("/cmd_vel", "/chatter")]
    kits.until(lambda: "/chatter" in topics(student, "sub"), "the robot's subscriptions")
    for number in range(attempts):
        for out in outs:
            say(student, out, str(number))
    student_writers = dds_link(student).participant
    assert not [topic for topic in written_topics(student_writers) if topic.startswith(("rt/", "rq/", "rr/"))]
    assert received == [[], []]
    assert set(student.blocked.counts.values()) == {attempts}


def test_endpoints_of_a_robot_have_the_gids_that_its_discovery_transmits(kits: DdsKits) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    talker(robot, "/chatter")
    listener(robot, "/orders")
    kits.until(lambda: {"/chatter", "/orders"} <= {e.topic for e in student.endpoints()}, "the robot")
    gids = {info.topic: info.gid for info in student.endpoints()}
    participant = dds_link(robot).participant
    endpoints = [own.endpoint for own in participant._own_endpoints.values()]
    guids = {endpoint.topic: endpoint.guid for endpoint in endpoints}
    assert (gids["/chatter"], gids["/orders"]) == (guids["rt/chatter"], guids["rt/orders"])


def written_topics(participant: Any) -> list[str]:
    return [own.endpoint.topic for own in participant._own_endpoints.values() if isinstance(own, Writer)]


def test_closed_port_is_reported_once_as_a_computer_without_a_program(
    kits: DdsKits, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.ros.dds.link.SILENT_SECONDS", 0.2)
    # No program uses this address of the loopback device.
    student = kits.join(host="127.77.0.9")
    kits.until(lambda: kits.lines, "a line about the silence")
    end = wall.monotonic() + 0.5
    kits.until(lambda: wall.monotonic() > end, "half a second")
    (line,) = kits.lines
    domain = student.link.domain
    assert line.startswith(
        f"Nothing comes from dds/127.77.0.9 in domain {domain}. The computer is there, but no "
    )


def test_domain_without_a_free_port_is_an_error(kits: DdsKits, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.ros.dds.participant.PORT_ATTEMPTS", 1)
    kits.join()
    with pytest.raises(CourseError, match=r"No UDP port from \d+ to \d+ is free on 127.0.0.1: end other ROS"):
        kits.join()


@pytest.mark.parametrize(("kind", "heard"), [("publisher", True), ("subscription", False)])
def test_topic_with_another_definition_of_its_type_is_reported(
    kits: DdsKits, kind: Literal["publisher", "subscription"], heard: bool
) -> None:
    robot, student = kits.join(), kits.join()
    link = dds_link(robot)
    node = link.node("robot", "/")
    link.announce(node)
    entity = link.endpoint(node, kind, "/pose", STRING, Qos(), f"RIHS01_{'0' * 64}")
    names = dds_names("/pose", STRING)
    own: Writer | Reader
    if heard:
        own = link.participant.add_writer(*names, Qos(), user_data(entity.type_hash))
    else:
        own = link.participant.add_reader(*names, Qos(), lambda sample: None, user_data(entity.type_hash))
    link.list_endpoint(entity, own.endpoint.guid)
    kits.until(lambda: kits.lines, "a line about the type")
    (line,) = kits.lines
    assert line.startswith(f"The robot has another definition of {STRING} than this kit, so /pose ")
    # `ros2 topic info -v` shows the robot's hash, as on the robot.
    (info,) = student.endpoints_on("/pose")
    assert info.type_hash() == entity.type_hash
    assert str(describe(info, student.nodes()).topic_type_hash) == entity.type_hash
    assert student.link.is_open


@pytest.mark.parametrize("type_name", ["std_srvs/srv/SetBool_Request", "Foo", ""])
def test_tap_does_not_subscribe_to_a_topic_whose_type_is_not_a_message(kits: DdsKits, type_name: str) -> None:
    robot, student = kits.join(), kits.join()
    student.tap(lambda sample: None)
    link = dds_link(robot)
    node = link.node("robot", "/")
    link.announce(node)
    entity = link.endpoint(node, "publisher", "/odd", type_name, Qos(), f"RIHS01_{'0' * 64}")
    # The DDS name of a type that does not have three parts is the type itself.
    dds = "std_srvs::srv::dds_::SetBool_Request_" if "/" in type_name else type_name
    writer = link.participant.add_writer("rt/odd", dds, Qos())
    link.list_endpoint(entity, writer.endpoint.guid)
    kits.until(lambda: student.endpoints_on("/odd"), "the topic")
    end = wall.monotonic() + 0.5
    kits.until(lambda: wall.monotonic() > end, "half a second")
    assert [info.kind for info in student.endpoints_on("/odd")] == ["pub"]


def test_address_without_a_ros_program_is_explained(kits: DdsKits) -> None:
    student = kits.join()
    link = dds_link(student)
    # The kit's own announcement arrives at this address; it is not a robot's response.
    end = wall.monotonic() + 0.5
    kits.until(lambda: wall.monotonic() > end, "half a second")
    assert student.link_report()[0] == ("robot", "dds/127.0.0.1, no answer yet")
    assert "Nothing comes from dds/127.0.0.1 in domain" in link.no_nodes_message()
    assert STRING not in kits.lines
