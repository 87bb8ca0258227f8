"""The box around the objects of a scene."""

from collections.abc import Iterable

import numpy as np

from course_lib.arrays import Floats, Reals
from course_lib.viewer.drawables import Drawable, Inset, Lines, Mesh, MeshcatObject, Points, Sheet, Solids
from course_lib.viewer.scene import Scene

# The number of points from which on a few far ones are ignored, as a laser scanner measures them.
_MANY = 50
# Percentiles of each coordinate that bound many points.
_MOST = (2.0, 98.0)


def bounds_of(scene: Scene, paths: Iterable[str]) -> Floats | None:
    """Return the lowest and highest corner of objects, in the scene's frame, shape (2, 3).

    Of many points, the farthest 2 % on each side are ignored.

    Returns:
        None if nothing has a place: no object, only pictures in a corner, or no finite number.
    """
    boxes = [_box(scene, path, thing) for path in paths if (thing := scene.node(path).object) is not None]
    found = [box for box in boxes if box is not None and np.isfinite(box).all()]
    if not found:
        return None
    lows, highs = np.stack(found, axis=1)
    corners: Floats = np.stack([lows.min(axis=0), highs.max(axis=0)])
    return corners


def _box(scene: Scene, path: str, thing: Drawable) -> Floats | None:
    """Return the corners of an object's box in the scene's frame, or None if it has no place."""
    points, reach = _places(thing)
    transform = scene.world_transform(path)
    # Distant points may overflow; such boxes are left out.
    with np.errstate(all="ignore"):
        placed = points @ transform[:3, :3].T + transform[:3, 3]
        half = reach @ np.abs(transform[:3, :3]).T
        kept = np.isfinite(placed).all(axis=1)
        if not kept.any():
            return None
        low, high = (placed - half)[kept], (placed + half)[kept]
        if len(low) >= _MANY and isinstance(thing, Points):
            return np.stack([np.percentile(low, _MOST[0], axis=0), np.percentile(high, _MOST[1], axis=0)])
        return np.stack([low.min(axis=0), high.max(axis=0)])


def _places(thing: Drawable) -> tuple[Reals, Reals]:
    """Return the points of an object, shape (N, 3), and how far it reaches beyond them, shape (N or 1, 3)."""
    nothing = np.zeros((1, 3))
    if isinstance(thing, Solids):
        return thing.placements[:, :3, 3], np.abs(thing.placements[:, :3, :3]).sum(axis=2) / 2
    if isinstance(thing, Mesh):
        return thing.vertices, nothing
    if isinstance(thing, Lines | Points):
        return thing.points, nothing
    if isinstance(thing, Sheet):
        rows, columns = thing.cells.shape
        return np.array([(0, 0, 0), (columns * thing.width, rows * thing.width, 0)]), nothing
    if isinstance(thing, MeshcatObject):
        return (np.empty((0, 3)) if thing.stand_in is None else thing.stand_in.vertices), nothing
    return (np.empty((0, 3)) if isinstance(thing, Inset) else nothing), nothing
