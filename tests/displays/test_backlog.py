from itertools import chain
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import Image
from tf2_msgs.msg import TFMessage

from course_lib.displays import session
from course_lib.displays.registry import REGISTRY, OwnDisplay, register, short_name
from course_lib.displays.session import RvizSession
from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.viewer import encoding
from tests.displays.bench import marker
from tests.displays.samples import FRAME, messages
from tests.displays.stage import publish, wait


class Unseen(Viewer):
    is_seen = False


class Noted(OwnDisplay):
    class_name = "tests/Noted"
    type_name = "visualization_msgs/msg/Marker"
    seen: list[Any]

    def drawing(self, message: Any) -> dict[str, Any]:
        self.seen.append(message)
        return {}


@pytest.fixture
def processed_samples(monkeypatch: pytest.MonkeyPatch) -> list[Sample]:
    """The samples that sessions have processed."""
    samples: list[Sample] = []
    receive = RvizSession.receive

    def note(session: RvizSession, sample: Sample) -> None:
        samples.append(sample)
        receive(session, sample)

    monkeypatch.setattr(RvizSession, "receive", note)
    return samples


def frame(x: float) -> TFMessage:
    transform = TransformStamped(child_frame_id=FRAME)
    transform.header.frame_id = "map"
    transform.transform.translation.x = float(x)
    return TFMessage(transforms=[transform])


def both(class_name: str = "rviz_default_plugins/Marker", topic: str | None = "/m") -> tuple[Viewer, Viewer]:
    viewers = Viewer(), Unseen()
    for viewer in viewers:
        viewer.add(class_name, topic, name="it")
    return viewers


def described(viewer: Viewer) -> tuple[str, list[str], bytes]:
    text = str(viewer.statuses())
    return text, sorted(viewer.scene.objects()), encoding.snapshot(viewer.scene)


@pytest.mark.parametrize("class_name", [name for name in REGISTRY if name.startswith("rviz")])
def test_every_display_shows_the_same_state_after_a_backlog_of_messages(
    graph: Graph, class_name: str
) -> None:
    has_topic = hasattr(REGISTRY[class_name], "topic_label")
    topic = {"InteractiveMarkers": "/t", "Effort": "/t/image"}.get(short_name(class_name), "/t/image")
    viewers = both(class_name, topic if has_topic else None)
    for number in range(3):
        publish(graph, "/tf", frame(number))
        for name, message in messages(class_name, number):
            publish(graph, name, message)
        wait(graph, 0.4)
    seen, unseen = (described(viewer) for viewer in viewers)
    assert unseen == seen


def test_messages_are_processed_only_on_request(graph: Graph, processed_samples: list[Sample]) -> None:
    viewer = Unseen()
    viewer.add("Marker", "/m")
    publish(graph, "/m", marker())
    wait(graph, 1.0)
    assert repr(viewer) == "<Viewer of map with Grid, Marker>"
    assert [display.name for display in viewer.displays] == ["Grid", "Marker"]
    assert processed_samples == []
    assert ("Marker", "Topic", "ok", "1 messages received at inf hz.") in viewer.statuses()
    assert len(processed_samples) == 1


def test_property_change_is_applied_after_earlier_messages(graph: Graph) -> None:
    viewers = both()
    displays = [viewer["it"] for viewer in viewers]
    publish(graph, "/m", marker())
    for display in displays:
        display["Topic"] = "/other"
    publish(graph, "/other", marker(number=7))
    wait(graph, 0.5)
    rows = [display.rows() for display in displays]
    assert rows[0] == rows[1]
    seen, unseen = (described(viewer) for viewer in viewers)
    assert unseen == seen


@pytest.mark.parametrize(
    "change",
    [
        lambda viewer: viewer.options.__setitem__("Fixed Frame", FRAME),
        lambda viewer: setattr(viewer, "fixed_frame", FRAME),
        lambda viewer: viewer.remove(viewer["it"]),
        lambda viewer: viewer["it"].__setitem__("Enabled", False),
        lambda viewer: viewer.add("MarkerArray", "/a"),
        lambda viewer: viewer.close(),
    ],
)
def test_viewer_changes_are_applied_after_earlier_messages(graph: Graph, change: Any) -> None:
    viewers = both()
    fading = marker(frame=FRAME)
    fading.lifetime.sec = 1
    publish(graph, "/tf", frame(1.0))
    publish(graph, "/m", fading)
    wait(graph, 0.7)
    for viewer in viewers:
        change(viewer)
    publish(graph, "/m", marker(number=3, frame="lost"))
    wait(graph, 0.7)
    seen, unseen = (described(viewer) for viewer in viewers)
    assert unseen == seen


def test_recorded_frames_have_the_arrival_times_of_messages(graph: Graph) -> None:
    viewers = both()
    for number in range(4):
        publish(graph, "/m", marker(number=number))
        wait(graph, 1.0)
    for viewer in viewers:
        viewer.refresh()
    times = [[round(part.time, 6) for part in viewer.scene_recording._frames.frames()] for viewer in viewers]
    assert len(times[0]) > 3
    assert times[0] == times[1]


def test_number_of_waiting_messages_is_limited(
    graph: Graph, processed_samples: list[Sample], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session, "MAX_WAITING", 10)
    viewer = Unseen()
    viewer.add("Marker", "/m")
    for number in range(25):
        publish(graph, "/m", marker(number=number))
    assert len(processed_samples) in range(15, 25)
    assert "25 messages received" in str(viewer.statuses())


def test_large_messages_without_a_matching_display_use_no_buffer(
    graph: Graph, processed_samples: list[Sample], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session, "MAX_BYTES", 1_000)
    viewer = Unseen()
    viewer.add("Image", "/shown")
    picture = Image(width=40, height=10, step=120, encoding="rgb8", data=bytes(1_200))
    publish(graph, "/not_shown", picture)
    assert processed_samples == []
    publish(graph, "/shown", picture)
    assert [sample.topic for sample in processed_samples] == ["/not_shown", "/shown"]


def test_custom_display_receives_its_messages_immediately(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(REGISTRY, Noted.class_name, Noted)  # removed after the test
    monkeypatch.setattr(Noted, "seen", [], raising=False)
    monkeypatch.setattr(
        Noted, "__module__", "course_lib.displays.noted"
    )  # the name of a module decides nothing
    register(Noted)
    viewer = Unseen()
    viewer.add(Noted.class_name, "/m")
    publish(graph, "/m", marker())
    assert len(Noted.seen) == 1


def test_after_a_first_request_messages_are_drawn_immediately(
    graph: Graph, processed_samples: list[Sample]
) -> None:
    viewer = Unseen()
    viewer.add("Marker", "/m")
    publish(graph, "/m", marker())
    assert processed_samples == []
    assert list(chain(viewer.scene.objects()))
    publish(graph, "/m", marker(number=2))
    assert len(processed_samples) == 2
