"""turtlesim's window as a top view: water, pen lines and turtles."""

from itertools import count

import numpy as np

from course_lib.displays.shapes import placement
from course_lib.displays.viewer import Viewer
from course_lib.displays.views import TopDownOrtho
from course_lib.robots.turtlesim import METER, PIXELS, SIZE, TurtlesimNode
from course_lib.viewer.drawables import Drawable, Lines, Solids

ROOT = "turtlesim"
# The time between two updates [s].
PERIOD = 0.04
# The scale [px/m], at which the whole water fits into a view of the default height.
SCALE = 25.0
SKIN = (0.6, 0.85, 0.3, 1.0)
SHELLS = (
    (0.55, 0.35, 0.2, 1.0), (0.75, 0.3, 0.25, 1.0), (0.85, 0.65, 0.2, 1.0), (0.5, 0.3, 0.6, 1.0),
    (0.2, 0.5, 0.5, 1.0),
)  # fmt: skip
# Centers and sizes of head, legs and tail along x and y [m].
LIMBS = (
    (0.5, 0.0, 0.36, 0.3), (0.28, 0.36, 0.32, 0.2), (0.28, -0.36, 0.32, 0.2), (-0.28, 0.36, 0.32, 0.2),
    (-0.28, -0.36, 0.32, 0.2), (-0.48, 0.0, 0.26, 0.12),
)  # fmt: skip
UNTURNED = np.eye(3)


class TurtleView:
    """The display of a turtlesim simulator in a viewer.

    Args:
        node: The simulator, whose timer triggers drawing.
    """

    def __init__(self, node: TurtlesimNode) -> None:
        self._node = node
        self.viewer = Viewer(fixed_frame="world")
        self.viewer.remove(self.viewer["Grid"])
        self.viewer.view = TopDownOrtho(scale=SCALE, x=SIZE / 2, y=SIZE / 2)
        self._drawn: dict[str, object] = {}
        self._turtles: dict[str, int] = {}
        self._numbers = count()
        self.draw()
        node.create_timer(PERIOD, self.draw)

    def draw(self) -> None:
        """Update the drawing."""
        water = tuple(channel / 255 for channel in self._node.background)
        edge = PIXELS / METER  # [m]
        box = placement(UNTURNED, (edge, edge, 0.01), (SIZE / 2, SIZE / 2, -0.1))
        self._show("water", water, Solids("box", [box], (*water, 1.0), lit=False))
        # Draw pen lines that have grown, and remove cleared ones.
        strips = {f"lines/{number}": strip for number, strip in enumerate(self._node.canvas.strips)}
        for name in [name for name in self._drawn if name.startswith("lines/") and name not in strips]:
            del self._drawn[name]
            self.viewer.scene.delete(f"{ROOT}/{name}")
        for name, strip in strips.items():
            state = (id(strip), len(strip.points))
            if self._drawn.get(name) != state:
                points = [(x, y, 0.0) for x, y in strip.points]
                color = (*(channel / 255 for channel in strip.pen.color), 1.0)
                self._show(name, state, Lines(points, color, strip.pen.width / METER))
        scene = self.viewer.scene
        for name in self._turtles.keys() - self._node.turtles.keys():
            del self._turtles[name]
            scene.delete(f"{ROOT}/turtles/{name}")
        for name, turtle in self._node.turtles.items():
            path = f"{ROOT}/turtles/{name}"
            if name not in self._turtles:
                self._turtles[name] = next(self._numbers)
                # A turtle faces x, with a shell in its own color.
                limbs = [placement(UNTURNED, (long, wide, 0.1), (x, y, 0.1)) for x, y, long, wide in LIMBS]
                shell = placement(UNTURNED, (0.75, 0.62, 0.2), (0.0, 0.0, 0.2))
                shell_color = SHELLS[self._turtles[name] % len(SHELLS)]
                scene.set_object(f"{path}/limbs", Solids("sphere", limbs, SKIN))
                scene.set_object(f"{path}/shell", Solids("sphere", [shell], shell_color))
            cos, sin = np.cos(turtle.theta), np.sin(turtle.theta)
            turned = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            scene.set_transform(path, placement(turned, 1.0, (turtle.x, turtle.y, 0.0)))

    def _show(self, name: str, state: object, drawable: Drawable) -> None:
        if self._drawn.get(name) != state:
            self._drawn[name] = state
            self.viewer.scene.set_object(f"{ROOT}/{name}", drawable)
