import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from math import copysign

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import String

from course_lib.ros import wall
from course_lib.ros.graph import use_graph
from course_lib.ros.messages import deserialize, serialize, type_name
from course_lib.ros.messages.hashes import type_hash
from course_lib.ros.qos import Qos
from course_lib.ros.zenoh.ears import Ear
from course_lib.ros.zenoh.explain import NO_STOP, STOP_IS_DUE, about_clock
from course_lib.ros.zenoh.inbox import MAX_BYTES, MAX_MESSAGES, Inbox, Packet, Traffic
from course_lib.ros.zenoh.link import Declared
from course_lib.ros.zenoh.robot_graph import RobotGraph
from course_lib.ros.zenoh.sending import STALE
from course_lib.ros.zenoh.session import open_session
from course_lib.ros.zenoh.tokens import attachment, key_of
from course_lib.tools.sources import GraphSource
from tests.patience import PATIENCE
from tests.ros.zenoh.conftest import Kits, Routers
from tests.ros.zenoh.test_two_kits import (
    BEST_EFFORT,
    LATCHED,
    MOVING,
    STRING,
    connect,
    listener,
    say,
    speeds,
    talker,
    texts,
    topics,
)

RESTARTS = 3
A_MESSAGES_WAY = 20.0  # what the fastest message of a machine under load may take [s]


@pytest.fixture
def routers() -> Iterator[Routers]:
    routers = Routers()
    yield routers
    routers.kill()


def ends_with_the_map(heard: list[bytes]) -> bool:
    return texts(heard)[-1:] == ["the map"]


def test_a_link_comes_back_with_the_router_again_and_again(routers: Routers) -> None:
    kits = Kits(f"tcp/127.0.0.1:{routers.port}")
    robot, student = kits.join(send="/chatter /map"), kits.join()
    out, heard = talker(robot, "/chatter"), listener(student, "/chatter")
    held = talker(robot, "/map", qos=LATCHED)
    say(robot, held, "the map")
    early = listener(student, "/map", qos=LATCHED)
    connect(kits, robot, out, heard, String())
    kits.until(lambda: early, "the latched message")
    for _ in range(RESTARTS):
        routers.kill()
        kits.until(lambda: sum("is lost" in line for line in kits.lines) == 2, "both lines on the loss")
        kits.until(lambda: not student.about_link()[2][1], "the end of the robot's nodes")
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
from course_lib.ros.qos import Qos
from course_lib.ros.zenoh.connect import RobotAddress, link_to

graph = link_to(RobotAddress(sys.argv[1], send=["/cmd_vel"]))
node = graph.add_node("x", "/")
graph.add_subscription(node, 0, "/a", "std_msgs/msg/String", Qos(), lambda *_: None)
graph.add_publisher(node, "/cmd_vel", "geometry_msgs/msg/Twist", Qos())
print("up", flush=True)
sys.stdin.readline()
sys.exit(3)
"""


@pytest.mark.parametrize("killed", [False, True])
def test_the_interpreter_exits_though_the_link_was_not_closed(routers: Routers, killed: bool) -> None:
    command = [sys.executable, "-c", LINKED, f"127.0.0.1:{routers.port}"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as linked:
        assert linked.stdout is not None
        assert linked.stdout.readline() == "up\n"
        if killed:
            routers.kill()
        linked.communicate("\n", timeout=PATIENCE)
    assert linked.returncode == 3


def packet(sequence: int, size: int = 10, late_ns: int = 0, gid: bytes = b"") -> Packet:
    now_ns = wall.time_ns()
    return Packet(bytes(size), sequence, now_ns - late_ns, gid, now_ns)


def test_a_busy_kernel_keeps_the_newest_messages_of_a_topic_only(kits: Kits) -> None:
    student, taken = kits.join(), list[Packet]()
    inbox = Inbox(student.link.arrived, taken.append)
    for sequence in range(1, 10 * MAX_MESSAGES + 1):
        inbox.put(packet(sequence))
    kits.until(lambda: len(taken) == MAX_MESSAGES, "the newest")
    assert taken[-1].sequence == 10 * MAX_MESSAGES
    assert inbox.dropped == 9 * MAX_MESSAGES
    for sequence in range(10):
        inbox.put(packet(sequence, MAX_BYTES // 4))
    taken.clear()
    kits.until(lambda: len(taken) == 4, "the newest of the large ones")
    assert student.link.arrived.empty()


def test_messages_that_were_lost_are_counted_by_the_gaps_in_their_numbers() -> None:
    traffic = Traffic()
    for sequence in (3, 4, 7, 8):
        traffic.note(packet(sequence, gid=b"a"))
    traffic.note(packet(100, gid=b"b"))
    traffic.forget_sequences()
    traffic.note(packet(50, gid=b"a"))
    assert (traffic.heard, traffic.lost) == (6, 2)


def test_a_link_that_is_too_slow_is_named_with_its_rate(kits: Kits) -> None:
    student = kits.join()
    ear = Ear("/image", Inbox(student.link.arrived, lambda _: None), Declared(student.link), 0)
    for sequence in range(0, 120, 2):
        ear.inbox.put(packet(sequence, 1000))
    assert ear.complaint().startswith("/image: 50% of the messages are lost on the way, ")
    assert "lost on the way" in str(ear.row()[1])


def test_latched_messages_are_counted_but_have_no_rate(kits: Kits) -> None:
    ear = Ear("/map", Inbox(kits.join().link.arrived, lambda _: None), Declared(kits.graphs[0].link), 1)
    for sequence in range(2):
        ear.inbox.put(packet(sequence))
    assert ear.row() == ("/map", "latched, 2 messages heard")


@pytest.mark.parametrize("skew", [-200.0, 300.0])
def test_a_clock_that_differs_is_measured_and_told(kits: Kits, skew: float) -> None:
    student = kits.join()
    listener(student, "/chatter")
    with open_session(kits.address) as robot:
        out = robot.declare_publisher(key_of(0, "/chatter", STRING, type_hash(STRING)))

        def told() -> bool:
            extra = attachment(1, bytes(16), wall.time_ns() + int(skew * 1e9))
            out.put(serialize(String()), attachment=extra)
            return any("clock" in line for line in kits.lines)

        kits.until(told, "the line")
    (line,) = [line for line in kits.lines if "clock" in line]
    rounded = float(line.split(" is ")[1].split(" s ")[0])
    assert rounded == pytest.approx(abs(skew), abs=A_MESSAGES_WAY)
    assert line == about_clock(copysign(rounded, skew))
    in_table = str(dict(student.about_link())["robot's clock"])
    assert float(in_table.split(" s ")[0]) == pytest.approx(skew, abs=A_MESSAGES_WAY)


def test_a_flood_leaves_timers_in_time(kits: Kits) -> None:
    robot, student = kits.join(send="/flood"), kits.join()
    out, heard = talker(robot, "/flood"), listener(student, "/flood")
    connect(kits, robot, out, heard, String())
    fired: list[int] = []
    student.call_at(student.now_ns, lambda: fired.append(student.now_ns), node=0, entity=0)
    for _ in range(1000):
        robot.publish(out, serialize(String(data="x" * 1000)))
    kits.until(lambda: fired, "the timer")


def test_a_stop_that_was_due_without_a_link_is_sent_when_it_is_back(routers: Routers) -> None:
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
        due = wall.monotonic() + 2 * STALE
        kits.until(lambda due=due: wall.monotonic() > due, "the time of the stop")  # type: ignore[misc]
        assert speeds(heard, Twist) == [0.2]
        routers.start()
        kits.until(lambda: len(heard) > 1, "the stop once the link is back")
        assert speeds(heard, Twist) == [0.2, 0.0]
    for graph in tuple(kits.graphs):
        kits.leave(graph)


@pytest.fixture
def driven(routers: Routers) -> Iterator[tuple[Kits, RobotGraph, int, list[bytes]]]:
    """Drive a robot, then kill the router; return the driver, its publisher, what the robot heard."""
    kits = Kits(f"tcp/127.0.0.1:{routers.port}")
    robot, student = kits.join(), kits.join(send="/cmd_vel")
    heard = listener(robot, "/cmd_vel", type_name(Twist))
    drive = talker(student, "/cmd_vel", type_name(Twist))
    connect(kits, student, drive, heard, Twist())
    student.publish(drive, serialize(MOVING))
    kits.until(lambda: speeds(heard, Twist), "the command")
    kits.until(lambda: student._sending._brakes[drive].owes, "the look that sees who listens")
    routers.kill()
    kits.until(lambda: not (student.link.is_up() or robot.link.is_up()), "the loss")
    heard.clear()
    yield kits, student, drive, heard
    for graph in tuple(kits.graphs):
        kits.leave(graph)


Driven = tuple[Kits, RobotGraph, int, list[bytes]]


def test_the_stop_of_a_node_that_ends_without_a_link_goes_out_before_another_nodes_command(
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


def test_an_interrupt_without_a_link_stops_the_robot_when_the_link_is_back(
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


def test_a_link_that_is_ended_while_it_is_down_sends_the_stop_when_it_is_back(
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


def test_python_ends_though_the_robot_cannot_be_stopped_and_says_so(driven: Driven) -> None:
    kits, student, _, _ = driven
    kits.graphs.remove(student)
    student.leave()
    assert not student.link.is_open
    assert kits.lines[-2:] == [STOP_IS_DUE, NO_STOP]


def test_a_silent_topic_of_the_robot_is_not_blamed_on_its_qos(kits: Kits) -> None:
    robot, student = kits.join(send="/scan"), kits.join()
    talker(robot, "/scan", qos=BEST_EFFORT)
    kits.until(lambda: "/scan" in topics(student, "pub"), "the publisher")
    with use_graph(student):
        assert "QoS" not in GraphSource(student).why_silent("/scan", Qos())
