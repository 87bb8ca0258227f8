import random
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from math import copysign

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import String

from course_lib.ros.graph.graph import use_graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import deserialize, message_class, serialize, type_name
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.robot.link import NO_STOP, STOP_IS_DUE, Packet, clock_warning
from course_lib.ros.robot.robot_graph import (
    MAX_BYTES,
    MAX_DEPTH,
    MAX_MESSAGES,
    MAX_PUBLISHERS,
    Inbox,
    RobotGraph,
    TopicSubscription,
    TopicSubscriptions,
    Traffic,
)
from course_lib.ros.robot.sending import STALE_SECONDS
from course_lib.ros.time import wall
from course_lib.ros.zenoh.link import encode_attachment, key_expr_of, open_session
from course_lib.tools.sources import GraphSource
from tests.patience import PATIENCE
from tests.processes import Program
from tests.ros.zenoh.conftest import Kits, Routers, zenoh_link
from tests.ros.zenoh.mutations import Mutations
from tests.ros.zenoh.test_two_kits import (
    BEST_EFFORT,
    LATCHED,
    MOVING,
    STRING,
    VOLATILE,
    connect,
    listener,
    say,
    serve,
    speeds,
    talker,
    texts,
    topics,
)

RESTARTS = 3
# 100,000 need 2 minutes; they were sent once.
MUTATIONS = 3_000
A_MESSAGES_WAY = 20.0  # latency limit of the fastest message on a machine under load [s]


@pytest.fixture
def routers() -> Iterator[Routers]:
    routers = Routers()
    yield routers
    routers.kill()


def ends_with_the_map(heard: list[bytes]) -> bool:
    return texts(heard)[-1:] == ["the map"]


@pytest.mark.slow
def test_link_reconnects_after_every_router_restart(routers: Routers) -> None:
    kits = Kits(f"tcp/127.0.0.1:{routers.port}")
    robot, student = kits.join(send="/chatter /map"), kits.join()
    out, heard = talker(robot, "/chatter"), listener(student, "/chatter")
    held = talker(robot, "/map", qos=LATCHED)
    say(robot, held, "the map")
    early = listener(student, "/map", qos=LATCHED)
    connect(kits, robot, out, heard, String())
    kits.until(lambda: early, "the latched message")
    for _ in range(RESTARTS):
        assert student.link_error() == ""
        routers.kill()
        kits.until(lambda: sum("is lost" in line for line in kits.lines) == 2, "both lines on the loss")
        assert "is lost" in student.link_error()
        kits.until(lambda: not student.link_report()[2][1], "the end of the robot's nodes")
        routers.start()
        kits.until(
            lambda: sum("is back after" in line for line in kits.lines) == 2, "both lines on the return"
        )
        heard.clear()
        connect(kits, robot, out, heard, String())
        late = listener(student, "/map", qos=LATCHED)
        kits.until(partial(ends_with_the_map, late), "the latched message once more")
        kits.lines.clear()
    for graph in tuple(kits.graphs):
        kits.leave(graph)


LINKED = """
import sys
from course_lib.ros.graph.topics import Qos
from course_lib.ros.robot.connect import RobotAddress, link_to

graph = link_to(RobotAddress(sys.argv[1], send=["/cmd_vel"]))
node = graph.add_node("x", "/")
graph.add_subscription(node, 0, "/a", "std_msgs/msg/String", Qos(), lambda *_: None)
graph.add_publisher(node, "/cmd_vel", "geometry_msgs/msg/Twist", Qos())
print("up", flush=True)
sys.stdin.readline()
sys.exit(3)
"""


@pytest.mark.slow
@pytest.mark.parametrize("killed", [False, True])
def test_interpreter_exits_although_the_link_was_not_closed(routers: Routers, killed: bool) -> None:
    command = [sys.executable, "-c", LINKED, f"127.0.0.1:{routers.port}"]
    pipe = subprocess.PIPE
    with Program(command, stdin=pipe, stdout=pipe) as linked:
        assert linked.read_line() == "up\n"
        if killed:
            routers.kill()
        linked.communicate("\n", timeout=PATIENCE)
    assert linked.returncode == 3


def on_bench(topic: str, kit: RobotGraph, kept: int) -> TopicSubscription:
    subscription = TopicSubscription(topic, STRING, kept)
    subscription.inbox = Inbox(kit.link.actions, lambda _: None)
    return subscription


def packet(sequence: int, size: int = 10, late_ns: int = 0, gid: bytes = b"") -> Packet:
    now_ns = wall.time_ns()
    return Packet(bytes(size), sequence, now_ns - late_ns, gid, now_ns)


@pytest.mark.slow
def test_busy_kernel_keeps_only_the_newest_messages_of_a_topic(kits: Kits) -> None:
    student, taken = kits.join(), list[Packet]()
    inbox = Inbox(student.link.actions, taken.append)
    for sequence in range(1, 10 * MAX_MESSAGES + 1):
        inbox.put(packet(sequence))
    kits.until(lambda: len(taken) == MAX_MESSAGES, "the newest")
    assert taken[-1].sequence == 10 * MAX_MESSAGES
    assert inbox.dropped == 9 * MAX_MESSAGES
    for sequence in range(10):
        inbox.put(packet(sequence, MAX_BYTES // 4))
    taken.clear()
    kits.until(lambda: len(taken) == 4, "the newest of the large ones")
    assert student.link.actions.empty()


def test_lost_messages_are_counted_by_gaps_in_the_sequence_numbers() -> None:
    traffic = Traffic()
    for sequence in (3, 4, 7, 8):
        traffic.add(packet(sequence, gid=b"a"))
    traffic.add(packet(100, gid=b"b"))
    traffic.reset_sequences()
    traffic.add(packet(50, gid=b"a"))
    assert (traffic.received, traffic.lost) == (6, 2)


def test_sequence_numbers_of_a_bounded_number_of_publishers_are_kept() -> None:
    traffic = Traffic()
    for number in range(2 * MAX_PUBLISHERS):
        traffic.add(packet(1, gid=b"%d" % number))
    assert len(traffic._last_sequence) == MAX_PUBLISHERS


def test_publisher_with_a_huge_depth_is_listed_and_requested_with_a_bounded_one(kits: Kits) -> None:
    student, taken = kits.join(), list[object]()
    student.tap(taken.append)
    session = open_session(kits.address)
    qos = Qos(depth=2**70, durability="transient_local")
    node = zenoh_link(student).node("robot", "/")
    entity = replace(node, zid=str(session.zid()), kind="publisher", topic="/map", type_name=STRING)
    token = session.liveliness().declare_token(replace(entity, type_hash=type_hash(STRING), qos=qos).token)
    kits.until(lambda: list(student._subscriptions), "the subscription of the tap")
    assert [info.qos.depth for info in student._remote.publisher_infos()] == [MAX_DEPTH]
    token.undeclare()
    session.close()


def test_changed_tokens_messages_and_requests_raise_nothing(kits: Kits) -> None:
    student, session = kits.join(call="/set"), open_session(kits.address)
    messages = []
    for kind in (STRING, type_name(Twist)):
        topic = f"/{kind.rpartition('/')[2].lower()}"
        heard = [listener(student, topic, kind, qos) for qos in (VOLATILE, LATCHED)]
        messages.append((topic, kind, serialize(message_class(kind)())))
    serve(student, "/set")
    # It subscribes to everything that the tokens announce.
    student.tap(lambda sample: None)
    service = ("/set", "std_srvs/srv/Trigger", b"\0\1\0\0\0")
    victim = zenoh_link(student).node("victim", "/").zid
    changes = Mutations(random.Random(0), session, victim, student.link.domain, messages, [service])
    for number in range(MUTATIONS):
        changes.send()
        if number % 5 == 0:
            student.advance()
    kits.until(student.link.actions.empty, "the end of the queue")
    assert all(heard)
    session.close()


def test_messages_lost_on_a_slow_link_are_reported_with_their_rate(kits: Kits) -> None:
    student = kits.join()
    subscription = on_bench("/image", student, 0)
    for sequence in range(0, 120, 2):
        subscription.inbox.put(packet(sequence, 1000))
    assert subscription.warning().startswith("/image: 50% of the messages are lost on the way, ")
    assert "lost on the way" in str(subscription.status_row()[1])


def test_latched_messages_are_counted_but_have_no_rate(kits: Kits) -> None:
    subscription = on_bench("/map", kits.join(), 1)
    for sequence in range(2):
        subscription.inbox.put(packet(sequence))
    assert subscription.status_row() == ("/map", "latched, 2 messages received")


def test_two_subscriptions_of_a_topic_have_one_row(kits: Kits, monkeypatch: pytest.MonkeyPatch) -> None:
    link = kits.join().link
    # A network that enforces QoS has a subscription for each endpoint.
    monkeypatch.setattr(link, "is_qos_enforced", True)
    subscriptions = TopicSubscriptions(link, lambda *_: None)
    for endpoint, topic in enumerate(("/odom", "/odom", "/scan")):
        subscriptions.add(endpoint, topic, STRING, Qos())
    for subscription, count in zip(subscriptions, (2, 1, 0), strict=True):
        subscription.latched_count = 1
        for sequence in range(count):
            subscription.inbox.put(packet(sequence))
    assert subscriptions.status_rows() == [
        ("/odom", "latched, 2 messages received"),
        ("/scan", "latched, 0 messages received"),
    ]
    subscriptions.close()


@pytest.mark.parametrize(
    ("days", "offset"),
    [(1.9, "164160.0 s"), (-3.0, "3 days"), (700.0, "700 days"), (-20_770.0, "57 years")],
)
def test_large_clock_offset_is_reported_in_days_or_years(days: float, offset: str) -> None:
    direction = "ahead of" if days > 0 else "behind"
    start = f"The robot's clock is {offset} {direction} this computer's: stamps and tf do not fit"
    assert clock_warning(days * 86_400).startswith(start)


@pytest.mark.parametrize("skew", [-200.0, 300.0])
def test_clock_offset_of_the_robot_is_measured_and_reported(kits: Kits, skew: float) -> None:
    student = kits.join()
    listener(student, "/chatter")
    with open_session(kits.address) as robot:
        out = robot.declare_publisher(key_expr_of(0, "/chatter", STRING, type_hash(STRING)))

        def told() -> bool:
            extra = encode_attachment(1, bytes(16), wall.time_ns() + int(skew * 1e9))
            out.put(serialize(String()), attachment=extra)
            return any("clock" in line for line in kits.lines)

        kits.until(told, "the line")
    (line,) = [line for line in kits.lines if "clock" in line]
    rounded = float(line.split(" is ")[1].split(" s ")[0])
    assert rounded == pytest.approx(abs(skew), abs=A_MESSAGES_WAY)
    assert line == clock_warning(copysign(rounded, skew))
    in_table = str(dict(student.link_report())["robot's clock"])
    assert float(in_table.split(" s ")[0]) == pytest.approx(skew, abs=A_MESSAGES_WAY)


def test_message_flood_does_not_delay_timers(kits: Kits) -> None:
    robot, student = kits.join(send="/flood"), kits.join()
    out, heard = talker(robot, "/flood"), listener(student, "/flood")
    connect(kits, robot, out, heard, String())
    fired: list[int] = []
    student.call_at(student.now_ns, lambda: fired.append(student.now_ns), node=0, entity=0)
    for _ in range(1000):
        robot.publish(out, serialize(String(data="x" * 1000)))
    kits.until(lambda: fired, "the timer")


@pytest.mark.slow
def test_stop_due_while_disconnected_is_sent_after_reconnection(routers: Routers) -> None:
    kits = Kits(f"tcp/127.0.0.1:{routers.port}")
    robot, student = kits.join(), kits.join(send="/cmd_vel")
    heard = listener(robot, "/cmd_vel", type_name(Twist))
    drive = talker(student, "/cmd_vel", type_name(Twist))
    connect(kits, student, drive, heard, MOVING)
    kits.until(lambda: speeds(heard, Twist)[-1] == 0.0, "the stop with a link")
    for last in (MOVING, Twist()):
        heard.clear()
        student.publish(drive, serialize(MOVING))
        kits.until(lambda: heard, "the command")
        routers.kill()
        kits.until(lambda: not (student.link.is_up() or robot.link.is_up()), "the loss")
        student.publish(drive, serialize(last))
        due = wall.monotonic() + 2 * STALE_SECONDS
        kits.until(lambda due=due: wall.monotonic() > due, "the time of the stop")  # type: ignore[misc]
        assert speeds(heard, Twist) == [0.2]
        routers.start()
        kits.until(lambda: len(heard) > 1, "the stop once the link is back")
        assert speeds(heard, Twist) == [0.2, 0.0]
    for graph in tuple(kits.graphs):
        kits.leave(graph)


@pytest.fixture
def driven(routers: Routers) -> Iterator[tuple[Kits, RobotGraph, int, list[bytes]]]:
    """Drive a robot, then kill the router. Return the driver, its publisher and the received commands."""
    kits = Kits(f"tcp/127.0.0.1:{routers.port}")
    robot, student = kits.join(), kits.join(send="/cmd_vel")
    heard = listener(robot, "/cmd_vel", type_name(Twist))
    drive = talker(student, "/cmd_vel", type_name(Twist))
    connect(kits, student, drive, heard, Twist())
    student.publish(drive, serialize(MOVING))
    kits.until(lambda: speeds(heard, Twist), "the command")
    kits.until(lambda: student._sending._stops[drive].is_due, "the look that sees who listens")
    routers.kill()
    kits.until(lambda: not (student.link.is_up() or robot.link.is_up()), "the loss")
    heard.clear()
    yield kits, student, drive, heard
    for graph in tuple(kits.graphs):
        kits.leave(graph)


Driven = tuple[Kits, RobotGraph, int, list[bytes]]


@pytest.mark.slow
def test_stop_of_a_removed_node_is_sent_before_commands_of_another_node_after_reconnection(
    routers: Routers, driven: Driven
) -> None:
    kits, student, drive, heard = driven
    student.remove_endpoint(drive)
    other = talker(student, "/cmd_vel", type_name(Twist))
    routers.start()

    def drives() -> bool:
        student.publish(other, serialize(MOVING))
        return bool(speeds(heard, Twist))

    kits.until(drives, "the other node's commands")
    assert deserialize(heard[0], Twist).linear.x == 0.0


@pytest.mark.slow
def test_interrupt_while_disconnected_stops_the_robot_after_reconnection(
    routers: Routers, driven: Driven
) -> None:
    kits, student, _, heard = driven

    def interrupt() -> None:
        raise KeyboardInterrupt

    student.call_at(student.now_ns, interrupt, node=0, entity=0)
    with pytest.raises(KeyboardInterrupt):
        kits.until(lambda: False, "the interrupt")
    routers.start()
    kits.until(lambda: heard, "the stop")
    assert deserialize(heard[0], Twist).linear.x == 0.0


@pytest.mark.slow
def test_link_closed_while_disconnected_sends_the_stop_after_reconnection(
    routers: Routers, driven: Driven
) -> None:
    kits, student, _, heard = driven
    kits.leave(student)
    assert STOP_IS_DUE in kits.lines
    assert student.link.is_open
    routers.start()
    kits.until(lambda: heard, "the stop")
    assert deserialize(heard[0], Twist).linear.x == 0.0
    kits.until(lambda: not student.link.is_open, "the end of the link")


@pytest.mark.slow
def test_python_exits_with_a_notice_when_the_robot_cannot_be_stopped(driven: Driven) -> None:
    kits, student, _, _ = driven
    kits.graphs.remove(student)
    student.close_at_exit()
    assert not student.link.is_open
    assert kits.lines[-2:] == [STOP_IS_DUE, NO_STOP]


def test_silence_of_a_robot_topic_is_not_attributed_to_its_qos(kits: Kits) -> None:
    robot, student = kits.join(send="/scan"), kits.join()
    talker(robot, "/scan", qos=BEST_EFFORT)
    kits.until(lambda: "/scan" in topics(student, "pub"), "the publisher")
    with use_graph(student):
        assert "QoS" not in GraphSource(student).silence_reason("/scan", Qos())
