import warnings
from io import BytesIO
from types import SimpleNamespace
from typing import Any

import meshcat
import meshcat.geometry as g
import numpy as np
import pytest
from meshcat.animation import Animation
from PIL import Image

from course_lib.errors import CourseError
from course_lib.viewer import renderer
from course_lib.viewer.drawables import Camera, Drawable, Mesh, MeshcatObject, Points, Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.visualizer import Window

ORANGE, CORNERS = 0xFF8000, np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
TRANSFORM_UP_TO_Y = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])  # three.js's axis


def render_pixels(scene: Scene) -> np.ndarray:
    scene.camera = Camera(eye=(3, 2, 2))
    return np.asarray(Image.open(BytesIO(renderer.draw(scene, (80, 60))))).astype(int)


@pytest.fixture
def scene() -> Scene:
    return Scene()


@pytest.fixture
def vis(scene: Scene) -> Any:
    return meshcat.Visualizer(window=Window(scene))


OURS: list[tuple[Any, Drawable]] = [
    (g.Box([1, 2, 0.5]), Solids("box", [np.diag([1, 2, 0.5, 1])], (1, 128 / 255, 0, 1))),
    (g.Sphere(0.7), Solids("sphere", [np.diag([1.4, 1.4, 1.4, 1])], (1, 128 / 255, 0, 1))),
    (
        g.Cylinder(2.0, 0.5),
        Solids("cylinder", [TRANSFORM_UP_TO_Y @ np.diag([1, 1, 2, 1])], (1, 128 / 255, 0, 1)),
    ),
    (g.TriangularMeshGeometry(CORNERS, [[0, 1, 2]]), Mesh(CORNERS, [[0, 1, 2]], (1, 128 / 255, 0, 1))),
]


@pytest.mark.parametrize(("theirs", "ours"), OURS, ids=["box", "ball", "cylinder", "triangles"])
def test_meshcat_geometry_is_drawn_like_viewer_geometry(
    scene: Scene, vis: Any, theirs: Any, ours: Drawable
) -> None:
    vis["thing"].set_object(theirs, g.MeshLambertMaterial(color=ORANGE))
    expected = Scene()
    expected.set_object("thing", ours)
    assert np.array_equal(render_pixels(scene), render_pixels(expected))
    assert len(np.unique(render_pixels(scene))) > 2


def test_meshcat_points_have_their_colors(scene: Scene, vis: Any) -> None:
    vis["cloud"].set_object(g.PointCloud(CORNERS.T, np.eye(3, dtype=np.float32), size=0.3))
    expected = Scene()
    colors = np.column_stack([np.eye(3), np.ones(3)])
    expected.set_object("cloud", Points(CORNERS, colors, (0.3, 0.3)))
    assert np.array_equal(render_pixels(scene), render_pixels(expected))


def test_transforms_visibility_and_deletion_change_the_scene(scene: Scene, vis: Any) -> None:
    matrix = np.eye(4)
    matrix[:3, 3] = 1, 2, 3  # [m]
    vis["a"]["b"].set_object(g.Box([1, 1, 1]))
    vis["a"].set_transform(matrix)
    vis["a"].set_property("visible", False)
    assert np.array_equal(scene.world_transform("meshcat/a/b"), matrix)
    assert not scene.is_visible("meshcat/a/b")
    vis.delete()
    assert scene.objects() == {}


def test_color_property_is_applied_to_all_descendants_of_a_path(scene: Scene, vis: Any) -> None:
    vis["a"]["b"].set_object(g.Box([1, 1, 1]), g.MeshLambertMaterial(color=ORANGE))
    vis["a"].set_property("color", [0, 0, 1, 1])
    vis["a"]["b"].set_property("position", [0, 0, 0.5])
    expected = Scene()
    expected.set_object("box", Solids("box", [np.eye(4)], (0, 0, 1, 1)))
    raised = np.eye(4)
    raised[2, 3] = 0.5  # [m]
    expected.set_transform("box", raised)
    assert np.array_equal(render_pixels(scene), render_pixels(expected))


def test_camera_and_background_are_taken_from_the_scene(scene: Scene, vis: Any) -> None:
    vis["/Cameras/default/rotated/<object>"].set_property("position", [1.0, 2.0, -3.0])
    target = np.eye(4)
    target[:3, 3] = 0, 0, 1  # [m]
    vis["/Cameras/default"].set_transform(target)
    vis["/Background"].set_property("top_color", [1.0, 0.5, 0.0])
    assert scene.camera.eye == (1.0, 3.0, 3.0)
    assert scene.camera.target == (0.0, 0.0, 1.0)
    assert scene.background == (255, 128, 0)


def test_grid_and_lights_of_meshcat_cannot_be_changed(scene: Scene, vis: Any) -> None:
    vis["/Grid"].set_property("visible", False)
    assert [node.path for node in scene.nodes()] == [""]


def test_animations_are_stored_for_the_page(scene: Scene, vis: Any) -> None:
    animation = Animation(default_framerate=30)
    with animation.at_frame(vis["box"], 10) as frame:
        frame.set_transform(np.eye(4))
    vis.set_animation(animation)
    assert scene.animation is not None
    assert scene.animation["animations"][0]["path"] == "/meshcat/box"


def test_unsupported_command_is_reported(vis: Any) -> None:
    with pytest.raises(CourseError, match="'set_control' is not supported"):
        vis.window.send(SimpleNamespace(lower=lambda: {"type": "set_control", "path": ""}))


def test_image_is_drawn_without_a_page(vis: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.viewer.renderer.find_browser", lambda: None)
    assert vis.get_image().size == (800, 600)


@pytest.mark.slow
def test_pinocchio_draws_a_robot_and_moves_it() -> None:
    pinocchio = pytest.importorskip("pinocchio")
    from example_robot_data import load
    from pinocchio.visualize import MeshcatVisualizer

    robot, scene = load("ur10"), Scene()
    visualizer = MeshcatVisualizer(robot.model, robot.collision_model, robot.visual_model)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        visualizer.initViewer(viewer=meshcat.Visualizer(window=Window(scene)))
        visualizer.loadViewerModel()
        configuration = pinocchio.neutral(robot.model)
        configuration[1] = -1.0  # [rad]
        visualizer.display(configuration)
    links = [path for path in scene.objects() if "/visuals/" in path]
    placements = visualizer.visual_data.oMg
    for path, geometry, placement in zip(links, robot.visual_model.geometryObjects, placements, strict=True):
        assert path.endswith(geometry.name)
        assert scene.world_transform(path) == pytest.approx(placement.homogeneous, abs=1e-12)
        assert isinstance(scene.objects()[path], Mesh)
        assert not isinstance(scene.objects()[path], MeshcatObject)
    assert len(np.unique(render_pixels(scene).reshape(-1, 3), axis=0)) > 50
