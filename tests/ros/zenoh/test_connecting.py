import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib import Viewer, connect, disconnect
from course_lib.errors import CourseError
from course_lib.recording import read_bag
from course_lib.ros.graph import Graph, current_graph, use_graph
from course_lib.ros.zenoh import connect as connecting
from course_lib.ros.zenoh.connect import RobotAddress, link_to
from course_lib.ros.zenoh.sending import HeldBack
from course_lib.tools.ros2 import ros2
from course_lib.tools.run import run
from course_lib.tools.sources import GraphSource
from tests.patience import PATIENCE
from tests.ros.zenoh.conftest import Kits, free_port
from tests.ros.zenoh.test_two_kits import listener, talker

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


def course(*words: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "course_lib", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_programs_and_tools_meet_over_a_router(router: str, tmp_path: Path) -> None:
    (tmp_path / "talker.py").write_text(TALKER)
    (tmp_path / "listener.py").write_text(LISTENER)
    robot = course("run", str(tmp_path / "talker.py"), "--robot", router, "--send", "/chatter")
    assert robot.stdout is not None
    assert robot.stdout.readline() == "up\n"
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


def test_doctor_listens_for_a_moment_and_measures_the_robots_clock(router: str, tmp_path: Path) -> None:
    joints = TALKER.replace("std_msgs", "sensor_msgs").replace("String(data=", "JointState(name=[")
    joints = joints.replace('"hello")', '"hello"])').replace("String", "JointState")
    (tmp_path / "joints.py").write_text(joints)
    robot = course("run", str(tmp_path / "joints.py"), "--robot", router, "--send", "/chatter")
    assert robot.stdout is not None
    assert robot.stdout.readline() == "up\n"
    said = course("ros2", "--robot", router, "doctor").communicate(timeout=PATIENCE)[0]
    assert "s from this computer's" in said
    assert re.search(r"/chatter +: \d+\.\d Hz", said)
    robot.send_signal(signal.SIGINT)
    robot.communicate(timeout=PATIENCE)


def test_a_pair_that_dds_would_refuse_counts_over_a_link_without_a_warning(
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
    assert "/chatter: publisher and subscription have incompatible QoS (RELIABILITY)" in said.err


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


@pytest.mark.parametrize(
    ("address", "line"),
    [
        ("robot:port", "'robot:port' is not an address of a robot: write it like tcp/192.168.1.5:7447."),
        ("", "'' is not an address of a robot"),
        ("127.0.0.1:{port}", "No Zenoh router answers at tcp/127.0.0.1:"),
    ],
)
def test_a_robot_that_cannot_be_reached_is_one_line(address: str, line: str) -> None:
    with pytest.raises(CourseError) as error:
        link_to(RobotAddress(address.format(port=free_port())))
    assert str(error.value).startswith(line)


def test_a_domain_is_a_small_number(router: str) -> None:
    with pytest.raises(CourseError, match="'300' is not a domain: give a number from 0 to 232"):
        link_to(RobotAddress(router, 300))


def test_without_the_extra_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connecting, "find_spec", lambda name: None)
    with pytest.raises(CourseError, match=r'pip install "course-lib\[robot\]"'):
        link_to(RobotAddress("tcp/127.0.0.1:7447"))


def test_options_of_a_robot_without_a_robot_are_refused(tmp_path: Path) -> None:
    result = course("run", str(tmp_path / "x.py"), "--send", "/cmd_vel").communicate(timeout=PATIENCE)
    assert "add --robot tcp/HOST:7447" in result[1]


def test_a_notebook_is_linked_and_unlinked(kits: Kits, capsys: pytest.CaptureFixture[str]) -> None:
    robot = kits.join(send="/chatter")
    talker(robot, "/chatter")
    with use_graph(Graph(notebook=True)):
        connect(kits.address, send=["cmd_vel"])
        output: list[str] = []
        ros2(["topic", "list"], GraphSource(current_graph()), output.append)
        assert "/chatter" in "".join(output)
        with pytest.raises(CourseError, match="linked to a robot already"):
            connect(kits.address)
        ros2(["doctor"], GraphSource(current_graph()), output.append)
        assert f"{kits.address}, connected" in "".join(output)
        disconnect()
        assert not current_graph().about_link()
        assert current_graph().notebook
        with pytest.raises(CourseError, match="is not linked"):
            disconnect()
    assert f"Linked to {kits.address}: 1 node. What may go out: cmd_vel." in capsys.readouterr().out


@pytest.mark.parametrize(("notebook", "end"), [(False, "--send /cmd_vel"), (True, 'or send=["/cmd_vel"]')])
def test_what_is_held_back_names_what_lets_it_out(notebook: bool, end: str) -> None:
    lines: list[str] = []
    HeldBack(lines.append, notebook=notebook).note("/cmd_vel", "--send")
    assert lines[0].endswith(end)


def test_a_notebook_with_nodes_is_not_linked(router: str) -> None:
    graph = Graph(notebook=True)
    graph.add_node("mine", "/")
    with use_graph(graph), pytest.raises(CourseError, match=r"nodes already \(/mine\): restart the kernel"):
        connect(router)


def test_a_notebook_with_a_viewer_is_not_linked_until_the_viewer_is_closed(kits: Kits) -> None:
    kits.join()
    with use_graph(Graph(notebook=True)):
        viewer = Viewer()
        with pytest.raises(CourseError, match=r"a viewer or a recording already.*: restart the kernel"):
            connect(kits.address)
        viewer.close()
        connect(kits.address)
        disconnect()


def test_what_is_graded_is_not_linked(router: str) -> None:
    with use_graph(Graph()), pytest.raises(CourseError, match="exercises are checked without a robot"):
        connect(router)


def test_a_domain_without_nodes_names_those_that_have_some(
    kits: Kits, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(os.environ, "ROS_DOMAIN_ID", "7")
    talker(kits.join(domain=42), "/chatter")
    link_to(RobotAddress(kits.address)).close()
    assert "no nodes in domain 7, but in domain 42: connect with --domain 42" in capsys.readouterr().err
