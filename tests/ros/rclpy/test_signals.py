"""Ctrl+C and SIGTERM, in a process of its own: the handlers are the process's."""

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import os, signal
from course_lib.ros import standin_path, virtual_time
standin_path.install()
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
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, cwd=root, check=True
    )
    return done.stdout.splitlines()


@pytest.mark.parametrize(("name", "ended"), [("SIGINT", "KeyboardInterrupt"), ("SIGTERM", "returned")])
def test_a_signal_shuts_the_context_down_so_that_only_try_shutdown_is_fine_afterwards(
    name: str, ended: str
) -> None:
    assert outcome(name) == [
        ended,
        "ok False",
        "failed to shutdown: rcl_shutdown already called on the given context",
        "True",
    ]
