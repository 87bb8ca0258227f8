"""Evidence made by hand."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from course_lib.grading.evidence import Evidence
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize, type_name
from course_lib.ros.qos import Qos

Published = Sequence[tuple[float, str, Any]]
MakeEvidence = Callable[..., Evidence]


@pytest.fixture
def evidence() -> MakeEvidence:
    """Evidence of (seconds, topic, message) rows."""

    def make(*published: tuple[float, str, Any], seconds: float = 3.0, **more: Any) -> Evidence:
        samples = tuple(
            Sample(START_NS + round(at * 1e9), topic, type_name(message), serialize(message), Qos(), 7)
            for at, topic, message in published
        )
        return Evidence("week01.demo", "public", seconds, samples, **more)

    return make


@pytest.fixture
def cube() -> Callable[..., Any]:
    """A red cube as lesson 1 asks for it, with some fields changed."""

    def make(**changes: Any) -> Any:
        from visualization_msgs.msg import Marker

        marker = Marker(type=Marker.CUBE, ns="basic_shapes")
        marker.header.frame_id = "map"
        marker.pose.position.z = 0.5
        marker.scale.x = marker.scale.y = marker.scale.z = 1.0
        marker.color.r, marker.color.a = 1.0, 0.8
        for dotted, value in changes.items():
            *path, last = dotted.split("__")
            owner = marker
            for name in path:
                owner = getattr(owner, name)
            setattr(owner, last, value)
        return marker

    return make
