"""The life of a viewer: it listens while a page shows it or a name holds it."""

import re
import sys
import urllib.request
import weakref
from types import SimpleNamespace
from typing import Any

import pytest

from course_lib.displays.viewer import Viewer
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time import pace
from course_lib.viewer.widget import side_panel
from tests.displays.bench import marker
from tests.displays.stage import publish, visible_nodes, wait


def test_closed_viewer_receives_no_messages_and_can_be_closed_again(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    viewer.close()
    viewer.close()
    publish(graph, "/m", marker())
    assert visible_nodes(viewer) == {"Grid"}


def test_cell_output_contains_the_view_an_image_and_the_statuses(graph: Graph) -> None:
    from course_lib.ros.time import pace

    viewer = Viewer()
    pace.pages.clear()
    data, metadata = viewer._repr_mimebundle_()
    assert metadata["image/png"]["alt"] == data["text/plain"]
    assert {"application/vnd.jupyter.widget-view+json", "image/png", "text/plain"} <= data.keys()
    assert "No tf data." in data["text/plain"]
    assert (
        viewer._repr_mimebundle_()[0]["application/vnd.jupyter.widget-view+json"]
        == (data["application/vnd.jupyter.widget-view+json"])
    )
    assert [is_there() for is_there in pace.pages] == [False]
    viewer.close()
    assert pace.pages == set()


def test_panels_follow_the_statuses(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    viewer = Viewer()
    viewer._repr_mimebundle_()
    posted: list[Any] = []
    assert viewer._cell._view is not None
    link = viewer._cell._view.link
    monkeypatch.setattr(link, "post", posted.append)
    viewer.fixed_frame = "moon"
    link.receive({"type": "panels", "act": "OpenPanels", "page": "one", "number": 0})
    assert "Frame [moon] does not exist" in posted[-1]["changed"]["status"]["text"]
    viewer.close()


def test_unreferenced_viewer_without_a_page_ends_its_subscriptions(graph: Graph) -> None:
    viewer = Viewer()
    assert len(graph._taps) == 1
    del viewer
    assert graph._taps == []


def test_viewer_exists_while_a_page_shows_it_and_ends_with_its_last_view(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = Viewer()
    viewer_reference = weakref.ref(viewer)
    viewer._repr_mimebundle_()
    assert viewer._cell._view is not None
    view = viewer._cell._view
    history = {7: viewer, 8: None}
    names = {"_7": viewer, "_": viewer, "_oh": history}
    hook = SimpleNamespace(_=viewer)
    shell = SimpleNamespace(user_ns=names, user_ns_hidden={"_7": viewer}, displayhook=hook)
    monkeypatch.setattr("IPython.core.getipython.get_ipython", lambda: shell)
    del viewer
    view.link.receive({"type": "views", "count": 1})
    assert viewer_reference() is not None
    view.link.receive({"type": "views", "count": 0})
    assert viewer_reference() is None
    assert graph._taps == []
    assert (names, history) == ({"_": "", "_oh": {8: None}}, {8: None})
    assert not pace.pages


def test_frame_rate_is_ten_per_second_while_all_pages_are_hidden(graph: Graph) -> None:
    viewer = Viewer()
    viewer._repr_mimebundle_()
    assert viewer._cell._view is not None
    link, frames = viewer._cell._view.link, list[int]()
    viewer.session.after_frame.append(lambda: frames.append(graph.now_ns))
    drawn = {}
    for kind, page in (("ready", "a"), ("away", "b"), ("hide", "a"), ("hide", "b"), ("ready", "a")):
        link.receive({"type": kind, "page": page, "number": 0})
        frames.clear()
        for _ in range(60):
            wait(graph, 1 / 60)
        drawn[kind, page] = len(frames)
    assert drawn["away", "b"] == drawn["hide", "a"] == drawn["ready", "a"] in range(29, 32)
    assert drawn["hide", "b"] in range(9, 12)
    viewer.close()


def test_referenced_viewer_keeps_running_without_a_page_and_can_be_shown_again(graph: Graph) -> None:
    viewer = Viewer()
    viewer._repr_mimebundle_()
    assert viewer._cell._view is not None
    view = viewer._cell._view
    view.link.receive({"type": "views", "count": 0})
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    assert visible_nodes(viewer) == {"Grid", "Marker"}
    view.link.receive({"type": "views", "count": 1})
    assert view.keeps is viewer
    viewer.close()


def test_program_opens_its_viewer_in_a_browser_tab_until_it_is_closed(
    graph: Graph, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    viewer = Viewer()
    url = viewer.open()
    assert opened == [url]
    assert url in capsys.readouterr().out
    assert viewer.open(browser=False) == url
    with urllib.request.urlopen(url, timeout=60) as response:
        assert response.status == 200
    viewer.close()
    assert viewer.session.after_frame == []


def test_beside_option_shows_the_viewer_in_the_cell_if_no_page_docks_it(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    visible_nodes: list[object] = []
    monkeypatch.setattr("IPython.display.display", visible_nodes.append)
    monkeypatch.delitem(sys.modules, "sidecar", raising=False)
    viewer = Viewer()
    viewer.beside()
    assert visible_nodes == [viewer]
    assert "sidecar" not in sys.modules
    assert viewer._cell._view is not None
    assert viewer._cell._view.beside
    side_panel.close()
    viewer.close()


def test_viewer_on_a_hub_opens_behind_its_proxy_without_starting_a_browser(
    graph: Graph, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("course_lib.host.find_spec", lambda name: name)
    monkeypatch.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/")
    viewer = Viewer()
    url = viewer.open()
    assert re.fullmatch(r"/user/ada/proxy/\d+/[\w-]+/", url)
    assert capsys.readouterr().out == f"The viewer is at {url} after the name of your hub\n"
    monkeypatch.setenv("JUPYTERHUB_PUBLIC_URL", "https://hub.example/user/ada/")
    assert viewer.open() == f"https://hub.example{url}"
    assert opened == []
    viewer.close()


def test_open_on_a_hub_without_a_proxy_is_rejected_with_the_alternative(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.host.find_spec", lambda name: None)
    monkeypatch.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/")
    with pytest.raises(CourseError, match=r"no jupyter-server-proxy\. Show the viewer in a notebook"):
        Viewer().open()
