import threading
import time
from typing import Any

import msgpack
import numpy as np
import pytest

from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import time_lock
from course_lib.viewer.drawables import Solids, Text
from course_lib.viewer.page_link import INTERVAL, PageLink
from course_lib.viewer.scene import Scene

A_MINUTE = 60.0  # [s]
RED_BOX = Solids("box", [np.eye(4)], (1, 0, 0, 1))
BLUE_BOX = Solids("box", [np.eye(4)], (0, 0, 1, 1))


def decoded(batch: bytes) -> Any:
    kinds = {0x12: np.uint8, 0x16: np.uint32, 0x17: np.float32}
    return msgpack.unpackb(batch, ext_hook=lambda code, data: np.frombuffer(data, kinds[code]))


def moved(x: float) -> np.ndarray:
    transform_node_to_parent = np.eye(4)
    transform_node_to_parent[0, 3] = x  # [m]
    return transform_node_to_parent


class Page:
    """Keeps the batches that a stream sends."""

    def __init__(self, scene: Scene, connected: bool = True) -> None:
        self.batches: list[Any] = []
        self.numbers: list[int] = []
        self.said: list[dict[str, Any]] = []
        self.stream = PageLink(scene, self.take)
        if connected:
            self.stream.connect(self.stream.snapshot()[0])

    def take(self, content: dict[str, Any], buffers: list[bytes]) -> None:
        if content["type"] == "batch":
            self.numbers.append(content["number"])
            self.batches.append(decoded(buffers[0]))
        else:
            self.said.append(content)


@pytest.fixture
def by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Batches are sent by `flush` alone."""
    monkeypatch.setattr(PageLink, "_send_batches", lambda self: None)


def test_scene_without_pages_starts_no_thread_and_sends_nothing() -> None:
    scene = Scene()
    page = Page(scene, connected=False)
    before = set(threading.enumerate())  # threads of other tests may end during this test
    scene.set_object("a", RED_BOX)
    time.sleep(2 * INTERVAL)
    assert page.batches == []
    assert set(threading.enumerate()) <= before


@pytest.mark.usefixtures("by_hand")
def test_batch_contains_the_last_values() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_object("a", RED_BOX)
    scene.set_object("a", BLUE_BOX)
    for x in range(100):
        scene.set_transform("a", moved(x))
    page.stream.flush()
    (batch,) = page.batches
    (command,) = batch["commands"]
    assert command["object"]["colors"].tolist() == [0, 0, 255, 255]
    assert batch["paths"] == ["a"]
    assert batch["matrices"].tolist() == [1, 0, 0, 0, 1, 0, 0, 0, 1, 99, 0, 0]


def test_batches_are_sent_automatically_and_at_most_40_times_a_second() -> None:
    scene = Scene()
    page = Page(scene)
    begun = time.monotonic()
    while len(page.batches) < 10:
        assert time.monotonic() < begun + A_MINUTE
        scene.set_transform("a", moved(time.monotonic()))
        time.sleep(0.001)
    assert len(page.batches) <= (time.monotonic() - begun) / INTERVAL + 1
    assert page.numbers == list(range(1, len(page.numbers) + 1))


def test_slow_page_receives_fewer_batches_with_every_command_in_order() -> None:
    scene = Scene()
    page = Page(scene)
    page.stream.receive({"type": "ready", "page": "a", "number": 0})
    page.stream.receive({"type": "ack", "page": "a", "number": 0, "drawing": 0.2})
    begun = time.monotonic()
    added: list[str] = []
    while time.monotonic() - begun < 1.0:
        added.append(f"box{len(added)}")
        scene.set_object(added[-1], RED_BOX)
        scene.set_object("last", RED_BOX)
        scene.delete("last")
        time.sleep(0.005)
    while page.stream._changes:
        time.sleep(INTERVAL)
        assert time.monotonic() < begun + A_MINUTE
    page.stream.close()
    assert len(page.batches) <= (time.monotonic() - begun) / 0.2 + 1
    commands = [command for batch in page.batches for command in batch["commands"]]
    kept = [command["path"] for command in commands if command["path"] != "last"]
    assert (kept, commands[-1]) == (added, {"type": "delete", "path": "last"})


def test_change_is_sent_while_robot_time_is_paused() -> None:
    virtual_time.install()
    scene = Scene()
    page = Page(scene)
    with time_lock.hold():
        scene.set_object("a", RED_BOX)
    end = time.monotonic() + A_MINUTE
    while not page.batches:
        assert time.monotonic() < end
        time.sleep(INTERVAL)
    assert page.batches[-1]["commands"][0]["path"] == "a"
    page.stream.close()


@pytest.mark.usefixtures("by_hand")
def test_transform_path_list_is_sent_again_only_if_it_changes() -> None:
    scene = Scene()
    page = Page(scene)
    for x, paths in enumerate(("ab", "ab", "a"), 1):
        for path in paths:
            scene.set_transform(path, moved(float(x)))
        page.stream.flush()
    assert [batch.get("paths") for batch in page.batches] == [["a", "b"], None, ["a"]]


@pytest.mark.usefixtures("by_hand")
def test_object_added_after_a_delete_is_kept() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_object("a", RED_BOX)
    scene.delete("a")
    scene.set_object("a", BLUE_BOX)
    page.stream.flush()
    assert [command["type"] for command in page.batches[0]["commands"]] == ["delete", "object"]


@pytest.mark.usefixtures("by_hand")
def test_non_finite_transform_does_not_affect_others() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_transform("bad", np.full((4, 4), np.nan))
    scene.set_transform("good", moved(1.0))
    page.stream.flush()
    assert page.batches[0]["paths"] == ["good"]
    (status,) = page.said
    assert "'bad' is not finite" in status["text"]


def test_page_is_informed_whether_its_snapshot_is_current() -> None:
    scene = Scene()
    page = Page(scene, connected=False)
    old, _ = page.stream.snapshot()
    scene.set_object("a", RED_BOX)
    assert not page.stream.connect(old)
    new, snapshot = page.stream.snapshot()
    assert page.stream.connect(new)
    assert [command["type"] for command in decoded(snapshot)["commands"]] == [
        "background",
        "camera",
        "object",
    ]


def test_snapshot_contains_the_complete_scene() -> None:
    scene = Scene()
    scene.set_object("a/text", Text("hi", 0.5))
    scene.set_transform("a", moved(2.0))
    scene.set_visible("a", False)
    scene.background = (1, 2, 3)
    snapshot = decoded(Page(scene).stream.snapshot()[1])
    found = {command["type"]: command for command in snapshot["commands"]}
    assert found["background"]["color"] == [1, 2, 3]
    assert found["camera"]["vertical_fov"] == pytest.approx(np.pi / 4)
    assert found["visible"] == {"type": "visible", "path": "a", "value": False}
    text = found["object"]["object"]
    assert text["mask"].size == text["rows"] * text["columns"]
    assert snapshot["paths"] == ["a"]


def test_closed_stream_sends_nothing() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_object("a", RED_BOX)
    page.stream.close()
    scene.set_object("b", RED_BOX)
    time.sleep(2 * INTERVAL)
    assert page.batches == []
