"""RViz's panels in a real page: clicks and keys reach the session."""

from pathlib import Path

import pytest
from playwright.sync_api import expect
from sensor_msgs.msg import Image
from std_msgs.msg import String

from tests.browser.bench import Bench
from tests.displays.bench import marker
from tests.displays.robot_model.robots import ARM, CYLINDER
from tests.displays.stage import LATCHED, publish

pytestmark = pytest.mark.browser


@pytest.mark.slow
def test_status_line_shows_the_worst_status_until_the_tree_is_opened(bench: Bench) -> None:
    assert bench.page.get_by_role("treegrid").count() == 0
    assert "No tf data" in bench.page.locator(".course-line").first.inner_text()
    bench.open()
    assert bench.page.get_by_role("treegrid", name="Displays").is_visible()


@pytest.mark.slow
def test_long_status_is_wrapped_below_a_narrow_view(bench: Bench) -> None:
    bench.page.evaluate("document.querySelector('.course-viewer').style.width = '420px'")
    line = bench.page.locator(".course-line").first
    assert line.inner_text().endswith("No tf data. Actual error: Frame [map] does not exist")
    assert line.evaluate(
        "line => line.scrollWidth <= line.clientWidth && line.scrollHeight <= line.clientHeight"
    )


@pytest.mark.slow
def test_status_has_icon_level_and_text(bench: Bench) -> None:
    bench.open("Marker", "Status: Ok")
    row = bench.row("Topic").first
    assert "messages received" in row.inner_text()
    assert row.get_by_role("img").get_attribute("title") == "Ok"
    assert "✔" in row.get_by_role("img").inner_text()


@pytest.mark.slow
def test_checkboxes_show_and_hide_displays(bench: Bench) -> None:
    bench.open()
    bench.page.get_by_role("checkbox", name="Show Marker").click()
    bench.host.carry()
    assert not bench.viewer["Marker"].enabled


@pytest.mark.slow
def test_property_editors_match_the_property_types(bench: Bench) -> None:
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


def test_fields_show_the_value_that_python_has_accepted(bench: Bench) -> None:
    bench.open("Marker", "Topic")
    field = bench.page.get_by_role("spinbutton", name="Frame Rate")
    # Each is clipped or rejected, and the second one changes nothing.
    for typed in ("-5", "-1", "e"):
        field.press("Control+a")
        field.press_sequentially(typed)
        field.press("Enter")
        bench.host.carry()
        expect(field).to_have_value("1")
    assert "'Frame Rate' is '', expected an integer" in bench.page.locator(".course-notice").inner_text()
    depth = bench.page.get_by_role("spinbutton", name="Depth")
    depth.fill("1234567")
    depth.press("Enter")
    bench.host.carry()
    expect(depth).to_have_value("1234567")
    field.fill("12")
    field.press("Escape")
    bench.host.carry()
    expect(field).to_have_value("1")
    assert bench.viewer.options["Frame Rate"] == 1


@pytest.mark.slow
def test_rows_with_and_without_values_have_equal_heights(bench: Bench) -> None:
    bench.open("Grid")
    rows = bench.page.get_by_role("treegrid", name="Displays").get_by_role("row").all()
    boxes = [row.bounding_box() for row in rows]
    assert len(boxes) > 10
    assert {box and box["height"] for box in boxes} == {24}


@pytest.mark.slow
def test_fixed_frame_is_edited_with_suggestions(bench: Bench) -> None:
    bench.open()
    field = bench.page.get_by_role("combobox", name="Fixed Frame")
    assert bench.page.locator(f"#{field.get_attribute('list')} option").count() == 1
    field.fill("odom")
    field.press("Enter")
    bench.host.carry()
    assert bench.viewer.fixed_frame == "odom"


def test_displays_are_added_by_topic_of_the_running_graph_and_by_type(bench: Bench) -> None:
    publish(bench.graph, "/others", marker())
    bench.viewer.refresh()
    bench.open()
    before = len(bench.viewer.displays)
    bench.press("Add a display")
    bench.choose("/others (visualization_msgs/msg/Marker) → Marker")
    bench.press("Add a display")
    window = bench.page.get_by_role("dialog")
    window.get_by_role("listbox").select_option(label="Axes")
    assert "Displays an axis at the Target Frame's origin." in window.inner_text()
    bench.choose("Axes")
    assert [(d.name, d.class_name.partition("/")[2]) for d in bench.viewer.displays[before:]] == [
        ("Marker", "Marker"), ("Axes", "Axes"),
    ]  # fmt: skip
    assert bench.viewer.displays[before]["Topic"] == "/others"


@pytest.mark.slow
def test_topic_of_several_displays_is_suggested_once(bench: Bench) -> None:
    publish(bench.graph, "/camera/depth", Image())  # for Camera, DepthCloud and Image
    bench.viewer.add("DepthCloud")
    bench.viewer.refresh()
    bench.open("DepthCloud")
    field = bench.page.get_by_role("combobox", name="Depth Map Topic")
    options = bench.page.locator(f"[id='{field.get_attribute('list')}'] option")
    assert options.evaluate_all("all => all.map((one) => one.value)") == ["/camera/depth"]


@pytest.mark.slow
def test_row_that_is_not_a_display_is_not_renamed(bench: Bench) -> None:
    bench.open()
    bench.row("Global Options").focus()
    bench.press("Rename the chosen display")
    expect(bench.page.get_by_role("dialog")).to_have_count(0)
    assert bench.page.locator(".course-notice").inner_text() == "Select a display in the tree first."


@pytest.mark.slow
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


@pytest.mark.slow
def test_keyboard_focus_moves_to_the_next_row_after_a_display_is_removed_and_shortcuts_work(
    bench: Bench,
) -> None:
    bench.open()
    bench.row("Grid").press("Delete")
    bench.host.carry()
    assert bench.page.evaluate("document.activeElement.dataset.key") == "displays/Marker"
    bench.page.keyboard.press("Control+s")
    assert bench.page.get_by_role("dialog", name="Save").is_visible()


@pytest.mark.slow
def test_open_list_is_not_rebuilt_when_displays_change(bench: Bench) -> None:
    bench.open()
    bench.press("Add a display")
    stays = "document.querySelector('dialog option')"
    bench.page.evaluate(f"globalThis.before = {stays}")
    bench.viewer.remove(bench.viewer["Marker"])
    bench.widget.link.receive({"type": "panels", "act": "RequestUpdate"})
    bench.host.carry()
    assert bench.row("Marker").count() == 0
    assert bench.page.evaluate(f"globalThis.before === {stays}")


@pytest.mark.slow
def test_layout_is_saved_and_opened_with_keyboard_shortcuts(bench: Bench, tmp_path: Path) -> None:
    canvas = bench.page.locator("canvas")
    canvas.press("Control+s")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("mine")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    assert (tmp_path / "mine.rviz").exists()
    bench.viewer.remove(bench.viewer["Marker"])
    bench.widget.link.receive({"type": "panels", "act": "OpenPanels"})
    bench.host.carry()
    canvas.press("Control+o")
    bench.choose("mine.rviz")
    assert [display.name for display in bench.viewer.displays] == ["Grid", "Marker"]


def test_notice_below_a_narrow_view_is_not_cut_off(bench: Bench, tmp_path: Path) -> None:
    canvas = bench.page.locator("canvas")
    canvas.press("Control+s")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("the_layout_of_my_first_own_robot")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    bench.page.evaluate("document.querySelector('.course-viewer').style.width = '420px'")
    notice = bench.page.locator(".course-notice")
    assert notice.inner_text() == "Saved the_layout_of_my_first_own_robot.rviz."
    assert notice.evaluate("notice => notice.scrollWidth <= notice.clientWidth")
    # On a line of its own: next to the status it would take up to six lines from the view.
    assert notice.evaluate("notice => notice.clientWidth > 0.9 * notice.parentElement.clientWidth")
    status = bench.page.locator(".course-line").first
    assert status.evaluate("status => status.clientWidth") > 60
    parts = bench.page.locator(".course-lines, .course-lines button")
    hidden = parts.evaluate_all("parts => parts.map((part) => part.scrollWidth - part.clientWidth)")
    assert max(hidden) <= 0


def test_long_status_leaves_one_line_to_a_notice(bench: Bench) -> None:
    status = bench.page.locator(".course-line").first
    assert "No tf data. Actual error: Frame [map] does not exist" in status.inner_text()
    bench.page.evaluate("document.querySelector('.course-viewer').style.width = '640px'")
    bench.page.locator("canvas").press("g")
    notice = bench.page.locator(".course-notice")
    assert notice.inner_text() == "Click and drag to set position and orientation."
    assert notice.evaluate("notice => notice.clientHeight") < 30  # [px]; a line has 20
    bench.page.evaluate("document.querySelector('.course-viewer').style.width = '185px'")
    lines = bench.page.locator(".course-lines")
    assert lines.evaluate("line => line.scrollWidth <= line.clientWidth")


@pytest.mark.slow
def test_long_notice_leaves_a_line_of_the_status_readable(bench: Bench) -> None:
    bench.page.locator("canvas").press("n")
    bench.drag((0, 0))
    bench.drag((10, 0))
    assert "[Length: " in bench.page.locator(".course-notice").inner_text()
    status = bench.page.locator(".course-line").first
    assert status.evaluate("status => status.clientWidth") > 200  # [px] of 780
    assert status.evaluate("status => status.scrollHeight <= status.clientHeight")


@pytest.mark.slow
def test_malformed_panel_command_is_reported_in_the_status_line(bench: Bench) -> None:
    bench.widget.link.receive({"type": "panels", "act": "SetValue", "row": "nowhere", "value": 1})
    bench.host.carry()
    assert "'nowhere' no longer exists" in bench.page.locator(".course-notice").inner_text()
    bench.widget.link.receive({"type": "panels", "act": "TurnView", "eye": None})
    bench.host.carry()
    assert "Expected `array`, got `null` - at `$.eye`" in bench.page.locator(".course-notice").inner_text()


@pytest.mark.slow
def test_every_control_is_reachable_with_tab_and_has_a_label(bench: Bench) -> None:
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


@pytest.mark.slow
def test_view_with_a_closed_connection_is_recreated(bench: Bench) -> None:
    assert bench.widget.comm is not None
    bench.widget.comm.handle_close({})
    bench.viewer.scene.set_visible("displays", False)  # no page is connected, and nothing fails
    bench.viewer._repr_mimebundle_()
    anew = bench.viewer._cell._view
    assert anew is not bench.widget
    assert anew is not None
    bench.host.open(anew)
    bench.host.show(anew)
    assert bench.page.locator("canvas").count() == 2


@pytest.mark.slow
def test_expand_property_overrides_rows_that_were_expanded_or_collapsed_before(bench: Bench) -> None:
    bench.viewer.add("RobotModel", topic="/description")
    publish(bench.graph, "/description", String(data=ARM.format(arm=CYLINDER)), LATCHED)
    bench.viewer["RobotModel"]["Link Tree Style"] = "Tree of links and joints"
    bench.viewer.refresh()
    bench.open("RobotModel", "Link/Joint Tree")
    bench.row("base").press("ArrowRight")
    bench.row("base").press("ArrowLeft")
    assert bench.row("j").count() == 0
    bench.page.get_by_role("checkbox", name="Expand Tree").click()
    bench.host.carry()
    bench.row("tool").wait_for()
    bench.page.get_by_role("checkbox", name="Expand Tree").click()
    bench.host.carry()
    bench.row("j").wait_for(state="detached")
    bench.page.get_by_role("combobox", name="Link Tree Style").select_option("Tree of links")
    bench.host.carry()
    bench.row("Link Tree").wait_for()


def test_values_of_all_levels_are_in_one_column_and_a_shortened_label_has_its_name_as_title(
    bench: Bench,
) -> None:
    bench.viewer.add("PointCloud2", topic="/cloud", color_transformer="Intensity")
    bench.host.carry()
    bench.open("PointCloud2")
    inner = bench.row("Selectable").locator(".course-value").bounding_box()
    outer = bench.row("PointCloud2").locator(".course-value").bounding_box()
    assert inner is not None
    assert outer is not None
    assert inner["x"] == outer["x"]
    label = bench.page.get_by_text("Autocompute Intensity Bounds", exact=True)
    label.hover()
    assert label.get_attribute("title") == (
        "Autocompute Intensity Bounds: Whether to automatically compute the intensity min/max values."
    )


# In the page: what has been written into the rows of the panels since.
RECORD_WRITES = """() => {
    window.written = [];
    const observer = new MutationObserver((all) => written.push(...all.map((one) => one.target.outerHTML)));
    const everything = { subtree: true, childList: true, attributes: true };
    for (const tree of document.querySelectorAll(".course-tree")) observer.observe(tree, everything); }"""


def test_panel_update_writes_only_changed_elements(bench: Bench) -> None:
    publish(bench.graph, "/m", marker())
    bench.viewer.refresh()
    bench.open("Marker", "Status: Hint")
    bench.row("Topic").filter(has_text="2 messages received").wait_for()
    bench.page.evaluate(RECORD_WRITES)
    publish(bench.graph, "/m", marker())
    bench.viewer.refresh()
    bench.widget.link.receive({"type": "panels", "act": "RequestUpdate"})
    bench.host.carry()
    assert bench.page.evaluate("() => written") == ["<span>3 messages received at inf hz.</span>"]
