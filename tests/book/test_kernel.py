from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.book import kernel
from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph, use_graph
from tests.displays.bench import marker
from tests.displays.stage import publish


@pytest.fixture
def graph() -> Iterator[Graph]:
    with use_graph(Graph()) as made:
        yield made


@pytest.mark.slow
def test_scene_is_compacted_once(graph: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[bytes] = []
    usual = kernel.compact

    def counted(packed: bytes) -> tuple[bytes, dict[str, bytes]]:
        made.append(packed)
        return usual(packed)

    monkeypatch.setattr(kernel, "compact", counted)
    scenes, viewer = kernel.Scenes("week09", tmp_path, "scenes"), Viewer()
    publish(graph, "/m", marker())
    scenes.add_viewer(viewer)
    scenes.extend_live_scene()
    scenes.add_resting_view(viewer.freeze())
    scenes.write()
    assert sorted(path.name for path in tmp_path.glob("week09*.js")) == ["week09-01.js", "week09-02.js"]
    assert len(made) == 2
    assert {kernel.script(usual(packed)[0]) for packed in made} == {
        path.read_bytes() for path in tmp_path.glob("week09*.js")
    }
