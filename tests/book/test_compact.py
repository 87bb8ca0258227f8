import numpy as np
import pytest
import trimesh

from course_lib.book.kernel import MOST_FACES, SHARED, PageMesh, compact, simplify
from course_lib.viewer import encoding
from course_lib.viewer.drawables import Mesh
from course_lib.viewer.scene import Scene


def ball(faces: int = 4) -> Mesh:
    """Return a ball of radius 0.1 m, its upper half red, the lower blue."""
    sphere = trimesh.creation.icosphere(faces, 0.1)
    red, blue = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
    colors = np.where(sphere.vertices[:, 2:] > 0, red, blue)
    return Mesh(sphere.vertices, sphere.faces, colors, sphere.vertex_normals)


def scene_of(*meshes: Mesh) -> bytes:
    scene = Scene()
    for number, mesh in enumerate(meshes):
        scene.set_object(f"mesh{number}", mesh)
    return encoding.snapshot(scene)


@pytest.mark.slow
def test_large_mesh_is_simplified_with_shape_and_colors_preserved() -> None:
    large = ball()
    assert large.normals is not None
    colors = np.rint(large.colors * 255).astype(np.uint8)
    mesh = simplify(PageMesh(large.vertices, large.faces, large.normals, colors), MOST_FACES)
    assert len(large.faces) > 3 * MOST_FACES
    assert MOST_FACES / 3 < len(mesh.faces) <= MOST_FACES
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 0.1, atol=0.006)
    assert np.allclose(mesh.normals, mesh.vertices / 0.1, atol=0.2)
    is_red = mesh.colors[:, 0] == 255
    assert (mesh.vertices[is_red, 2] > -0.006).all()
    assert (mesh.vertices[~is_red, 2] < 0.006).all()


@pytest.mark.slow
def test_equal_meshes_of_several_scenes_are_stored_once() -> None:
    one, of_one = compact(scene_of(ball()))
    two, of_two = compact(scene_of(ball(), ball()))
    assert of_one == of_two
    assert len(of_one) == 1
    assert max(len(one), len(two)) < SHARED


def test_small_mesh_is_stored_in_its_scene() -> None:
    packed = scene_of(ball(1))
    small, shared = compact(packed)
    assert (small, shared) == (packed, {})
