import threading
import time
from typing import Any

import msgpack
import numpy as np
import pytest

from course_lib.ros import virtual_time
from course_lib.ros.baton import baton
from course_lib.viewer.drawables import Solids, Text
from course_lib.viewer.scene import Scene
from course_lib.viewer.stream import INTERVAL, Stream

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
        self.stream = Stream(scene, self.take)
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
    monkeypatch.setattr(Stream, "_send_batches", lambda self: None)


def test_nothing_is_done_while_nobody_follows() -> None:
    scene = Scene()
    page = Page(scene, connected=False)
    before = set(threading.enumerate())  # some of other tests may end meanwhile
    scene.set_object("a", RED_BOX)
    time.sleep(2 * INTERVAL)
    assert page.batches == []
    assert set(threading.enumerate()) <= before


@pytest.mark.usefixtures("by_hand")
def test_a_batch_holds_the_last_value_of_everything() -> None:
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


def test_batches_are_sent_by_themselves_and_at_most_40_times_a_second() -> None:
    scene = Scene()
    page = Page(scene)
    begun = time.monotonic()
    while len(page.batches) < 10:
        assert time.monotonic() < begun + A_MINUTE
        scene.set_transform("a", moved(time.monotonic()))
        time.sleep(0.001)
    assert len(page.batches) <= (time.monotonic() - begun) / INTERVAL + 1
    assert page.numbers == list(range(1, len(page.numbers) + 1))


def test_a_change_made_in_robot_time_is_sent_while_robot_time_stands_still() -> None:
    virtual_time.install()
    scene = Scene()
    page = Page(scene)
    with baton.known():
        scene.set_object("a", RED_BOX)
    end = time.monotonic() + A_MINUTE
    while not page.batches:
        assert time.monotonic() < end
        time.sleep(INTERVAL)
    assert page.batches[-1]["commands"][0]["path"] == "a"
    page.stream.close()


@pytest.mark.usefixtures("by_hand")
def test_paths_are_sent_again_only_if_others_move() -> None:
    scene = Scene()
    page = Page(scene)
    for paths in ("ab", "ab", "a"):
        for path in paths:
            scene.set_transform(path, moved(1.0))
        page.stream.flush()
    assert [batch.get("paths") for batch in page.batches] == [["a", "b"], None, ["a"]]


@pytest.mark.usefixtures("by_hand")
def test_an_object_put_after_a_delete_stays() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_object("a", RED_BOX)
    scene.delete("a")
    scene.set_object("a", BLUE_BOX)
    page.stream.flush()
    assert [command["type"] for command in page.batches[0]["commands"]] == ["delete", "object"]


@pytest.mark.usefixtures("by_hand")
def test_a_transform_that_is_not_a_number_leaves_the_others_alone() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_transform("bad", np.full((4, 4), np.nan))
    scene.set_transform("good", moved(1.0))
    page.stream.flush()
    assert page.batches[0]["paths"] == ["good"]
    (status,) = page.said
    assert "'bad' is not finite" in status["text"]


def test_a_page_learns_whether_its_snapshot_is_still_right() -> None:
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


def test_a_snapshot_holds_all_that_was_set() -> None:
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


def test_a_closed_stream_sends_nothing_more() -> None:
    scene = Scene()
    page = Page(scene)
    scene.set_object("a", RED_BOX)
    page.stream.close()
    scene.set_object("b", RED_BOX)
    time.sleep(2 * INTERVAL)
    assert page.batches == []
