"""A started run, and the messages that are published in it."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from course_lib.ros.graph.graph import Graph, Sample, use_graph
from course_lib.ros.messages import deserialize, message_class
from course_lib.ros.time import virtual_time
from course_lib.ros.time.driving import spin_for
from course_lib.ros.time.time_lock import time_lock

Published = list[tuple[str, Any]]


@pytest.fixture
def graph() -> Iterator[Graph]:
    """A run that `rclpy.init()` has begun."""
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph, time_lock.hold():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        yield graph
        uninstall_signal_handlers()


@pytest.fixture
def published(graph: Graph) -> Published:
    """The topic and the message of all that is published."""
    received: Published = []

    def hear(sample: Sample) -> None:
        received.append((sample.topic, deserialize(sample.cdr, message_class(sample.type_name))))

    graph.tap(hear)
    return received


@pytest.fixture
def on(published: Published) -> Callable[[str], list[Any]]:
    """Return the messages that were published on a topic."""
    return lambda topic: [message for name, message in published if name == topic]


@pytest.fixture
def run(graph: Graph) -> Callable[..., None]:
    """Runs nodes for some seconds."""

    def run_for(seconds: float, *nodes: Node) -> None:
        spin_for(seconds, *nodes)

    return run_for
