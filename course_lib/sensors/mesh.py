"""Triangle meshes, with a tree of boxes so that a ray meets few of the triangles."""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from course_lib.errors import CourseError
from course_lib.sensors.checked import Floats, check_array
from course_lib.sensors.shapes import Shape

_LEAF = 4  # triangles
_CHUNK = 2048  # rays at a time: bounds the memory of the pairs
_RIM = 1e-12  # no gap between neighbours


def mesh(vertices: ArrayLike, faces: ArrayLike) -> Shape:
    """Make a shape of triangles, seen from both sides.

    Args:
        vertices: Shape (V, 3), [m].
        faces: Indices of vertices, shape (F, 3).
    """
    points = check_array("vertices [m] of a mesh", vertices, (-1, 3))
    corners = check_array("faces of a mesh", faces, (-1, 3))
    if not corners.size or corners.min() < 0 or corners.max() >= len(points) or (corners % 1).any():
        raise CourseError(
            f"faces of a mesh are {corners.tolist()!s:.60}; give one or more rows of three "
            f"whole numbers of vertices, from 0 to {len(points) - 1}."
        )
    triangles = _Triangles(points[corners.astype(np.intp)])
    used = np.abs(triangles.corners)
    reach = float(np.linalg.norm(used, axis=2).max())
    return Shape(2 * used.max(axis=(0, 1)), reach, triangles.distances)


def load_mesh(path: Path | str) -> Shape:
    """Read an STL, OBJ or DAE file, in metres, by coal.

    Raises:
        CourseError: If the file is missing or holds no mesh.
    """
    # On first use: slow to import, absent on Windows; it ships no types.
    import coal  # type: ignore[import-untyped,unused-ignore]

    try:
        model = coal.MeshLoader().load(str(path), np.ones(3))
    except (RuntimeError, ValueError) as error:
        raise CourseError(
            f"{path} cannot be read as a mesh. Give an STL, OBJ or DAE file that exists."
        ) from error
    triangles = [model.tri_indices(number) for number in range(model.num_tris)]
    return mesh(model.vertices(), [[triangle[corner] for corner in range(3)] for triangle in triangles])


class _Triangles:
    """Triangles in a full binary tree of boxes; node k has the children 2k + 1 and 2k + 2.

    Args:
        corners: Shape (F, 3 corners, 3), [m].
    """

    def __init__(self, corners: Floats) -> None:
        self.corners = corners
        leaves = 1 << int(np.ceil(np.log2(max(1.0, len(corners) / _LEAF))))
        order = np.resize(np.arange(len(corners)), leaves * _LEAF)[None]  # some faces twice: harmless
        centers = corners.mean(axis=1)
        while len(order) < leaves:  # split every node in two, across its longest edge
            points = centers[order]
            axis = np.ptp(points, axis=1).argmax(axis=1)
            keys = np.take_along_axis(points, axis[:, None, None], axis=2)[..., 0]
            order = np.take_along_axis(order, keys.argsort(axis=1, kind="stable"), axis=1)
            order = order.reshape(2 * len(order), -1)
        low, high = [corners[order].min(axis=(1, 2))], [corners[order].max(axis=(1, 2))]
        while len(low[0]) > 1:
            low.insert(0, np.minimum(low[0][::2], low[0][1::2]))
            high.insert(0, np.maximum(high[0][::2], high[0][1::2]))
        self._order, self._low, self._high = order, np.concatenate(low), np.concatenate(high)

    def distances(self, origin: Floats, rays: Floats) -> Floats:
        """Cast rays; see Shape."""
        parts = [rays[:, at : at + _CHUNK] for at in range(0, rays.shape[1], _CHUNK)]
        return np.concatenate([self._cast(origin, part) for part in parts])

    def _cast(self, origin: Floats, rays: Floats) -> Floats:
        """Go down the tree level by level with all pairs of a ray and a node that it meets."""
        low, high = (self._low - origin).T, (self._high - origin).T
        with np.errstate(divide="ignore"):
            slopes = 1 / rays
        first_leaf = len(self._order) - 1
        ray, node = np.arange(rays.shape[1]), np.zeros(rays.shape[1], np.intp)
        while True:
            met = _boxes_met(low[:, node], high[:, node], slopes[:, ray])
            ray, node = ray[met], node[met]
            if not len(node) or node[0] >= first_leaf:  # the tree is full: all reach the leaves together
                break
            ray, node = np.repeat(ray, 2), (2 * node[:, None] + (1, 2)).ravel()
        ray, face = np.repeat(ray, _LEAF), self._order[node - first_leaf].ravel()
        nearest = np.full(rays.shape[1], np.inf)
        np.minimum.at(nearest, ray, self._triangles_met(origin, rays[:, ray], face))
        return nearest

    def _triangles_met(self, origin: Floats, rays: Floats, face: NDArray[np.intp]) -> Floats:
        """Cast each ray at one triangle, inf for a miss (Möller and Trumbore 1997).

        All rays have one origin, so what does not depend on the direction is worked out once per triangle.
        """
        edge, other = (self.corners[:, corner] - self.corners[:, 0] for corner in (1, 2))
        start = origin - self.corners[:, 0]
        turned = np.cross(start, edge)
        height = np.einsum("ij,ij->i", other, turned)
        normals = (np.cross(other, edge), np.cross(other, start), turned)
        scale, u, v = (np.einsum("ij,ij->j", rays, normal.T[:, face]) for normal in normals)
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel to the triangle: NaN, a miss
            u, v, along = u / scale, v / scale, height[face] / scale
            inside = (u >= -_RIM) & (v >= -_RIM) & (u + v <= 1 + _RIM)
        return np.where(inside & (along >= 0), along, np.inf)


def _boxes_met(low: Floats, high: Floats, slopes: Floats) -> NDArray[np.bool_]:
    """Tell which rays meet their box; corners from the rays' origin, all shape (3, pairs)."""
    with np.errstate(invalid="ignore"):  # along a wall: 0 * inf
        one, other = low * slopes, high * slopes
        enter, leave = np.fmin(one, other).max(axis=0), np.fmax(one, other).min(axis=0)
        # A hair of room, since a box may be as flat as its triangle.
        met: NDArray[np.bool_] = (enter <= leave + 1e-9 * (1 + np.abs(leave))) & (leave >= -1e-9)
    return met
