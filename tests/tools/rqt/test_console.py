import pytest
from rclpy.node import Node

from course_lib.ros.graph.graph import Graph
from course_lib.tools.rqt.monitors import ConsoleView


@pytest.fixture
def view(graph: Graph, planner: Node) -> ConsoleView:
    view = ConsoleView(graph, [])
    view.listen()
    logger = planner.get_logger()
    logger.info("all <well>")
    logger.warn("battery is low")
    logger.error("battery is empty")
    return view


def test_messages_are_sorted_newest_first_with_named_severities(view: ConsoleView) -> None:
    picture = view.picture()
    assert (
        picture.index("battery is empty")
        < picture.index("battery is low")
        < picture.index("all &lt;well&gt;")
    )
    assert "Displaying 3 of 3 messages" in picture
    assert "Error</td><td>planner</td><td>1700000000.<wbr>000000000</td>" in picture


def test_filters_exclude_messages_by_severity_node_and_text(view: ConsoleView) -> None:
    view.controls["Error"].value = False
    assert "battery is empty" not in view.picture()
    view.controls["Text"].value = "BATTERY"
    assert "Displaying 1 of 3" in view.picture()
    view.controls["Node"].value = "camera"
    assert "Displaying 0 of 3" in view.picture()


def test_highlighted_messages_are_also_marked_by_a_symbol(view: ConsoleView) -> None:
    view.controls["Highlight"].value = "low"
    assert "<mark>► battery is low</mark>" in view.picture()


def test_paused_console_ignores_messages(view: ConsoleView, planner: Node) -> None:
    view.controls["Pause"].value = True
    planner.get_logger().info("unheard")
    assert "Displaying 3 of 3" in view.picture()
