"""Mistakes that are forgiven in a notebook, where cells are run again."""

import linecache
import signal
import threading

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.hints import hint
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


def hint_of(*cells: str) -> str:
    """Run cells in one namespace. Return the hint for the error of the last one."""
    names: dict[str, object] = {"__name__": "__main__", "In": list(cells)}
    exec("import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String", names)
    for index, cell in enumerate(cells):
        name = f"cell {index}"
        linecache.cache[name] = (len(cell), None, cell.splitlines(True), name)
        try:
            exec(compile(cell, name, "exec"), names)
        except Exception as error:
            assert index == len(cells) - 1
            return hint(error)
    return ""


TALKER = """class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
"""
INIT = "rclpy.init()"


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        (
            (INIT, TALKER, "talker = Talker()", f"{TALKER}        self.count = 0\n", "talker.count"),
            "this Talker was created before the cell of the class was run again: run the cell that "
            "creates it, with Talker(…), again.",
        ),
        (
            (INIT, TALKER, "talker = Talker()", f"{TALKER}    def stop(self): ...\n", "talker.stop()"),
            "this Talker was created before the cell of the class was run again",
        ),
        (
            (INIT, TALKER, "talker = Talker()", TALKER, "talker.count"),
            "set `self.count` in Talker.__init__, spelled the same.",
        ),
        (
            ("def width(a):\n    return a\n", "width = width(2)", "width = width(2)"),
            "width = … has replaced the function width, which is now 2: choose another name for the "
            "result, and run the cell with def width again.",
        ),
        (
            (INIT, TALKER, "talker = Talker()", "rclpy.shutdown()", "rclpy.spin_once(talker)"),
            "rclpy.shutdown() was called before, maybe in another cell: call `rclpy.init()`, and then",
        ),
        (
            (INIT, TALKER, "talker = Talker()", "rclpy.shutdown()", "talker.publisher.publish(String())"),
            "rclpy.shutdown() was called since this node was created",
        ),
        (("main()",), "main is not defined: write `def main()` with the lines to run"),
        (
            ("def main():\n    node = 3\n", "main()", "node"),
            "node is set in the function main, and exists only there: return it from main.",
        ),
        (("import time as wall", "time.time()"), "the module time is imported as wall: write wall"),
        (
            ("a, b = [1, 2, 3], [4, 5, 6]", "[x + y for x, y in (a, b)]"),
            "zip pairs the items of two lists: write for x, y in zip(a, b).",
        ),
    ],
)
def test_hint_follows_the_order_of_the_cells(cells: tuple[str, ...], expected: str, notebook: Graph) -> None:
    assert hint_of(*cells).startswith(expected)


def test_spin_of_a_destroyed_node_has_a_hint(notebook: Graph, capsys: Captured) -> None:
    rclpy.init()
    old = Node("talker")
    Node("talker")
    capsys.readouterr()
    rclpy.spin_once(old, timeout_sec=0.1)
    assert capsys.readouterr().out.startswith("hint: /talker is spun and does nothing: it was destroyed")
