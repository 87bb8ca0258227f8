"""Views in a real page: camera motions of the user reach the session."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import Quaternion, TransformStamped
from tf2_msgs.msg import TFMessage

from course_lib.displays.views import FPS, FrameAligned, Orbit, TopDownOrtho, ViewController, XYOrbit
from tests.browser.bench import Bench
from tests.displays.stage import publish

pytestmark = pytest.mark.browser
TURNED_AFTER = 150  # delay after which a page reports that its view is at rest [ms]


def rests_at(bench: Bench, label: str, value: object) -> None:
    """Wait until the page has reported the final camera."""
    bench.host.wait_until(lambda: bench.viewer.view[label] == pytest.approx(value, abs=1e-3))


@pytest.mark.slow
def test_view_rotated_with_the_mouse_updates_the_view_properties(bench: Bench) -> None:
    view = bench.viewer.view
    yaw, pitch, distance = view["Yaw"], view["Pitch"], view["Distance"]
    bench.drag((0, 0), (50, 0), (100, 20))
    rests_at(bench, "Yaw", yaw - 0.5)
    assert view["Pitch"] == pytest.approx(pitch + 0.1, abs=1e-3)
    assert view["Distance"] == pytest.approx(distance, rel=1e-6)


@pytest.mark.slow
def test_saved_view_is_restored(bench: Bench) -> None:
    bench.press("Views panel")
    bench.press("Save the current view")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("Start")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    bench.page.get_by_role("combobox", name="Type of view").select_option("TopDownOrtho")
    bench.host.carry()
    assert repr(bench.viewer.view) == "TopDownOrtho"
    notice = bench.page.locator(".course-notice")
    bench.press("Use the chosen saved view")
    assert notice.inner_text() == "Choose a saved view first."
    bench.page.get_by_role("listbox", name="Saved views").select_option("Start")
    bench.press("Use the chosen saved view")
    assert repr(bench.viewer.view) == "Orbit"
    assert notice.inner_text() == ""


@pytest.mark.slow
def test_fps_view_rotates_around_the_camera(bench: Bench) -> None:
    bench.press("Views panel")
    bench.page.get_by_role("combobox", name="Type of view").select_option("FPS")
    bench.host.carry()
    bench.widget.flush()
    bench.host.carry()
    view = bench.viewer.view
    position, yaw = view["Position"], view["Yaw"]
    bench.drag((0, 0), (40, 0))
    rests_at(bench, "Yaw", yaw - 0.2)
    assert view["Position"] == pytest.approx(position, abs=1e-6)


def show_view(bench: Bench, view: ViewController) -> None:
    bench.viewer.view = view
    tell(bench)


def tell(bench: Bench) -> None:
    """Send the changes to the page before the next frame."""
    bench.widget.flush()
    bench.widget.link.receive({"type": "panels", "act": "RequestUpdate"})
    bench.host.carry()


@pytest.mark.slow
def test_xy_orbit_view_keeps_its_focal_point_on_the_ground(bench: Bench) -> None:
    show_view(bench, XYOrbit(distance=5.0, yaw=0.0, pitch=0.8))
    view, canvas = bench.viewer.view, bench.page.locator("canvas")
    bench.page.keyboard.down("Shift")
    bench.drag((0, 60), (30, 60))
    bench.page.keyboard.up("Shift")
    canvas.press("ArrowLeft")
    canvas.press("+")
    rests_at(bench, "Distance", 5.0 * math.exp(-0.12))
    x, y, z = view["Focal Point"]
    assert (x, z) == pytest.approx((0.0, 0.0), abs=1e-3)
    assert y < -0.05  # the point under the pointer moves to the right, which is +y
    assert view["Yaw"] == pytest.approx(0.08, abs=1e-3)
    assert view["Pitch"] == pytest.approx(0.8, abs=1e-3)


@pytest.mark.slow
def test_frame_aligned_view_rotates_about_the_frame_axis_unless_locked(bench: Bench) -> None:
    half = 0.5**0.5
    tilt = TransformStamped(child_frame_id="tilted")
    tilt.header.frame_id = "map"
    tilt.transform.rotation = Quaternion(x=half, w=half)  # z of the frame is -y of map
    publish(bench.graph, "/tf_static", TFMessage(transforms=[tilt]))
    show_view(bench, FrameAligned(target_frame="tilted", yaw=0.5, pitch=0.3, position=(1.0, 2.0, 3.0)))
    view = bench.viewer.view
    bench.drag((0, 0), (40, 20))
    rests_at(bench, "Yaw", 0.3)
    assert view["Pitch"] == pytest.approx(0.4, abs=1e-3)
    assert view["Position"] == pytest.approx((1.0, 2.0, 3.0), abs=1e-6)
    view["Lock Camera"] = True
    tell(bench)
    bench.drag((0, 0), (40, 20))
    bench.page.wait_for_timeout(2 * TURNED_AFTER)
    bench.host.carry()
    assert view["Yaw"] == pytest.approx(0.3, abs=1e-3)


@pytest.mark.slow
def test_top_down_view_rotates_and_z_resets_it(bench: Bench) -> None:
    show_view(bench, TopDownOrtho(scale=50.0))
    view = bench.viewer.view
    bench.drag((0, 0), (40, 20))
    rests_at(bench, "Angle", 0.2)
    assert view["Scale"] == pytest.approx(50.0, abs=1e-3)
    bench.page.locator("canvas").press("z")
    bench.host.carry()
    assert (view["Angle"], view["Scale"]) == (0.0, 10.0)


@pytest.mark.slow
def test_focus_tool_moves_the_focal_point_to_the_clicked_object(bench: Bench) -> None:
    eye = bench.viewer.camera.eye
    bench.page.locator("canvas").press("c")
    bench.drag((0, 0))
    view = bench.viewer.view
    bench.host.wait_until(lambda: max(map(abs, view["Focal Point"])) == pytest.approx(0.5, abs=0.01))
    assert bench.viewer.camera.eye == pytest.approx(eye)


@pytest.mark.slow
def test_full_screen_view_fills_the_area_between_the_panels(bench: Bench) -> None:
    bench.open()
    bench.press("Full screen (F11)")
    bench.page.wait_for_function("document.fullscreenElement?.className == 'course-viewer'")
    box = bench.page.locator("canvas").bounding_box()
    size = bench.page.viewport_size
    assert box is not None
    assert size is not None
    assert box["height"] > size["height"] - 120
    assert bench.page.get_by_role("group", name="Time").is_visible()
    assert box["width"] == pytest.approx(size["width"] - 330, abs=2)


def test_wheel_zooms_by_its_motion_and_a_disc_marks_the_focal_point_during_a_turn(bench: Bench) -> None:
    show_view(bench, Orbit(distance=5.0, focal_point=(0.0, 3.0, 0.0), focal_shape_size=1.0))
    bench.drag((0, 0), (0, 0))
    bench.page.mouse.wheel(0, -120)
    bench.page.mouse.wheel(0, 5)  # a touchpad
    rests_at(bench, "Distance", 5.0 * math.exp(0.12 * (-1 + 0.05)))
    before = bench.host.pixels().astype(int)
    bench.page.mouse.down()
    bench.host.carry()
    change = bench.host.pixels() - before
    is_yellow = (change[..., :2].min(axis=2) > 20) & (change[..., 2] < 0)
    assert is_yellow.sum() > 500
    bench.page.mouse.up()
    bench.host.carry()
    assert np.abs(bench.host.pixels() - before).max(axis=2)[is_yellow].mean() < 20


@pytest.mark.slow
@pytest.mark.parametrize(
    ("view", "label", "dragged", "turned"),
    [
        (Orbit(distance=5.0, yaw=0.0, pitch=0.0), "Focal Point", (1.0, 0.0, 0.0), (1.6, 0.0, 0.0)),
        (TopDownOrtho(scale=50.0), "Scale", 50 * math.exp(-0.2), 50 * math.exp(-0.32)),
        (XYOrbit(distance=5.0), "Distance", 5 * math.exp(0.2), 5 * math.exp(0.32)),
        (FPS(yaw=math.pi, pitch=0.0, position=(0.0, 0.0, 1.0)), "Position", (2.214, 0, 1), (3.489, 0, 1)),
    ],
    ids=lambda value: repr(value) if isinstance(value, ViewController) else "",
)
def test_shift_with_the_right_button_or_the_wheel_acts_as_in_rviz(
    bench: Bench, view: ViewController, label: str, dragged: object, turned: object
) -> None:
    show_view(bench, view)
    bench.page.keyboard.down("Shift")
    bench.drag((0, 0), (0, 20), button="right")
    rests_at(bench, label, dragged)
    bench.page.mouse.wheel(0, 120)
    rests_at(bench, label, turned)
    bench.page.keyboard.up("Shift")


@pytest.mark.slow
def test_zero_button_restores_the_default_camera(bench: Bench) -> None:
    show_view(bench, Orbit(distance=3.0, focal_point=(1.0, 2.0, 3.0)))
    bench.press("Views panel")
    bench.press("Jump to 0,0,0 with the current view controller (Z)")
    view = bench.viewer.view
    assert (view["Distance"], view["Focal Point"]) == (10.0, (0.0, 0.0, 0.0))


def test_key_f_looks_at_the_point_below_the_pointer(bench: Bench) -> None:
    show_view(bench, Orbit(distance=5.0, yaw=0.0, pitch=math.pi / 2))
    canvas = bench.page.locator("canvas")
    box = canvas.bounding_box()
    assert box is not None
    canvas.press("f")  # the pointer is elsewhere
    # The cube of 1 m at the origin, seen from above, 4.5 m above its top.
    pixels_per_meter = box["height"] / 2 / math.tan(math.pi / 8) / 4.5
    bench.page.mouse.move(box["x"] + box["width"] / 2 + 0.25 * pixels_per_meter, box["y"] + box["height"] / 2)
    canvas.press("f")
    bench.host.carry()
    bench.host.wait_until(lambda: bench.viewer.view["Focal Point"] != (0.0, 0.0, 0.0))
    x, y, z = bench.viewer.view["Focal Point"]
    assert (abs(x), abs(y), z) == pytest.approx((0.0, 0.25, 0.5), abs=0.03)


@pytest.mark.slow
def test_fps_view_moves_by_the_same_step_after_it_has_looked_at_a_point(bench: Bench) -> None:
    show_view(bench, FPS(yaw=math.pi, pitch=0.0, position=(5.0, 0.0, 0.3)))
    canvas = bench.page.locator("canvas")
    box = canvas.bounding_box()
    assert box is not None
    bench.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    canvas.press("f")
    canvas.press("-")
    away = 5.0 + 10 * (math.exp(0.12) - 1)
    bench.host.wait_until(lambda: bench.viewer.view["Position"][0] == pytest.approx(away, abs=0.01))


def touch(bench: Bench, *steps: tuple[tuple[int, int], ...]) -> None:
    """Put fingers on the view, move them from step to step, and lift them.

    A step has a position `right`, `down` of the middle for each finger, in pixels.
    """
    box = bench.page.locator("canvas").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    session = bench.page.context.new_cdp_session(bench.page)
    session.send("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
    kinds = ["touchStart", *["touchMove"] * (len(steps) - 1), "touchEnd"]
    for kind, step in zip(kinds, [*steps, ()], strict=True):
        fingers = [{"x": x + right, "y": y + down, "id": i} for i, (right, down) in enumerate(step)]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})
    session.send("Emulation.setTouchEmulationEnabled", {"enabled": False})
    bench.host.carry()


def test_one_finger_turns_a_view_and_two_fingers_zoom_and_pan_it(bench: Bench) -> None:
    show_view(bench, Orbit(distance=8.0, yaw=0.5, pitch=0.5))
    touch(bench, ((0, 0),), ((50, 0),), ((100, 0),))
    rests_at(bench, "Yaw", 0.0)
    touch(bench, ((-50, 0), (50, 0)), ((-75, 0), (75, 0)), ((-100, 0), (100, 0)))
    rests_at(bench, "Distance", 4.0)
    # The fingers move one after the other, so the second pans back a little less than the first.
    assert bench.viewer.view["Focal Point"] == pytest.approx((0, 0, 0), abs=0.1)
    touch(bench, ((-50, 0), (50, 0)), ((-50, 40), (50, 40)))
    bench.host.wait_until(lambda: bench.viewer.view["Focal Point"][2] > 0.2)
    view = bench.viewer.view
    turned = view["Yaw"], view["Pitch"], view["Distance"]
    assert turned == pytest.approx((0.0, 0.5, 4.0), abs=0.01)
