import warnings
from collections.abc import Iterator
from typing import Any

import meshcat.geometry as g
import numpy as np
import pytest

from course_lib.viewer.drawables import Mesh, Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.visualizer import Visualizer
from course_lib.viewer.widget import SceneWidget

pinocchio = pytest.importorskip("pinocchio")


@pytest.fixture(autouse=True)
def warnings_fail() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Pinocchio and the readers of meshes use what newer versions of Python and numpy report.
        warnings.simplefilter("ignore", DeprecationWarning)
        yield


def display_robot(name: str) -> tuple[Any, Scene]:
    from example_robot_data import load
    from pinocchio.visualize import MeshcatVisualizer

    robot, scene = load(name), Scene()
    visualizer = MeshcatVisualizer(robot.model, robot.collision_model, robot.visual_model)
    visualizer.initViewer(viewer=Visualizer(scene))
    visualizer.loadViewerModel()
    return visualizer, scene


def empty() -> tuple[Any, Scene]:
    from pinocchio.visualize import MeshcatVisualizer

    scene, visualizer = Scene(), MeshcatVisualizer(pinocchio.Model())
    visualizer.initViewer(viewer=Visualizer(scene))
    return visualizer, scene


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["ur10", "talos"])
def test_pinocchio_draws_a_robot_at_its_joint_positions(name: str) -> None:
    visualizer, scene = display_robot(name)
    configuration = pinocchio.randomConfiguration(
        visualizer.model, np.full(visualizer.model.nq, -1.0), np.full(visualizer.model.nq, 1.0)
    )
    visualizer.display(configuration)
    pinocchio.framesForwardKinematics(visualizer.model, visualizer.data, configuration)
    pinocchio.updateGeometryPlacements(
        visualizer.model, visualizer.data, visualizer.visual_model, visualizer.visual_data
    )
    links = visualizer.visual_model.geometryObjects
    assert len(links) > 5
    for link, placement in zip(links, visualizer.visual_data.oMg, strict=True):
        path = f"meshcat/pinocchio/visuals/{link.name}"
        transform_link_to_scene = scene.world_transform(path)
        transform_link_to_scene[:3, :3] /= link.meshScale
        assert transform_link_to_scene == pytest.approx(placement.homogeneous, abs=1e-9)
        assert isinstance(scene.objects()[path], Mesh | Solids)


def test_pinocchio_camera_calls_move_the_camera() -> None:
    visualizer, scene = empty()
    visualizer.setCameraPosition([1.0, 2.0, 3.0])
    visualizer.setCameraTarget([0.0, 0.5, 1.0])
    assert (scene.camera.eye, scene.camera.target) == ((1.0, 2.0, 3.0), (0.0, 0.5, 1.0))
    for preset, (target, eye) in visualizer.CAMERA_PRESETS.items():
        visualizer.setCameraPreset(preset)
        assert scene.camera.target == pytest.approx(tuple(target)), preset
        assert scene.camera.eye == pytest.approx(tuple(eye)), preset
    before = np.tan(scene.camera.vertical_fov / 2)
    visualizer.setCameraZoom(2.0)
    assert np.tan(scene.camera.vertical_fov / 2) == pytest.approx(before / 2)
    visualizer.setCameraZoom(1.0)
    assert np.tan(scene.camera.vertical_fov / 2) == pytest.approx(before)


def test_camera_without_control_has_the_given_pose() -> None:
    visualizer, scene = empty()
    visualizer.disableCameraControl()
    pose = pinocchio.SE3(pinocchio.utils.rotate("z", np.pi / 2), np.array([1.0, 2.0, 3.0])).homogeneous
    visualizer.setCameraPose(pose)
    assert scene.camera.eye == (1.0, 2.0, 3.0)
    assert np.subtract(scene.camera.target, scene.camera.eye) == pytest.approx([-1, 0, 0])
    visualizer.setCameraPose(np.eye(4))
    visualizer.enableCameraControl()
    assert scene.camera.eye == pytest.approx((3.0, 0.0, 1.0))


@pytest.mark.slow
def test_captured_image_has_the_requested_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.viewer.renderer.find_browser", lambda: None)
    visualizer, scene = display_robot("ur10")
    visualizer.setCameraPosition([1.5, 1.5, 1.0])
    visualizer.display(pinocchio.neutral(visualizer.model))
    picture = visualizer.captureImage(320, 200)
    assert picture.shape[:2] == (200, 320)
    assert (np.abs(picture[..., :3].astype(int) - scene.background).max(axis=-1) > 30).mean() > 0.01
    assert visualizer.captureImage().shape[:2] == (600, 800)


def test_subtree_is_a_visualizer() -> None:
    scene = Scene()
    vis = Visualizer(scene)
    vis["a"]["b"].set_object(g.Box([1, 1, 1]))
    matrix = np.eye(4)
    matrix[:3, 3] = 1, 2, 3  # [m]
    vis["a"].set_transform(matrix)
    vis["/Grid"].set_transform(matrix)
    assert np.array_equal(scene.world_transform("meshcat/a/b"), matrix)
    assert [node.path for node in scene.nodes()] == ["", "meshcat", "meshcat/a", "meshcat/a/b"]
    vis["a"].set_transform()
    assert np.array_equal(scene.world_transform("meshcat/a/b"), np.eye(4))


def test_position_quaternion_and_scale_are_independent() -> None:
    scene = Scene()
    vis = Visualizer(scene)
    turn = pinocchio.utils.rotate("z", np.pi / 2)
    for name, value in {"position": [1, 2, 3], "quaternion": [0, 0, 1, 1], "scale": [2, 3, 4]}.items():
        vis["a"].set_property(name, list(np.divide(value, np.sqrt(2))) if name == "quaternion" else value)
    vis["a"].set_property("position", [1.0, 2.0, 5.0])
    expected = np.eye(4)
    expected[:3, :3] = turn @ np.diag([2, 3, 4])
    expected[:3, 3] = 1, 2, 5
    assert scene.transform("meshcat/a") == pytest.approx(expected)


def test_three_js_cameras_are_accepted() -> None:
    scene = Scene()
    node = Visualizer(scene)["/Cameras/default/rotated"]
    node.set_object(g.OrthographicCamera(left=-1, right=1, top=2, bottom=-2, near=-10, far=10, zoom=2))
    assert scene.camera.orthographic_scale == 200.0  # [px/m] of a view 400 px high
    node.set_object(g.PerspectiveCamera(fov=60, near=0.5))
    assert np.degrees(scene.camera.vertical_fov) == pytest.approx(60)
    assert scene.camera.near == 0.5
    assert "orthographic_scale=None" in repr(scene.camera)


def test_cell_shows_a_view_instead_of_a_server_iframe() -> None:
    scene = Scene()
    cell = Visualizer(scene).jupyter_cell(height=300)
    assert isinstance(cell, SceneWidget)
    assert (cell.scene, cell.height) == (scene, 300)
    cell.close()
