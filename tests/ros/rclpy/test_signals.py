"""Ctrl+C and SIGTERM in a separate process, because signal handlers are global."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.processes import Program

PROGRAM = """
import os, signal
from course_lib.ros.programs import import_path; from course_lib.ros.time import virtual_time
import_path.install()
virtual_time.install()
import rclpy
from rclpy.executors import ExternalShutdownException
rclpy.init()
node = rclpy.create_node("talker")
node.create_timer(1.0, lambda: os.kill(os.getpid(), signal.SIGNAME))
try:
    rclpy.spin(node)
    print("returned")
except (KeyboardInterrupt, ExternalShutdownException) as error:
    print(type(error).__name__)
print("ok", rclpy.ok())
try:
    rclpy.shutdown()
except Exception as error:
    print(error)
rclpy.try_shutdown()
print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


def outcome(name: str) -> list[str]:
    code = PROGRAM.replace("SIGNAME", name)
    root = Path(__file__).parents[3]
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, cwd=root, check=True
    )
    return process.stdout.splitlines()


@pytest.mark.parametrize(("name", "ended"), [("SIGINT", "KeyboardInterrupt"), ("SIGTERM", "returned")])
def test_signal_shuts_the_context_down_and_then_only_try_shutdown_is_allowed(name: str, ended: str) -> None:
    assert outcome(name) == [
        ended,
        "ok False",
        "failed to shutdown: rcl_shutdown already called on the given context",
        "True",
    ]


BUSY_THREAD = """
import sys, threading
import rclpy

rclpy.init()
node = rclpy.create_node("talker")


def count():
    number = 0
    while True:
        number += 1


threading.Thread(target=count, daemon=True, name="counter").start()
rclpy.spin(node)
"""


@pytest.mark.slow
@pytest.mark.parametrize(("number", "error"), [(signal.SIGINT, ""), (signal.SIGTERM, "ExternalShutdown")])
def test_thread_in_a_busy_loop_is_reported_and_a_signal_ends_the_program(
    tmp_path: Path, number: signal.Signals, error: str
) -> None:
    file = tmp_path / "busy.py"
    file.write_text(BUSY_THREAD, encoding="utf-8")
    command = [sys.executable, "-m", "course_lib", "run", "--seconds", "1", str(file)]
    with Program(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        line = process.read_line()
        process.send_signal(number)
        _, errors = process.communicate(timeout=PATIENCE)
    assert line.startswith('Thread "counter" has been running without a pause (busy.py, line 1')
    assert error in errors


BUSY_PUBLISHER = """
import threading

import rclpy
from std_msgs.msg import Int32

rclpy.init()
node = rclpy.create_node("eager")
publisher = node.create_publisher(Int32, "numbers", 10)


def publish():
    while True:
        publisher.publish(Int32(data=1))


threading.Thread(target=publish, daemon={daemon}, name="eager").start()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
"""


@pytest.mark.parametrize("daemon", [True, False])
def test_thread_publishing_in_a_busy_loop_ends_with_the_run(tmp_path: Path, daemon: bool) -> None:
    file = tmp_path / "eager.py"
    file.write_text(BUSY_PUBLISHER.format(daemon=daemon), encoding="utf-8")
    command = [sys.executable, "-m", "course_lib", "run", "--seconds", "1", str(file)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert run.returncode == 0
    assert "publisher's context is invalid" in run.stderr or daemon


BUSY_MAIN = """
import rclpy

rclpy.init()
node = rclpy.create_node("busy")
while True:
    pass
"""


@pytest.mark.slow
def test_computing_main_thread_is_reported_and_an_interrupt_ends_it(tmp_path: Path) -> None:
    file = tmp_path / "busy.py"
    file.write_text(BUSY_MAIN, encoding="utf-8")
    command = [sys.executable, "-m", "course_lib", "run", "--seconds", "1", str(file)]
    with Program(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        line = process.read_line()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE)
    assert line.startswith(
        "The main thread has computed for 5 s without a call of ROS (busy.py, line 6: while"
    )
