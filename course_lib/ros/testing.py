"""A pytest plugin for nodes: ``pytest_plugins = ["course_lib.ros.testing"]`` in a conftest.py.

The stand-in then provides ROS's packages, and the tests and their threads run in robot time.
"""

from collections.abc import Iterator

import pytest

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.programs import import_path
from course_lib.ros.time import virtual_time
from course_lib.ros.time.interrupts import keep_signal_handlers
from course_lib.ros.time.time_lock import time_lock

import_path.install()
virtual_time.install()


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop() -> Iterator[None]:
    """Run all tests in one graph. Threads that still spin at the end are ended."""
    with use_graph(Graph()) as graph, keep_signal_handlers(), time_lock.hold():
        try:
            return (yield)
        finally:
            graph.end_ns = graph.now_ns
            time_lock.finish_other_threads()
