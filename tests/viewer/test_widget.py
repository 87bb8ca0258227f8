import base64
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgpack
import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

from course_lib.viewer import widget as widget_module
from course_lib.viewer.drawables import Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget

RED_BOX = Solids("box", [np.eye(4)], (1, 0, 0, 1))


@pytest.fixture(autouse=True)
def no_server(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("JPY_SESSION_NAME", raising=False)


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    scene.set_object("box", RED_BOX)
    return scene


def test_cell_output_contains_a_view_an_image_and_text(scene: Scene) -> None:
    data, metadata = SceneWidget(scene, label="The red box")._repr_mimebundle_()
    assert data["text/plain"] == metadata["image/png"]["alt"] == "The red box: 1 objects"
    assert "application/vnd.jupyter.widget-view+json" in data
    assert base64.b64decode(data["image/png"]).startswith(b"\x89PNG")


def test_scene_too_large_for_immediate_drawing_has_no_image(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(widget_module, "_PICTURE_LIMIT", 11)
    assert "image/png" not in SceneWidget(scene)._repr_mimebundle_()[0]


def test_state_contains_the_scene_at_the_time_of_the_request(scene: Scene) -> None:
    widget = SceneWidget(scene)
    before = widget.get_state()
    scene.set_object("other", RED_BOX)
    after = widget.get_state()
    assert len(after["snapshot"]) > len(before["snapshot"])
    assert after["number"] > before["number"]
    assert "snapshot" not in widget.get_state("height")


def test_all_widgets_share_one_copy_of_the_code(scene: Scene) -> None:
    assert SceneWidget(scene).code == SceneWidget(Scene()).code


def test_widget_without_a_page_sends_no_messages(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    widget = SceneWidget(scene)
    monkeypatch.setattr(widget, "send", lambda *_: pytest.fail("sent to nobody"))
    scene.set_object("other", RED_BOX)
    widget.flush()
    assert not widget.link.is_ready


def test_changes_are_sent_before_the_page_answers_under_a_jupyter_server(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("JPY_SESSION_NAME", "lesson.ipynb")
    widget = SceneWidget(scene)
    sent: list[dict[str, object]] = []
    monkeypatch.setattr(widget, "send", lambda content, buffers: sent.append(content))
    scene.set_object("other", RED_BOX)
    widget.flush()
    assert sent == [{"type": "batch", "number": 1, "ask": False}]


def test_invalid_page_message_is_ignored(scene: Scene) -> None:
    widget = SceneWidget(scene)
    for content in ({}, {"type": "format_disk"}, {"type": "ready", "number": "first"}):
        widget.link.receive(content)


def test_program_with_a_scene_exits_without_output() -> None:
    program = (
        "import numpy as np\n"
        "from course_lib.viewer.drawables import Solids\n"
        "from course_lib.viewer.scene import Scene\n"
        "from course_lib.viewer.widget import SceneWidget\n"
        "scene = Scene()\n"
        "widget = SceneWidget(scene)\n"
        "widget.link.receive({'type': 'ready', 'number': 0})\n"
        "for x in range(50):\n"
        "    scene.set_transform('a', np.eye(4) + x * np.eye(4, k=3))\n"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert (process.returncode, process.stdout, process.stderr) == (0, "", "")


@pytest.mark.slow
def test_notebook_run_without_a_page_is_saved_with_its_final_scene(tmp_path: Path) -> None:
    cells = [
        "import numpy as np\n"
        "from course_lib.viewer.drawables import Solids\n"
        "from course_lib.viewer.scene import Scene\n"
        "from course_lib.viewer.widget import SceneWidget\n"
        "scene = Scene()\n"
        "SceneWidget(scene)",
        "scene.set_object('late/box', Solids('box', [np.eye(4)], (1, 0, 0, 1)))",
    ]
    new: Any = nbformat.v4  # has no types
    notebook = new.new_notebook(cells=[new.new_code_cell(cell) for cell in cells])
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()
    states = notebook.metadata["widgets"]["application/vnd.jupyter.widget-state+json"]["state"].values()
    buffers = {tuple(b["path"]): b["data"] for state in states for b in state.get("buffers", ())}
    scene = msgpack.unpackb(base64.b64decode(buffers[("snapshot",)]))
    assert [c["path"] for c in scene["commands"] if c["type"] == "object"] == ["late/box"]


def test_message_of_a_page_triggers_no_event_after_which_matplotlib_draws_figures(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    events: list[str] = []
    shell = SimpleNamespace(events=SimpleNamespace(trigger=events.append))
    monkeypatch.setattr("IPython.get_ipython", lambda: shell)
    widget, received = SceneWidget(scene), list[Any]()
    widget.on_msg(lambda _, content, buffers: received.append(content))
    content = {"type": "hello"}
    widget.comm.handle_msg({"content": {"data": {"method": "custom", "content": content}}, "buffers": []})
    assert (received, events) == ([content], [])
