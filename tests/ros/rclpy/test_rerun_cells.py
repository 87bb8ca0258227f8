"""Mistakes that are forgiven in a notebook, where cells are run again."""

import signal
import threading

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.time.time_lock import time_lock
from tests.patience import PATIENCE

Captured = pytest.CaptureFixture[str]


def test_second_init_prints_a_one_line_notice(notebook: Graph, capsys: Captured) -> None:
    rclpy.init()
    rclpy.init()
    out = capsys.readouterr().out
    assert out == "rclpy.init() was already called; everything keeps running.\n"


def test_new_node_of_the_same_name_replaces_the_old_one_and_prints_a_notice(
    notebook: Graph, capsys: Captured
) -> None:
    rclpy.init()
    old = Node("talker")
    old.create_publisher(String, "x", 10)
    Node("talker", namespace="other")
    assert capsys.readouterr().out == ""
    Node("talker")
    assert capsys.readouterr().out == "The new node /talker replaces the one of the same name.\n"
    assert [node.name for node in notebook.nodes()] == ["talker", "talker"]
    assert list(old.publishers) == []


def test_replaced_node_logs_on_rosout(notebook: Graph, capsys: Captured) -> None:
    rclpy.init()
    Node("talker")
    new = Node("talker")
    new.get_logger().info("hello")
    assert [sample.topic for sample in notebook.latched_samples()] == ["/rosout"]


def test_spin_in_a_notebook_without_a_page_stops_after_five_seconds(
    notebook: Graph, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    rclpy.init()
    node, calls = Node("talker"), []
    node.create_timer(1.0, lambda: calls.append(node.get_clock().now()))
    rclpy.spin(node)
    assert len(calls) == 5
    assert "spin() stopped after 5 s of robot time" in capsys.readouterr().out
    assert rclpy.ok()


def test_executor_spin_in_a_notebook_without_a_page_stops_after_five_seconds(
    notebook: Graph, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    rclpy.init()
    node = Node("talker")
    node.create_timer(2.0, rclpy.shutdown)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin()
    assert notebook.now_ns == START_NS + 2_000_000_000
    assert capsys.readouterr().out == ""


def test_stopping_a_cell_ends_spin_with_one_line_and_the_node_stays_usable(
    notebook: Graph, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")

    def stop() -> None:
        raise KeyboardInterrupt

    rclpy.init()
    node = Node("talker")
    timer = node.create_timer(1.5, stop)
    rclpy.spin(node)
    output = capsys.readouterr().out
    assert output.startswith("Stopped after 1.5 s of robot time, in test_rerun_cells.py, line ")
    assert output.endswith(": raise KeyboardInterrupt.\n")
    assert output.count("\n") == 1
    node.destroy_timer(timer)
    rclpy.spin_once(node, timeout_sec=1.0)
    assert notebook.now_ns == START_NS + 2_500_000_000


def test_no_signal_handlers_are_installed_in_a_kernel(notebook: Graph) -> None:
    before = signal.getsignal(signal.SIGINT)
    rclpy.init()
    assert signal.getsignal(signal.SIGINT) is before


def test_thread_spinning_in_a_kernel_runs_while_a_cell_waits(notebook: Graph) -> None:
    rclpy.init()
    node, calls = Node("talker"), []
    node.create_timer(1.0, lambda: calls.append("tick"))
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    node.get_clock().sleep_for(rclpy.duration.Duration(seconds=3))
    rclpy.shutdown()
    assert len(calls) == 3
    with time_lock.hold():
        time_lock.sleep_until(notebook.now_ns + 10**7, "the end of the thread")
    thread.join(PATIENCE)
    assert not thread.is_alive()
