"""What a scene shows, in words: for those who do not see it, and for tests."""

import numpy as np

from course_lib.arrays import Reals
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Points, Sheet, Solids, Text
from course_lib.viewer.scene import Scene

LIMIT = 20  # objects that are told one by one


def summary(scene: Scene) -> list[str]:
    """Return a line for each object that is shown: its path, what it is, and where its middle is in [m]."""
    shown = [(path, thing) for path, thing in scene.objects().items() if scene.visible(path)]
    lines = [f"{path}: {_what(thing)} at {_middle(scene, path, thing)}" for path, thing in shown[:LIMIT]]
    return lines + ([f"and {len(shown) - LIMIT} more"] if len(shown) > LIMIT else [])


def _what(thing: Drawable) -> str:
    if isinstance(thing, Solids):
        name = {"sphere": "ellipsoid"}.get(thing.shape, thing.shape)
        return _counted(len(thing.placements), name)
    if isinstance(thing, Mesh):
        return _counted(len(thing.faces), "triangle")
    if isinstance(thing, Points):
        return _counted(len(thing.points), "point")
    if isinstance(thing, Lines):
        return _counted(len(thing.points) - 1 if thing.strip else len(thing.points) // 2, "line")
    if isinstance(thing, Sheet):
        return f"{thing.cells.shape[1]} x {thing.cells.shape[0]} cells"
    return f"the words {thing.text!r}" if isinstance(thing, Text) else "an object of meshcat"


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'es' if name == 'box' else 's'}" if count != 1 else f"1 {name}"


def _middle(scene: Scene, path: str, thing: Drawable) -> str:
    """Return the middle of what an object's points span, in the scene's frame."""
    points: Reals
    if isinstance(thing, Solids):
        points = thing.placements[:, :3, 3]
    elif isinstance(thing, Mesh):
        points = thing.vertices
    elif isinstance(thing, Sheet):
        rows, columns = thing.cells.shape
        points = np.array([(0, 0, 0), (columns * thing.width, rows * thing.width, 0)])
    else:
        points = thing.points if isinstance(thing, Lines | Points) else np.zeros((1, 3))
    transform = scene.world_transform(path)
    if not len(points):
        return "nowhere"
    placed = points @ transform[:3, :3].T + transform[:3, 3]
    x, y, z = np.round((placed.min(axis=0) + placed.max(axis=0)) / 2, 2) + 0.0  # no minus zero
    return f"({x:g}, {y:g}, {z:g})"
