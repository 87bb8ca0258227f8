"""Scenes and helpers for the tests of sensors."""

from collections.abc import Callable
from typing import Any

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from course_lib.arrays import Floats
from course_lib.ros.graph.graph import START_NS, Graph, Sample, use_graph
from course_lib.ros.messages import deserialize
from course_lib.sensors.world import placed

# Transform of a camera that looks along the world's x; its z points ahead, x to the right, y down.
TRANSFORM_OPTICAL_TO_WORLD = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
AT_ORIGIN = placed(0, 0, 0)


def published(make: Callable[[], Node], message: type, seconds: float = 0.1) -> list[Any]:
    """Run a node for some robot time. Return its messages of a type."""
    samples = list[Sample]()
    with use_graph(Graph(end_ns=START_NS + round(seconds * 1e9))) as graph:
        graph.tap(samples.append)
        rclpy.init()
        executor = SingleThreadedExecutor()
        executor.add_node(make())
        executor.spin()
    name = message._TYPE_NAME  # type: ignore[attr-defined]  # every message class has it
    return [deserialize(sample.cdr, message) for sample in samples if sample.type_name == name]


def random_rays(chance: np.random.Generator, count: int) -> Floats:
    """Unit vectors in all directions, shape (3, count)."""
    rays = chance.standard_normal((3, count))
    unit: Floats = rays / np.linalg.norm(rays, axis=0)
    return unit
