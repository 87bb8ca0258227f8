"""Small scenes, seen from above, in a page."""

import numpy as np

from course_lib.viewer.drawables import Camera, Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host

RED, GREEN, BLUE = (255, 0, 0), (0, 255, 0), (0, 0, 255)


def box(color: tuple[int, int, int], x: float = 0.0) -> Solids:
    transform_unit_to_node = np.eye(4)
    transform_unit_to_node[0, 3] = x  # [m]
    return Solids("box", [transform_unit_to_node], (*np.divide(color, 255), 1))


def from_above() -> Scene:
    scene = Scene()
    scene.camera = Camera(eye=(0, 0, 6), target=(0, 0, 0), up=(0, 1, 0))
    return scene


def show_scene(host: Host, scene: Scene) -> SceneWidget:
    widget = SceneWidget(scene, height=300)
    host.open(widget)
    host.show(widget)
    return widget
