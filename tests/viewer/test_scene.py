import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.viewer.drawables import Lines, Mesh, Points, Solids, are_equal
from course_lib.viewer.scene import Scene

BOX = Solids("box", [np.eye(4)], (1, 0, 0, 1))


def moved(x: float) -> np.ndarray:
    transform_node_to_parent = np.eye(4)
    transform_node_to_parent[0, 3] = x  # [m]
    return transform_node_to_parent


def test_last_value_of_a_path_wins() -> None:
    scene = Scene()
    other = Solids("sphere", [np.eye(4)], (0, 1, 0, 1))
    scene.set_object("a/b", BOX)
    scene.set_object("a/b", other)
    assert scene.objects() == {"a/b": other}


def test_redundant_slashes_are_dropped() -> None:
    scene = Scene()
    scene.set_object("/meshcat//box/", BOX)
    assert list(scene.objects()) == ["meshcat/box"]
    assert scene.is_visible("/meshcat/box")


def test_delete_removes_the_subtree_and_keeps_siblings_with_a_common_prefix() -> None:
    scene = Scene()
    for path in ("a", "a/b/c", "ab"):
        scene.set_object(path, BOX)
    scene.delete("a")
    scene.delete("never there")
    assert list(scene.objects()) == ["ab"]
    scene.set_object("a/b", BOX)
    assert np.array_equal(scene.transform("a"), np.eye(4))


def test_deleting_the_root_empties_the_scene() -> None:
    scene = Scene()
    scene.set_object("a/b", BOX)
    scene.delete("")
    assert scene.objects() == {}


def test_world_transform_is_the_product_of_all_parents() -> None:
    scene = Scene()
    scene.set_object("a/b", BOX)
    scene.set_transform("a", moved(1.0))
    scene.set_transform("a/b", moved(2.0))
    assert scene.world_transform("a/b")[0, 3] == 3.0
    assert scene.transform("a/b")[0, 3] == 2.0


def test_hidden_parent_hides_its_children() -> None:
    scene = Scene()
    scene.set_object("a/b", BOX)
    scene.set_visible("a", False)
    assert not scene.is_visible("a/b")
    scene.set_visible("a", True)
    assert scene.is_visible("a/b")


def test_transform_is_copied_so_that_later_array_changes_do_not_move_the_node() -> None:
    scene = Scene()
    matrix = moved(1.0)
    scene.set_transform("a", matrix)
    matrix[0, 3] = 5.0
    assert scene.transform("a")[0, 3] == 1.0


def test_equal_transform_and_visibility_do_not_notify_listeners() -> None:
    scene = Scene()
    scene.set_transform("a", moved(1.0))
    scene.set_visible("a", False)
    received: list[tuple[str, str]] = []
    scene.listen(lambda kind, path: received.append((kind, path)))
    scene.set_transform("a", moved(1.0))
    scene.set_visible("a", False)
    assert received == []


@pytest.mark.parametrize(
    ("following", "changes"),
    [
        (Lines([(0, 0, 0), (1, 0, 0)], (1, 0, 0, 1)), []),
        (Lines([(0, 0, 0), (2, 0, 0)], (1, 0, 0, 1)), [("object", "a")]),
        (Lines([(0, 0, 0), (1, 0, 0)], (1, 0, 0, 1), width=0.1), [("object", "a")]),
        (Points([(0, 0, 0), (1, 0, 0)], (1, 0, 0, 1), (0.1, 0.1)), [("object", "a")]),
    ],
)
def test_equal_object_does_not_notify_listeners(
    following: Lines | Points, changes: list[tuple[str, str]]
) -> None:
    scene = Scene()
    scene.set_object("a", Lines([(0, 0, 0), (1, 0, 0)], (1, 0, 0, 1)))
    received: list[tuple[str, str]] = []
    scene.listen(lambda kind, path: received.append((kind, path)))
    scene.set_object("a", following)
    assert received == changes


def test_mesh_whose_bounding_box_was_computed_equals_one_without() -> None:
    triangle = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    one, other = (Mesh(triangle, None, (1, 0, 0, 1)) for _ in range(2))
    assert one.corners.shape == (2, 3)
    assert are_equal(one, other)
    assert are_equal(other, one)


def test_equal_transform_is_a_change_while_an_animation_moves_nodes_in_the_pages() -> None:
    scene = Scene()
    scene.set_transform("a", moved(1.0))
    scene.set_animation({})
    received: list[tuple[str, str]] = []
    scene.listen(lambda kind, path: received.append((kind, path)))
    scene.set_transform("a", moved(1.0))
    assert received == [("transform", "a")]


def test_wrong_shape_is_rejected_with_both_shapes() -> None:
    with pytest.raises(CourseError, match=r"transform of 'a' has shape \(3, 3\), expected \(4, 4\)"):
        Scene().set_transform("a", np.eye(3))


def test_unknown_path_is_rejected_with_close_paths() -> None:
    scene = Scene()
    scene.set_object("displays/grid", BOX)
    with pytest.raises(CourseError, match="similar nodes: displays/grid"):
        scene.transform("displays/gird")


def test_scene_listeners_receive_every_change_until_stopped() -> None:
    scene = Scene()
    received: list[tuple[str, str]] = []
    stop = scene.listen(lambda what, path: received.append((what, path)))
    scene.set_object("a", BOX)
    scene.background = (1, 2, 3)
    scene.delete("a")
    stop()
    scene.set_object("a", BOX)
    assert received == [("object", "a"), ("background", ""), ("delete", "a")]
