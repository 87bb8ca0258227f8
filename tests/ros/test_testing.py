"""Tests of nodes under plain pytest, written as the course's documents write them."""

import subprocess
import sys
from pathlib import Path

import pytest

NODE = """
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.declare_parameter("robot_name", "physical_ai_robot")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, lambda: self.publisher.publish(String(data="hi")))
"""
TESTS = """
import threading
import time

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

from my_package.my_node import Talker


@pytest.fixture(scope="module")
def node_with_executor():
    rclpy.init()
    node, executor = Talker(), SingleThreadedExecutor()
    executor.add_node(node)
    yield node, executor
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()


def test_parameter_has_its_default_value(node_with_executor):
    node, _ = node_with_executor
    assert node.get_parameter("robot_name").value == "physical_ai_robot"


def test_messages_are_published_while_a_thread_spins(node_with_executor):
    node, executor = node_with_executor
    heard = []
    node.create_subscription(String, "chatter", heard.append, 10)
    threading.Thread(target=executor.spin, daemon=True).start()
    begun = time.time()
    time.sleep(60.1)
    assert len(heard) == 120
    assert time.time() - begun == pytest.approx(60.1)


def test_failing_assertion(node_with_executor):
    assert 1 + 1 == 3
"""


@pytest.mark.slow
def test_nodes_in_an_executor_are_tested_in_robot_time(tmp_path: Path) -> None:
    package = tmp_path / "my_package"
    package.mkdir()
    (package / "my_node.py").write_text(NODE)
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["course_lib.ros.testing"]')
    (tmp_path / "test_my_node.py").write_text(TESTS)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path)]
    process = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert "1 failed, 2 passed" in process.stdout, process.stdout + process.stderr
    assert "assert (1 + 1) == 3" in process.stdout
