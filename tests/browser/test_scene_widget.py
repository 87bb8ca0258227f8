"""The scene widget in a real page: it draws changes from Python and reports actions of the user."""

import base64
from io import BytesIO
from itertools import count as count_up

import msgpack
import numpy as np
import pytest
from PIL import Image

from course_lib.viewer import page_link
from course_lib.viewer.drawables import Mesh, Solids
from course_lib.viewer.encoding import snapshot
from course_lib.viewer.page_link import Click
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host, count
from tests.browser.scenes import BLUE, GREEN, RED, box, from_above, show_scene

pytestmark = pytest.mark.browser


def test_scene_changes_are_drawn_on_an_open_page(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    assert widget.link.is_ready
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


def test_page_that_draws_slowly_reports_it_and_shows_the_last_change(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    xs = count_up(1)

    def is_slower_than(period: float) -> bool:
        for _ in range(page_link._ACK_BATCHES):
            scene.set_object("box", box(RED, x=1e-6 * next(xs)))
            widget.flush()
        host.carry()
        return widget.link.interval >= period

    host.page.evaluate("""() => {
        globalThis.everyFrame = requestAnimationFrame;
        globalThis.requestAnimationFrame = (draw) => setTimeout(() => everyFrame(draw), 150); }""")
    host.wait_until(lambda: is_slower_than(0.15))
    scene.set_object("box", box(BLUE))
    host.wait_until(lambda: count(host.pixels(), BLUE) > 1000)
    host.page.evaluate("() => { globalThis.requestAnimationFrame = everyFrame; }")
    host.wait_until(lambda: not is_slower_than(0.15))


@pytest.mark.slow
def test_reloaded_page_shows_changes_made_during_the_reload(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
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


def test_scene_change_between_state_and_first_acknowledgement_is_not_lost(host: Host) -> None:
    scene = from_above()
    widget = SceneWidget(scene, height=300)
    host.open(widget)
    scene.set_object("box", box(GREEN))
    host.show(widget)
    assert count(host.pixels(), GREEN) > 1000


def test_hidden_page_receives_no_updates_until_it_is_visible_again(host: Host) -> None:
    hide = """hidden => {
        Object.defineProperty(document, "hidden", { value: hidden, configurable: true });
        document.dispatchEvent(new Event("visibilitychange")); }"""
    scene = from_above()
    widget = show_scene(host, scene)
    scene.set_object("box", box(RED))
    widget.flush()
    host.carry()
    host.page.evaluate(hide, True)
    host.carry()
    scene.set_object("box", box(GREEN))
    widget.flush()
    assert host.sent == []
    host.page.evaluate(hide, False)
    host.carry()
    assert count(host.pixels(), GREEN) > 1000
    scene.set_object("box", box(BLUE))
    widget.flush()
    host.carry()
    assert count(host.pixels(), BLUE) > 1000


@pytest.mark.slow
def test_view_scrolled_out_of_sight_receives_no_updates_until_visible_again(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    scene.set_object("box", box(RED))
    widget.flush()
    host.carry()
    host.page.evaluate("document.body.style.paddingBottom = '3000px'; scrollTo(0, 2000)")
    host.wait_until(lambda: not widget.link.is_watched)
    assert widget.link.is_ready
    scene.set_object("box", box(GREEN))
    widget.flush()
    assert host.sent == []
    host.page.evaluate("scrollTo(0, 0)")
    host.wait_until(lambda: count(host.pixels(), GREEN) > 1000)
    scene.set_object("box", box(BLUE))
    widget.flush()
    host.carry()
    assert count(host.pixels(), BLUE) > 1000
    host.page.evaluate("document.body.style.paddingBottom = ''")


def test_scene_is_sent_again_after_a_lost_update(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    scene.set_object("lost", box(RED, x=-1))
    widget.flush()
    host.sent.clear()
    scene.set_object("next", box(GREEN, x=1))
    widget.flush()
    host.carry()
    assert count(host.pixels(), RED) > 1000
    assert count(host.pixels(), GREEN) > 1000


def test_page_reports_its_number_of_views(host: Host) -> None:
    widget = SceneWidget(from_above(), height=300)
    counts: list[int] = []
    widget.on_views = counts.append
    host.open(widget)
    host.show(widget)
    host.show(widget)
    host.hide()
    host.hide()
    assert counts == [1, 2, 1, 0]


def test_views_of_one_scene_share_the_camera_and_scenes_are_independent(host: Host) -> None:
    scene, other = from_above(), from_above()
    widget = show_scene(host, scene)
    host.show(widget, width=200)
    show_scene(host, other)
    host.page.set_viewport_size({"width": 800, "height": 900})
    scene.set_object("box", box(RED))
    widget.flush()
    host.carry()
    pixels = host.pixels()
    assert min(count(pixels[:300], RED), count(pixels[300:600], RED)) > 1000
    assert count(pixels[600:], RED) == 0


def test_click_reports_the_hit_object_and_position(host: Host) -> None:
    scene = from_above()
    scene.set_object("marker/7", box(RED))
    widget = show_scene(host, scene)
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


def test_dragging_rotates_the_view_and_the_wheel_zooms_after_a_click(host: Host) -> None:
    scene = from_above()
    scene.set_object("box", box(RED))
    show_scene(host, scene)
    host.page.wait_for_selector(AT_REST)
    before = count(host.pixels(), RED)
    host.page.mouse.move(200, 150)
    host.page.mouse.wheel(0, -300)
    host.carry()
    host.page.wait_for_selector(AT_REST)
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


@pytest.mark.slow
def test_lost_graphics_context_is_restored(host: Host) -> None:
    host.reload()
    scene = from_above()
    scene.set_object("box", box(RED))
    widget = show_scene(host, scene)
    host.page.evaluate("() => contexts.at(-1).getExtension('WEBGL_lose_context').loseContext()")
    scene.set_object("box", box(GREEN))
    widget.flush()
    host.carry(frames=4)
    assert count(host.pixels(), GREEN) > 1000


def test_page_acknowledges_updates_so_that_later_changes_are_drawn(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    scene.set_object("box", box(RED))
    for number in range(40):
        scene.set_transform("box", np.diag([1, 1, 1, 1]) + 0.02 * number * np.eye(4, k=3))
        widget.flush()
        host.carry(frames=0)
    host.page.evaluate("() => new Promise(requestAnimationFrame)")
    assert count(host.pixels()[:, :210], RED) == 0  # the box is at its last position, 0.78 m to the right


AT_REST = "canvas[aria-busy=false]"
KEPT = "() => Object.values(models).at(-1).get('snapshot') !== before"


@pytest.mark.slow
def test_page_keeps_a_snapshot_of_a_constantly_changing_scene(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    host.page.evaluate("() => { globalThis.before = Object.values(models).at(-1).get('snapshot') }")
    for step in range(1000):
        scene.set_transform("a", np.eye(4) + step * np.eye(4, k=3))
        widget.flush()
        host.carry()
        if host.page.evaluate(KEPT):
            break
    assert host.page.evaluate(KEPT)


@pytest.mark.slow
def test_page_stores_a_scene_snapshot_for_the_saved_notebook(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
    host.page.evaluate("() => { globalThis.before = Object.values(models).at(-1).get('snapshot') }")
    scene.set_object("a/box", box(RED))
    scene.set_object("mesh", Mesh(np.eye(3), None, (0, 1, 0, 1)))
    scene.set_visible("mesh", False)
    scene.set_transform("a", np.eye(4) + 0.5 * np.eye(4, k=3))
    widget.flush()
    host.carry()
    host.page.wait_for_function(KEPT)
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


@pytest.mark.slow
def test_many_scenes_share_one_graphics_context_and_are_all_drawn(host: Host) -> None:
    host.reload()
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


@pytest.mark.slow
def test_full_screen_view_is_toggled_by_key_or_button_and_resized(host: Host) -> None:
    scene = from_above()
    scene.set_object("box", box(RED))
    show_scene(host, scene)
    host.page.wait_for_selector(AT_REST)
    before = count(host.pixels(), RED)
    host.page.mouse.click(10, 10)
    host.page.keyboard.press("F11")
    host.page.wait_for_function("document.fullscreenElement !== null")
    host.carry(frames=4)
    assert count(host.pixels(), RED) > 2 * before
    host.page.get_by_role("button", name="Full screen").click()
    host.page.wait_for_function("document.fullscreenElement === null")
    host.carry(frames=4)
    host.page.wait_for_selector(AT_REST)
    assert count(host.pixels(), RED) == before


SAVED_AND_PLAIN = """() => {
    const saved = document.querySelector(".course-keeps").courseKeeps()["image/png"];
    const canvas = document.querySelector(".course-keeps canvas");
    const scale = Math.min(480 / canvas.width, 360 / canvas.height);
    const size = { width: Math.round(scale * canvas.width), height: Math.round(scale * canvas.height) };
    const small = Object.assign(document.createElement("canvas"), size);
    small.getContext("2d").drawImage(canvas, 0, 0, size.width, size.height);
    return [saved, small.toDataURL("image/png").split(",")[1]]; }"""


def test_picture_that_is_saved_with_a_notebook_is_small(host: Host) -> None:
    scene = from_above()
    places = np.tile(np.eye(4), (25, 1, 1))
    places[:, :2, 3] = [(x, y) for x in range(-2, 3) for y in range(-2, 3)]
    scene.set_object("balls", Solids("sphere", places, (0.7, 0.7, 0.9, 1)))
    show_scene(host, scene)
    host.wait_until(lambda: count(host.pixels(), (120, 120, 150), 60) > 5000)
    saved, plain = (base64.b64decode(text) for text in host.page.evaluate(SAVED_AND_PLAIN))
    assert len(saved) < 0.75 * len(plain)
    pixels, exact = (np.asarray(Image.open(BytesIO(data)).convert("RGB"), int) for data in (saved, plain))
    assert np.abs(pixels[: len(exact)] - exact).max() <= 3
