"""The default view shows all drawn objects."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.arrays import Floats
from course_lib.displays.viewer import Viewer
from course_lib.displays.views import Orbit, TopDownOrtho
from course_lib.ros.graph.graph import Graph
from course_lib.viewer.drawables import Camera, Points
from course_lib.viewer.scene import Scene, _points_and_extent, bounds_of
from tests.displays.bench import marker
from tests.displays.stage import publish, wait
from tests.viewer.test_stream import decoded

RVIZ = (10.0, (0.0, 0.0, 0.0))
# Width divided by height of the narrowest picture in which everything has to fit.
NARROW = 1.0


def cube_at(x: float, y: float = 0.0, z: float = 0.5, side: float = 1.0) -> Marker:
    cube = marker()
    position, scale = cube.pose.position, cube.scale
    position.x, position.y, position.z = x, y, z
    scale.x = scale.y = scale.z = side
    return cube


def is_in_picture(camera: Camera, *points: tuple[float, float, float]) -> bool:
    matrix = camera.view_matrix()
    x, y, z = (np.array(points) @ matrix[:3, :3].T + matrix[:3, 3]).T
    half = -z * np.tan(camera.vertical_fov / 2)
    return bool((z < 0).all() and (abs(y) <= half).all() and (abs(x) <= NARROW * half).all())


def view_of(viewer: Viewer) -> tuple[Any, Any]:
    """Return distance and focal point, as they are shown in a cell."""
    viewer.refresh()
    return viewer.view["Distance"], viewer.view["Focal Point"]


@pytest.fixture
def viewer(graph: Graph) -> Viewer:
    viewer = Viewer()
    viewer.add("Axes")
    viewer.add("Marker", topic="/m")
    return viewer


def test_view_of_grid_and_axes_is_the_default_of_rviz(viewer: Viewer) -> None:
    assert view_of(viewer) == RVIZ


@pytest.mark.parametrize(("x", "side"), [(0.0, 1.0), (4.0, 1.0), (-30.0, 8.0), (0.3, 0.05)])
def test_first_object_and_the_origin_are_in_the_picture(
    graph: Graph, viewer: Viewer, x: float, side: float
) -> None:
    publish(graph, "/m", cube_at(x, side=side, z=side / 2))
    corners = [(x + a * side / 2, b * side / 2, c * side) for a in (-1, 1) for b in (-1, 1) for c in (0, 1)]
    assert is_in_picture(viewer.camera, *corners, (0, 0, 0))
    assert viewer.view["Distance"] < 1.5 * (abs(x) + side) + 4.0


def test_small_object_far_away_is_shown_without_the_origin(graph: Graph, viewer: Viewer) -> None:
    publish(graph, "/m", cube_at(400.0))
    assert view_of(viewer)[0] < 5.0
    assert is_in_picture(viewer.camera, (399.5, 0.5, 0.0), (400.5, -0.5, 1.0))


SETTERS: dict[str, Callable[[Viewer], object]] = {
    "a property": lambda viewer: viewer.view.__setitem__("Distance", 12.0),
    "another view": lambda viewer: setattr(viewer, "view", TopDownOrtho(scale=50.0)),
    "an equal view": lambda viewer: setattr(viewer, "view", Orbit()),
    "RViz's key Z": lambda viewer: viewer.view.return_home(),
    "a hand": lambda viewer: viewer.session.on_view_turn(Camera(eye=(3.0, 0.0, 2.0))),
    "meshcat": lambda viewer: setattr(viewer.scene, "camera", Camera(eye=(3.0, 0.0, 2.0))),
}


@pytest.mark.parametrize("setter", SETTERS)
def test_view_that_was_set_is_not_moved(graph: Graph, viewer: Viewer, setter: str) -> None:
    viewer.refresh()
    SETTERS[setter](viewer)
    before = viewer.camera
    publish(graph, "/m", cube_at(40.0))
    assert viewer.camera == before


def test_view_of_a_layout_is_not_moved(graph: Graph, viewer: Viewer, tmp_path: Path) -> None:
    viewer.view["Distance"] = 7.0
    viewer.save_rviz(tmp_path / "mine.rviz")
    opened = Viewer.from_rviz(tmp_path / "mine.rviz")
    publish(graph, "/m", cube_at(40.0))
    assert view_of(opened) == (7.0, (0.0, 0.0, 0.0))


def test_layout_without_a_view_is_fitted(graph: Graph, tmp_path: Path) -> None:
    (tmp_path / "bare.rviz").write_text(
        "Visualization Manager:\n  Global Options: {Fixed Frame: map}\n  Displays:\n"
        "  - {Class: rviz_default_plugins/Marker, Name: M, Topic: /m}\n"
    )
    opened = Viewer.from_rviz(tmp_path / "bare.rviz")
    publish(graph, "/m", cube_at(40.0, side=9.0))
    assert is_in_picture(opened.camera, (40.0, 0.0, 4.0), (0, 0, 0))


def test_motion_inside_the_picture_never_moves_the_view(graph: Graph, viewer: Viewer) -> None:
    publish(graph, "/m", cube_at(4.0))
    before = view_of(viewer)
    for x in (3.0, 1.0, 0.0):
        publish(graph, "/m", cube_at(x))
        assert view_of(viewer) == before


def test_motion_out_of_the_picture_moves_the_view_only_when_it_is_opened(
    graph: Graph, viewer: Viewer
) -> None:
    viewer.session.after_frame.append(lambda: None)
    publish(graph, "/m", cube_at(1.0))
    before = view_of(viewer)
    for x in (20.0, 40.0):
        publish(graph, "/m", cube_at(x))
        viewer.session.update(graph.now_ns)
    assert (viewer.view["Distance"], viewer.view["Focal Point"]) == before
    viewer.refresh()
    assert is_in_picture(viewer.camera, (40.0, 0.0, 0.5), (0, 0, 0))


@pytest.mark.parametrize(("x", "is_moved"), [(0.2, False), (30.0, True)])
def test_first_drawing_of_another_display_moves_the_view_only_if_it_is_outside(
    graph: Graph, viewer: Viewer, x: float, is_moved: bool
) -> None:
    viewer.add("MarkerArray", topic="/many")
    # As if a page showed it.
    viewer.session.after_frame.append(lambda: None)
    publish(graph, "/m", cube_at(0.0))
    viewer.session.update(graph.now_ns)
    before = dict(viewer.view._values)
    publish(graph, "/many", MarkerArray(markers=[cube_at(x, side=0.2)]))
    viewer.session.update(graph.now_ns)
    assert (dict(viewer.view._values) != before) is is_moved
    assert is_in_picture(viewer.session.context.scene.camera, (x, 0.0, 0.5), (0, 0, 0))


def test_few_far_points_of_a_cloud_do_not_shrink_the_others(viewer: Viewer) -> None:
    points = np.zeros((200, 3))
    points[:, 0] = np.linspace(-3.0, 3.0, 200)
    points[:2] = [(900.0, 0.0, 0.0), (0.0, -900.0, 0.0)]
    viewer.scene.set_object("mine/cloud", Points(points, (1.0, 1.0, 1.0, 1.0), (1.0, 1.0)))
    assert view_of(viewer)[0] < 12.0
    assert is_in_picture(viewer.camera, (-2.9, 0.0, 0.0), (2.9, 0.0, 0.0))


def test_bounds_of_a_large_cloud_are_percentiles() -> None:
    scene = Scene()
    points = np.random.default_rng(3).normal(0.0, 1.0, (300_000, 3)).astype(np.float32)
    points[7] = (5000.0, 0.0, 0.0)
    drawable = Points(points, (1.0, 1.0, 1.0, 1.0), (0.1, 0.1))
    scene.set_object("cloud", drawable)
    bounds = bounds_of(scene, ["cloud"])
    assert bounds is not None
    expected: Floats = np.percentile(points, (2, 98), axis=0)
    assert np.abs(bounds - expected).max() < 0.05
    assert len(_points_and_extent(drawable)[0]) <= 20_000


def test_invisible_objects_are_ignored(graph: Graph, viewer: Viewer) -> None:
    viewer.scene.set_object("mine/hidden", Points([(50.0, 0.0, 0.0)], (1.0, 1.0, 1.0, 1.0), (1.0, 1.0)))
    viewer.scene.set_visible("mine", False)
    publish(graph, "/m", cube_at(0.0))
    assert view_of(viewer)[0] < 6.0


def test_another_fixed_frame_fits_the_view_again(graph: Graph, viewer: Viewer) -> None:
    publish(graph, "/m", cube_at(20.0, side=5.0))
    far = view_of(viewer)
    viewer.reset()
    viewer.fixed_frame = "odom"
    odom = cube_at(0.0)
    odom.header.frame_id = "odom"
    publish(graph, "/m", odom)
    assert view_of(viewer)[0] < far[0] / 3


def test_empty_object_does_not_move_the_view(graph: Graph, viewer: Viewer) -> None:
    viewer.scene.set_object("mine/nowhere", Points(np.zeros((0, 3)), (1.0, 1.0, 1.0, 1.0), (1.0, 1.0)))
    assert view_of(viewer) == RVIZ
    publish(graph, "/m", cube_at(0.0))
    assert view_of(viewer)[0] < 6.0


def test_replay_is_played_from_one_camera_that_shows_every_position(graph: Graph, viewer: Viewer) -> None:
    for x in (-4.0, 0.0, 4.0):
        publish(graph, "/m", cube_at(x))
        wait(graph, 1.0)
    first, *later = decoded(viewer.replay(5.0).recording)["batches"]
    assert is_in_picture(viewer.scene.camera, (-4.0, 0.0, 0.5), (4.0, 0.0, 0.5))
    camera = next(one for one in first["commands"] if one["type"] == "camera")
    assert camera["eye"] == pytest.approx(viewer.scene.camera.eye)
    assert "camera" not in str(later)


def test_replay_of_a_view_that_was_set_keeps_its_camera(graph: Graph, viewer: Viewer) -> None:
    viewer.view = Orbit(distance=3.0)
    publish(graph, "/m", cube_at(8.0))
    wait(graph, 1.0)
    viewer.replay(5.0)
    assert viewer.view["Distance"] == 3.0
