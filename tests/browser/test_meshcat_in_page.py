import meshcat
import meshcat.geometry as g
import numpy as np
import pytest
from meshcat.animation import Animation

from course_lib.viewer.drawables import Camera, Mesh, Solids, Text
from course_lib.viewer.scene import Scene
from course_lib.viewer.visualizer import Window
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host, count

pytestmark = pytest.mark.browser

CYAN = (0, 255, 255)


def show_scene(host: Host, scene: Scene) -> SceneWidget:
    scene.camera = Camera(eye=(0, 0, 6), target=(0, 0, 0), up=(0, 1, 0))
    widget = SceneWidget(scene, height=300)
    host.open(widget)
    host.show(widget)
    return widget


@pytest.mark.slow
def test_meshcat_object_without_an_equivalent_drawable_is_drawn_by_three_js(host: Host) -> None:
    scene = Scene()
    vis = meshcat.Visualizer(window=Window(scene))
    wires = g.MeshBasicMaterial(color=0x00FFFF, wireframe=True)
    vis["wires"].set_object(g.Sphere(1.0), wires)
    show_scene(host, scene)
    assert 200 < count(host.pixels(), CYAN, within=130) < 12_000


def test_meshcat_animation_plays(host: Host) -> None:
    scene = Scene()
    vis = meshcat.Visualizer(window=Window(scene))
    vis["box"].set_object(g.Box([1, 1, 1]), g.MeshLambertMaterial(color=0x00FFFF))
    animation = Animation(default_framerate=30)
    for frame_number, x in ((0, -1.5), (6, 1.5)):
        with animation.at_frame(vis["box"], frame_number) as frame:
            frame.set_transform(meshcat.transformations.translation_matrix([x, 0, 0]))
    vis.set_animation(animation)
    show_scene(host, scene)
    host.wait_until(lambda: count(host.pixels()[:, :200], CYAN) == 0)
    assert count(host.pixels()[:, 200:400], CYAN) > 1000


@pytest.mark.slow
def test_replaced_objects_are_freed_from_graphics_memory(host: Host) -> None:
    host.reload()
    host.page.evaluate("""() => {
        globalThis.alive = 0;
        const gl = WebGL2RenderingContext.prototype;
        const { createBuffer, deleteBuffer, createTexture, deleteTexture } = gl;
        gl.createBuffer = function () { alive++; return createBuffer.call(this); };
        gl.createTexture = function () { alive++; return createTexture.call(this); };
        gl.deleteBuffer = function (it) { if (it) alive--; return deleteBuffer.call(this, it); };
        gl.deleteTexture = function (it) { if (it) alive--; return deleteTexture.call(this, it); };
    }""")
    scene = Scene()
    widget = show_scene(host, scene)
    alive = []
    for number in range(6):
        scene.set_object("balls", Solids("sphere", [np.eye(4)] * 3, (1, 0, 0, 1)))
        scene.set_object("text", Text(f"{number}", 0.5))
        scene.set_object("mesh", Mesh(np.eye(3), None, (0, 1, 0, 1)))
        widget.flush()
        host.carry()
        alive.append(host.page.evaluate("alive"))
    assert alive[-1] == alive[1] > 0
    scene.delete("")
    widget.flush()
    host.carry()
    assert host.page.evaluate("alive") < alive[1] / 2
