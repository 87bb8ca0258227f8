from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node

from course_lib import extension
from course_lib.ros import notices
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.notices import ReplacedNodes, repeated_lines


@pytest.fixture
def node() -> Iterator[Node]:
    # Other tests of this process may have logged a line repeatedly.
    repeated_lines.end()
    with use_graph(Graph(notebook=True)):
        rclpy.init()
        yield Node("robot")
        rclpy.try_shutdown()
        repeated_lines.end()


def printed_notices(capsys: pytest.CaptureFixture[str]) -> list[str]:
    return [line.rpartition("] ")[2] for line in capsys.readouterr().err.splitlines()]


def test_repeated_log_lines_in_a_notebook_are_counted(node: Node, capsys: pytest.CaptureFixture[str]) -> None:
    for _ in range(1003):
        node.get_logger().warning("no transform")
    node.get_logger().warning("found it")
    assert printed_notices(capsys) == [
        *5 * ["[robot]: no transform"],
        "… repeated 5 times",
        "… repeated 95 times",
        "… repeated 995 times",
        "… repeated 998 times",
        "[robot]: found it",
    ]


def test_log_lines_that_differ_in_text_or_severity_are_all_shown(
    node: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in range(20):
        node.get_logger().info(f"step {number % 2}")
        node.get_logger().error(f"step {number % 2}")
    assert len(printed_notices(capsys)) == 40


def test_end_of_a_cell_prints_the_count_of_repeated_lines(
    node: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(8):
        node.get_logger().info("on")
    repeated_lines.end()
    repeated_lines.end()
    assert printed_notices(capsys)[5:] == ["… repeated 3 times"]
    node.get_logger().info("on")
    assert printed_notices(capsys) == ["[robot]: on"]


def test_log_of_a_program_keeps_every_line(capsys: pytest.CaptureFixture[str]) -> None:
    with use_graph(Graph()):
        rclpy.init()
        for _ in range(20):
            Node.get_logger(Node("robot")).info("on")
        rclpy.try_shutdown()
    assert printed_notices(capsys).count("[robot]: on") == 20


def test_nodes_replaced_in_a_cell_are_listed_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    replacements = ReplacedNodes()
    replacements.is_deferred = True
    for name in ("/a", "/b", "/a"):
        replacements.add(name)
    assert capsys.readouterr().out == ""
    replacements.report()
    replacements.report()
    assert capsys.readouterr().out == "New nodes replace nodes with the same names: /a, /b.\n"


def test_node_replaced_between_cells_is_reported_immediately(
    capsys: pytest.CaptureFixture[str],
) -> None:
    extension._begin_cell()
    notices.replacements.add("/a")
    extension._end_cell()
    notices.replacements.add("/b")
    assert [line.split()[3] for line in capsys.readouterr().out.splitlines()] == ["/a", "/b"]
