"""A class whose gateway reaches the robot over DDS; the robot is a DDS participant of the kit."""

import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.gateway.gateway import PASSWORDS, Gateway, GatewayUser, Settings, load_users
from course_lib.ros.dds.link import DdsLink
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.robot.link import Packet
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import STALE_SECONDS, STOP_PERIOD, Permissions
from course_lib.ros.zenoh.link import ZenohLink
from tests.domains import Domains
from tests.gateway.conftest import ROSTER
from tests.gateway.test_driving import AHEAD, STAND, TWIST
from tests.patience import PATIENCE, join
from tests.ports import free_port

STRING, SET_BOOL, TRIGGER = "std_msgs/msg/String", "std_srvs/srv/SetBool", "std_srvs/srv/Trigger"
LATCHED = Qos(depth=1, durability="transient_local")
CALLED = ["/reset", "/private", "/lab/move", "/lab/secret"]
SENSOR = Qos(depth=5, reliability="best_effort")
FIRST_DOMAIN = 200
DOMAINS = Domains(FIRST_DOMAIN, count=6)


def text(content: str) -> bytes:
    """Return the CDR bytes of a String."""
    data = content.encode() + b"\0"
    # DDS pads messages to a multiple of 4 bytes.
    return b"\0\1\0\0" + len(data).to_bytes(4, "little") + data + bytes(-len(data) % 4)


class Robot:
    """A robot over DDS: a latched topic, a fast topic, a service, and a base with velocity commands."""

    def __init__(self, domain: int, base: str = TWIST, node: str = "robot") -> None:
        self.link = DdsLink("127.0.0.1", domain)
        self.commands: list[bytes] = []
        self.requests: list[bytes] = []
        self.own = self.link.node(node, "/lab")
        self._kept: list[Any] = [self.link.announce(self.own)]
        self.description = self.publisher("/robot_description", STRING, LATCHED)
        self.description.put(text("<robot/>"))
        self.scan = self.publisher("/scan", STRING, SENSOR)
        self.link.subscriber("/cmd_vel", base, Qos(), 0, self._on_command)
        base_end = self.link.endpoint(self.own, "subscription", "/cmd_vel", base, Qos())
        self._kept.append(self.link.announce(base_end))
        for name in ("/reset", "/private"):
            self.serve(name, SET_BOOL)

    def serve(self, name: str, type_name: str) -> None:
        """Offer a service, whose requests are kept and answered alike."""
        server = self.link.endpoint(self.own, "server", name, type_name, Qos())
        self._kept.append(self.link.service(server, self._on_request))

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Any:
        """Declare a publisher of the robot."""
        return self.link.publisher(self.link.endpoint(self.own, "publisher", topic, type_name, qos))

    def _on_command(self, packet: Packet) -> None:
        self.commands.append(packet.cdr)

    def _on_request(self, cdr: bytes, send_reply: Callable[[bytes], None]) -> None:
        self.requests.append(cdr)
        # success, and "done".
        send_reply(b"\0\1\0\0\1\0\0\0\5\0\0\0done\0\0\0\0")

    def turn(self) -> None:
        """Run the queued tasks of the link, and publish a scan."""
        while not self.link.actions.empty():
            self.link.actions.get_nowait()()
        self.scan.put(text("scan"))


class DdsClassroom:
    """A gateway in front of a robot over DDS, and its users. All are driven by `until`."""

    def __init__(self, folder: Path, **robot: Any) -> None:
        self.domain = DOMAINS.next()
        self.lines: list[str] = []
        self.robot = Robot(self.domain, **robot)
        place = f"tcp/127.0.0.1:{free_port()}"
        (folder / "roster.csv").write_text(ROSTER)
        self.users = load_users(folder, folder / "roster.csv", "", place)
        _, self.ann, self.bob = self.users
        self._place = place
        settings = Settings(place, "dds/127.0.0.1", ["cmd_vel"], ["reset", "lab/move"], self.domain)
        self.gateway = Gateway(settings, self.users, folder / PASSWORDS, self.lines.append)
        self.graphs: list[RobotGraph] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._look_after, daemon=True)
        self._thread.start()

    def _look_after(self) -> None:
        while not self._ended.is_set():
            self.gateway.stop(older_than=STALE_SECONDS)
            self.gateway.wait(STOP_PERIOD)

    def student(self, user: GatewayUser) -> RobotGraph:
        """Link a student's kit to the gateway."""
        link = ZenohLink(user.address(self._place), self.domain)
        self.graphs.append(RobotGraph(link, Permissions.from_names(["/cmd_vel"], CALLED), self.lines.append))
        return self.graphs[-1]

    def until(self, ready: Callable[[], object], what: str) -> None:
        """Drive the robot and the kits until `ready()`."""
        deadline = time.monotonic() + PATIENCE
        while not ready():
            assert time.monotonic() < deadline, f"not seen: {what}; {self.lines}"
            self.robot.turn()
            for graph in self.graphs:
                graph.advance()

    def close(self) -> None:
        """End the kits, the gateway and the robot."""
        for graph in self.graphs:
            graph.close()
        self._ended.set()
        join(self._thread)
        self.gateway.close()
        self.robot.link.close()


@pytest.fixture
def room(tmp_path: Path) -> Iterator[DdsClassroom]:
    classroom = DdsClassroom(tmp_path)
    yield classroom
    classroom.close()


def listen(graph: RobotGraph, topic: str, type_name: str, qos: Qos) -> list[bytes]:
    """Return a list that fills with the messages of a topic."""
    received: list[bytes] = []
    node = graph.add_node("listener", "/")
    graph.add_subscription(
        node, 0, topic, type_name, qos, lambda cdr, source_ns, received_ns: received.append(cdr)
    )
    return received


@pytest.mark.slow
def test_students_discover_nodes_endpoints_and_qos_of_the_robot(room: DdsClassroom) -> None:
    ann = room.student(room.ann)
    room.until(lambda: "/lab/robot" in {node.full_name for node in ann.nodes()}, "the robot's node")

    def ends() -> set[tuple[str, str, str, str]]:
        names = {node.id: node.full_name for node in ann.nodes()}
        return {(names[info.node], info.kind, info.topic, info.qos.reliability) for info in ann.endpoints()}

    room.until(
        lambda: (
            {
                ("/lab/robot", "pub", "/scan", "best_effort"),
                ("/lab/robot", "pub", "/robot_description", "reliable"),
                ("/lab/robot", "sub", "/cmd_vel", "reliable"),
            }
            <= ends()
        ),
        "the robot's endpoints",
    )


@pytest.mark.slow
def test_topics_are_forwarded_on_demand_and_latched_messages_to_late_subscribers(room: DdsClassroom) -> None:
    ann = room.student(room.ann)
    descriptions = listen(ann, "/robot_description", STRING, LATCHED)
    room.until(lambda: descriptions, "the latched message")
    assert not room.robot.scan.is_matched()
    scans = listen(ann, "/scan", STRING, SENSOR)
    room.until(lambda: len(scans) > 2, "scans")
    late = listen(room.student(room.bob), "/robot_description", STRING, LATCHED)
    room.until(lambda: late, "the latched message for a late-joining student")
    assert (descriptions, late) == ([text("<robot/>")],) * 2
    for graph in room.graphs:
        graph.close()
    room.graphs.clear()
    room.until(lambda: not room.robot.scan.is_matched(), "the end of the demand")


@pytest.mark.slow
def test_only_the_driver_moves_the_robot_and_it_stops_without_commands(room: DdsClassroom) -> None:
    ann, bob = room.student(room.ann), room.student(room.bob)
    drives = {}
    for graph in (ann, bob):
        drives[graph] = graph.add_publisher(graph.add_node("driver", "/"), "/cmd_vel", TWIST, Qos())
    room.gateway.set_driver(room.bob)

    def commands() -> bool:
        ann.publish(drives[ann], AHEAD + b"ann!")
        bob.publish(drives[bob], AHEAD)
        time.sleep(0.02)
        return len(room.robot.commands) > 3 and room.gateway.held["s1234"] > 3

    room.until(commands, "Bob's commands")
    # The robot also stops when this test, on a busy machine, does not publish for half a second.
    assert {AHEAD} <= set(room.robot.commands) <= {AHEAD, STAND}
    room.until(lambda: room.robot.commands[-1] == STAND, "the stop")
    stops = list(takewhile(STAND.__eq__, reversed(room.robot.commands)))
    # One stop is the kit's, one the gateway's.
    assert 1 <= len(stops) <= 2


@pytest.mark.slow
def test_robot_stops_when_the_driver_changes_and_when_the_gateway_ends(tmp_path: Path) -> None:
    room = DdsClassroom(tmp_path)
    ann = room.student(room.ann)
    drive = ann.add_publisher(ann.add_node("driver", "/"), "/cmd_vel", TWIST, Qos())

    def moves() -> bool:
        ann.publish(drive, AHEAD)
        time.sleep(0.02)
        return room.robot.commands[-1:] == [AHEAD]

    room.gateway.set_driver(room.ann)
    room.until(moves, "Ann's commands")
    room.gateway.set_driver(None)
    room.until(lambda: room.robot.commands[-1] == STAND, "the stop at the change")
    room.gateway.set_driver(room.ann)
    room.until(moves, "Ann's commands again")
    room.close()
    assert room.robot.commands[-1] == STAND


@pytest.mark.slow
def test_only_allowed_services_can_be_called(room: DdsClassroom) -> None:
    ann = room.student(room.ann)
    node = ann.link.node("caller", "/")
    replies: list[bytes | None] = []
    kept = [ann.link.announce(node)]
    for name in ("/private", "/reset"):
        client = ann.link.client(ann.link.endpoint(node, "client", name, SET_BOOL, Qos()))
        kept.append(client)
        request = b"\0\1\0\0" + (b"\1" if name == "/reset" else b"\0")
        room.until(partial(_is_service, ann, name), name)
        client.call(request, replies.append)
    room.until(lambda: any(replies), "the reply of the allowed service")
    assert [reply for reply in replies if reply] == [b"\0\1\0\0\1\0\0\0\5\0\0\0done\0\0\0\0"]
    assert room.robot.requests == [b"\0\1\0\0\1\0\0\0"]
    del kept


def test_only_services_of_allowed_actions_can_be_called(room: DdsClassroom) -> None:
    names = {
        "send_goal": "example_interfaces/action/Fibonacci_SendGoal",
        "cancel_goal": "action_msgs/srv/CancelGoal",
        "get_result": "example_interfaces/action/Fibonacci_GetResult",
    }
    ann = room.student(room.ann)
    node = ann.link.node("caller", "/")
    kept: list[Any] = [ann.link.announce(node)]
    replies: dict[str, list[bytes | None]] = {"/lab/secret": [], "/lab/move": []}
    for action, received in replies.items():
        for number, (name, type_name) in enumerate(names.items()):
            full_name = f"{action}/_action/{name}"
            room.robot.serve(full_name, type_name)
            room.until(partial(_is_service, ann, full_name), full_name)
            client = ann.link.client(ann.link.endpoint(node, "client", full_name, type_name, Qos()))
            kept.append(client)
            client.call(b"\0\1\0\0" + bytes([number, action == "/lab/move", 0, 0]), received.append)
    room.until(lambda: len([one for one in replies["/lab/move"] if one]) == 3, "the replies of the action")
    assert not any(replies["/lab/secret"])
    assert sorted(room.robot.requests) == [b"\0\1\0\0" + bytes([number, 1, 0, 0]) for number in range(3)]
    del kept


def _is_service(graph: RobotGraph, name: str) -> bool:
    return name in {info.service[0] for info in graph.endpoints() if info.service is not None}


@pytest.mark.slow
def test_commands_with_a_wrong_type_are_not_forwarded_and_reported(tmp_path: Path) -> None:
    room = DdsClassroom(tmp_path, base="geometry_msgs/msg/TwistStamped")
    ann = room.student(room.ann)
    drive = ann.add_publisher(ann.add_node("driver", "/"), "/cmd_vel", TWIST, Qos())
    room.gateway.set_driver(room.ann)

    def is_reported() -> bool:
        ann.publish(drive, AHEAD)
        return any("the robot takes geometry_msgs/msg/TwistStamped there" in line for line in room.lines)

    room.until(is_reported, "a line about the type")
    assert room.robot.commands == []
    room.close()


@pytest.mark.slow
def test_restarted_robot_is_discovered_and_driven_again(room: DdsClassroom) -> None:
    ann = room.student(room.ann)
    scans = listen(ann, "/scan", STRING, SENSOR)
    drive = ann.add_publisher(ann.add_node("driver", "/"), "/cmd_vel", TWIST, Qos())
    room.gateway.set_driver(room.ann)
    for _ in range(2):
        room.until(lambda: scans, "scans")
        room.robot.link.close()
        room.until(lambda: "/lab/robot" not in {node.full_name for node in ann.nodes()}, "the end")
        room.robot = Robot(room.domain)
        scans.clear()

    def drives() -> bool:
        ann.publish(drive, AHEAD)
        time.sleep(0.02)
        return AHEAD in room.robot.commands

    room.until(lambda: scans, "scans of the new robot")
    room.until(drives, "commands to the new robot")


@pytest.mark.slow
def test_names_invalid_in_zenoh_are_not_forwarded(room: DdsClassroom) -> None:
    ann = room.student(room.ann)
    for topic in ("/a*b", "/a$*", "/a/**/b", "/é", "/x#y"):
        room.robot.publisher(topic, STRING, Qos())
    room.robot.publisher("/last", STRING, Qos())
    room.until(lambda: "/last" in {info.topic for info in ann.endpoints()}, "the topic that is valid")
    assert not {info.topic for info in ann.endpoints()} & {"/a*b", "/a$*", "/a/**/b", "/é", "/x#y"}


@pytest.mark.slow
def test_messages_with_types_unknown_to_the_gateway_are_forwarded(room: DdsClassroom) -> None:
    link = room.robot.link
    custom = "lab_msgs/msg/Secret"
    entity = link.endpoint(room.robot.own, "publisher", "/secret", custom, LATCHED, f"RIHS01_{'7' * 64}")
    link.publisher(entity).put(b"\0\1\0\0\7")
    ann = room.student(room.ann)
    room.until(lambda: "/secret" in {info.topic for info in ann.endpoints()}, "the topic")


@pytest.mark.parametrize(
    "address", ["dds/", "dds/a b", "DDS/10.88.0.1", "dds:/lab", "dds/no-such-host.invalid"]
)
def test_address_without_a_robot_is_an_error(tmp_path: Path, address: str) -> None:
    users = load_users(tmp_path, None, "", "tcp/127.0.0.1:1")
    settings = Settings(f"tcp/127.0.0.1:{free_port()}", address)
    with pytest.raises(CourseError, match=r"not an address of a robot|There is no computer"):
        Gateway(settings, users, tmp_path / PASSWORDS, print)


@pytest.mark.slow
def test_type_hash_of_a_command_is_compared_with_the_robot_type_hash(room: DdsClassroom) -> None:
    room.until(lambda: room.gateway.is_robot_connected(), "the robot")
    assert room.gateway._bridge is not None
    bridge = room.gateway._bridge
    room.until(lambda: bridge.is_command("/cmd_vel", TWIST, type_hash(TWIST)), "the robot's subscription")
    assert not bridge.is_command("/cmd_vel", TWIST, f"RIHS01_{'0' * 64}")
    assert any("another definition of geometry_msgs/msg/Twist" in line for line in room.lines)


@pytest.mark.slow
def test_unresponsive_address_is_reported_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.gateway.dds_bridge.SILENT_SECONDS", 0.2)
    users = load_users(tmp_path, None, "", "tcp/127.0.0.1:1")
    lines: list[str] = []
    # Nothing uses this address of the loopback network.
    settings = Settings(f"tcp/127.0.0.1:{free_port()}", "dds/127.77.0.9", domain=FIRST_DOMAIN - 1)
    gateway = Gateway(settings, users, tmp_path / PASSWORDS, lines.append)
    deadline = time.monotonic() + PATIENCE
    while not lines:
        assert time.monotonic() < deadline
        gateway.wait(STOP_PERIOD)
    quiet_until = time.monotonic() + 1.0
    while time.monotonic() < quiet_until:
        gateway.wait(STOP_PERIOD)
    gateway.close()
    assert len(lines) == 1
    assert lines[0].startswith(f"Nothing comes from dds/127.77.0.9 in domain {FIRST_DOMAIN - 1}.")
