"""RViz's panels in a real page: what is clicked and typed there reaches the session."""

from pathlib import Path

import pytest

from tests.browser.bench import Bench
from tests.displays.bench import marker
from tests.displays.stage import publish

pytestmark = pytest.mark.browser


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


def test_the_keyboard_goes_on_below_a_removed_display_and_reaches_the_layout(bench: Bench) -> None:
    bench.open()
    bench.row("Grid").press("Delete")
    bench.host.carry()
    assert bench.page.evaluate("document.activeElement.dataset.key") == "displays/Marker"
    bench.page.keyboard.press("Control+s")
    assert bench.page.get_by_role("dialog", name="Save").is_visible()


def test_lists_that_somebody_is_in_stay_while_other_things_change(bench: Bench) -> None:
    bench.open()
    bench.press("Add a display")
    stays = "document.querySelector('dialog option')"
    bench.page.evaluate(f"globalThis.before = {stays}")
    bench.viewer.remove(bench.viewer["Marker"])
    bench.widget.link.receive({"type": "desk", "act": "LookAgain"})
    bench.host.carry()
    assert bench.row("Marker").count() == 0
    assert bench.page.evaluate(f"globalThis.before === {stays}")


def test_a_layout_is_saved_and_opened_by_keys(bench: Bench, tmp_path: Path) -> None:
    canvas = bench.page.locator("canvas")
    canvas.press("Control+s")
    bench.page.get_by_role("dialog").get_by_role("textbox").fill("mine")
    bench.page.keyboard.press("Enter")
    bench.host.carry()
    assert (tmp_path / "mine.rviz").exists()
    bench.viewer.remove(bench.viewer["Marker"])
    bench.widget.link.receive({"type": "desk", "act": "OpenPanels"})
    bench.host.carry()
    canvas.press("Control+o")
    bench.choose("mine.rviz")
    assert [display.name for display in bench.viewer.displays] == ["Grid", "Marker"]


def test_a_malformed_order_is_answered_in_the_status_line(bench: Bench) -> None:
    bench.widget.link.receive({"type": "desk", "act": "SetValue", "row": "nowhere", "value": 1})
    bench.host.carry()
    assert "'nowhere' is not there any more" in bench.page.locator(".course-notice").inner_text()
    bench.widget.link.receive({"type": "desk", "act": "TurnView", "eye": None})
    bench.host.carry()
    assert "TurnView from the page lacks 'scale'" in bench.page.locator(".course-notice").inner_text()


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


def test_a_view_whose_connection_the_page_closed_is_made_anew(bench: Bench) -> None:
    assert bench.widget.comm is not None
    bench.widget.comm.handle_close({})
    bench.viewer.scene.set_visible("displays", False)  # nobody listens, and nothing fails
    bench.viewer._repr_mimebundle_()
    anew = bench.viewer._cell._view
    assert anew is not bench.widget
    assert anew is not None
    bench.host.open(anew)
    bench.host.show(anew)
    assert bench.page.locator("canvas").count() == 2
