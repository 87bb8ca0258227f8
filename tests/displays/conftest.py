"""A graph that viewers listen to."""

from collections.abc import Iterator

import pytest

from course_lib.ros.graph.graph import Graph, use_graph


@pytest.fixture
def graph() -> Iterator[Graph]:
    with use_graph(Graph()) as made:
        yield made
