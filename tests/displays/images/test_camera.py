from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, Image

from course_lib.displays.display import Display
from course_lib.displays.panel.panels import display_rows
from course_lib.viewer.drawables import Inset
from tests.displays.bench import Bench
from tests.displays.images.test_pixels import image

PATH = "displays/Camera/picture"
WIDTH, HEIGHT = 8, 6
PICTURE = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)


def info(fx: float = 10.0, fy: float = 10.0, cx: float = 4.0, cy: float = 3.0, tx: float = 0.0) -> CameraInfo:
    camera_info = CameraInfo(width=WIDTH, height=HEIGHT)
    camera_info.p = np.array([fx, 0, cx, tx, 0, fy, cy, 0, 0, 0, 1, 0], float)
    return camera_info


def add(bench: Bench, **properties: Any) -> Display:
    config = {"Topic": "/eye/image_raw", "Visibility": {"Grid": False, "Value": True}}
    return bench.session.add("rviz_default_plugins/Camera", "Camera", config, **properties)


def show_inset(
    bench: Bench, described: CameraInfo | None, frame: str = "map", picture: Image | None = None
) -> Inset | None:
    if described is not None:
        bench.publish("/eye/camera_info", described)
    message = picture or image(PICTURE, "rgb8")
    message.header.frame_id = frame
    bench.publish("/eye/image_raw", message)
    bench.update()
    drawable = bench.scene.objects().get(PATH)
    assert drawable is None or isinstance(drawable, Inset)
    return drawable


def pixel_of(inset: Inset, point: tuple[float, float, float]) -> tuple[float, float]:
    """Return where the camera of a picture sees a point, in pixels of the image."""
    camera = inset.camera
    assert camera is not None
    x, y, z, _ = camera.view_matrix() @ (*point, 1.0)
    per_height = 0.5 / np.tan(camera.vertical_fov / 2) / -z
    right, down = camera.shift[0] + x * per_height, camera.shift[1] - y * per_height
    return (right / inset.aspect + 0.5) * WIDTH, (down + 0.5) * HEIGHT


@pytest.mark.parametrize("described", [info(), info(cx=1.0, cy=5.0), info(fx=20.0, fy=5.0), info(tx=-30.0)])
@pytest.mark.parametrize("point", [(0.0, 0.0, 4.0), (0.7, -0.4, 2.0)])
def test_points_are_drawn_at_the_pixels_of_the_projection_matrix(
    described: CameraInfo, point: tuple[float, float, float]
) -> None:
    bench = Bench()
    add(bench)
    inset = show_inset(bench, described)
    assert inset is not None
    u, v, w = described.p.reshape(3, 4) @ (*point, 1.0)  # map is the optical frame here
    assert pixel_of(inset, point) == pytest.approx((u / w, v / w))


def test_camera_is_placed_at_its_frame() -> None:
    bench = Bench()
    bench.transform("map", "optical", (1.0, 2.0, 3.0))
    add(bench, far_plane_distance=7.0)
    inset = show_inset(bench, info(), "optical")
    assert inset is not None
    assert inset.camera is not None
    assert inset.camera.eye == (1.0, 2.0, 3.0)
    assert inset.camera.target == (1.0, 2.0, 4.0)
    assert inset.camera.far == 7.0


def test_zoom_magnifies_around_the_center() -> None:
    near, far = (Bench(), Bench())
    add(near, zoom_factor=2.0)
    add(far)
    big, small = show_inset(near, info(cx=3.0)), show_inset(far, info(cx=3.0))
    assert big is not None
    assert small is not None
    (u, v), (x, y) = pixel_of(big, (0.2, 0.1, 2.0)), pixel_of(small, (0.2, 0.1, 2.0))
    assert (u - WIDTH / 2, v - HEIGHT / 2) == pytest.approx((2 * (x - WIDTH / 2), 2 * (y - HEIGHT / 2)))


@pytest.mark.parametrize(
    ("zoom", "roi", "area"),
    [
        (1.0, (0, 0, 0, 0), (0.0, 0.0, 1.0, 1.0)),
        (2.0, (0, 0, 0, 0), (-0.5, -0.5, 2.0, 2.0)),
        (1.0, (2, 3, 4, 3), (0.25, 0.5, 0.5, 0.5)),
        (2.0, (2, 3, 4, 3), (0.0, 0.5, 1.0, 1.0)),
    ],
)
def test_image_covers_the_region_of_interest_of_the_camera_info(
    zoom: float, roi: tuple[int, ...], area: tuple[float, ...]
) -> None:
    bench, described = Bench(), info()
    add(bench, zoom_factor=zoom)
    region = described.roi
    region.x_offset, region.y_offset, region.width, region.height = roi
    inset = show_inset(bench, described)
    assert inset is not None
    assert inset.area == area


@pytest.mark.parametrize(
    ("rendering", "behind", "over"),
    [("background", True, 0.0), ("overlay", False, 0.25), ("background and overlay", True, 0.25)],
)
def test_image_is_drawn_behind_the_scene_or_as_an_overlay(rendering: str, behind: bool, over: float) -> None:
    bench = Bench()
    add(bench, image_rendering=rendering, overlay_alpha=0.25)
    inset = show_inset(bench, info())
    assert inset is not None
    assert (inset.is_behind, inset.overlay_alpha, inset.hidden_paths) == (behind, over, ("displays/Grid",))


def test_missing_camera_info_is_reported_as_in_rviz() -> None:
    bench = Bench()
    display = add(bench)
    assert show_inset(bench, None) is None
    assert bench.status(display, "Camera Info") == (
        "warn",
        "Expecting Camera Info on topic [/eye/camera_info]. No CameraInfo received. Topic may not exist.",
    )
    bench.publish("/eye/camera_info", info())
    bench.update()
    assert PATH in bench.scene.objects()


def test_invalid_camera_info_is_reported_with_rviz_text_and_the_next_is_used() -> None:
    position = "CameraInfo/P resulted in an invalid position calculation (nans or infs)"
    bench = Bench()
    display = add(bench)
    for wrong, text in (
        (info(fx=0.0), position),
        (CameraInfo(width=WIDTH, height=HEIGHT), position),
        (info(cx=np.nan), "Contains invalid floating point values (nans or infs)"),
    ):
        assert show_inset(bench, wrong) is None
        assert bench.status(display, "Camera Info") == ("error", text)
    assert show_inset(bench, info()) is not None
    assert bench.status(display, "Camera Info") == ("ok", "ok")


def test_compressed_image_uses_the_camera_info_of_the_raw_image() -> None:
    bench = Bench()
    display = bench.session.add(
        "rviz_default_plugins/Camera", "Camera", {"Topic": "/eye/image_raw/compressed"}
    )
    assert [s.topic for s in display.subscriptions] == ["/eye/image_raw/compressed", "/eye/camera_info"]


def test_camera_has_no_filter_size_and_at_most_ten_images_wait_for_their_frame() -> None:
    bench = Bench()
    display = add(bench)
    assert "Topic/Filter size" not in dict(display)
    for _ in range(12):
        assert show_inset(bench, info(), "optical") is None
    hints = " ".join(bench.hints(display))
    assert "10 messages waiting for tf2." in hints
    assert "queue is full" in hints


def test_size_missing_in_camera_info_is_the_size_of_the_whole_image() -> None:
    bench = Bench()
    add(bench)
    described = info(fx=1000.0, fy=1000.0, cx=500.0, cy=3.0)
    described.width = 0
    picture = image(np.zeros((HEIGHT, 1000, 3), np.uint8), "rgb8")
    inset = show_inset(bench, described, picture=picture)
    assert inset is not None
    assert inset.aspect == pytest.approx(1000 / HEIGHT)


@pytest.mark.parametrize("distance", [0.001, 5.0])
def test_far_plane_accepts_the_distances_of_rviz(distance: float) -> None:
    bench = Bench()
    display = add(bench, far_plane_distance=distance)
    inset = show_inset(bench, info())
    assert display["Far Plane Distance"] == distance
    assert inset is not None
    assert inset.camera is not None
    assert inset.camera.far == max(distance, 0.02)


def test_panel_lists_the_other_displays_below_visibility() -> None:
    bench = Bench()
    camera = add(bench)
    bench.session.add("rviz_default_plugins/Axes", "Axes", {})
    above = f"{camera.path}#Visibility#"

    def boxes() -> dict[str, Any]:
        rows = display_rows(bench.session)
        return {key.removeprefix(above): rows[key].row.value for key in rows if key.startswith(above)}

    others = {display.name: True for display in bench.session.displays if display is not camera}
    assert "Axes" in others
    assert boxes() == {**others, "Grid": False}
    edit = display_rows(bench.session)[f"{above}Axes"].edit
    assert edit is not None
    edit(False)
    assert boxes() == {**others, "Grid": False, "Axes": False}
    # Each box stays in its place, directly below Visibility.
    keys = list(display_rows(bench.session))
    first = keys.index(above.removesuffix("#")) + 1
    assert keys[first : first + len(others)] == [above + name for name in others]
    assert camera["Visibility"] == {"Grid": False, "Axes": False}
