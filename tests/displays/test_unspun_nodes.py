"""Hints of a viewer about nodes that are not spun or were stopped by an error."""

from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node

from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph, current_graph, use_graph
from course_lib.ros.time.driving import LiveRun, spin_for, start_live_run


class Ticking(Node):
    def __init__(self) -> None:
        super().__init__("ticking")
        self.create_timer(1.0, lambda: None)


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    with use_graph(Graph(notebook=True)):
        rclpy.init(args=[])
        viewer = Viewer()
        yield viewer
        viewer.close()
        rclpy.try_shutdown()


def hints(viewer: Viewer) -> list[str]:
    return [row.text for row in viewer.statuses() if (row.name, row.level) == ("Nodes", "hint")]


def test_unspun_node_with_a_timer_has_a_hint(viewer: Viewer) -> None:
    node = Ticking()
    (hint,) = hints(viewer)
    assert hint.startswith("the node /ticking was created but is not spun")
    spin_for(1.0, node)
    assert hints(viewer) == []


def test_node_without_callbacks_gets_no_hint(viewer: Viewer) -> None:
    Node("quiet")
    assert hints(viewer) == []


def test_destroyed_node_gets_no_hint(viewer: Viewer) -> None:
    Ticking().destroy_node()
    assert hints(viewer) == []


def test_node_replaced_by_one_of_the_same_name_gets_no_hint(viewer: Viewer) -> None:
    spin_for(1.0, Ticking())
    Ticking()
    assert len(hints(viewer)) == 1
    spin_for(1.0, Ticking())
    assert hints(viewer) == []


def errors(viewer: Viewer) -> list[str]:
    return [row.text for row in viewer.statuses() if row.level == "error" and row.name == "Nodes"]


def test_error_of_a_live_run_is_shown_until_one_of_its_node_names_is_spun(viewer: Viewer) -> None:
    first, second = Ticking(), Node("other")
    run = LiveRun(current_graph(), (first, second))
    start_live_run(run)
    run.fail(ValueError("too fast"))
    assert errors(viewer) == ["ticking, other: stopped by an error, ValueError: too fast"]
    spin_for(1.0, Node("third"))
    assert len(errors(viewer)) == 1
    spin_for(1.0, Node("other"))
    assert errors(viewer) == [], "the next cell runs some of the nodes again, without the faulty one"
