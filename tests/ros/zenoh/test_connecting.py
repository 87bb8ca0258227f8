import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from rclpy.task import Future

from course_lib import Viewer, connect, disconnect
from course_lib.errors import CourseError
from course_lib.recording import read_bag
from course_lib.ros.graph.graph import Graph, current_graph, use_graph
from course_lib.ros.robot import connect as connecting
from course_lib.ros.robot.connect import RobotAddress, link_to
from course_lib.ros.robot.sending import BlockedTraffic
from course_lib.ros.zenoh.link import Handlers, open_session
from course_lib.tools.ros2 import ros2
from course_lib.tools.run import run
from course_lib.tools.sources import GraphSource, wait_for_response
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import Program
from tests.ros.dds.attack import ATTACK, ATTEMPTS
from tests.ros.zenoh.conftest import Kits
from tests.ros.zenoh.test_two_kits import listener, serve, talker, texts

TALKER = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chatter", 10)
node.create_timer(0.1, lambda: publisher.publish(String(data="hello")))
print("up", flush=True)
rclpy.spin(node)
"""
BEST_EFFORT_TALKER = """
import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chatter", qos_profile_sensor_data)
while not publisher.get_subscription_count():
    rclpy.spin_once(node, timeout_sec=0.1)
print("heard by", publisher.get_subscription_count())
"""
LISTENER = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("listener")
heard = []
node.create_subscription(String, "chatter", heard.append, 10)
while not heard:
    rclpy.spin_once(node)
"""


def course(*words: str) -> Program:
    command = [sys.executable, "-m", "course_lib", *words]
    return Program(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


@pytest.mark.slow
def test_programs_and_tools_connect_through_a_router(router: str, tmp_path: Path) -> None:
    (tmp_path / "talker.py").write_text(TALKER)
    (tmp_path / "listener.py").write_text(LISTENER)
    robot = course("run", str(tmp_path / "talker.py"), "--robot", router, "--send", "/chatter")
    assert robot.read_line() == "up\n"
    tool = course("ros2", "--robot", router.removeprefix("tcp/"), "topic", "echo", "--once", "/chatter")
    assert tool.communicate(timeout=PATIENCE) == ("data: hello\n---\n", "")
    code = run(
        [tmp_path / "listener.py"],
        seconds=None,
        seed=0,
        bag=tmp_path / "bag",
        args=(),
        real_time=False,
        robot=RobotAddress(router),
    )
    assert code == 0
    assert {topic.name for topic in read_bag(tmp_path / "bag").topics()} >= {"/chatter"}
    robot.send_signal(signal.SIGINT)
    robot.communicate(timeout=PATIENCE)


@pytest.mark.slow
def test_thousand_attempts_to_send_unpermitted_messages_do_not_reach_the_network(
    kits: Kits, tmp_path: Path
) -> None:
    (tmp_path / "attack.py").write_text(ATTACK)
    robot, session, handlers = kits.join(call="/reset /private"), open_session(kits.address), Handlers()
    for service in ("/reset", "/private"):
        serve(robot, service)
    keys, said = set[str](), listener(robot, "/allowed")
    everything = [
        declare("0/**", handlers.wrap(lambda received: keys.add(str(received.key_expr).split("/")[1])))
        for declare in (session.declare_subscriber, session.declare_queryable)
    ]
    attack = course("run", str(tmp_path / "attack.py"), "--robot", kits.address, "--send", "/allowed")
    # The program's last message is permitted and contains the number of attempts.
    kits.until(lambda: any(text.endswith("attempts") for text in texts(said)), "the number of attempts")
    attack.send_signal(signal.SIGINT)
    attack.communicate(timeout=PATIENCE)
    assert int(texts(said)[-1].split()[0]) >= ATTEMPTS
    assert (keys, len(everything)) == ({"allowed"}, 2)
    session.close()
    handlers.wait()


@pytest.mark.parametrize(
    ("blocked", "server", "named"),
    [("/fib/_action/send_goal", "/fib", "/fib"), ("/lab/set_parameters", "/lab", "/lab/set_parameters")],
)
def test_error_of_a_blocked_call_names_the_service_and_the_option_that_allows_it(
    blocked: str, server: str, named: str, kits: Kits
) -> None:
    graph, future = kits.join(), Future()  # type: ignore[var-annotated]  # not generic in Jazzy
    graph.blocked.add(blocked, "--call")
    with pytest.raises(CourseError, match=f"^{named} was not called, .* connect with --call {named}$"):
        wait_for_response(GraphSource(graph), future, server, 1.0)


@pytest.mark.slow
def test_doctor_listens_briefly_and_measures_the_clock_offset_of_the_robot(
    router: str, tmp_path: Path
) -> None:
    joints = TALKER.replace("std_msgs", "sensor_msgs").replace("String(data=", "JointState(name=[")
    joints = joints.replace('"hello")', '"hello"])').replace("String", "JointState")
    (tmp_path / "joints.py").write_text(joints)
    robot = course("run", str(tmp_path / "joints.py"), "--robot", router, "--send", "/chatter")
    assert robot.read_line() == "up\n"
    said = course("ros2", "--robot", router, "doctor").communicate(timeout=PATIENCE)[0]
    assert "s from this computer's" in said
    assert re.search(r"/chatter +: \d+\.\d Hz", said)
    robot.send_signal(signal.SIGINT)
    robot.communicate(timeout=PATIENCE)


@pytest.mark.slow
def test_qos_incompatible_in_dds_is_accepted_over_a_link_without_a_warning(
    kits: Kits, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    listener(kits.join(), "/chatter")
    (tmp_path / "best_effort.py").write_text(BEST_EFFORT_TALKER)
    code = run(
        [tmp_path / "best_effort.py"],
        seconds=20.0,
        seed=0,
        bag=None,
        args=(),
        real_time=False,
        robot=RobotAddress(kits.address, send=["/chatter"]),
    )
    said = capsys.readouterr()
    assert (code, said.out) == (0, "heard by 1\n")
    assert "No messages will be sent" not in said.err
    assert "have incompatible QoS (RELIABILITY)" in said.err


@pytest.mark.slow
def test_goals_of_two_runs_have_different_ids(
    router: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "ids.py").write_text("import uuid\nprint(uuid.uuid4())\n")
    for _ in range(2):
        run(
            [tmp_path / "ids.py"],
            seconds=None,
            seed=0,
            bag=None,
            args=(),
            real_time=False,
            robot=RobotAddress(router),
        )
    assert len(set(capsys.readouterr().out.split())) == 2


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("address", "line"),
    [
        (
            "robot:port",
            "'robot:port' is not an address of a robot: write it like tcp/192.168.1.5:7447 or dds/",
        ),
        ("tcp/lab:99999", "'tcp/lab:99999' is not an address of a robot: a port is a number from 1 to 65535"),
        ("tcp/lab:0", "'tcp/lab:0' is not an address of a robot: a port is a number from 1 to 65535"),
        ("", "'' is not an address of a robot"),
        ("dds/", "'dds/' is not an address of a robot: write it like dds/192.168.1.5."),
        ("dds/no such host", "'dds/no such host' is not an address of a robot"),
        ("dds", "'dds' is not an address of a robot: write it like dds/192.168.1.5."),
        (
            "dds://10.88.0.1",
            "'dds://10.88.0.1' is not an address of a robot: write it without a port or other ",
        ),
        (
            "dds:/lab",
            "'dds:/lab' is not an address of a robot: write it without a port or other signs, dds/lab.",
        ),
        ("DDS/10.88.0.1", "'DDS/10.88.0.1' is not an address of a robot: write it without a port or other "),
        (
            "dds/lab:7400",
            "'dds/lab:7400' is not an address of a robot: write it without a port or other signs, ",
        ),
        (
            "dds/fd00::5",
            "'dds/fd00::5' is not an address of a robot: a link over DDS needs the robot's IPv4 ",
        ),
        ("dds/::1", "'dds/::1' is not an address of a robot: a link over DDS needs the robot's IPv4 address"),
        ("dds/[::1]", "'dds/[::1]' is not an address of a robot: a link over DDS needs the robot's IPv4 "),
        ("dds/10.88.0", "'dds/10.88.0' is not an address of a robot: an IPv4 address has four numbers"),
        ("dds/10.88.0.300", "There is no computer '10.88.0.300' in this network"),
        ("dds/0.0.0.0", "0.0.0.0 stands for all addresses of a computer: write the robot's own address"),
        ("dds/239.255.0.1", "239.255.0.1 is a multicast address, which belongs to a group of computers"),
        ("dds/255.255.255.255", "255.255.255.255 is the broadcast address of a network"),
        ("dds/no.such.host.invalid", "There is no computer 'no.such.host.invalid' in this network"),
        ("dds/no..host", "There is no computer 'no..host' in this network"),
        ("127.0.0.1:{port}", "No Zenoh router answers at tcp/127.0.0.1:"),
    ],
)
def test_unreachable_robot_is_a_one_line_error(address: str, line: str) -> None:
    with pytest.raises(CourseError) as error:
        link_to(RobotAddress(address.format(port=free_port())))
    assert str(error.value).startswith(line)


def test_out_of_range_domain_is_rejected(router: str) -> None:
    with pytest.raises(CourseError, match="'300' is not a domain: expected a number from 0 to 232"):
        link_to(RobotAddress(router, 300))


def test_empty_domain_variable_means_domain_0_and_other_signs_are_rejected(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "")
    with pytest.raises(CourseError, match="There is no computer"):
        link_to(RobotAddress("dds/no..host"))
    monkeypatch.setenv("ROS_DOMAIN_ID", "²")
    with pytest.raises(CourseError, match="'²' is not a domain: expected a number from 0 to 232"):
        link_to(RobotAddress("dds/no..host"))


def test_missing_robot_extra_is_reported_with_the_install_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connecting, "find_spec", lambda name: None)
    with pytest.raises(CourseError, match=r'pip install "course-lib\[robot\]"'):
        link_to(RobotAddress("tcp/127.0.0.1:7447"))


def test_robot_options_without_a_robot_are_rejected(tmp_path: Path) -> None:
    result = course("run", str(tmp_path / "x.py"), "--send", "/cmd_vel").communicate(timeout=PATIENCE)
    assert "add --robot dds/HOST or --robot tcp/HOST:7447" in result[1]


@pytest.mark.slow
def test_notebook_can_be_connected_and_disconnected(kits: Kits, capsys: pytest.CaptureFixture[str]) -> None:
    robot = kits.join(send="/chatter")
    talker(robot, "/chatter")
    with use_graph(Graph(notebook=True)):
        connect(kits.address, send=["cmd_vel"])
        output: list[str] = []
        ros2(["topic", "list"], GraphSource(current_graph()), output.append)
        assert "/chatter" in "".join(output)
        with pytest.raises(CourseError, match="already linked to a robot"):
            connect(kits.address)
        ros2(["doctor"], GraphSource(current_graph()), output.append)
        assert f"{kits.address}, connected" in "".join(output)
        disconnect()
        assert not current_graph().link_report()
        assert current_graph().notebook
        with pytest.raises(CourseError, match="is not linked"):
            disconnect()
    assert f"Linked to {kits.address}: 1 node. Sending is allowed for cmd_vel." in capsys.readouterr().out


@pytest.mark.parametrize(("notebook", "end"), [(False, "--send /cmd_vel"), (True, 'or send=["/cmd_vel"]')])
def test_notice_of_a_withheld_topic_includes_the_option_that_allows_it(notebook: bool, end: str) -> None:
    lines: list[str] = []
    BlockedTraffic(lines.append, notebook=notebook).add("/cmd_vel", "--send")
    assert lines[0].endswith(end)


@pytest.mark.parametrize("name", ["send", "call"])
def test_string_instead_of_a_list_of_topics_is_rejected(name: str) -> None:
    allowed: dict[str, Any] = {name: "/cmd_vel"}
    with pytest.raises(CourseError, match=rf"{name}='/cmd_vel' is a string, .*: {name}=\['/cmd_vel'\]"):
        connect("tcp/127.0.0.1:1", **allowed)


def test_notebook_with_nodes_cannot_be_connected(router: str) -> None:
    graph = Graph(notebook=True)
    graph.add_node("mine", "/")
    with use_graph(graph), pytest.raises(CourseError, match=r"Nodes already exist \(/mine\): restart"):
        connect(router)


@pytest.mark.slow
def test_notebook_with_a_viewer_cannot_be_connected_until_the_viewer_is_closed(kits: Kits) -> None:
    kits.join()
    with use_graph(Graph(notebook=True)):
        viewer = Viewer()
        with pytest.raises(CourseError, match=r"A viewer or a recording already.*: restart the kernel"):
            connect(kits.address)
        viewer.close()
        connect(kits.address)
        disconnect()


def test_graded_run_cannot_connect_to_a_robot(router: str) -> None:
    with use_graph(Graph()), pytest.raises(CourseError, match="exercises are checked without a robot"):
        connect(router)


@pytest.mark.slow
def test_domain_without_nodes_is_reported_with_the_domains_that_have_nodes(
    kits: Kits, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(os.environ, "ROS_DOMAIN_ID", "7")
    talker(kits.join(domain=42), "/chatter")
    link_to(RobotAddress(kits.address)).close()
    assert "no nodes in domain 7, but in domain 42: connect with --domain 42" in capsys.readouterr().err
