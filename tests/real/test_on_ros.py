"""Programs under the real rclpy, in a separate process and on loopback."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from course_lib.recording import read_bag
from tests.patience import PATIENCE
from tests.processes import Program

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not os.environ.get("REAL_ROS_PYTHON"), reason="REAL_ROS_PYTHON names no Python with the real rclpy"
    ),
]
ROOT = Path(__file__).parents[2]
TF = """
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import String
from tf2_ros import Buffer, TransformBroadcaster, TransformListener


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.broadcaster = TransformBroadcaster(self)
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(String, "found", 10)
        self.create_timer(0.05, self.on_timer)

    def on_timer(self):
        found = TransformStamped(child_frame_id="base_link")
        found.header.stamp, found.header.frame_id = self.get_clock().now().to_msg(), "map"
        found.transform.translation.x = 2.5
        found.transform.rotation.w = 1.0
        self.broadcaster.sendTransform(found)
        if self.buffer.can_transform("map", "base_link", Time()):
            x = self.buffer.lookup_transform("map", "base_link", Time()).transform.translation.x
            self.publisher.publish(String(data=str(x)))


rclpy.init()
try:
    rclpy.spin(Robot())
except KeyboardInterrupt:
    print("interrupted")
"""
OWN_TYPES = """
import rclpy
from example_interfaces.action import Fibonacci
from my_msgs.msg import Reading
from my_msgs.srv import Scale
from rclpy.action import ActionClient, ActionServer

rclpy.init()
node = rclpy.create_node("own")
heard = []
publisher = node.create_publisher(Reading, "reading", 10)
node.create_subscription(Reading, "reading", heard.append, 10)
node.create_service(Scale, "scale", lambda q, r: (setattr(r, "value", q.factor * 2), r)[1])


def execute(goal):
    goal.publish_feedback(Fibonacci.Feedback(sequence=[0, 1]))
    goal.succeed()
    return Fibonacci.Result(sequence=[0, 1, goal.request.order])


def wait(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=10)
    return future.result()


server = ActionServer(node, Fibonacci, "fib", execute)
client, actions = node.create_client(Scale, "scale"), ActionClient(node, Fibonacci, "fib")
client.wait_for_service()
actions.wait_for_server()
print("service", wait(client.call_async(Scale.Request(factor=21.0))).value)
feedback = []
goal = wait(actions.send_goal_async(Fibonacci.Goal(order=5), feedback.append))
print("action", list(wait(goal.get_result_async()).result.sequence), list(feedback[0].feedback.sequence))
message = Reading(name="a", values=[1.0, 2.5], flags=[True], raw=b"\\x07")
message.poses[1].position.y = 3.0
publisher.publish(message)
while not heard:
    rclpy.spin_once(node, timeout_sec=1)
print("message", heard[0] == message, heard[0].limit, Reading.FAST, heard[0].poses[1].position.y)
try:
    Reading(name=3)
except AssertionError as error:
    print(error)
"""
READING = """uint8 FAST=3
string name
float64[] values
bool[<=3] flags
byte raw
float32 limit 0.5
geometry_msgs/Pose[2] poses
builtin_interfaces/Time stamp
"""


def _course(*words: object, timeout: float = 6 * PATIENCE) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "course_lib", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, cwd=ROOT)


def test_program_with_tf2_runs_unchanged_and_is_recorded(tmp_path: Path) -> None:
    program, bag = tmp_path / "robot.py", tmp_path / "bag"
    program.write_text(TF)
    done = _course("run", program, "--ros", "--seconds", 2, "--bag", bag)
    assert (done.returncode, done.stdout) == (0, "interrupted\n"), done.stderr
    assert re.search(r"/tf \[tf2_msgs/msg/TFMessage\]: \d+ messages, \d+\.\d+ Hz, jitter", done.stderr)
    assert "the kit's on the real rclpy: tf2_msgs (types), tf2_py, tf2_ros." in done.stderr
    samples = read_bag(bag).samples
    assert {sample.message().data for sample in samples if sample.topic == "/found"} == {"2.5"}
    assert sum(sample.topic == "/tf" for sample in samples) > 10


def test_program_without_a_node_ends_with_a_line(tmp_path: Path) -> None:
    program = tmp_path / "waits.py"
    program.write_text("import time\ntime.sleep(600)\n")
    done = _course("run", program, "--ros", "--seconds", 1)
    assert done.returncode == 0, done.stderr
    assert "No node has started for 10 s: --seconds begins now." in done.stderr


def test_import_of_a_package_without_a_wheel_has_a_hint(tmp_path: Path) -> None:
    program = tmp_path / "drive.py"
    program.write_text("from nav2_simple_commander.robot_navigator import BasicNavigator\n")
    done = _course("run", program, "--ros", "--seconds", 1)
    assert done.returncode == 1
    assert "hint: nav2_simple_commander is not in the environment of the real ROS 2" in done.stderr


def test_custom_messages_services_and_actions_have_their_types(tmp_path: Path) -> None:
    package = tmp_path / "my_msgs"
    for name, text in {
        "msg/Reading.msg": READING,
        "srv/Scale.srv": "float64 factor\n---\nfloat64 value\n",
    }.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text)
    program = tmp_path / "own.py"
    program.write_text(OWN_TYPES)
    done = _course("run", program, "--ros", "--seconds", 30)
    assert done.stdout.splitlines() == [
        "service 42.0",
        "action [0, 1, 5] [0, 1]",
        "message True 0.5 3 3.0",
        "The 'name' field must be of type 'str'",
    ], done.stderr
    assert done.returncode == 0


def test_crash_shows_only_the_program_traceback_and_its_exit_code(tmp_path: Path) -> None:
    program = tmp_path / "broken.py"
    program.write_text("import rclpy\nrclpy.init()\nprint('up')\n1 / 0\n")
    done = _course("run", program, "--ros", "--seconds", 5)
    assert (done.returncode, done.stdout) == (1, "up\n")
    assert "ZeroDivisionError" in done.stderr
    assert "course_lib" not in done.stderr
    assert "Nothing was published." in done.stderr


CRASHING = """
import ctypes, rclpy
rclpy.init()
node = rclpy.create_node("crashing")
def read_null():
    ctypes.string_at(0)
node.create_timer(0.1, read_null)
rclpy.spin(node)
"""


def test_crash_in_c_code_is_reported_with_the_line_of_python(tmp_path: Path) -> None:
    program = tmp_path / "crashing.py"
    program.write_text(CRASHING)
    done = _course("run", program, "--ros", "--seconds", 5)
    assert done.returncode == 128 + signal.SIGSEGV
    assert f'{program}", line 6 in read_null' in done.stderr
    assert "crashing.py was ended by SIGSEGV (Segmentation fault)" in done.stderr


def test_interrupted_program_has_a_traceback_without_lines_of_the_kit(tmp_path: Path) -> None:
    program = tmp_path / "interrupted.py"
    program.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n")
    run = _course("run", program, "--ros")
    assert run.returncode == 0
    assert 'interrupted.py", line 2, in <module>' in run.stderr
    assert run.stderr.count("  File ") == 1
    assert "\nKeyboardInterrupt\n" in run.stderr


def test_end_of_a_program_is_not_reported_as_a_lost_link(tmp_path: Path) -> None:
    program = tmp_path / "brief.py"
    ends = "rclpy.spin_once(node, timeout_sec=1.0)\nrclpy.shutdown()\ntime.sleep(1.0)\n"
    program.write_text(f"import rclpy, time\nrclpy.init()\nnode = rclpy.create_node('brief')\n{ends}")
    done = _course("run", program, "--ros")
    assert done.returncode == 0
    assert "is lost" not in done.stderr


STUBBORN = """
import os, time, rclpy
rclpy.init()
node = rclpy.create_node("stubborn")
print("up", os.getpid(), flush=True)
while True:
    try:
        time.sleep(0.05)
    except BaseException:
        pass
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_program_that_ignores_interrupts_does_not_outlive_the_command(
    number: signal.Signals, tmp_path: Path
) -> None:
    program = tmp_path / "stubborn.py"
    program.write_text(STUBBORN)
    command = [sys.executable, "-m", "course_lib", "run", str(program), "--ros", "--seconds", "60"]
    with Program(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        child = int(process.read_line().removeprefix("up "))
        process.send_signal(number)
        deadline = time.monotonic() + PATIENCE
        while Path(f"/proc/{child}").exists():
            assert time.monotonic() < deadline
            time.sleep(0.05)
        process.communicate(timeout=PATIENCE)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_program_ends_with_the_command(number: signal.Signals, tmp_path: Path) -> None:
    program, ended = tmp_path / "robot.py", tmp_path / "ended"
    text = TF.replace('print("interrupted")', f'open({str(ended)!r}, "w").close()')
    program.write_text(
        text.replace("        if self.buffer", '        print("up", flush=True)\n        if self.buffer')
    )
    command = [sys.executable, "-m", "course_lib", "run", str(program), "--ros", "--seconds", "60"]
    pipe = subprocess.PIPE
    with Program(command, stdout=pipe, stderr=pipe) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        for _ in range(20):
            assert process.read_line() == "up\n"
        process.send_signal(number)
        deadline = time.monotonic() + PATIENCE
        while not ended.exists():
            assert time.monotonic() < deadline
            time.sleep(0.05)
        process.stdout.close()
        err = process.stderr.read()
    assert number != signal.SIGINT or "/tf [tf2_msgs/msg/TFMessage]" in err


def test_public_checks_pass_on_the_real_ros_with_bit_equal_values() -> None:
    done = _course("check", "--ros", "solutions/week01_solution.ipynb")
    assert done.returncode == 0, done.stdout + done.stderr
    tasks = re.findall(r"^(week01\.\w+): (\d+) of (\d+) checks pass", done.stdout, re.MULTILINE)
    assert len(tasks) >= 5
    assert all(passed == number for _, passed, number in tasks)
    pairs = re.findall(r"(\d+) of (\d+) pairs bit-equal", done.stdout)
    assert len(pairs) == len(tasks)
    assert all(equal == number for equal, number in pairs)
    # Checks with the same outcome share a line.
    assert "\n  ok a cube with 1 m edges; above the origin, on the ground; " in done.stdout


def test_rejected_parameters_have_their_times_as_in_the_kit() -> None:
    done = _course("check", "--ros", "solutions/week06_solution.ipynb")
    camera = done.stdout[done.stdout.index("week06.camera:") : done.stdout.index("week06.camera_monitor:")]
    assert "ros2 param set reports 61 and 0.5 Hz as rejected" in camera
    assert "\n  NO " not in camera


def test_unfinished_exercise_fails_without_a_run() -> None:
    done = _course("check", "--ros", "exercises/week01_exercise.ipynb")
    assert done.returncode == 1, done.stdout + done.stderr
    unfinished = "not run on ROS, as it is not finished: NotImplementedError"
    assert len(re.findall(rf"^week01\.\w+: {unfinished}", done.stdout, re.MULTILINE)) == 6
    assert "pass on the real ROS 2" not in done.stdout


def test_end_of_the_run_time_is_not_an_error_of_the_program(tmp_path: Path) -> None:
    program = tmp_path / "spin.py"
    program.write_text("import rclpy\nrclpy.init()\nrclpy.spin(rclpy.create_node('waits'))\n")
    done = _course("run", program, "--ros", "--seconds", "1")
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    assert "KeyboardInterrupt" not in done.stderr


def test_wrong_answer_also_fails_on_the_real_ros(tmp_path: Path) -> None:
    text = (ROOT / "solutions/week01_solution.ipynb").read_text("utf-8")
    wrong = tmp_path / "week01_exercise.ipynb"
    wrong.write_text(text.replace("Marker.CUBE", "Marker.SPHERE"))
    done = _course("check", "--ros", wrong)
    assert done.returncode == 1
    assert re.search(r"^week01.red_cube: [0-3] of 4 checks pass", done.stdout, re.MULTILINE)
    assert "\n  NO " in done.stdout
