"""Views without a graphics card: fewer triangles while something moves, and no instances."""

from base64 import b64decode
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from course_lib.viewer.drawables import Camera, Inset, Lines, Mesh, Points, Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host, count
from tests.browser.waiting import wait_until

pytestmark = pytest.mark.browser
RED, GREY = (255, 0, 0), (200, 200, 200)
SIDE = 200  # rows and columns of the mesh
COUNT_DRAWN = """() => {
    globalThis.drawn = [];
    globalThis.instanced = 0;
    for (const gl of [WebGLRenderingContext, WebGL2RenderingContext]) {
        const [draw, drawInstances] = [gl.prototype.drawElements, gl.prototype.drawElementsInstanced];
        gl.prototype.drawElements = function (...all) {
            drawn.push(all[1] / 3); return draw.apply(this, all); };
        gl.prototype.drawElementsInstanced = function (...all) {
            instanced++; return drawInstances.apply(this, all); };
    } }"""


@pytest.fixture
def counted(host: Host) -> Host:
    host.page.evaluate(COUNT_DRAWN)
    return host


def shown(host: Host, **objects: Any) -> Scene:
    """Show a scene that the camera sees from above."""
    scene = Scene()
    for name, drawable in objects.items():
        scene.set_object(name, drawable)
    widget = SceneWidget(scene)
    host.open(widget)
    host.show(widget)
    host.carry()
    return scene


def sphere() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return the vertices and faces of a sphere with a radius of 1.5 m."""
    around, over = np.meshgrid(np.linspace(0, 2 * np.pi, SIDE), np.linspace(0, np.pi, SIDE))
    flat = np.sin(over)
    places = np.stack([np.cos(around) * flat, np.sin(around) * flat, np.cos(over)], axis=-1)
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + SIDE, corner + 1], axis=1),
            np.stack([corner + 1, corner + SIDE, corner + SIDE + 1], axis=1),
        ]
    )
    return 1.5 * places.reshape(-1, 3).astype(np.float32), faces.astype(np.uint32)


@pytest.mark.slow
def test_moving_mesh_is_simplified_and_drawn_in_full_at_rest(counted: Host) -> None:
    vertices, faces = sphere()
    scene = shown(counted, ball=Mesh(vertices, faces, (200 / 255,) * 3 + (1,), lit=False))
    page = counted.page
    assert page.evaluate("Math.max(...drawn)") == len(faces)
    full = count(counted.pixels(), GREY)
    where = np.eye(4)
    fewest: float = len(faces)

    def is_coarse() -> bool:
        nonlocal fewest
        where[2, 3] += 1e-6  # [m]
        scene.set_transform("ball", where)
        page.evaluate("drawn.length = 0")
        counted.carry()
        fewest = min([fewest, *page.evaluate("drawn")])
        return bool(fewest < len(faces) / 4)

    wait_until(is_coarse, page)
    coarse = count(counted.pixels(), GREY)
    assert coarse == pytest.approx(full, rel=0.1)
    page.evaluate("drawn.length = 0")
    wait_until(lambda: len(faces) in page.evaluate("drawn"), page)
    assert count(counted.pixels(), GREY) == pytest.approx(full, rel=0.005)


KEEP_WIDTHS = """() => {
    globalThis.widths = [];
    for (const gl of [WebGLRenderingContext, WebGL2RenderingContext]) {
        const viewport = gl.prototype.viewport;
        gl.prototype.viewport = function (...all) { widths.push(all[2]); return viewport.apply(this, all); };
    } }"""


def test_first_image_of_a_drag_is_coarse_and_the_last_image_at_rest_is_fine(host: Host) -> None:
    host.page.evaluate(KEEP_WIDTHS)
    shown(host, box=Solids("box", [np.eye(4)], (1, 0, 0, 1)))
    canvas = host.page.locator("canvas")
    wait_until(lambda: canvas.get_attribute("aria-busy") == "false", host.page)
    width = host.page.evaluate("document.querySelector('canvas').width")
    assert max(host.page.evaluate("widths")) == 2 * width
    first = host.page.evaluate("""async () => {
        widths.length = 0;
        document.querySelector("canvas").dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
        while (!widths.length) await new Promise(requestAnimationFrame);
        return Math.max(...widths); }""")
    assert first <= width
    wait_until(lambda: canvas.get_attribute("aria-busy") == "false", host.page)
    assert max(host.page.evaluate("widths")) == 2 * width


def test_many_boxes_points_and_lines_need_one_draw_call_each_without_instancing(counted: Host) -> None:
    spread = np.stack([np.linspace(-2, 2, 300)] * 2 + [np.zeros(300)], axis=-1)
    boxes = np.tile(np.eye(4), (300, 1, 1))
    boxes[:, :3, 3] = spread
    boxes[:, [0, 1, 2], [0, 1, 2]] = 0.05
    shown(
        counted,
        boxes=Solids("box", boxes, (1, 0, 0, 1)),
        points=Points(spread, (1, 0, 0, 1), (0.05, 0.05)),
        lines=Lines(spread, (1, 0, 0, 1), width=0.05),
    )
    assert count(counted.pixels(), RED, 120) > 100
    assert counted.page.evaluate("instanced") == 0
    drawn = counted.page.evaluate("drawn")
    assert {300 * 12, 300 * 2} <= set(drawn)


COUNT_DOTS = """() => {
    globalThis.dots = [];
    for (const gl of [WebGLRenderingContext, WebGL2RenderingContext]) {
        const draw = gl.prototype.drawArrays;
        gl.prototype.drawArrays = function (...all) {
            if (all[0] === this.POINTS) dots.push(all[2]); return draw.apply(this, all); };
    } }"""


def red_of(pixels: NDArray[Any]) -> tuple[int, float]:
    """Return the number of red pixels, and their mean brightness."""
    is_red = (pixels[..., 0] > 100) & (pixels[..., 1] < 60)
    return int(is_red.sum()), float(pixels[is_red, 0].mean())


def test_very_many_boxes_are_dots_that_look_like_boxes_while_the_view_turns(counted: Host) -> None:
    page = counted.page
    page.evaluate(COUNT_DOTS)
    across = np.linspace(-2, 2, 40)  # [m]
    places = np.stack([part.ravel() for part in np.meshgrid(across, across, [0.0])], axis=-1)
    shown(counted, boxes=Points(places, (1, 0, 0, 1), (0.05,) * 3, spot="box"))
    canvas = page.locator("canvas")
    wait_until(lambda: canvas.get_attribute("aria-busy") == "false", page)
    page.evaluate("dots.length = drawn.length = 0")
    full = red_of(counted.pixels())
    copied = page.evaluate("""async () => {
        const canvas = document.querySelector("canvas");
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight" }));
        while (!dots.length) await new Promise(requestAnimationFrame);
        return canvas.toDataURL("image/png"); }""")
    picture = Image.open(BytesIO(b64decode(copied.partition(",")[2]))).convert("RGB")
    assert page.evaluate("[dots[0], drawn.length]") == [1600, 0]
    assert full[0] > 1000
    assert red_of(np.asarray(picture)) == pytest.approx(full, rel=0.1)
    wait_until(lambda: canvas.get_attribute("aria-busy") == "false", page)
    assert set(page.evaluate("drawn")) == {1600 * 12}


def test_click_on_one_of_many_boxes_gives_its_index(host: Host) -> None:
    boxes = np.tile(np.eye(4), (3, 1, 1))
    boxes[:, 0, 3] = (-9.0, 0.0, 9.0)
    scene = Scene()
    scene.set_object("boxes", Solids("box", boxes, (1, 0, 0, 1)))
    widget = SceneWidget(scene)
    clicks: list[Any] = []
    widget.link.on_click.append(clicks.append)
    host.open(widget)
    host.show(widget)
    host.carry()
    box = host.page.locator("canvas").bounding_box()
    assert box is not None
    host.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    host.wait_until(lambda: clicks)
    assert (clicks[0].path, clicks[0].index) == ("boxes", 1)


COUNT_COPIES = """() => {
    globalThis.copies = { view: 0, corner: 0 };
    const copy = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function (...all) {
        // Only pictures of the scene are copied in part; those of a corner go to a canvas of their own.
        if (all.length === 9) copies[this.canvas.isConnected ? "view" : "corner"]++;
        return copy.apply(this, all); }; }"""
TURN = """async turns => {
    Object.assign(copies, { view: 0, corner: 0 });
    for (let i = 0; i < turns; i++) {
        const key = new KeyboardEvent("keydown", { key: "ArrowLeft" });
        document.querySelector("canvas").dispatchEvent(key);
        await new Promise(requestAnimationFrame);
        await new Promise(requestAnimationFrame);
    }
    return copies; }"""


def test_scene_in_a_corner_is_not_drawn_again_while_only_the_view_turns(host: Host) -> None:
    host.page.evaluate(COUNT_COPIES)
    inset = Inset(np.zeros((3, 4, 3), np.uint8), camera=Camera(eye=(4, 0, 0)))
    shown(host, box=Solids("box", [np.eye(4)], (1, 0, 0, 1)), inset=inset)
    wait_until(lambda: host.page.evaluate("copies.corner") > 0, host.page)
    copies = host.page.evaluate(TURN, 40)
    assert copies["view"] >= 40
    assert copies["corner"] <= copies["view"] / 2
