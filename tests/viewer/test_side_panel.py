from collections.abc import Iterator

import pytest
from sidecar import Sidecar

from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget, side_panel

VIEW = "application/vnd.jupyter.widget-view+json"


@pytest.fixture
def widget() -> Iterator[SceneWidget]:
    yield SceneWidget(Scene(), label="RViz view")
    side_panel.close()


@pytest.fixture
def other(widget: SceneWidget) -> SceneWidget:
    return SceneWidget(Scene(), label="RViz view")


def dock(widget: SceneWidget, action: str, **rest: str) -> Sidecar | None:
    """Answer a page's order; returns the panel that is open then."""
    widget.link.receive({"type": "dock", "page": "one", "number": 0, "action": action, **rest})
    return side_panel._panel


def panel_model(panel: Sidecar | None) -> str:
    """Return the model of the widget in the panel."""
    assert panel is not None
    return str(panel.outputs[0]["data"][VIEW]["model_id"])


def test_page_opens_the_panel_with_the_view_and_closes_it(widget: SceneWidget) -> None:
    panel = dock(widget, "open")
    assert panel is not None
    assert (panel.title, panel.anchor, panel.model_id) == ("RViz view", "split-right", widget.panel)
    assert panel_model(panel) == widget.model_id
    assert widget.beside
    assert dock(widget, "close") is None
    assert (panel.comm, widget.panel, widget.beside) == (None, "", False)


def test_automatically_docked_view_keeps_an_open_panel_and_a_button_opens_it_again(
    widget: SceneWidget,
) -> None:
    first = dock(widget, "join")
    assert dock(widget, "join") is first
    assert dock(widget, "open") is not first


def test_next_view_uses_the_open_panel_if_the_notebook_requests_one(
    widget: SceneWidget, other: SceneWidget
) -> None:
    side_panel.take(widget)
    assert not widget.beside, "a notebook without a panel keeps its views in the cells"
    side_panel.is_enabled = True
    side_panel.take(widget)
    panel = dock(widget, "join")
    side_panel.take(other)
    assert side_panel._panel is panel
    assert panel_model(panel) == other.model_id
    assert (widget.panel, other.panel) == ("", panel.model_id if panel else None)
    assert (widget.beside, other.beside) == (True, True)
    assert dock(widget, "take") is panel
    assert panel_model(panel) == widget.model_id


def test_panel_that_was_opened_by_its_button_shows_the_next_view(
    widget: SceneWidget, other: SceneWidget
) -> None:
    panel = dock(widget, "open")
    side_panel.take(other)
    assert side_panel._panel is panel
    assert panel_model(panel) == other.model_id


def test_page_that_opens_the_panel_late_shows_the_last_view(widget: SceneWidget, other: SceneWidget) -> None:
    side_panel.is_enabled = True
    side_panel.take(widget)
    side_panel.take(other)
    assert panel_model(dock(widget, "join")) == other.model_id


def test_only_a_panel_that_is_still_open_is_closed_by_its_page(widget: SceneWidget) -> None:
    first = dock(widget, "open")
    assert first is not None
    name = first.model_id
    dock(widget, "close")
    second = dock(widget, "open")
    assert second is not None
    assert dock(widget, "gone", panel=name) is second, "the page reports the first one late"
    assert dock(widget, "gone", panel=widget.panel) is None
    assert not widget.beside


def test_closed_panel_leaves_later_views_in_their_cells(widget: SceneWidget, other: SceneWidget) -> None:
    side_panel.is_enabled = True
    side_panel.take(widget)
    dock(widget, "join")
    dock(widget, "close")
    side_panel.take(other)
    assert not other.beside


def test_side_panel_is_closed_with_its_widget(widget: SceneWidget) -> None:
    panel = dock(widget, "open")
    widget.close()
    assert panel is not None
    assert panel.comm is None
