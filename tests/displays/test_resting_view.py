import gc
import json
from typing import Any

from course_lib.displays.viewer import Viewer
from course_lib.ros.graph import Graph
from tests.displays.bench import at, marker
from tests.displays.stage import publish, wait
from tests.viewer.test_stream import decoded


def panels(view: Any) -> Any:
    return json.loads(view.panels)


def test_a_view_at_rest_keeps_its_picture_and_statuses_while_the_viewer_goes_on(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    view = viewer.freeze()
    publish(graph, "/m", marker())
    viewer.look()
    assert "displays/Marker/drawn" not in "".join(view.scene.objects())
    assert len(viewer.scene.objects()) > len(view.scene.objects())
    data, _ = view._repr_mimebundle_()
    assert "Marker         Topic        ✔ Ok    OK" in data["text/plain"]
    assert "messages received" in str(viewer.statuses())
    assert "messages received" not in view.panels
    viewer.close()


def test_its_panels_are_text_and_its_tools_need_no_python(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m", name="hidden", enabled=False)
    shown = panels(viewer.freeze())
    rows = shown["rows"].values()
    assert all("editor" not in row and "checked" not in row for row in rows)
    texts = {row["key"]: row.get("text") for row in rows}
    assert (texts["options#Fixed Frame"], texts["displays/hidden"]) == ("map", "off")
    labels = [tool["label"] for tool in shown["changed"]["toolbar"]]
    assert labels == ["Interact", "Move Camera", "Focus Camera", "Measure"]
    viewer.close()


def test_its_film_has_the_last_seconds(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    for x in range(4):
        publish(graph, "/m", marker(pose=at(float(x))))
        wait(graph, 1.0)
        viewer.look()
    assert decoded(viewer.freeze(1.5).film)["end"] == 1.5
    assert decoded(viewer.freeze(100.0).film)["end"] == 4.0
    viewer.close()


def test_its_film_can_be_written_with_fewer_pictures_while_its_viewer_lives(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    for x in range(8):
        publish(graph, "/m", marker(pose=at(float(x))))
        wait(graph, 0.5)
        viewer.look()
    view = viewer.freeze(3.0)
    wait(graph, 1.0)
    viewer.look()
    few, all_of_them = decoded(view.packed(1.0)), decoded(view.film)
    assert (few["start"], few["end"]) == (all_of_them["start"], all_of_them["end"])
    assert 1 < len(few["batches"]) < len(all_of_them["batches"])
    viewer.close()
    del viewer
    gc.collect()
    assert view.packed(1.0) == view.film


def test_it_ends_with_the_last_page_that_shows_it(graph: Graph) -> None:
    viewer = Viewer()
    view = viewer.freeze()
    view.link.receive({"type": "views", "count": 1})
    assert view.comm is not None
    view.link.receive({"type": "views", "count": 0})
    assert view.comm is None
    viewer.close()
