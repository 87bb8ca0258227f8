import struct
import time

import pytest

from course_lib.gateway.gateway import MOST_KEYS
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import Permissions
from course_lib.ros.zenoh.link import ZenohLink
from tests.gateway.conftest import Classroom, hears, wait_for

TWIST = "geometry_msgs/msg/Twist"
KEY = f"cmd_vel/geometry_msgs::msg::dds_::Twist_/{type_hash(TWIST)}"
AHEAD = b"\0\1\0\0" + struct.pack("<6d", 0.2, 0, 0, 0, 0, 0)
STAND = b"\0\1\0\0" + bytes(48)


def commands(room: Classroom) -> list[tuple[str, bytes]]:
    return hears(room.robot, "0/cmd_vel/**")


@pytest.mark.slow
def test_only_the_driver_moves_the_robot_and_other_commands_are_counted(classroom: Classroom) -> None:
    ann, bob, received = (
        classroom.student(classroom.ann),
        classroom.student(classroom.bob),
        commands(classroom),
    )
    classroom.gateway.set_driver(classroom.bob)

    def drive() -> bool:
        ann.put(f"0/students/s1234/{KEY}", AHEAD + b"ann")
        bob.put(f"0/students/b_1/{KEY}", AHEAD)
        time.sleep(0.05)
        return len(received) > 5 and classroom.gateway.held["s1234"] > 5

    wait_for(drive, "Bob drives")
    assert {payload for _, payload in received} <= {AHEAD, STAND}
    assert {key for key, _ in received} == {f"0/{KEY}"}
    assert classroom.gateway.held["b_1"] == classroom.gateway.passed["s1234"] == 0


@pytest.mark.slow
def test_robot_stops_when_the_driver_changes(classroom: Classroom) -> None:
    ann, received = classroom.student(classroom.ann), commands(classroom)
    classroom.gateway.set_driver(classroom.ann)

    def drive() -> bool:
        ann.put(f"0/students/s1234/{KEY}", AHEAD)
        time.sleep(0.05)
        return len(received) > 0

    wait_for(drive, "Ann drives")
    classroom.gateway.set_driver(classroom.bob)
    wait_for(lambda: received[-1][1] == STAND, "the robot stops")
    passed = classroom.gateway.passed["s1234"]
    held = classroom.gateway.held["s1234"]
    ann.put(f"0/students/s1234/{KEY}", AHEAD)
    wait_for(lambda: classroom.gateway.held["s1234"] > held, "Ann is held back")
    assert classroom.gateway.passed["s1234"] == passed
    assert received[-1][1] == STAND


@pytest.mark.slow
def test_missing_driver_commands_stop_the_robot_once(classroom: Classroom) -> None:
    ann, received = classroom.student(classroom.ann), commands(classroom)
    classroom.gateway.set_driver(classroom.ann)

    def drive() -> bool:
        ann.put(f"0/students/s1234/{KEY}", AHEAD)
        time.sleep(0.05)
        return len(received) > 0

    wait_for(drive, "Ann drives")
    wait_for(lambda: received[-1][1] == STAND, "the robot stops")
    until_then = [*received]
    time.sleep(1.0)
    assert received == until_then


@pytest.mark.slow
def test_moving_command_with_trailing_bytes_counts_as_motion(classroom: Classroom) -> None:
    ann, received = classroom.student(classroom.ann), commands(classroom)
    classroom.gateway.set_driver(classroom.ann)
    longer = AHEAD + bytes(48)  # its last 48 bytes stand still

    def drive() -> bool:
        ann.put(f"0/students/s1234/{KEY}", longer)
        time.sleep(0.05)
        return len(received) > 0

    wait_for(drive, "Ann drives")
    wait_for(lambda: received[-1][1] == STAND, "the robot stops")


@pytest.mark.slow
def test_unknown_types_use_no_memory_and_wildcards_are_not_forwarded(classroom: Classroom) -> None:
    ann, received = classroom.student(classroom.ann), commands(classroom)
    classroom.gateway.set_driver(classroom.ann)

    def flood() -> bool:
        for key in ("**", "cmd_vel/**", "cmd_vel/*/*", "cmd_vel/odd/key"):
            ann.put(f"0/students/s1234/{key}", b"1")
        for number in range(40):
            ann.put(f"0/students/s1234/cmd_vel/a::msg::dds_::T{number}_/RIHS01_{'0' * 64}", b"1")
        time.sleep(0.05)
        return classroom.gateway.held["s1234"] >= 40 - MOST_KEYS and len(dict(received)) >= MOST_KEYS

    wait_for(flood, "the first keys arrive, the rest is held back")
    assert len(dict(received)) == MOST_KEYS
    assert all("/a::msg::dds_::T" in key for key, _ in received)


@pytest.mark.slow
def test_kit_drives_with_the_command_topic_of_the_robot_and_is_listed_on_the_page(
    classroom: Classroom,
) -> None:
    received = commands(classroom)
    classroom.gateway.set_driver(classroom.ann)
    link = ZenohLink(classroom.ann.address(classroom.place))
    node = link.node("driver", "/")
    entity = link.endpoint(node, "publisher", link.network_topic("/cmd_vel"), TWIST, Qos())
    kept = [link.announce(node), outlet := link.publisher(entity)]

    def drive() -> bool:
        outlet.put(AHEAD)
        time.sleep(0.05)
        return len(received) > 0

    wait_for(drive, "the kit drives")
    assert received[0] == (f"0/{KEY}", AHEAD)
    wait_for(lambda: "s1234" in classroom.gateway.connected_students(), "the gateway knows the kit")
    assert classroom.ann.token not in link.address
    del kept
    link.close()


@pytest.mark.slow
def test_driver_is_reported_correctly_despite_false_claims(classroom: Classroom) -> None:
    ann = classroom.student(classroom.ann)
    claims = [ann.liveliness().declare_token(f"@course/{one}/b_1/cmd_vel") for one in ("GATEWAY", "s1234")]
    classroom.gateway.set_driver(classroom.ann)
    lines: list[str] = []
    kit = RobotGraph(
        ZenohLink(classroom.bob.address(classroom.place)),
        Permissions.from_names(["/cmd_vel"], ()),
        lines.append,
    )
    node = kit.add_node("driver", "/")
    drive = kit.add_publisher(node, "/cmd_vel", TWIST, Qos())

    def told(text: str) -> bool:
        kit.publish(drive, AHEAD)
        kit.advance()
        return any(text in line for line in lines)

    wait_for(lambda: told("s1234 drives: your /cmd_vel is not passed on"), "Bob is told")
    assert ("driver", "s1234") in kit.link_report()
    classroom.gateway.set_driver(classroom.bob)
    wait_for(lambda: told("You drive now"), "Bob is told that he drives")
    classroom.gateway.set_driver(None)
    wait_for(lambda: told("Nobody drives"), "Bob is told that nobody drives")
    assert len(lines) == len({*lines})
    del claims  # until here they are there
    kit.close()
