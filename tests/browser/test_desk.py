"""RViz's panels in a real page: what is clicked and typed there reaches the session."""

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TransformStamped,
)
from playwright.sync_api import Locator
from tf2_msgs.msg import TFMessage

from course_lib.displays.viewer import Viewer
from course_lib.displays.views import FrameAligned, TopDownOrtho, View, XYOrbit
from course_lib.ros.graph import Graph, Sample, use_graph
from course_lib.ros.messages import deserialize
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host
from tests.displays.bench import marker
from tests.displays.stage import publish

pytestmark = pytest.mark.browser
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder


class Bench:
    """A viewer in a page, with its graph."""

    def __init__(self, host: Host, graph: Graph) -> None:
        self.host, self.page, self.graph = host, host.page, graph
        self.viewer = Viewer()
        self.viewer.add("Marker", topic="/m")
        publish(graph, "/m", marker())
        self.viewer._repr_mimebundle_()
        self.widget: SceneWidget = self.viewer._panel._view  # type: ignore[assignment]  # it was just shown
        host.open(self.widget)
        host.show(self.widget, 780)
        self.heard: list[Sample] = []
        graph.tap(self.heard.append)

    def row(self, label: str) -> Locator:
        return self.page.get_by_role("row").filter(has=self.page.get_by_text(label, exact=True))

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name, exact=True).click()
        self.host.carry()

    def open(self, *labels: str) -> None:
        self.press("Displays panel")
        for label in labels:
            self.row(label).press("ArrowRight")

    def choose(self, label: str) -> None:
        """Choose in the window that is open."""
        self.page.get_by_role("dialog").get_by_role("listbox").select_option(label=label)
        self.page.get_by_role("dialog").locator("button[type=submit]").click()
        self.host.carry()

    def drag(self, *points: tuple[int, int]) -> None:
        """Drag in the view, from its middle, by pixels."""
        box = self.page.locator("canvas").bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(x + points[0][0], y + points[0][1])
        self.page.mouse.down()
        for dx, dy in points[1:]:
            self.page.mouse.move(x + dx, y + dy)
        self.page.mouse.up()
        self.host.carry()

    def message(self, topic: str, kind: Any) -> Any:
        (sample,) = (sample for sample in self.heard if sample.topic == topic)
        return deserialize(sample.cdr, kind)


@pytest.fixture
def bench(host: Host, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.chdir(tmp_path)
    with use_graph(Graph()) as graph:
        host.page.set_default_timeout(8000)
        made = Bench(host, graph)
        assert host.errors == []
        yield made
        if PICTURES:
            host.page.screenshot(
                path=Path(PICTURES)
                / f"desk_{os.environ['PYTEST_CURRENT_TEST'].split('::')[1].split(' ')[0]}.png"
            )
        assert host.errors == []
        made.viewer.close()


def test_a_calm_line_says_the_worst_status_until_the_tree_is_opened(bench: Bench) -> None:
    assert bench.page.get_by_role("treegrid").count() == 0
    assert "No tf data" in bench.page.locator(".course-line").first.inner_text()
    bench.open()
    assert bench.page.get_by_role("treegrid", name="Displays").is_visible()


def test_a_status_has_icon_word_and_text(bench: Bench) -> None:
    bench.open("Marker", "Status: Ok")
    row = bench.row("Topic").first
    assert "messages received" in row.inner_text()
    assert row.get_by_role("img").get_attribute("title") == "Ok"
    assert "✔" in row.get_by_role("img").inner_text()


def test_check_boxes_show_and_hide_displays(bench: Bench) -> None:
    bench.open()
    bench.page.get_by_role("checkbox", name="Show Marker").click()
    bench.host.carry()
    assert not bench.viewer["Marker"].enabled


def test_properties_are_edited_by_their_kinds(bench: Bench) -> None:
    bench.open("Grid", "Offset")
    bench.page.get_by_role("spinbutton", name="Cell Size").fill("2.5")
    bench.page.get_by_role("combobox", name="Plane", exact=True).select_option("XZ")
    bench.page.get_by_role("spinbutton", name="Offset z").fill("1")
    bench.page.get_by_label("Color", exact=True).fill("#ff0080")
    bench.page.get_by_role("spinbutton", name="Alpha").fill("7")
    bench.page.keyboard.press("Tab")
    bench.host.carry()
    grid = bench.viewer["Grid"]
    assert [grid[label] for label in ("Cell Size", "Plane", "Offset", "Color", "Alpha")] == [
        2.5, "XZ", (0.0, 0.0, 1.0), (255, 0, 128), 1.0,
    ]  # fmt: skip


def test_the_fixed_frame_is_edited_with_suggestions(bench: Bench) -> None:
    bench.open()
    field = bench.page.get_by_role("combobox", name="Fixed Frame")
    assert bench.page.locator(f"#{field.get_attribute('list')} option").count() == 1
    field.fill("odom")
    field.press("Enter")
    bench.host.carry()
    assert bench.viewer.fixed_frame == "odom"


def test_displays_are_added_by_topic_of_the_running_graph_and_by_type(bench: Bench) -> None:
    publish(bench.graph, "/others", marker())
    bench.viewer.look()
    bench.open()
    bench.press("Add a display")
    bench.choose("/others (visualization_msgs/msg/Marker) → Marker")
    bench.press("Add a display")
    bench.choose("Axes")
    assert [(d.name, d.class_name.partition("/")[2]) for d in bench.viewer.displays[2:]] == [
        ("Marker", "Marker"), ("Axes", "Axes"),
    ]  # fmt: skip
    assert bench.viewer.displays[2]["Topic"] == "/others"


def test_displays_are_renamed_duplicated_and_removed(bench: Bench) -> None:
    bench.open()
    bench.row("Grid").focus()
    bench.press("Rename the chosen display")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("Floor")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    bench.press("Duplicate the chosen display")
    assert [display.name for display in bench.viewer.displays] == ["Floor", "Marker", "Floor"]
    bench.row("Marker").press("Delete")
    bench.host.carry()
    assert [display.name for display in bench.viewer.displays] == ["Floor", "Floor"]


def test_a_layout_is_saved_and_opened_by_keys(bench: Bench, tmp_path: Path) -> None:
    canvas = bench.page.locator("canvas")
    canvas.press("Control+s")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("mine")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    assert (tmp_path / "mine.rviz").exists()
    bench.viewer.remove(bench.viewer["Marker"])
    bench.widget.link.receive({"type": "desk", "act": "open"})
    bench.host.carry()
    canvas.press("Control+o")
    bench.choose("mine.rviz")
    assert [display.name for display in bench.viewer.displays] == ["Grid", "Marker"]


def test_a_goal_is_dragged_on_the_ground_as_rviz_publishes_it(bench: Bench) -> None:
    bench.viewer.view = type(bench.viewer.view)(yaw=-1.5707963, focal_point=(1.0, 2.0, 0.0))  # y is up
    bench.widget.flush()
    bench.host.carry()
    bench.page.locator("canvas").press("g")
    bench.drag((0, 0), (0, -20), (0, -60))
    goal = bench.message("/goal_pose", PoseStamped)
    assert goal.header.frame_id == "map"
    at, turn = goal.pose.position, goal.pose.orientation
    assert (at.x, at.y, at.z) == pytest.approx((1.0, 2.0, 0.0), abs=0.02)
    assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx((0, 0, 0.5**0.5, 0.5**0.5), abs=0.02)
    assert bench.page.get_by_role("button", name="Interact (i)").get_attribute("aria-pressed") == "true"


def test_an_estimate_has_the_covariance_of_rviz(bench: Bench) -> None:
    bench.page.locator("canvas").press("p")
    bench.drag((0, 0), (40, 0))
    covariance = bench.message("/initialpose", PoseWithCovarianceStamped).pose.covariance
    assert {i: value for i, value in enumerate(covariance) if value} == {
        0: 0.25, 7: 0.25, 35: 0.06853891909122467,
    }  # fmt: skip


def test_a_point_on_an_object_is_published(bench: Bench) -> None:
    bench.press("Publish Point (u)")
    bench.drag((0, 0))
    point = bench.message("/clicked_point", PointStamped)
    assert point.header.frame_id == "map"
    assert max(abs(point.point.x), abs(point.point.y), abs(point.point.z)) == pytest.approx(0.5, abs=0.01)


def test_escape_leaves_a_tool(bench: Bench) -> None:
    canvas = bench.page.locator("canvas")
    canvas.press("n")
    assert bench.page.get_by_role("button", name="Measure (n)").get_attribute("aria-pressed") == "true"
    canvas.press("Escape")
    assert bench.page.get_by_role("button", name="Interact (i)").get_attribute("aria-pressed") == "true"


def test_a_selected_object_tells_its_message_and_frame(bench: Bench) -> None:
    bench.press("Views panel")
    bench.page.locator("canvas").press("s")
    bench.drag((0, 0))
    assert "in frame 'map'" in bench.page.get_by_label("Selection").inner_text()
    assert "frame_id: map" in bench.page.get_by_label("Selection").inner_text()


def test_a_distance_is_measured(bench: Bench) -> None:
    bench.page.locator("canvas").press("n")
    bench.drag((0, 0))
    bench.drag((10, 0))
    assert "[Length: 0." in bench.page.locator(".course-notice").inner_text()


def test_a_view_turned_by_hand_comes_back_to_the_properties(bench: Bench) -> None:
    view = bench.viewer.view
    yaw, pitch, distance = view["Yaw"], view["Pitch"], view["Distance"]
    bench.drag((0, 0), (50, 0), (100, 20))
    bench.page.wait_for_timeout(300)
    bench.host.carry()
    assert view["Yaw"] == pytest.approx(yaw - 0.5, abs=1e-3)
    assert view["Pitch"] == pytest.approx(pitch + 0.1, abs=1e-3)
    assert view["Distance"] == pytest.approx(distance, rel=1e-6)


def test_views_are_changed_saved_and_used_again(bench: Bench) -> None:
    bench.press("Views panel")
    bench.press("Save the current view")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("Start")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    bench.page.get_by_role("combobox", name="Type of view").select_option("TopDownOrtho")
    bench.host.carry()
    assert repr(bench.viewer.view) == "TopDownOrtho"
    bench.page.get_by_role("listbox", name="Saved views").select_option("Start")
    bench.press("Use the chosen saved view")
    assert repr(bench.viewer.view) == "Orbit"


def test_clicks_reach_python_and_the_scene_is_told_in_words(bench: Bench) -> None:
    paths: list[str | None] = []
    bench.viewer.on_click(lambda click: paths.append(click.path))
    bench.drag((0, 0))
    assert [path and path.split("/")[1] for path in paths] == ["Marker"]
    described = bench.page.locator("canvas").get_attribute("aria-describedby")
    assert "Fixed frame map" in (bench.page.locator(f"#{described}").text_content() or "")


def test_a_malformed_order_is_answered_in_the_status_line(bench: Bench) -> None:
    bench.widget.link.receive({"type": "desk", "act": "set", "row": "nowhere", "value": 1})
    bench.host.carry()
    assert "'nowhere' is not there any more" in bench.page.locator(".course-notice").inner_text()
    bench.widget.link.receive({"type": "desk", "act": "camera", "eye": None})
    bench.host.carry()
    assert "makes no sense" in bench.page.locator(".course-notice").inner_text()


def test_an_fps_view_turns_around_its_eye(bench: Bench) -> None:
    bench.press("Views panel")
    bench.page.get_by_role("combobox", name="Type of view").select_option("FPS")
    bench.host.carry()
    bench.widget.flush()
    bench.host.carry()
    view = bench.viewer.view
    position, yaw = view["Position"], view["Yaw"]
    bench.drag((0, 0), (40, 0))
    bench.page.wait_for_timeout(300)
    bench.host.carry()
    assert view["Position"] == pytest.approx(position, abs=1e-6)
    assert view["Yaw"] == pytest.approx(yaw - 0.2, abs=1e-3)


def show_view(bench: Bench, view: View) -> None:
    bench.viewer.view = view
    tell(bench)


def tell(bench: Bench) -> None:
    """Let the page have what was changed, without waiting for its turn."""
    bench.widget.flush()
    bench.widget.link.receive({"type": "desk", "act": "look"})
    bench.host.carry()


def rest(bench: Bench) -> None:
    """Let the page tell where the view was turned to."""
    bench.page.wait_for_timeout(300)
    bench.host.carry()


def test_an_xy_orbit_moves_turns_and_zooms_with_its_focal_point_on_the_ground(bench: Bench) -> None:
    show_view(bench, XYOrbit(distance=5.0, yaw=0.0, pitch=0.8))
    view, canvas = bench.viewer.view, bench.page.locator("canvas")
    bench.page.keyboard.down("Shift")
    bench.drag((0, 60), (30, 60))
    bench.page.keyboard.up("Shift")
    canvas.press("ArrowLeft")
    canvas.press("+")
    rest(bench)
    x, y, z = view["Focal Point"]
    assert (x, z) == pytest.approx((0.0, 0.0), abs=1e-3)
    assert y < -0.05  # what is under the pointer goes to the right with it, where +y is
    assert view["Yaw"] == pytest.approx(0.08, abs=1e-3)
    assert (view["Pitch"], view["Distance"]) == pytest.approx((0.8, 5.0 * math.exp(-0.1)), abs=1e-3)


def test_a_frame_aligned_view_turns_about_the_axis_of_its_frame_unless_it_is_locked(bench: Bench) -> None:
    half = 0.5**0.5
    tilt = TransformStamped(child_frame_id="tilted")
    tilt.header.frame_id = "map"
    tilt.transform.rotation = Quaternion(x=half, w=half)  # z of the frame is -y of map
    publish(bench.graph, "/tf_static", TFMessage(transforms=[tilt]))
    show_view(bench, FrameAligned(target_frame="tilted", yaw=0.5, pitch=0.3, position=(1.0, 2.0, 3.0)))
    view = bench.viewer.view
    bench.drag((0, 0), (40, 20))
    rest(bench)
    assert (view["Yaw"], view["Pitch"]) == pytest.approx((0.3, 0.4), abs=1e-3)
    assert view["Position"] == pytest.approx((1.0, 2.0, 3.0), abs=1e-6)
    view["Lock Camera"] = True
    tell(bench)
    bench.drag((0, 0), (40, 20))
    rest(bench)
    assert view["Yaw"] == pytest.approx(0.3, abs=1e-3)


def test_a_view_from_above_turns_and_z_brings_it_back(bench: Bench) -> None:
    show_view(bench, TopDownOrtho(scale=50.0))
    view = bench.viewer.view
    bench.drag((0, 0), (40, 20))
    rest(bench)
    assert (view["Angle"], view["Scale"]) == pytest.approx((0.2, 50.0), abs=1e-3)
    bench.page.locator("canvas").press("z")
    bench.host.carry()
    assert (view["Angle"], view["Scale"]) == (0.0, 10.0)


def test_the_properties_of_a_tool_are_typed_in_the_views_panel(bench: Bench) -> None:
    bench.press("Views panel")
    bench.page.get_by_text("Tool Properties", exact=True).click()
    bench.row("2D Goal Pose").press("ArrowRight")
    field = bench.page.get_by_role("textbox", name="Topic")
    field.fill("/my_goal")
    field.press("Enter")
    bench.host.carry()
    assert bench.viewer.session.tools[6]["Topic"] == "/my_goal"


def test_focus_puts_the_focal_point_on_what_is_clicked(bench: Bench) -> None:
    eye = bench.viewer.camera.eye
    bench.page.locator("canvas").press("c")
    bench.drag((0, 0))
    bench.page.wait_for_timeout(300)
    bench.host.carry()
    assert max(map(abs, bench.viewer.view["Focal Point"])) == pytest.approx(0.5, abs=0.01)
    assert bench.viewer.camera.eye == pytest.approx(eye)


def test_everything_is_reached_by_the_tab_key_and_has_a_name(bench: Bench) -> None:
    bench.open("Grid")
    bench.press("Views panel")
    bench.page.evaluate("document.activeElement.blur()")
    unnamed = """() => [...document.querySelectorAll('.course-viewer :is(button, input, select, canvas)')]
        .filter(e => !(e.ariaLabel || e.getAttribute('aria-label') || e.textContent)).map(e => e.outerHTML)"""
    assert bench.page.evaluate(unnamed) == []
    seen = set()
    for _ in range(60):
        bench.page.keyboard.press("Tab")
        seen.add(bench.page.evaluate("document.activeElement.ariaLabel"))
    assert {
        "Interact (i)",
        "Add a display",
        "Cell Size",
        "Offset z",
        "Type of view",
        "Displays panel",
    } <= seen


def test_in_full_screen_the_view_fills_what_the_panels_leave(bench: Bench) -> None:
    bench.open()
    bench.press("Full screen")
    bench.page.wait_for_function("document.fullscreenElement?.className == 'course-viewer'")
    box = bench.page.locator("canvas").bounding_box()
    size = bench.page.viewport_size
    assert box is not None
    assert size is not None
    assert box["height"] > size["height"] - 120
    assert bench.page.get_by_role("group", name="Time").is_visible()
    assert box["width"] == pytest.approx(size["width"] - 330, abs=2)
