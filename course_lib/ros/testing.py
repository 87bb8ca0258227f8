"""A plugin for pytest, which tests nodes: ``pytest_plugins = ["course_lib.ros.testing"]``, in a conftest.py.

ROS's names are then the stand-in's, and the tests and the threads that they start run on robot time.
"""

from collections.abc import Iterator

import pytest

from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.interrupts import signals_kept

standin_path.install()
virtual_time.install()


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop() -> Iterator[None]:
    """Run all tests in one graph; threads that still spin at the end are ended."""
    with use_graph(Graph()) as graph, signals_kept(), baton.known():
        try:
            return (yield)
        finally:
            graph.end_ns = graph.now_ns
            baton.let_others_finish()
