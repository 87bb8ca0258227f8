from typing import Any

import pytest
from sidecar import Sidecar

from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget

VIEW = "application/vnd.jupyter.widget-view+json"


@pytest.fixture
def widget() -> SceneWidget:
    return SceneWidget(Scene(), label="RViz view")


def dock(widget: SceneWidget, **order: Any) -> Sidecar | None:
    """Answer a page's order; returns the panel that is open then."""
    widget.link.receive({"type": "dock", "page": "one", "number": 0, **order})
    return widget._panel._panel


def test_a_page_opens_the_panel_with_the_view_in_it_and_closes_it(widget: SceneWidget) -> None:
    panel = dock(widget, open=True)
    assert panel is not None
    assert (panel.title, panel.anchor, panel.model_id) == ("RViz view", "split-right", widget.panel)
    assert panel.outputs[0]["data"][VIEW]["model_id"] == widget.model_id
    assert dock(widget, open=False) is None
    assert (panel.comm, widget.panel) == (None, "")


def test_a_view_that_docks_of_itself_leaves_an_open_panel_and_a_button_opens_it_again(
    widget: SceneWidget,
) -> None:
    first = dock(widget, open=True, again=False)
    assert dock(widget, open=True, again=False) is first
    assert dock(widget, open=True) is not first


def test_the_panel_goes_with_its_widget(widget: SceneWidget) -> None:
    panel = dock(widget, open=True)
    widget.close()
    assert panel is not None
    assert panel.comm is None
