"""One link of a robot in the scene."""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from course_lib.displays.axes import axes
from course_lib.displays.frames import Matrix
from course_lib.displays.robot_model.looks import Looks, inertia, mass, placement
from course_lib.robots.links import Link
from course_lib.viewer.drawables import Drawable, Lines
from course_lib.viewer.scene import Scene

_TRAIL_STEP, _TRAIL_STEPS = 0.02, 100  # [m], of 2 m; as RViz's ribbon
_TRAIL_WIDTH = 0.01  # [m]
_TRAIL_COLOR = (0.0, 0.5, 0.5, 1.0)
_AXES = axes(0.1, 0.01)


@dataclass(frozen=True)
class Wanted:
    """What is to be seen of a link."""

    shown: Mapping[str, bool]  # by kind: visual, collision, mass, inertia, axes, trail
    alpha: float
    lost: bool = False  # whether nobody knows where it is


class DrawnLink:
    """A link below its node of the scene; what is not to be seen is not even made."""

    def __init__(self, scene: Scene, path: str, link: Link, file: Path | None) -> None:
        self.name = link.name
        self.has_geometry = bool(link.visuals or link.collisions)  # whether it can be seen at all
        self.looks = Looks(link, file)
        self._scene = scene
        self._path = path
        self._body = link.inertial
        self._transform: Matrix | None = None
        self._wanted: Wanted | None = None
        self._made: dict[str, object] = {}  # what each kind was drawn with
        self._trail: deque[Matrix] = deque(maxlen=_TRAIL_STEPS)
        self._shapes = {"visual": link.visuals, "collision": link.collisions}

    def show(self, wanted: Wanted) -> None:
        """Show what is wanted, and hide the rest."""
        if wanted == self._wanted:
            return
        self._wanted = wanted
        for kind, shown in wanted.shown.items():
            node = f"{self._path}/{kind}"
            look = (wanted.alpha, wanted.lost) if kind in self._shapes else None
            if shown and self._made.get(kind, ()) != look:
                self._made[kind] = look
                self._scene.delete(node)
                self._draw(node, kind, wanted)
            if kind in self._made:
                self._scene.set_visible(node, shown)
        if not wanted.shown["trail"]:
            self._trail.clear()

    def place(self, transform_link_to_fixed: Matrix) -> None:
        """Move the link."""
        if transform_link_to_fixed is self._transform:
            return
        self._transform = transform_link_to_fixed
        for kind in self._made.keys() - {"trail"}:
            self._scene.set_transform(f"{self._path}/{kind}", transform_link_to_fixed)
        if "trail" in self._made:
            self._follow(transform_link_to_fixed[:3, 3])

    def _draw(self, node: str, kind: str, wanted: Wanted) -> None:
        for name, (drawable, transform) in self._parts(kind, wanted):
            self._scene.set_object(f"{node}/{name}", drawable)
            self._scene.set_transform(f"{node}/{name}", transform)
        if self._transform is not None and kind != "trail":
            self._scene.set_transform(node, self._transform)

    def _parts(self, kind: str, wanted: Wanted) -> Iterable[tuple[str, tuple[Drawable, Matrix]]]:
        for index, shape in enumerate(self._shapes.get(kind, ())):
            drawable = self.looks.drawn(shape, wanted.alpha, wanted.lost)
            if drawable is not None:
                yield str(index), (drawable, placement(shape))
        body = self._body
        other = {"mass": body and mass(body), "inertia": body and inertia(body), "axes": _AXES}.get(kind)
        if other:
            yield kind, (other, np.eye(4))

    def _follow(self, position: Matrix) -> None:
        """Lengthen the trail, and let its end go after 2 m."""
        trail = self._trail
        start = trail[-1] if trail else position
        way = float(np.linalg.norm(position - start))
        steps = int(way / _TRAIL_STEP) if trail else 1
        for step in range(max(steps - _TRAIL_STEPS, 0) + 1, steps + 1):
            trail.append(start + (position - start) * (step * _TRAIL_STEP / (way or 1.0)))
        if steps and len(trail) > 1:
            self._scene.set_object(f"{self._path}/trail", Lines(np.array(trail), _TRAIL_COLOR, _TRAIL_WIDTH))
