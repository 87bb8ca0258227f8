"""The default view shows what is drawn, until somebody sets the view.

RViz starts 10 m from the origin, whatever is there. A view here that neither a program nor a layout
nor a hand has set is moved so that everything drawn and the origin are in the picture: when
something is drawn for the first time, and when a display draws for the first time, or a cell shows
the view, while something is outside the picture. It does not follow motion: a robot that drives
away leaves the picture, as in RViz.
"""

from math import pi, tan
from typing import Any

import numpy as np

from course_lib.arrays import Floats
from course_lib.displays.views import Orbit, direction
from course_lib.viewer.bounds import bounds_of
from course_lib.viewer.drawables import Camera
from course_lib.viewer.scene import Node, Scene

# Half the height of a picture at a distance of 1 m.
_SLOPE = tan(pi / 8)
# Width of the picture divided by its height that things have to fit in: views in cells are wider,
# and views beside the notebook may be a little narrower.
_ASPECT = 1.0
# The fraction of the picture that things may fill.
_FILLED = 0.85
# Half the side of the cube around the origin that is always in the picture, [m].
_AROUND_ORIGIN = 0.5
# Size of the drawn things, as a multiple of their distance to the origin, below which it is left
# out.
_FAR_AWAY = 0.03
# [m] range of the distance of a view.
_NEAREST, _FARTHEST = 2.0, 500.0


class Framing:
    """Moves a view that nobody has set.

    Args:
        scene: What is drawn.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        # Paths of displays, and of what programs add themselves, that have drawn something.
        self._drawn: set[str] = set()

    def choose(self, view: Orbit, camera: Camera, references: set[str], *, is_opened: bool) -> bool:
        """Move a view if the rule says so.

        Args:
            view: The view to move.
            camera: What it shows now.
            references: Paths of grids and axes, which have no place of their own.
            is_opened: Whether a cell is about to show the view.

        Returns:
            Whether the view has changed.
        """
        with self._scene.lock:
            is_first = not self._drawn
            new = [
                node.path
                for root in self._scene.node("").children.values()
                for node in root.children.values()
                if node.path not in self._drawn and node.path not in references and _has_drawable(node)
            ]
            self._drawn.update(new)
            if not new and (is_first or not is_opened):
                return False
            below = (self._scene.find(path) for path in self._drawn)
            drawn = [inner for node in below if node is not None for inner in node.subtree()]
            shown = [node.path for node in drawn if node.object and self._scene.visible(node.path)]
            bounds = bounds_of(self._scene, shown)
        if bounds is None:
            # Only pictures in a corner were drawn: what follows is the first thing with a place.
            self._drawn.difference_update(new)
            return False
        corners = _corners(_with_origin(bounds))
        if not is_first and _distance(
            corners, camera, np.array(camera.target), filled=1.0
        ) <= _focal_distance(camera):
            return False
        values = _values(corners, view)
        is_changed = any(view[label] != value for label, value in values.items())
        view.set_quietly(values)
        return is_changed


def _has_drawable(node: Node) -> bool:
    return any(inner.object is not None for inner in node.subtree())


def _with_origin(bounds: Floats) -> Floats:
    """Return the box with the origin, unless the drawn things are small and far away from it."""
    low, high = bounds
    far = np.linalg.norm(np.maximum(0, np.maximum(low, -high)))
    if np.linalg.norm(high - low) < _FAR_AWAY * far:
        return bounds
    return np.stack([np.minimum(low, -_AROUND_ORIGIN), np.maximum(high, _AROUND_ORIGIN)])


def _corners(bounds: Floats) -> Floats:
    """Return the corners of a box, shape (8, 3)."""
    return np.stack(np.meshgrid(*bounds.T, indexing="ij"), axis=-1).reshape(-1, 3)


def _values(corners: Floats, view: Orbit) -> dict[str, Any]:
    """Return the properties with which an Orbit of the fixed frame shows all corners."""
    focus = np.round((corners.min(axis=0) + corners.max(axis=0)) / 2, 2)
    camera = Camera(tuple(focus + direction(view["Yaw"], view["Pitch"])), tuple(focus))
    distance = _distance(corners, camera, focus, filled=_FILLED)
    x, y, z = (focus + 0.0).tolist()
    return {"Distance": min(max(round(distance, 1), _NEAREST), _FARTHEST), "Focal Point": (x, y, z)}


def _distance(corners: Floats, camera: Camera, focus: Floats, filled: float) -> float:
    """Return the distance [m] to a focal point from which all corners are in the picture."""
    right, up, near = ((corners - focus) @ camera.view_matrix()[:3, :3].T).T
    needed = np.maximum(np.abs(up), np.abs(right) / _ASPECT) / (_SLOPE * filled)
    return float((needed + near).max())


def _focal_distance(camera: Camera) -> float:
    """Return the distance of a camera to its focal point, [m]."""
    return float(np.linalg.norm(np.subtract(camera.eye, camera.target)))
