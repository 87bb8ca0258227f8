"""The look "Studio" in a page: light background and shadow, and the complete return to RViz's look."""

import numpy as np
import pytest

from course_lib.viewer.drawables import Camera, Lines, Points, Sheet, Solids, Text
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host, Pixels, count
from tests.browser.waiting import wait_until

pytestmark = pytest.mark.browser
GROUND, RVIZ_GREY = (245, 246, 248), (48, 48, 48)


def look(host: Host) -> Pixels:
    """Return the pixels of the view, which is drawn in full detail when nothing moves."""
    host.carry()
    return host.pixels()[:400, :400]


def at_rest(host: Host) -> Pixels:
    """Return the pixels of the view when two pictures, a second apart, are equal."""
    pictures = [look(host)]

    def is_same() -> bool:
        host.page.wait_for_timeout(1000)
        pictures.append(look(host))
        return np.array_equal(pictures[-1], pictures[-2])

    wait_until(is_same, host.page)
    return pictures[-1]


def grey(pixels: Pixels) -> int:
    """Count the pixels of a shadow on the ground: gray, and clearly darker than the ground."""
    return int(((np.ptp(pixels, axis=2) < 25) & (np.abs(pixels.mean(axis=2) - 170) < 40)).sum())


@pytest.fixture
def scene(host: Host) -> Scene:
    scene = Scene()
    box = np.diag([1.5, 1.5, 0.1, 1.0])
    box[2, 3] = 1.5
    scene.set_object("box", Solids("box", [box], (1, 0, 0, 1)))
    widget = SceneWidget(scene)
    host.open(widget)
    host.show(widget)
    return scene


def test_studio_look_has_light_ground_and_shadows_and_rviz_look_is_restored(host: Host, scene: Scene) -> None:
    before = at_rest(host)
    assert count(before, RVIZ_GREY, 3) > 100_000
    scene.look = "Studio"
    wait_until(lambda: grey(look(host)) > 1000, host.page)
    studio = look(host)
    assert count(studio, RVIZ_GREY, 3) == 0
    assert count(studio, GROUND, 25) > 50_000
    scene.set_object("box", Solids("sphere", [np.diag([0.01, 0.01, 0.01, 1.0])], (1, 0, 0, 1)))
    wait_until(lambda: grey(at_rest(host)) < 200, host.page)
    box = np.diag([1.5, 1.5, 0.1, 1.0])
    box[2, 3] = 1.5
    scene.set_object("box", Solids("box", [box], (1, 0, 0, 1)))
    scene.look = "RViz"
    wait_until(lambda: np.array_equal(look(host), before), host.page)


@pytest.mark.slow
def test_shadow_map_is_kept_while_only_the_camera_moves(host: Host, scene: Scene) -> None:
    scene.look = "Studio"
    wait_until(lambda: grey(at_rest(host)) > 1000, host.page)
    host.page.evaluate("""() => {
        globalThis.maps = 0;
        for (const gl of [WebGLRenderingContext, WebGL2RenderingContext]) {
            const bind = gl.prototype.bindFramebuffer;
            gl.prototype.bindFramebuffer = function (target, buffer) {
                maps += buffer !== null; return bind.call(this, target, buffer); }; } }""")
    host.page.locator("canvas").press("ArrowLeft")
    turned = at_rest(host)
    assert host.page.evaluate("maps") == 0
    assert grey(turned) > 1000
    scene.set_transform("box", np.eye(4) + np.diag([0, 0, 0.5, 0]))
    host.wait_until(lambda: host.page.evaluate("maps") > 0)


@pytest.mark.slow
def test_custom_background_color_is_kept_in_studio_look(host: Host, scene: Scene) -> None:
    scene.background = (0, 0, 120)
    scene.look = "Studio"
    assert count(at_rest(host), (0, 0, 120), 3) > 50_000


def test_thin_lines_like_the_grid_fade_in_the_distance_only_in_studio_look(host: Host, scene: Scene) -> None:
    scene.delete("box")
    scene.camera = Camera(eye=(0, 0, 25), up=(0, 1, 0))  # sees 10 m to each side
    scene.set_object("line", Lines([(-30, 0, 0), (30, 0, 0)], (0, 0, 0.5, 0.9)))

    def line(pixels: Pixels) -> tuple[int, int]:
        """Return the number of blue pixels near the left edge of the view and around its middle."""
        blue = pixels[..., 2] - pixels[..., 0] > 40
        return int(blue[:, :40].any(axis=0).sum()), int(blue[:, 180:220].any(axis=0).sum())

    wait_until(lambda: line(at_rest(host)) == (40, 40), host.page)
    scene.look = "Studio"
    wait_until(lambda: line(at_rest(host)) == (0, 40), host.page)


@pytest.mark.parametrize("background", [(48, 48, 48), (0, 0, 120)])
def test_white_points_and_lines_are_gray_on_the_light_ground_of_studio_look(
    host: Host, scene: Scene, background: tuple[int, int, int]
) -> None:
    scene.delete("box")
    scene.background = background
    scene.camera = Camera(eye=(0, 0, 5), up=(0, 1, 0))
    white = (1.0, 1.0, 1.0, 1.0)
    scene.set_object("points", Points([(0.5, 0, 0)], white, (0.5, 0.5, 0.5)))
    scene.set_object("line", Lines([(-1, 0, 0), (0, 0, 0)], white, 0.3))
    scene.look = "Studio"
    is_light = background == RVIZ_GREY
    color = (115, 115, 115) if is_light else (255, 255, 255)
    wait_until(lambda: count(at_rest(host)[150:250, 100:300], color, 3) > 1500, host.page)


def test_sides_in_the_shade_differ_in_brightness_in_studio_look(host: Host, scene: Scene) -> None:
    scene.camera = Camera(eye=(-3, -3, 2))
    scene.set_object("box", Solids("box", [np.eye(4)], (1, 0, 0, 1)))
    scene.look = "Studio"
    wait_until(lambda: count(look(host), GROUND, 25) > 50_000, host.page)
    pixels = at_rest(host)
    # Below the center, the front edge of the box is in the middle of the view.
    left, right = pixels[210, 170, 0], pixels[210, 230, 0]
    assert right > left + 20 > 100


INK = (31, 36, 46)


def place_label(scene: Scene, name: str, text: str, *position: float, height: float = 0.6) -> None:
    transform = np.eye(4)
    transform[:3, 3] = position
    scene.set_transform(name, transform)
    scene.set_object(name, Text(text, height, (1, 1, 1, 1)))


def middle(pixels: Pixels) -> Pixels:
    """Return the pixels around the origin of a view, without the buttons in the corners."""
    return pixels[120:280, 80:320]


def ink_height(pixels: Pixels) -> int:
    """Return the number of rows from the first to the last dark pixel."""
    rows, _ = np.nonzero((np.abs(pixels.astype(int) - INK) <= 60).all(axis=2))
    return 1 + int(np.ptp(rows))


def test_white_labels_are_dark_on_a_plate(host: Host, scene: Scene) -> None:
    scene.delete("box")
    scene.background = (0, 120, 0)
    scene.look = "Studio"
    wait_until(lambda: count(middle(look(host)), (0, 120, 0), 10) > 30_000, host.page)
    place_label(scene, "label", "base_link", 0.0, 0.0, 0.0)
    wait_until(lambda: count(middle(look(host)), INK, 60) > 30, host.page)
    pixels = middle(at_rest(host))
    assert count(pixels, INK, 60) > 30
    assert count(pixels, (224, 239, 224), 20) > 400


@pytest.mark.parametrize("height", [0.02, 0.3, 3.0])
def test_labels_have_a_readable_size_at_any_distance(host: Host, scene: Scene, height: float) -> None:
    scene.delete("box")
    scene.look = "Studio"
    place_label(scene, "label", "HHHHHH", 0.0, 0.0, 0.0, height=height)
    wait_until(lambda: count(middle(look(host)), INK, 60) > 30, host.page)
    assert 6 <= ink_height(middle(at_rest(host))) <= 11


def test_nearest_of_overlapping_labels_is_shown_alone(host: Host, scene: Scene) -> None:
    scene.delete("box")
    scene.look = "Studio"
    place_label(scene, "near", "HH", 0.1, 0.1, 0.1)
    wait_until(lambda: count(middle(look(host)), INK, 60) > 20, host.page)
    alone = middle(at_rest(host))
    place_label(scene, "far", "HHHHHHHHHH", 0.0, 0.0, 0.0)
    assert np.array_equal(middle(at_rest(host)), alone)
    place_label(scene, "far", "HHHHHHHHHH", 0.0, 0.0, 1.0)
    wait_until(lambda: count(middle(look(host)), INK, 60) > 2 * count(alone, INK, 60), host.page)


def test_labels_are_in_front_of_objects(host: Host, scene: Scene) -> None:
    scene.look = "Studio"
    place_label(scene, "label", "HHHHHH", 0.0, 0.0, 1.5)
    wait_until(lambda: count(middle(look(host)), INK, 60) > 30, host.page)


@pytest.mark.slow
def test_sides_of_a_cube_are_shaded_by_sun_and_sky(host: Host, scene: Scene) -> None:
    scene.set_object("box", Solids("box", [np.diag([2.0, 2.0, 2.0, 1.0])], (0.8, 0, 0, 1)))
    scene.look = "Studio"
    host.wait_until(lambda: count(host.pixels(), GROUND, 25) > 50_000)
    pixels = look(host)
    red = pixels[(pixels[..., 0] > 3 * pixels[..., 1]) & (pixels[..., 0] > 60), 0]
    assert len(red) > 2000
    assert np.ptp(np.percentile(red, [10, 90])) > 25


@pytest.mark.slow
def test_opaque_map_keeps_its_colors_and_lies_below_the_shadow(host: Host, scene: Scene) -> None:
    colors = np.tile([0.0, 0.5, 0.0, 1.0], (256, 1))
    scene.set_object("map", Sheet(np.zeros((4, 4), np.uint8), colors, 1.0))
    transform = np.eye(4)
    transform[:2, 3] = -2.0
    scene.set_transform("map", transform)
    scene.look = "Studio"
    wait_until(lambda: count(at_rest(host), (0, 128, 0), 5) > 10_000, host.page)
    pixels = at_rest(host)
    shaded = (np.ptp(pixels, axis=2) > 25) & (abs(pixels[..., 1] - 86) < 20) & (pixels[..., 0] < 60)
    assert shaded.sum() > 1000


def test_shadow_is_softer_where_the_object_is_farther_from_the_ground(host: Host, scene: Scene) -> None:
    scene.look = "Studio"
    scene.camera = Camera(eye=(0.0, -7.0, 4.0))

    def edge(height: float) -> int:
        """Return the number of pixels between the shadow and the ground, with the box at a height in [m]."""
        box = np.diag([1.5, 1.5, 0.1, 1.0])
        box[2, 3] = height
        scene.set_object("box", Solids("box", [box], (1, 0, 0, 1)))
        wait_until(lambda: grey(look(host)) > 500, host.page)
        pixels = at_rest(host)
        return int(((np.ptp(pixels, axis=2) < 25) & (np.abs(pixels.mean(axis=2) - 205) < 22)).sum())

    assert edge(1.5) > 2 * edge(0.3) > 0
