"""Every kind of drawable in a real page: it is seen, and clicks hit it."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from course_lib.viewer import renderer
from course_lib.viewer.drawables import (
    Drawable,
    Lines,
    Mesh,
    MeshcatObject,
    Points,
    Sheet,
    Solids,
    Spot,
    Text,
)
from course_lib.viewer.page_link import Click
from tests.browser.fake_host import Host, count
from tests.browser.scenes import BLUE, GREEN, RED, box, from_above, show_scene

pytestmark = pytest.mark.browser


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
def test_every_drawable_is_visible_and_clickable(host: Host, drawable: Drawable) -> None:
    scene = from_above()
    scene.set_object("thing", drawable)
    widget = show_scene(host, scene)
    clicks: list[Click] = []
    widget.link.on_click.append(clicks.append)
    assert count(host.pixels(), RED, within=120) > 50  # a pixel line may lie between two rows
    host.page.mouse.click(200, 150)
    host.carry()
    assert [click.path for click in clicks] == ["thing"]


@pytest.mark.parametrize("behind", [False, True])
def test_transparent_sheet_is_blended_and_occludes_objects_below_unless_drawn_behind(
    host: Host, behind: bool
) -> None:
    scene = from_above()
    scene.background = (0, 0, 0)
    scene.set_object("sheet", Sheet(np.zeros((2, 2)), [(1, 0, 0, 0.5)] * 256, 1.0, behind))
    scene.set_object("box", box((0, 0, 255)))
    scene.set_transform("box", [[1.0, 0, 0, 1.5], [0, 1.0, 0, 1.5], [0, 0, 1.0, -2], [0, 0, 0, 1.0]])
    show_scene(host, scene)
    pixels = host.pixels()
    assert count(pixels, (128, 0, 0), within=2) > 1000
    assert (count(pixels, (0, 0, 255), within=2) > 1000) == behind
    assert (count(pixels, (128, 0, 128), within=2) > 1000) != behind


@pytest.mark.slow
def test_map_larger_than_a_texture_is_drawn_completely(host: Host) -> None:
    scene = from_above()
    cells = np.zeros((3, 20_000), np.uint8)
    cells[:, 15_000:] = 1
    cells[2, :5000] = 2
    colors = np.ones((256, 4))
    colors[:3, :3] = np.eye(3)
    scene.set_object("map", Sheet(cells, colors, 1e-4))
    scene.set_transform("map", np.diag([1.0, 5000.0, 1.0, 1.0]))
    show_scene(host, scene)
    red, green, blue = (count(host.pixels(), color) for color in (RED, GREEN, BLUE))
    assert green > 1000
    assert green / red == pytest.approx(15 / 40, rel=0.1)
    assert blue / red == pytest.approx(5 / 40, rel=0.2)


@pytest.mark.slow
def test_invalid_scene_change_is_reported_and_other_changes_are_drawn(host: Host) -> None:
    scene = from_above()
    widget = show_scene(host, scene)
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


@pytest.mark.slow
@pytest.mark.parametrize("spot", ["square", "disc", "sphere"])
def test_large_cloud_is_drawn_as_by_numpy_and_its_points_are_clickable(host: Host, spot: Spot) -> None:
    scene = from_above()
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 200), np.linspace(-1, 1, 200), [0.0]), axis=-1)
    colors = np.repeat(np.eye(4)[[0, 2]] + [0, 0, 0, 1], 20_000, axis=0).clip(0, 1)  # half red, half blue
    scene.set_object("cloud", Points(grid.reshape(-1, 3), colors, (0.03, 0.03), spot=spot))
    widget = show_scene(host, scene)
    clicks: list[Click] = []
    widget.link.on_click.append(clicks.append)
    png = renderer.draw(scene, (400, 300))
    expected = np.asarray(Image.open(BytesIO(png)).convert("RGB")).astype(np.int64)
    seen = host.pixels()[:300, :400]
    assert (np.abs(seen - expected).max(axis=-1) < 60).mean() > 0.97
    assert min(count(seen, RED), count(seen, BLUE)) > 5000
    host.page.mouse.click(200, 170)
    host.carry()
    assert clicks[0].path == "cloud"
    assert clicks[0].index is not None
    assert np.linalg.norm(grid.reshape(-1, 3)[clicks[0].index] - clicks[0].point) < 0.05


@pytest.mark.slow
def test_labels_overlap_as_in_rviz_until_a_button_hides_occluded_labels(host: Host) -> None:
    scene = from_above()
    for name, color, height in (("near", (1, 0, 0, 1), 0.5), ("far", (0, 1, 0, 1), 0.0)):
        scene.set_object(name, Text("MW", 1.0, color))
        scene.set_transform(name, [[1.0, 0, 0, 0], [0, 1.0, 0, 0.2], [0, 0, 1.0, height], [0, 0, 0, 1.0]])
    scene.set_object("aside", Text("MW", 0.5, (0, 0, 1, 1)))
    scene.set_transform("aside", [[1.0, 0, 0, 0], [0, 1.0, 0, -1.8], [0, 0, 1.0, 0], [0, 0, 0, 1.0]])
    show_scene(host, scene)
    apart = host.page.get_by_role("button", name="Labels do not overlap")
    full_screen = host.page.get_by_role("button", name="Full screen")
    boxes = [button.bounding_box() for button in (apart, full_screen)]
    # Only JupyterLab has a button between them.
    left, right = (box["x"] for box in boxes if box)
    assert right - left < 30
    assert count(host.pixels(), GREEN, within=120) > 50
    apart.click()
    host.carry()
    pixels = host.pixels()
    assert count(pixels, GREEN, within=120) == 0
    assert min(count(pixels, RED, within=120), count(pixels, BLUE, within=120)) > 50
    apart.click()
    host.carry()
    assert count(host.pixels(), GREEN, within=120) > 50


def test_names_of_frames_at_the_same_position_are_drawn_one_below_the_other(host: Host) -> None:
    scene = from_above()
    for name, color in (("base_link", (1, 0, 0, 1)), ("camera_link", (0, 1, 0, 1)), ("laser", (0, 0, 1, 1))):
        scene.set_object(name, Text("MW", 0.5, color, below=True))
    show_scene(host, scene)
    pixels = host.pixels()
    seen = [np.abs(pixels - color).max(axis=-1) < 120 for color in (RED, GREEN, BLUE)]
    rows = [np.flatnonzero(mask.any(axis=1)) for mask in seen]
    assert all(len(row) > 10 for row in rows)
    assert rows[0].max() < rows[1].min() <= rows[1].max() < rows[2].min()
