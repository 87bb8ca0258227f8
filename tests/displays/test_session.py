import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from visualization_msgs.msg import MarkerArray

from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import RosMessage, deserialize
from tests.displays.bench import ARRAY, TOPIC, Bench, marker, ns


def test_message_is_shown_in_the_next_frame() -> None:
    bench = Bench()
    bench.publish(TOPIC, marker(), at=1.0)
    assert bench.marker_names() == []
    bench.publish("/chatter", MarkerArray(), at=1.02)
    assert bench.marker_names() == []
    bench.publish("/chatter", MarkerArray(), at=1.04)
    assert bench.marker_names() == ["n/0"]


def test_simultaneous_transform_is_used_regardless_of_arrival_order() -> None:
    bench = Bench()
    bench.publish(ARRAY, MarkerArray(markers=[marker(frame="base")]))
    bench.transform("map", "base", (3.0, 0.0, 0.0))
    bench.update()
    assert bench.place("n/0")[0, 3] == 3.0


def test_drawables_expire_without_a_message() -> None:
    bench = Bench()
    bench.show(marker(lifetime=Duration(sec=1)))
    bench.session.tick(ns(0.9))
    assert bench.marker_names() == ["n/0"]
    bench.session.tick(ns(1.1))
    assert bench.marker_names() == []


def test_message_is_deserialized_once_for_all_displays(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench()
    bench.session.add("rviz_default_plugins/Marker", "Another", {"Topic": TOPIC})
    count = 0

    def counted(cdr: bytes, cls: type[RosMessage]) -> RosMessage:
        nonlocal count
        count += 1
        return deserialize(cdr, cls)

    monkeypatch.setattr("course_lib.ros.messages.deserialize", counted)
    bench.publish(TOPIC, marker())
    bench.publish("/nobody_listens", marker())
    assert count == 1


def test_displays_with_equal_names_have_separate_nodes() -> None:
    bench = Bench()
    added = [bench.session.add("rviz_default_plugins/Marker", "a/b", {"Topic": TOPIC}) for _ in range(2)]
    bench.publish(TOPIC, marker())
    bench.update()
    assert bench.marker_names() == ["n/0"]
    assert len(bench.scene.objects()) == 3
    bench.session.remove(added[0])
    assert len(bench.scene.objects()) == 2


def test_unknown_class_is_kept_and_reported_with_rviz_text() -> None:
    bench = Bench()
    config = {"Class": "my_pkg/Fancy", "Name": "Mine", "Secret": [1, 2]}
    display = bench.session.add("my_pkg/Fancy", "Mine", config)
    assert display.config == config
    (row,) = display.rows()
    assert row.level == "error"
    assert row.text.startswith(
        "The class required for this display, 'my_pkg/Fancy', could not be loaded.<br><b>Error:</b>"
    )


def test_hint_for_a_silent_topic_lists_active_topics_of_its_type() -> None:
    bench = Bench()
    bench.publish("/marker", marker())
    assert bench.hints(bench.marker) == [
        "no message has arrived on /markers; messages of its type arrive on /marker."
    ]


def test_topic_with_a_publisher_that_has_not_yet_published_gets_no_hint() -> None:
    bench = Bench()
    bench.publish("/marker", marker())
    bench.session.published_types = lambda topic: (
        ["visualization_msgs/msg/Marker"] if topic == "/markers" else []
    )
    assert bench.hints(bench.marker) == []


def test_all_messages_of_a_recording_are_delivered_regardless_of_qos() -> None:
    bench = Bench(match_qos=False)
    bench.array["Durability Policy"] = "Transient Local"
    bench.publish(ARRAY, MarkerArray(markers=[marker()]), qos=Qos(durability="volatile"))
    bench.update()
    assert bench.marker_names() == ["n/0"]


def test_backward_time_jump_resets_all_displays_as_in_rviz() -> None:
    bench = Bench()
    bench.transform("map", "base", at=5.0, static=False)
    bench.publish(TOPIC, marker(), at=5.0)
    bench.update(5.0)
    bench.publish("/chatter", MarkerArray(), at=1.0)
    bench.update(1.0)
    assert bench.marker_names() == []
    hint = "RViz's log: Detected jump back in time. Resetting RViz."
    assert hint in [row.text for row in bench.session.rows()]
    bench.publish(TOPIC, marker(), at=1.5)
    bench.update(1.5)
    assert bench.marker_names() == ["n/0"]


def test_transforms_ignored_by_tf2_cause_a_hint() -> None:
    bench = Bench()
    bench.transform("map", "map")
    assert any(row.text.startswith("TF_SELF_TRANSFORM") for row in bench.session.rows())


def test_static_transforms_must_be_latched_as_in_tf2() -> None:
    bench = Bench(fixed_frame="map")
    bench.transform("map", "base", static=True)
    assert "base" in bench.session.context.frames.buffer.frames()


def test_view_follows_its_target_frame() -> None:
    bench = Bench()
    bench.session.view["Target Frame"] = "base"
    bench.transform("map", "base", (10.0, 0.0, 0.0), static=False)
    bench.update(0.1)
    np.testing.assert_allclose(bench.scene.camera.target, [10, 0, 0])


def test_unknown_target_frame_causes_a_hint_until_it_is_known() -> None:
    bench = Bench()
    bench.transform("map", "base", (10.0, 0.0, 0.0), static=False)
    bench.session.view["Target Frame"] = "bas"
    (row,) = (row for row in bench.session.rows() if row.name == "Target Frame")
    assert row.level == "hint"
    assert row.text.endswith("Target Frame 'bas', so the view does not move. Did you mean base?")
    bench.session.view["Target Frame"] = "base"
    assert not any(row.name == "Target Frame" for row in bench.session.rows())


def test_unchanged_view_does_not_move_the_camera() -> None:
    bench = Bench()
    changes: list[str] = []
    bench.scene.listen(lambda what, path: changes.append(what))
    for at in (0.1, 0.2, 0.3):
        bench.update(at)
    assert "look" not in changes
