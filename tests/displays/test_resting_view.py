import gc
import json
from typing import Any

from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph
from tests.displays.bench import at, marker
from tests.displays.stage import publish, wait
from tests.viewer.test_stream import decoded


def panels(view: Any) -> Any:
    return json.loads(view.panels)


def test_frozen_view_keeps_its_image_and_statuses_while_the_viewer_continues(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    view = viewer.freeze()
    publish(graph, "/m", marker())
    viewer.refresh()
    assert "displays/Marker/drawn" not in "".join(view.scene.objects())
    assert len(viewer.scene.objects()) > len(view.scene.objects())
    data, metadata = view._repr_mimebundle_()
    assert metadata["image/png"]["alt"] == data["text/plain"]
    assert "Marker         Topic        ✔ Ok    OK" in data["text/plain"]
    assert "messages received" in str(viewer.statuses())
    assert "messages received" not in view.panels
    viewer.close()


def test_frozen_view_has_text_panels_and_tools_without_python(graph: Graph) -> None:
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


def test_frozen_view_has_a_recording_of_the_last_seconds(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    for x in range(4):
        publish(graph, "/m", marker(pose=at(float(x))))
        wait(graph, 1.0)
        viewer.refresh()
    assert decoded(viewer.freeze(1.5).recording)["end"] == 1.5
    assert decoded(viewer.freeze(100.0).recording)["end"] == 4.0
    viewer.close()


def test_recording_of_a_frozen_view_can_be_saved_with_fewer_frames_while_the_viewer_exists(
    graph: Graph,
) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    for x in range(8):
        publish(graph, "/m", marker(pose=at(float(x))))
        wait(graph, 0.5)
        viewer.refresh()
    view = viewer.freeze(3.0)
    wait(graph, 1.0)
    viewer.refresh()
    few, all_of_them = decoded(view.pack(1.0)), decoded(view.recording)
    assert (few["start"], few["end"]) == (all_of_them["start"], all_of_them["end"])
    assert 1 < len(few["batches"]) < len(all_of_them["batches"])
    viewer.close()
    del viewer
    gc.collect()
    assert view.pack(1.0) == view.recording


def test_frozen_view_ends_with_the_last_page_that_shows_it(graph: Graph) -> None:
    viewer = Viewer()
    view = viewer.freeze()
    view.link.receive({"type": "views", "count": 1})
    assert view.comm is not None
    view.link.receive({"type": "views", "count": 0})
    assert view.comm is None
    viewer.close()


def test_replay_plays_automatically_and_a_frozen_view_does_not(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    wait(graph, 2.0)
    replay, frozen = viewer.replay(1.0), viewer.freeze()
    assert (replay.plays, frozen.plays) == (True, False)
    assert decoded(replay.recording)["end"] == 1.0
    assert "again and again" in panels(replay)["changed"]["notice"]["text"]
    viewer.close()


def test_reset_discards_drawings_and_keeps_the_displays(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    viewer.refresh()
    assert "displays/Marker/" in "".join(viewer.scene.objects())
    viewer.reset()
    assert "displays/Marker/" not in "".join(viewer.scene.objects())
    assert [display.name for display in viewer.displays] == ["Grid", "Marker"]
    publish(graph, "/m", marker())
    viewer.refresh()
    assert "displays/Marker/" in "".join(viewer.scene.objects())
    viewer.close()


def test_reset_discards_messages_that_were_not_yet_drawn(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    viewer.reset()
    viewer.refresh()
    assert list(viewer.scene.objects()) == ["displays/Grid/drawing"]
    viewer.close()


def test_replay_after_a_reset_always_shows_the_grid(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    viewer.refresh()
    viewer.reset()
    wait(graph, 1.0)
    publish(graph, "/m", marker())
    viewer.refresh()
    scenes = viewer.scene_recording.scenes(1.0)
    is_drawn = ["displays/Grid/drawing" in scene.objects() for scene in scenes]
    assert is_drawn
    assert all(is_drawn)
    viewer.close()
