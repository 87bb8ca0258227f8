"""A started run of ten robot seconds, and a node in it."""

from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import time_lock
from tests.ros.rclpy.simulator import SIM

END_NS = START_NS + 10 * 10**9


@pytest.fixture
def graph() -> Iterator[Graph]:
    """A run before `rclpy.init()`."""
    virtual_time.install()
    with use_graph(Graph(end_ns=END_NS)) as graph, time_lock.hold():
        yield graph
        uninstall_signal_handlers()
        graph.end_ns = graph.now_ns
        time_lock.finish_other_threads()


@pytest.fixture
def started_graph(graph: Graph) -> Graph:
    """A run that has been started."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    return graph


@pytest.fixture
def node(started_graph: Graph) -> Node:
    """A node in a started run."""
    return Node("talker")


@pytest.fixture
def follower(started_graph: Graph) -> Node:
    """A node with `use_sim_time`."""
    return Node("follower", parameter_overrides=[SIM])


@pytest.fixture
def notebook() -> Iterator[Graph]:
    """The graph of a kernel, with the relaxed rules of a notebook."""
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph:
        yield graph
