"""Lets pytest test nodes: ``pytest_plugins = ["course_lib.ros.testing"]`` in a conftest.py does.

ROS's names are then the stand-in's, and the tests and the threads that they start run on robot time.
"""

from collections.abc import Iterator

import pytest

from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, use_graph

standin_path.install()
virtual_time.install()


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop() -> Iterator[None]:
    """Run all tests in one graph; threads that still spin at the end are ended."""
    from rclpy.signals import uninstall_signal_handlers

    with use_graph(Graph()) as graph, baton.known():
        try:
            return (yield)
        finally:
            uninstall_signal_handlers()
            graph.end_ns = graph.now_ns
            baton.let_others_finish()
