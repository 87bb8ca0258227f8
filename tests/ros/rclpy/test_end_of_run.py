"""The end of a run is to a program as Ctrl+C."""

import subprocess
import sys
from pathlib import Path

import pytest

from course_lib.ros.graph.graph import START_NS, Graph, Sample, use_graph
from course_lib.ros.programs.program import run_files
from tests.patience import PATIENCE

CLIENT = """
import rclpy
from std_srvs.srv import Trigger
rclpy.init()
client = rclpy.create_node("client").create_client(Trigger, "start")
while not client.wait_for_service(timeout_sec=1.0):
    print("waiting")
print("found")
"""
IN_MAIN = """
import rclpy, rclpy._rclpy_pybind11, time
from rclpy.node import Node
rclpy.init()
node = Node("talker")
try:
    {wait}
    print("returned")
except KeyboardInterrupt:
    print("KeyboardInterrupt")
print(rclpy.ok())
try:
    rclpy.spin_once(node)
except rclpy._rclpy_pybind11.RCLError as error:
    print(type(error).__name__)
node.destroy_node()
rclpy.try_shutdown()
print("left")
"""
IN_A_THREAD = """
import rclpy, threading, time
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
rclpy.init()
node = Node("talker")

def work():
    {lines}

thread = threading.Thread(target=work)
thread.start()
try:
    time.sleep(60)
except KeyboardInterrupt:
    thread.join()
    print("main")
"""
LATE_SERVER = """
import rclpy, time
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

def execute(goal):
    while True:
        print("feedback", node.get_clock().now().nanoseconds // 10**9 % 100)
        goal.publish_feedback(Fibonacci.Feedback())
        time.sleep(1.0)

rclpy.init()
node = Node("server")
server = ActionServer(node, Fibonacci, "count", execute)
ActionClient(node, Fibonacci, "count").send_goal_async(Fibonacci.Goal(order=5))
executor = MultiThreadedExecutor()
executor.add_node(node)
executor.spin()
"""
PUBLISHES_LATE = """
import rclpy
from std_msgs.msg import Empty
rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(Empty, "beat", 10)
node.create_timer(0.5, lambda: publisher.publish(Empty()))
try:
    rclpy.spin(node)
finally:
    publisher.publish(Empty())
"""
CLEANS_UP = """
import time
try:
    time.sleep(60)
except KeyboardInterrupt:
    for _ in range(20):
        time.sleep(0.1)
    print("stopped the motors")
"""
STUBBORN = """
import time
while True:
    try:
        time.sleep(1.0)
    except KeyboardInterrupt:
        pass
"""


def run(folder: Path, *sources: str, seconds: int = 3, exit_code: int = 0) -> list[Sample]:
    samples: list[Sample] = []
    for number, source in enumerate(sources):
        (folder / f"program{number}.py").write_text(source)
    with use_graph(Graph(end_ns=START_NS + seconds * 10**9)) as graph:
        graph.tap(samples.append)
        files = [folder / f"program{number}.py" for number in range(len(sources))]
        assert run_files(files, seed=1) == exit_code
    return samples


def test_client_without_a_server_ends_silently(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    run(tmp_path, CLIENT)
    assert capfd.readouterr() == ("waiting\n" * 3, "")


@pytest.mark.parametrize(
    "wait",
    [
        "rclpy.spin(node)",
        "time.sleep(60)",
        "rclpy.spin_until_future_complete(node, rclpy.Future())",
        "node.get_clock().sleep_for(rclpy.duration.Duration(seconds=60))",
        "rclpy.executors.MultiThreadedExecutor().spin()",
        "while rclpy.ok(): rclpy.spin_once(node, timeout_sec=0.7)",
        "while True: time.time()",
        "import threading; threading.Event().wait(60)",
    ],
)
@pytest.mark.parametrize("beside", [(), (STUBBORN,)])
def test_blocked_call_in_the_main_thread_raises_keyboard_interrupt(
    wait: str, beside: tuple[str, ...], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path, IN_MAIN.format(wait=wait), *beside)
    expected = ["KeyboardInterrupt", "False", "RCLError", "left"]
    assert capfd.readouterr().out.split() == expected


def test_asyncio_of_one_of_two_programs_is_interrupted(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    # Alone, the program is in the main thread, where asyncio replaces rclpy's handler of Ctrl+C.
    wait = "import asyncio; asyncio.run(asyncio.sleep(60))"
    run(tmp_path, IN_MAIN.format(wait=wait), STUBBORN)
    assert capfd.readouterr().out.split() == ["KeyboardInterrupt", "False", "RCLError", "left"]


def test_writing_a_folder_keeps_the_sigterm_handler_of_rclpy(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    program = """
import signal
from pathlib import Path
import rclpy
from course_lib.files import draft_folder
from course_lib.ros.time.time_lock import real_getsignal
rclpy.init()
handler = real_getsignal(signal.SIGTERM)
with draft_folder(Path(__file__).with_suffix(".bag")):
    pass
print(callable(handler), real_getsignal(signal.SIGTERM) is handler)
"""
    run(tmp_path, program)
    assert capfd.readouterr().out == "True True\n"


@pytest.mark.parametrize(
    ("lines", "shown"),
    [
        ("while rclpy.ok(): time.sleep(2.0)\n    print('over')", ["over"]),
        ("while True:\n        time.sleep(2.0)\n        print('beat')", ["beat", "beat"]),
        ("rclpy.spin(node)\n    print('returned')", []),
        ("try: rclpy.spin(node)\n    except ExternalShutdownException: print('raised')", ["raised"]),
        (
            "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
            "    rate = node.create_rate(1.0)\n    while rclpy.ok(): rate.sleep()",
            [],
        ),
    ],
)
def test_other_threads_end_silently_at_the_end_of_a_run(
    lines: str, shown: list[str], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path, IN_A_THREAD.format(lines=lines))
    out, err = capfd.readouterr()
    assert (out.split(), err) == ([*shown, "main"], "")


def test_callback_in_a_separate_thread_ends_in_its_wait(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path, LATE_SERVER)
    assert capfd.readouterr() == ("feedback 0\nfeedback 1\nfeedback 2\n", "")


def test_publishing_after_the_end_of_a_run_raises(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    beats = [sample for sample in run(tmp_path, PUBLISHES_LATE, exit_code=1) if sample.topic == "/beat"]
    assert [(sample.stamp_ns - START_NS) / 1e9 for sample in beats] == [0.5, 1.0, 1.5, 2.0, 2.5, 3.0]
    assert "RCLError: Failed to publish: publisher's context is invalid" in capfd.readouterr().err


def test_program_can_sleep_during_its_cleanup(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    run(tmp_path, CLEANS_UP)
    assert capfd.readouterr() == ("stopped the motors\n", "")


HANDLER = """
import signal, sys, time
import rclpy

def stop(number, frame):
    print("stopped by", signal.Signals(number).name)
    {last}

rclpy.init()
node = rclpy.create_node("robot")
before = signal.signal(signal.SIGINT, stop)
print(signal.getsignal(signal.SIGINT) is stop, callable(before))
rclpy.spin(node)
print("spun")
"""


@pytest.mark.parametrize("beside", [False, True])
@pytest.mark.parametrize(
    ("last", "rest"), [("sys.exit(0)", []), ("rclpy.shutdown()", ["spun"]), ("pass", [])]
)
def test_end_of_a_run_calls_the_sigint_handler_of_the_program(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], last: str, rest: list[str], beside: bool
) -> None:
    (tmp_path / "robot.py").write_text(HANDLER.format(last=last))
    (tmp_path / "other.py").write_text("print(end='')")
    files = [tmp_path / "robot.py", *([tmp_path / "other.py"] if beside else [])]
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        assert run_files(files, seed=0) == 0
    assert capsys.readouterr().out.splitlines() == ["True True", "stopped by SIGINT", *rest]


def test_ctrl_c_calls_the_handlers_of_concurrent_programs(tmp_path: Path) -> None:
    (tmp_path / "robot.py").write_text(HANDLER.format(last="rclpy.shutdown()"))
    (tmp_path / "killer.py").write_text(
        "import os, signal, time\ntime.sleep(1.0)\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(1.0)"
    )
    words = [sys.executable, "-m", "course_lib", "run", "robot.py", "killer.py"]
    process = subprocess.run(
        words, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.stdout.splitlines() == ["True True", "stopped by SIGINT", "spun"]
