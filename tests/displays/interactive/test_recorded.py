"""The InteractiveMarkers display without a graph, as for a bag."""

from typing import Any

import pytest
from geometry_msgs.msg import Point, Pose
from std_msgs.msg import Header
from visualization_msgs.msg import (
    InteractiveMarker,
    InteractiveMarkerPose,
    InteractiveMarkerUpdate,
)
from visualization_msgs.msg import InteractiveMarkerControl as C

from course_lib.displays.interactive import InteractiveMarkersDisplay
from tests.displays.bench import Bench
from tests.displays.interactive.control_stage import box

NAME = "rviz_default_plugins/InteractiveMarkers"


@pytest.fixture
def recording() -> tuple[Bench, InteractiveMarkersDisplay]:
    """A display without a graph, as for a bag."""
    bench = Bench()
    display = bench.session.add(NAME, "Im", {"Interactive Markers Namespace": "/simple"})
    assert isinstance(display, InteractiveMarkersDisplay)
    return bench, display


def hear(bench: Bench, number: int, **fields: Any) -> None:
    bench.publish("/simple/update", InteractiveMarkerUpdate(type=1, seq_num=number, **fields))
    bench.update()


def test_recorded_markers_are_shown(
    recording: tuple[Bench, InteractiveMarkersDisplay],
) -> None:
    bench, display = recording
    hear(bench, 1, markers=[box(C.MOVE_AXIS)])
    marker_pose = InteractiveMarkerPose(
        name="box", header=Header(frame_id="map"), pose=Pose(position=Point(x=3.0))
    )
    hear(bench, 5, poses=[marker_pose])
    path = f"{display.path}/handles/box/controls/button"
    assert bench.scene.world_transform(path)[0, 3] == 3.0
    hear(bench, 6, erases=["box"])
    assert not display.markers


MAP = Header(frame_id="map")
FAR = Pose(position=Point(x=float("inf")))
REFUSED = [
    ({"markers": [box(scale=float("nan"))]}, "error", "Marker contains invalid floats!"),
    ({"markers": [InteractiveMarker(name="box", header=MAP)]}, "ok", "Marker empty."),
    (
        {"poses": [InteractiveMarkerPose(name="box", header=MAP)]},
        "error",
        "Pose received for non-existing marker 'box",
    ),
    (
        {"poses": [InteractiveMarkerPose(name="box", pose=FAR, header=MAP)]},
        "error",
        "Pose message contains invalid floats!",
    ),
]


@pytest.mark.parametrize(("fields", "level", "text"), REFUSED)
def test_markers_rejected_by_rviz_have_its_status(
    recording: tuple[Bench, InteractiveMarkersDisplay], fields: Any, level: str, text: str
) -> None:
    bench, display = recording
    hear(bench, 1, **fields)
    assert bench.status(display, "box") == (level, text)
    assert not display.markers
