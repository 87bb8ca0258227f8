import base64
from io import BytesIO

import msgpack
import numpy as np
import pytest
from PIL import Image

from course_lib.viewer import zbuffer
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Drawable, Lines, Mesh, MeshcatObject, Points, Sheet, Solids, Text
from course_lib.viewer.encoding import snapshot
from course_lib.viewer.page_link import Click
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host, count

pytestmark = pytest.mark.browser

RED, GREEN, BLUE = (255, 0, 0), (0, 255, 0), (0, 0, 255)


def box(color: tuple[int, int, int], x: float = 0.0) -> Solids:
    transform_unit_to_node = np.eye(4)
    transform_unit_to_node[0, 3] = x  # [m]
    return Solids("box", [transform_unit_to_node], (*np.divide(color, 255), 1))


def from_above() -> Scene:
    scene = Scene()
    scene.camera = Camera(eye=(0, 0, 6), target=(0, 0, 0), up=(0, 1, 0))
    return scene


def shown(host: Host, scene: Scene) -> SceneWidget:
    widget = SceneWidget(scene, height=300)
    host.open(widget)
    host.show(widget)
    return widget


def test_changes_reach_the_page_while_it_is_open(host: Host) -> None:
    scene = from_above()
    widget = shown(host, scene)
    assert widget.link.ready
    scene.set_object("a/box", box(RED))
    widget.flush()
    host.carry()
    left = count(host.pixels()[:, :200], RED)
    assert left > 1000
    scene.set_transform("a", np.array([[1, 0, 0, 1.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]))
    widget.flush()
    host.carry()
    assert count(host.pixels()[:, :200], RED) == 0
    assert count(host.pixels(), RED) > 1000
    scene.set_visible("a", False)
    widget.flush()
    host.carry()
    assert count(host.pixels(), RED) == 0
    scene.set_visible("a", True)
    scene.delete("a")
    scene.set_object("b", box(BLUE))
    widget.flush()
    host.carry()
    assert count(host.pixels(), RED) == 0
    assert count(host.pixels(), BLUE) > 1000


def test_a_page_that_is_loaded_anew_shows_what_has_changed_meanwhile(host: Host) -> None:
    scene = from_above()
    widget = shown(host, scene)
    scene.set_object("box", box(RED))
    widget.flush()
    host.reload()
    scene.set_object("box", box(GREEN))
    host.open(widget)
    host.show(widget)
    assert count(host.pixels(), GREEN) > 1000
    scene.set_object("box", box(BLUE))
    widget.flush()
    host.carry()
    assert count(host.pixels(), BLUE) > 1000


def test_a_change_between_state_and_first_answer_is_not_lost(host: Host) -> None:
    scene = from_above()
    widget = SceneWidget(scene, height=300)
    host.open(widget)
    scene.set_object("box", box(GREEN))
    host.show(widget)
    assert count(host.pixels(), GREEN) > 1000


def test_a_lost_batch_is_noticed_and_the_scene_sent_again(host: Host) -> None:
    scene = from_above()
    widget = shown(host, scene)
    scene.set_object("lost", box(RED, x=-1))
    widget.flush()
    host.sent.clear()
    scene.set_object("next", box(GREEN, x=1))
    widget.flush()
    host.carry()
    assert count(host.pixels(), RED) > 1000
    assert count(host.pixels(), GREEN) > 1000


def test_a_page_tells_how_many_views_it_has(host: Host) -> None:
    widget = SceneWidget(from_above(), height=300)
    counts: list[int] = []
    widget.on_views = counts.append
    host.open(widget)
    host.show(widget)
    host.show(widget)
    host.hide()
    host.hide()
    assert counts == [1, 2, 1, 0]


def test_two_views_of_a_scene_move_together_and_two_scenes_do_not_mix(host: Host) -> None:
    scene, other = from_above(), from_above()
    widget = shown(host, scene)
    host.show(widget, width=200)
    shown(host, other)
    host.page.set_viewport_size({"width": 800, "height": 900})
    scene.set_object("box", box(RED))
    widget.flush()
    host.carry()
    pixels = host.pixels()
    assert min(count(pixels[:300], RED), count(pixels[300:600], RED)) > 1000
    assert count(pixels[600:], RED) == 0


def test_a_click_tells_what_was_hit_and_where(host: Host) -> None:
    scene = from_above()
    scene.set_object("marker/7", box(RED))
    widget = shown(host, scene)
    clicks: list[Click] = []
    widget.link.on_click.append(clicks.append)
    host.page.mouse.click(200, 150)
    host.page.mouse.click(10, 10)
    host.carry()
    hit, missed = clicks
    assert hit.path == "marker/7"
    assert hit.point == pytest.approx((0, 0, 0.5), abs=0.02)
    assert hit.normal == pytest.approx((0, 0, 1), abs=1e-6)
    assert missed.path is None


@pytest.mark.parametrize(
    "drawable",
    [
        Lines([[-1, 0, 0], [1, 0, 0]], (1, 0, 0, 1), width=0.2),
        Lines([[-1, 0, 0], [1, 0, 0]], (1, 0, 0, 1), width=0.0, strip=False),
        Points([[0, 0, 0]], (1, 0, 0, 1), (0.3, 0.3)),
        Text("MW", 0.5, (1, 0, 0, 1)),
        Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], None, (1, 0, 0, 1)),
        Sheet(np.zeros((2, 2)), [(1, 0, 0, 1)] * 256, 1.0),
        Solids("sphere", [np.eye(4)], (1, 0, 0, 1)),
        Solids("cylinder", [np.eye(4)], (1, 0, 0, 1)),
        Solids("cone", [np.eye(4)], (1, 0, 0, 1), lit=False),
    ],
    ids=["strip", "pixel line", "points", "text", "mesh", "sheet", "sphere", "cylinder", "cone"],
)
def test_every_drawable_is_seen_and_can_be_clicked(host: Host, drawable: Drawable) -> None:
    scene = from_above()
    scene.set_object("thing", drawable)
    widget = shown(host, scene)
    clicks: list[Click] = []
    widget.link.on_click.append(clicks.append)
    assert count(host.pixels(), RED, within=120) > 50  # a pixel line may lie between two rows
    host.page.mouse.click(200, 150)
    host.carry()
    assert [click.path for click in clicks] == ["thing"]


@pytest.mark.parametrize("behind", [False, True])
def test_a_transparent_sheet_is_blended_with_the_background_and_hides_what_is_below_unless_behind(
    host: Host, behind: bool
) -> None:
    scene = from_above()
    scene.background = (0, 0, 0)
    scene.set_object("sheet", Sheet(np.zeros((2, 2)), [(1, 0, 0, 0.5)] * 256, 1.0, behind))
    scene.set_object("box", box((0, 0, 255)))
    scene.set_transform("box", [[1.0, 0, 0, 1.5], [0, 1.0, 0, 1.5], [0, 0, 1.0, -2], [0, 0, 0, 1.0]])
    shown(host, scene)
    pixels = host.pixels()
    assert count(pixels, (128, 0, 0), within=2) > 1000
    assert (count(pixels, (0, 0, 255), within=2) > 1000) == behind
    assert (count(pixels, (128, 0, 128), within=2) > 1000) != behind


def test_a_drag_turns_the_view_and_the_wheel_zooms_once_the_view_was_clicked(host: Host) -> None:
    scene = from_above()
    scene.set_object("box", box(RED))
    shown(host, scene)
    before = count(host.pixels(), RED)
    host.page.mouse.move(200, 150)
    host.page.mouse.wheel(0, -300)
    host.carry()
    assert count(host.pixels(), RED) == before
    host.page.mouse.down()
    host.page.mouse.up()
    host.page.mouse.wheel(0, -300)
    host.carry()
    assert count(host.pixels(), RED) > before
    host.page.mouse.down()
    host.page.mouse.move(200, 50, steps=3)
    host.page.mouse.up()
    host.carry()
    assert count(host.pixels(), (200, 0, 0)) > 1000


def test_a_lost_graphics_context_comes_back(host: Host) -> None:
    scene = from_above()
    scene.set_object("box", box(RED))
    widget = shown(host, scene)
    host.page.evaluate("() => contexts.at(-1).getExtension('WEBGL_lose_context').loseContext()")
    scene.set_object("box", box(GREEN))
    widget.flush()
    host.carry(frames=4)
    assert count(host.pixels(), GREEN) > 1000


def test_a_page_answers_so_that_changes_go_on_for_ever(host: Host) -> None:
    scene = from_above()
    widget = shown(host, scene)
    scene.set_object("box", box(RED))
    for number in range(40):
        scene.set_transform("box", np.diag([1, 1, 1, 1]) + 0.02 * number * np.eye(4, k=3))
        widget.flush()
        host.carry(frames=0)
    host.page.evaluate("() => new Promise(requestAnimationFrame)")
    assert count(host.pixels()[:, :210], RED) == 0  # the box is at the last place, 0.78 m to the right


def test_the_page_keeps_the_scene_for_whoever_saves_the_notebook(host: Host) -> None:
    scene = from_above()
    widget = shown(host, scene)
    scene.set_object("a/box", box(RED))
    scene.set_object("mesh", Mesh(np.eye(3), None, (0, 1, 0, 1)))
    scene.set_visible("mesh", False)
    scene.set_transform("a", np.eye(4) + 0.5 * np.eye(4, k=3))
    widget.flush()
    host.carry()
    host.page.wait_for_timeout(1300)
    saved = host.page.evaluate("""() => {
        const { buffer } = Object.values(models).at(-1).get("snapshot");
        return btoa(String.fromCharCode(...new Uint8Array(buffer))); }""")
    kept, sent = (
        msgpack.unpackb(data, ext_hook=lambda code, part: (code, part))
        for data in (base64.b64decode(saved), snapshot(scene))
    )
    assert kept["commands"] == sent["commands"]
    matrices = dict(
        zip(kept["paths"], np.frombuffer(kept["matrices"][1], np.float32).reshape(-1, 4, 3), strict=True)
    )
    assert np.array_equal(matrices["a"].T, scene.transform("a")[:3])
    assert np.array_equal(matrices["mesh"].T, np.eye(4)[:3])


def test_a_change_that_cannot_be_shown_is_said_and_the_others_are_seen(host: Host) -> None:
    scene = from_above()
    widget = shown(host, scene)
    scene.set_object("bad", MeshcatObject({}))
    scene.set_object("good", box(GREEN))
    widget.flush()
    host.carry()
    assert "bad:" in host.page.get_by_role("status").inner_text()
    assert count(host.pixels(), GREEN) > 1000
    scene.set_transform("good", np.full((4, 4), np.nan))
    widget.flush()
    host.carry()
    assert "'good' is not finite" in host.page.get_by_role("status").inner_text()


def test_twenty_scenes_share_one_graphics_context_and_all_are_seen(host: Host) -> None:
    host.page.set_viewport_size({"width": 800, "height": 1600})
    for number in range(24):
        scene = from_above()
        scene.set_object("box", box(RED if number % 2 else BLUE))
        widget = SceneWidget(scene, height=60)
        host.open(widget)
        host.show(widget)
    host.carry(frames=6)
    pixels = host.pixels()
    for number in range(24):
        color = RED if number % 2 else BLUE
        assert count(pixels[60 * number : 60 * number + 60], color) > 100, number
    assert host.page.evaluate("contexts.length") == 1
    assert not host.page.evaluate("contexts.some((context) => context.isContextLost())")


def test_a_view_fills_the_screen_by_key_and_by_button_and_follows_its_size(host: Host) -> None:
    scene = from_above()
    scene.set_object("box", box(RED))
    shown(host, scene)
    before = count(host.pixels(), RED)
    host.page.mouse.click(10, 10)
    host.page.keyboard.press("f")
    host.page.wait_for_function("document.fullscreenElement !== null")
    host.carry(frames=4)
    assert count(host.pixels(), RED) > 2 * before
    host.page.get_by_role("button", name="Full screen").click()
    host.page.wait_for_function("document.fullscreenElement === null")
    host.carry(frames=4)
    assert count(host.pixels(), RED) == before


def test_a_large_cloud_is_drawn_as_numpy_draws_it_and_its_points_can_be_clicked(host: Host) -> None:
    scene = from_above()
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 200), np.linspace(-1, 1, 200), [0.0]), axis=-1)
    colors = np.repeat(np.eye(4)[[0, 2]] + [0, 0, 0, 1], 20_000, axis=0).clip(0, 1)  # half red, half blue
    scene.set_object("cloud", Points(grid.reshape(-1, 3), colors, (0.03, 0.03)))
    widget = shown(host, scene)
    clicks: list[Click] = []
    widget.link.on_click.append(clicks.append)
    png = zbuffer.draw(scene, (400, 300))
    expected = np.asarray(Image.open(BytesIO(png)).convert("RGB")).astype(np.int64)
    seen = host.pixels()[:300, :400]
    assert (np.abs(seen - expected).max(axis=-1) < 60).mean() > 0.97
    assert min(count(seen, RED), count(seen, BLUE)) > 5000
    host.page.mouse.click(200, 170)
    host.carry()
    assert clicks[0].path == "cloud"
    assert clicks[0].index is not None
    assert np.linalg.norm(grid.reshape(-1, 3)[clicks[0].index] - clicks[0].point) < 0.05
