import numpy as np

from course_lib.viewer.drawables import Lines, Mesh, Points, Sheet, Solids, Text
from course_lib.viewer.scene import LIMIT, Scene, summary

WHITE = (1.0, 1.0, 1.0, 1.0)


def at(x: float, y: float, z: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def test_each_kind_of_drawable_is_listed_with_its_count_and_position() -> None:
    scene = Scene()
    scene.set_transform("robot", at(1, 0, 0))
    corners = [(0, 0, 0), (2, 0, 0), (0, 4, 0)]
    scene.set_object("robot/boxes", Solids("box", [at(0, 0, 0), at(0, 0, 2)], WHITE))
    scene.set_object("robot/ball", Solids("sphere", [at(0, 0, 0.5)], WHITE))
    scene.set_object("robot/skin", Mesh(corners, None, WHITE))
    scene.set_object("robot/path", Lines(corners, WHITE))
    scene.set_object("robot/cloud", Points(corners, WHITE, (0.1, 0.1)))
    scene.set_object("robot/map", Sheet(np.zeros((4, 6)), [WHITE] * 256, 0.5))
    scene.set_object("robot/name", Text("Ada", 0.2))
    assert summary(scene) == [
        "robot/boxes: 2 boxes at (1, 0, 1)",
        "robot/ball: 1 ellipsoid at (1, 0, 0.5)",
        "robot/skin: 1 triangle at (2, 2, 0)",
        "robot/path: 2 lines at (2, 2, 0)",
        "robot/cloud: 3 points at (2, 2, 0)",
        "robot/map: 6 x 4 cells at (2.5, 1, 0)",
        "robot/name: the text 'Ada' at (1, 0, 0)",
    ]


def test_position_of_a_turned_mesh_is_the_center_of_its_own_box() -> None:
    scene = Scene()
    half = np.sqrt(0.5)
    turn = np.array([(half, -half, 0, 0), (half, half, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
    scene.set_transform("skin", turn)
    scene.set_object("skin", Mesh([(0, 0, 0), (2, 0, 0), (0, 4, 0)], None, WHITE))
    assert summary(scene) == ["skin: 1 triangle at (-0.71, 2.12, 0)"]


def test_mesh_without_vertices_has_no_position() -> None:
    scene = Scene()
    scene.set_object("skin", Mesh(np.zeros((0, 3)), None, WHITE))
    assert summary(scene) == ["skin: 0 triangles at nowhere"]


def test_hidden_objects_are_omitted_from_the_summary() -> None:
    scene = Scene()
    scene.set_object("box", Solids("box", [np.eye(4)], WHITE))
    scene.set_visible("box", False)
    assert summary(scene) == []


def test_summary_of_many_objects_lists_the_first_and_counts_the_others() -> None:
    scene = Scene()
    for index in range(LIMIT + 3):
        scene.set_object(f"box {index}", Solids("box", [np.eye(4)], WHITE))
    assert summary(scene)[-1] == "and 3 more"
    assert len(summary(scene)) == LIMIT + 1


def test_empty_cloud_has_no_position() -> None:
    scene = Scene()
    scene.set_object("cloud", Points(np.zeros((0, 3)), WHITE, (0.1, 0.1)))
    assert summary(scene) == ["cloud: 0 points at nowhere"]
