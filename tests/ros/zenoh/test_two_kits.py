from collections.abc import Callable
from dataclasses import replace
from itertools import dropwhile
from typing import Any

import pytest
import zenoh
from geometry_msgs.msg import Twist, TwistStamped
from std_msgs.msg import String
from std_srvs.srv import Trigger

from course_lib.ros.graph.topics import SERVICE_HEADER, Qos
from course_lib.ros.messages import deserialize, serialize, type_name
from course_lib.ros.robot import robot_graph
from course_lib.ros.robot.link import second_driver_warning
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import STALE_SECONDS, BlockedTraffic, Permissions
from course_lib.ros.time import wall
from course_lib.ros.zenoh.link import open_session
from tests.ros.zenoh.conftest import Kits, zenoh_link

STRING, CLOCK = "std_msgs/msg/String", "rosgraph_msgs/msg/Clock"
VOLATILE, LATCHED = Qos(), Qos(depth=1, durability="transient_local")
BEST_EFFORT = Qos(reliability="best_effort")
TWIST = "geometry_msgs/msg/Twist"
MOVING = Twist()
MOVING.linear.x = 0.2


def talker(graph: RobotGraph, topic: str, kind: str = STRING, qos: Qos = VOLATILE) -> int:
    return graph.add_publisher(graph.add_node("talker", "/"), topic, kind, qos)


def listener(graph: RobotGraph, topic: str, kind: str = STRING, qos: Qos = VOLATILE) -> list[bytes]:
    heard: list[bytes] = []
    node = graph.add_node("listener", "/")
    graph.add_subscription(node, 0, topic, kind, qos, lambda cdr, *_: heard.append(cdr))
    return heard


def topics(graph: RobotGraph, kind: str) -> list[str]:
    return [info.topic for info in graph.endpoints() if info.kind == kind]


def texts(heard: list[bytes]) -> list[str]:
    return [deserialize(cdr, String).data for cdr in heard]


def say(graph: RobotGraph, endpoint: int, text: str) -> None:
    graph.publish(endpoint, serialize(String(data=text)))


def connect(
    kits: Kits,
    graph: RobotGraph,
    endpoint: int,
    heard: list[Any],
    message: Any,
    ready: Callable[[], bool] = lambda: False,
) -> None:
    """Publish until messages arrive, because Zenoh may lose messages before its routes exist."""

    def published() -> bool:
        graph.publish(endpoint, serialize(message))
        return bool(heard) or ready()

    kits.until(published, "a first message")


def test_message_reaches_the_other_kit_once_and_is_not_returned(kits: Kits) -> None:
    robot, student = kits.join(send="chatter"), kits.join()
    out, here, there = talker(robot, "/chatter"), listener(robot, "/chatter"), listener(student, "/chatter")
    connect(kits, robot, out, there, String())
    for text in ("one", "two"):
        say(robot, out, text)
    kits.until(lambda: "two" in texts(there) and "two" in texts(here), "two messages")
    assert list(filter(None, texts(there))) == list(filter(None, texts(here))) == ["one", "two"]


def test_messages_to_remote_subscriptions_do_not_wait_while_a_program_publishes(kits: Kits) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    student.tap(lambda sample: None, lambda: {"/chatter"})
    out = talker(robot, "/chatter")
    kits.until(lambda: "/chatter" in topics(robot, "sub"), "the student's subscription")
    for number in range(100):
        say(robot, out, str(number))
    assert robot.pending == 0
    assert robot.count_stored_bytes() == 0


def test_remote_nodes_and_endpoints_are_listed_until_they_leave(kits: Kits) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    talker(robot, "/chatter", qos=BEST_EFFORT)
    listener(robot, "/orders")
    kits.until(lambda: {"/chatter", "/orders"} <= {e.topic for e in student.endpoints()}, "the robot")
    assert {node.full_name for node in student.nodes()} == {"/talker", "/listener"}
    offered = next(e.qos for e in student.endpoints() if e.topic == "/chatter")
    assert replace(offered, history="keep_last") == BEST_EFFORT  # over DDS no history is announced
    kits.leave(robot)
    kits.until(lambda: not student.nodes() and not student.endpoints(), "its end")


@pytest.mark.parametrize("late", [True, False])
def test_latched_messages_reach_early_and_late_joining_subscriptions(kits: Kits, late: bool) -> None:
    robot, student = kits.join(send="/robot_description"), kits.join()
    heard = [] if late else listener(student, "/robot_description", qos=LATCHED)
    out = talker(robot, "/robot_description", qos=LATCHED)
    for text in ("old", "new"):
        say(robot, out, text)
    if late:
        kits.until(lambda: "/robot_description" in topics(student, "pub"), "the robot")
        heard = listener(student, "/robot_description", qos=LATCHED)
    kits.until(lambda: texts(heard)[-1:] == ["new"], "the latched message")
    again = listener(student, "/robot_description", qos=LATCHED)  # the topic is listened to already
    kits.until(lambda: texts(again)[-1:] == ["new"], "the latched message once more")


KEEP_ALL = Qos(history="keep_all", depth=0, durability="transient_local")


@pytest.mark.parametrize(
    ("offered", "requested", "expected"),
    [
        (replace(LATCHED, depth=5), replace(LATCHED, depth=1), "7"),
        (replace(LATCHED, depth=5), replace(LATCHED, depth=3), "567"),
        (replace(LATCHED, depth=5), replace(LATCHED, depth=10), "34567"),
        (replace(LATCHED, depth=5), KEEP_ALL, "34567"),
        (KEEP_ALL, KEEP_ALL, "01234567"),
    ],
)
def test_late_joining_subscription_receives_latched_messages_up_to_its_depth(
    kits: Kits, offered: Qos, requested: Qos, expected: str
) -> None:
    robot, student = kits.join(send="/latched"), kits.join()
    out = talker(robot, "/latched", qos=offered)
    for number in range(8):
        say(robot, out, str(number))
    kits.until(lambda: "/latched" in topics(student, "pub"), "the robot")
    heard = listener(student, "/latched", qos=requested)
    kits.until(lambda: texts(heard)[-1:] == ["7"], "the latched messages")
    assert "".join(texts(heard)) == expected


@pytest.mark.slow
def test_topic_is_subscribed_only_while_it_has_a_listener(kits: Kits) -> None:
    robot, student = kits.join(send="/chatter"), kits.join()
    out = talker(robot, "/chatter")
    samples: list[Any] = []
    kits.until(lambda: "/chatter" in topics(student, "pub"), "the robot")
    say(robot, out, "to nobody")
    wanted = set[str]()
    end = student.tap(samples.append, lambda: wanted)
    assert "/chatter" not in topics(robot, "sub")
    wanted.add("/chatter")
    kits.until(lambda: "/chatter" in topics(robot, "sub"), "the display's subscription")
    connect(kits, robot, out, samples, String(data="to the display"))
    assert texts([sample.cdr for sample in samples])[0] == "to the display"
    end()
    kits.until(lambda: "/chatter" not in topics(robot, "sub"), "its end")


def test_messages_that_are_not_allowed_are_counted_and_reported_once_instead_of_forwarded(kits: Kits) -> None:
    robot, student = kits.join(), kits.join(send="/allowed")
    heard = listener(robot, "/cmd_vel", type_name(Twist)), listener(robot, "/allowed")
    held, allowed = talker(student, "/cmd_vel", type_name(Twist)), talker(student, "/allowed")
    kits.until(lambda: "/allowed" in topics(robot, "pub"), "the allowed one")
    for _ in range(3):
        student.publish(held, serialize(MOVING))
    connect(kits, student, allowed, heard[1], String())
    assert heard[0] == []
    assert "/cmd_vel" not in topics(robot, "pub")
    assert student.blocked.counts == {"/cmd_vel": 3}
    assert [line for line in kits.lines if "/cmd_vel" in line] == [
        "Messages on /cmd_vel are not sent: the link does not allow it. "
        "To send them, connect with --send /cmd_vel"
    ]


def speeds(heard: list[bytes], kind: Any) -> list[float]:
    """Return the speeds ahead from the first one that moves."""
    commands = [deserialize(cdr, kind) for cdr in heard]
    return list(dropwhile(lambda x: x == 0.0, (getattr(one, "twist", one).linear.x for one in commands)))


@pytest.mark.parametrize("kit_is_first", [False, True])
def test_second_node_that_drives_the_robot_is_reported_once(kits: Kits, kit_is_first: bool) -> None:
    robot, student = kits.join(send="/cmd_vel"), kits.join(send="/cmd_vel")

    def second_driver_lines() -> list[str]:
        return [line for line in kits.lines if "can drive the robot as well" in line]

    drivers = (student, robot) if kit_is_first else (robot, student)
    talker(drivers[0], "/cmd_vel", TWIST)
    kits.until(lambda: "/cmd_vel" in topics(drivers[1], "pub"), "the first driver")
    # A node that only shows what the robot does is not warned.
    assert not second_driver_lines()
    talker(drivers[1], "/cmd_vel", TWIST)
    # Both kits are drivers, so each of them reports the other one.
    kits.until(lambda: len(second_driver_lines()) == 2, "the lines")
    assert second_driver_lines() == [second_driver_warning("/cmd_vel", "/talker")] * 2
    talker(robot, "/cmd_vel", TWIST)
    kits.until(lambda: topics(student, "pub").count("/cmd_vel") == 3, "a third publisher")
    assert len(second_driver_lines()) == 2


@pytest.mark.parametrize("kind", [Twist, TwistStamped])
def test_robot_stops_when_its_commands_stop(kits: Kits, kind: Any) -> None:
    robot, student = kits.join(), kits.join(send="/cmd_vel")
    heard = listener(robot, "/cmd_vel", type_name(kind))
    drive = talker(student, "/cmd_vel", type_name(kind))
    connect(kits, student, drive, heard, kind())
    since = wall.monotonic()
    student.publish(drive, serialize(MOVING if kind is Twist else TwistStamped(twist=MOVING)))
    kits.graphs.remove(student)  # its kernel is busy, and drives nothing any more
    kits.until(lambda: speeds(heard, kind) == [0.2, 0.0], "the command and the stop")
    assert wall.monotonic() - since >= STALE_SECONDS
    kits.graphs.append(student)


def test_robot_stops_when_the_link_is_closed_or_interrupted(kits: Kits) -> None:
    robot, student = kits.join(), kits.join(send="/cmd_vel")
    heard = listener(robot, "/cmd_vel", type_name(Twist))
    drive = talker(student, "/cmd_vel", type_name(Twist))
    connect(kits, student, drive, heard, Twist())

    def interrupt() -> None:
        raise KeyboardInterrupt

    student.publish(drive, serialize(MOVING))
    student.call_at(student.now_ns, interrupt, node=0, entity=0)
    with pytest.raises(KeyboardInterrupt):
        kits.until(lambda: False, "the interrupt")
    kits.until(lambda: speeds(heard, Twist) == [0.2, 0.0], "the stop at the interrupt")
    student.publish(drive, serialize(MOVING))
    kits.leave(student)
    kits.until(lambda: speeds(heard, Twist) == [0.2, 0.0, 0.2, 0.0], "the stop at the end")


def serve(graph: RobotGraph, name: str) -> list[bytes]:
    """Offer a Trigger whose answer is "done"."""
    node, asked = graph.add_node("server", "/"), list[bytes]()
    request, response = type_name(Trigger.Request), type_name(Trigger.Response)
    reply = graph.add_publisher(node, f"rr{name}Reply", response, VOLATILE)

    def answer(data: bytes, *_: int) -> None:
        asked.append(data[SERVICE_HEADER.size :])
        header = data[: SERVICE_HEADER.size]
        graph.publish(reply, header + serialize(Trigger.Response(success=True, message="done")))

    graph.add_subscription(node, 0, f"rq{name}Request", request, VOLATILE, answer)
    return asked


def client(graph: RobotGraph, name: str) -> tuple[int, list[bytes]]:
    """Return a client's endpoint and its received responses."""
    node, heard = graph.add_node("client", "/"), list[bytes]()
    request, response = type_name(Trigger.Request), type_name(Trigger.Response)
    ask = graph.add_publisher(node, f"rq{name}Request", request, VOLATILE)
    graph.add_subscription(node, 0, f"rr{name}Reply", response, VOLATILE, lambda data, *_: heard.append(data))
    return ask, heard


def call(graph: RobotGraph, ask: int, number: int) -> None:
    graph.publish(ask, SERVICE_HEADER.pack(ask, number) + serialize(Trigger.Request()))


def test_service_is_called_over_the_link(kits: Kits) -> None:
    robot, student = kits.join(call="/reset"), kits.join(call="reset")
    serve(robot, "/reset")
    ask, heard = client(student, "/reset")
    kits.until(lambda: any(e.is_service for e in student.endpoints()), "the service")
    call(student, ask, 7)
    kits.until(lambda: heard, "the response")
    assert SERVICE_HEADER.unpack_from(heard[0]) == (ask, 7)
    assert deserialize(heard[0][SERVICE_HEADER.size :], Trigger.Response).message == "done"
    kits.until(lambda: "rq/resetRequest" in topics(robot, "pub"), "the client in the robot's list")


def test_blocked_parts_of_an_action_are_reported_with_the_option_that_allows_it() -> None:
    lines: list[str] = []
    blocked = BlockedTraffic(lines.append)
    blocked.add("/arm/fib/_action/send_goal", "--call")
    blocked.add("/arm/fib/_action/get_result", "--call")
    blocked.add("/arm/fib/_action/status", "--send")
    assert lines == [
        "Calls of /arm/fib are not sent: the link does not allow it. "
        "To send them, connect with --call /arm/fib"
    ]
    allowed = Permissions.from_names((), ["/arm/fib"])
    assert allowed.is_service_allowed("/arm/fib/_action/send_goal")
    assert allowed.is_topic_allowed("/arm/fib/_action/status")


def test_services_that_are_not_offered_are_reported_once_except_the_services_of_every_node() -> None:
    lines: list[str] = []
    blocked = BlockedTraffic(lines.append, notebook=True)
    for _ in range(2):
        blocked.add_service("/reset", "std_srvs/srv/Trigger")
        blocked.add_service("/arm/fib/_action/send_goal", "example_interfaces/action/Fibonacci_SendGoal")
        blocked.add_service("/arm/fib/_action/get_result", "example_interfaces/action/Fibonacci_GetResult")
        blocked.add_service("/arm/set_parameters", "rcl_interfaces/srv/SetParameters")
    assert lines == [
        "The service /reset is not offered to the robot: the link does not allow it. "
        'To offer it, connect with --call /reset or call=["/reset"]',
        "The action /arm/fib is not offered to the robot: the link does not allow it. "
        'To offer it, connect with --call /arm/fib or call=["/arm/fib"]',
    ]


def test_service_calls_that_are_not_allowed_are_not_forwarded(kits: Kits) -> None:
    robot, student = kits.join(call="/reset"), kits.join()
    asked = serve(robot, "/reset")
    ask, heard = client(student, "/reset")
    kits.until(lambda: any(e.is_service for e in student.endpoints()), "the service")
    call(student, ask, 1)
    kits.until(lambda: kits.lines, "the line")
    assert kits.lines == [
        "Calls of /reset are not sent: the link does not allow it. To send them, connect with --call /reset"
    ]
    assert (asked, heard) == ([], [])
    # `ros2 service call` ends with this reason, and waits for its own calls only.
    assert (student.take_blocked_calls(), student.take_blocked_calls()) == (["/reset"], [])


def test_service_is_not_offered_unless_it_is_allowed(kits: Kits) -> None:
    robot, student = kits.join(), kits.join(call="/other")
    serve(student, "/reset")
    serve(student, "/other")
    kits.until(lambda: any(e.is_service for e in robot.endpoints()), "the service")
    assert {e.service for e in robot.endpoints() if e.is_service} == {("/other", "std_srvs/srv/Trigger")}
    assert kits.lines == [
        "The service /reset is not offered to the robot: the link does not allow it. "
        "To offer it, connect with --call /reset"
    ]


def test_qos_incompatible_in_dds_is_delivered_and_reported(kits: Kits) -> None:
    robot, student = kits.join(send="/scan"), kits.join()
    out, heard = talker(robot, "/scan", qos=BEST_EFFORT), listener(student, "/scan")
    connect(kits, robot, out, heard, String())
    assert (
        "/scan: the publisher of /talker and the subscription of /listener have incompatible QoS "
        "(RELIABILITY). Zenoh delivers all the same; "
        "on a robot with DDS the topic would be silent." in kits.lines
    )


def test_nodes_of_another_domain_are_not_discovered_but_their_domain_is_listed(kits: Kits) -> None:
    robot, student = kits.join(domain=42, send="/chatter"), kits.join()
    talker(robot, "/chatter")
    listener(student, "/chatter")
    kits.until(lambda: zenoh_link(student).domains() == [0, 42], "both domains")
    assert topics(student, "pub") == []


@pytest.mark.parametrize(
    ("type_hash", "line"),
    [
        ("TypeHashNotSupported", "The robot runs ROS 2 Humble"),
        (
            f"RIHS01_{'0' * 64}",
            "another definition of std_msgs/msg/String than this kit, so /chatter stays",
        ),
    ],
)
def test_type_with_an_unsupported_or_different_hash_is_reported(
    kits: Kits, type_hash: str, line: str
) -> None:
    student = kits.join()
    with open_session(kits.address) as robot:
        token = (
            f"@ros2_lv/0/{robot.zid()}/0/1/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/{type_hash}"
        )
        with robot.liveliness().declare_token(f"{token}/::,10:,:,:,,"):
            kits.until(lambda: kits.lines and student.endpoints(), "the line")
    assert line in kits.lines[0]


def test_simulated_time_of_the_robot_is_reported(kits: Kits) -> None:
    robot = kits.join(send="/clock")
    talker(robot, "/clock", CLOCK)
    kits.join()
    kits.until(lambda: any("its time is simulated" in line for line in kits.lines), "the line")


@pytest.mark.parametrize("follower", ["node", "view"])
def test_simulated_time_is_not_reported_if_it_is_followed(
    kits: Kits, follower: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robot_graph, "CLOCK_SECONDS", 0.0)
    robot, student = kits.join(send="/clock"), kits.join()
    if follower == "node":
        listener(student, "/clock", CLOCK)
    else:
        student.tap(lambda sample: None, lambda: {"/clock"})
    talker(robot, "/clock", CLOCK)
    polled: list[int] = []
    monkeypatch.setattr(student, "_watch_link", lambda: polled.append(1))
    kits.until(lambda: "/clock" in topics(student, "pub"), "the clock")
    polled.clear()
    kits.until(lambda: len(polled) > 1, "two polls")
    assert not any("its time is simulated" in line for line in kits.lines)


def test_attachment_of_an_older_rmw_zenoh_is_reported(kits: Kits) -> None:
    student = kits.join()
    heard = listener(student, "/chatter")
    key = "0/chatter/std_msgs::msg::dds_::String_/"
    key += "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    with open_session(kits.address) as robot:
        out = robot.declare_publisher(key, congestion_control=zenoh.CongestionControl.BLOCK)
        kits.until(lambda: out.put(b"x", attachment=bytes(49)) or kits.lines, "the line")
    assert "an rmw_zenoh before 0.2.4" in kits.lines[0]
    assert heard == []
