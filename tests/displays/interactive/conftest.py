"""A server of interactive markers and a viewer that shows them."""

from collections.abc import Iterator

import pytest

from course_lib.ros.graph.graph import Graph
from tests.displays.interactive.control_stage import Stage
from tests.ros.rclpy.conftest import notebook

__all__ = ["notebook"]


@pytest.fixture
def stage(notebook: Graph) -> Iterator[Stage]:
    stage = Stage(notebook)
    yield stage
    stage.viewer.close()
