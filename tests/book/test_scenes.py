import base64
import gzip
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
import pytest
import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from visualization_msgs.msg import Marker

from course_lib import run_live, stop_all
from course_lib.book.kernel import ROOM, WATCHED, Scenes
from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.time_lock import time_lock
from tests.displays.bench import marker
from tests.displays.stage import publish, wait


@pytest.fixture
def graph() -> Iterator[Graph]:
    """A run that `rclpy.init()` has begun."""
    with use_graph(Graph(notebook=True)) as graph, time_lock.hold():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        yield graph
        stop_all()


@pytest.fixture
def viewer(graph: Graph) -> Iterator[Viewer]:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    yield viewer
    viewer.close()


def content_of(path: Path) -> Any:
    """Read a scene's script."""
    packed = gzip.decompress(base64.b64decode(path.read_text("utf-8").split('"')[1]))
    return msgpack.unpackb(packed, strict_map_key=False)


@pytest.mark.slow
def test_frozen_view_with_a_large_recording_plays_with_fewer_frames(
    graph: Graph, viewer: Viewer, tmp_path: Path
) -> None:
    chance = np.random.default_rng(1)
    for _ in range(40):
        points = [Point(x=x, y=y, z=z) for x, y, z in chance.random((400, 3)).tolist()]
        publish(graph, "/m", marker(Marker.POINTS, points=points))
        wait(graph, 0.1)
        viewer.refresh()
    scenes = Scenes("week09", tmp_path, "_scenes")
    shown = scenes.add_resting_view(viewer.freeze())
    scenes.write()
    recording = tmp_path / "week09-01.js"
    assert recording.stat().st_size < ROOM
    assert len(content_of(recording)["batches"]) > 2
    assert "400 points" in shown["text/html"]  # its picture in words


def test_replay_plays_by_itself_in_the_book_and_a_frozen_view_does_not(
    graph: Graph, viewer: Viewer, tmp_path: Path
) -> None:
    publish(graph, "/m", marker())
    wait(graph, 0.5)
    scenes = Scenes("week09", tmp_path, "_scenes")
    assert 'data-plays="true"' in scenes.add_resting_view(viewer.replay(0.5))["text/html"]
    assert 'data-plays="false"' in scenes.add_resting_view(viewer.freeze())["text/html"]
    assert 'data-plays="false"' in scenes.add_viewer(viewer)["text/html"]


def test_live_nodes_continue_after_a_view_is_created(
    graph: Graph, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    node = Node("talker")
    publisher = node.create_publisher(Marker, "/m", 10)
    node.create_timer(0.5, lambda: publisher.publish(marker()))
    run_live(node)
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    scenes = Scenes("week09", tmp_path, "_scenes")
    scenes.add_viewer(viewer)
    scenes.extend_live_scene()
    assert viewer.scene_recording.duration == pytest.approx(WATCHED)
    scenes.extend_live_scene()
    assert viewer.scene_recording.duration == pytest.approx(WATCHED)
    scenes.write()
    assert content_of(tmp_path / "week09-01.js")["end"] == pytest.approx(WATCHED)
    viewer.close()
