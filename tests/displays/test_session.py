import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from visualization_msgs.msg import MarkerArray

from course_lib.ros.messages import RosMessage, deserialize
from course_lib.ros.qos import Qos
from tests.displays.bench import ARRAY, TOPIC, Bench, marker, ns


def test_a_message_is_shown_by_the_frame_after_it_and_not_before() -> None:
    bench = Bench()
    bench.hear(TOPIC, marker(), at=1.0)
    assert bench.shown() == []
    bench.hear("/chatter", MarkerArray(), at=1.02)
    assert bench.shown() == []
    bench.hear("/chatter", MarkerArray(), at=1.04)
    assert bench.shown() == ["n/0"]


def test_transforms_of_the_same_moment_count_whichever_comes_first() -> None:
    bench = Bench()
    bench.hear(ARRAY, MarkerArray(markers=[marker(frame="base")]))
    bench.transform("map", "base", (3.0, 0.0, 0.0))
    bench.look()
    assert bench.place("n/0")[0, 3] == 3.0


def test_things_expire_without_a_message() -> None:
    bench = Bench()
    bench.show(marker(lifetime=Duration(sec=1)))
    bench.session.tick(ns(0.9))
    assert bench.shown() == ["n/0"]
    bench.session.tick(ns(1.1))
    assert bench.shown() == []


def test_a_message_is_deserialised_once_for_all_displays(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench()
    bench.session.add("rviz_default_plugins/Marker", "Another", {"Topic": TOPIC})
    count = 0

    def counted(cdr: bytes, cls: type[RosMessage]) -> RosMessage:
        nonlocal count
        count += 1
        return deserialize(cdr, cls)

    monkeypatch.setattr("course_lib.ros.messages.deserialize", counted)
    bench.hear(TOPIC, marker())
    bench.hear("/nobody_listens", marker())
    assert count == 1


def test_displays_of_one_name_have_nodes_of_their_own() -> None:
    bench = Bench()
    added = [bench.session.add("rviz_default_plugins/Marker", "a/b", {"Topic": TOPIC}) for _ in range(2)]
    bench.hear(TOPIC, marker())
    bench.look()
    assert bench.shown() == ["n/0"]
    assert len(bench.scene.objects()) == 3
    bench.session.remove(added[0])
    assert len(bench.scene.objects()) == 2


def test_an_unknown_class_is_kept_and_reported_in_rviz_words() -> None:
    bench = Bench()
    config = {"Class": "my_pkg/Fancy", "Name": "Mine", "Secret": [1, 2]}
    display = bench.session.add("my_pkg/Fancy", "Mine", config)
    assert display.config == config
    (row,) = display.rows()
    assert row.level == "error"
    assert row.text.startswith(
        "The class required for this display, 'my_pkg/Fancy', could not be loaded.<br><b>Error:</b>"
    )


def test_a_silent_topic_names_those_that_are_not() -> None:
    bench = Bench()
    bench.hear("/marker", marker())
    assert bench.hints(bench.marker) == [
        "nothing has come on /markers; messages of its type come on /marker."
    ]


def test_a_recording_brings_all_its_messages_whatever_the_display_asks_for() -> None:
    bench = Bench(match_qos=False)
    bench.array["Durability Policy"] = "Transient Local"
    bench.hear(ARRAY, MarkerArray(markers=[marker()]), qos=Qos(durability="volatile"))
    bench.look()
    assert bench.shown() == ["n/0"]


def test_time_that_jumps_back_resets_everything_as_in_rviz() -> None:
    bench = Bench()
    bench.transform("map", "base", at=5.0, static=False)
    bench.hear(TOPIC, marker(), at=5.0)
    bench.look(5.0)
    bench.hear("/chatter", MarkerArray(), at=1.0)
    bench.look(1.0)
    assert bench.shown() == []
    hint = "RViz's log: Detected jump back in time. Resetting RViz."
    assert hint in [row.text for row in bench.session.rows()]
    bench.hear(TOPIC, marker(), at=1.5)
    bench.look(1.5)
    assert bench.shown() == ["n/0"]


def test_transforms_that_tf2_ignores_are_hinted_at() -> None:
    bench = Bench()
    bench.transform("map", "map")
    assert any(row.text.startswith("TF_SELF_TRANSFORM") for row in bench.session.rows())


def test_static_transforms_must_be_latched_as_tf2_asks() -> None:
    bench = Bench(fixed_frame="map")
    bench.transform("map", "base", static=True)
    assert "base" in bench.session.context.frames.buffer.frames()


def test_the_view_follows_its_target_frame() -> None:
    bench = Bench()
    bench.session.view["Target Frame"] = "base"
    bench.transform("map", "base", (10.0, 0.0, 0.0), static=False)
    bench.look(0.1)
    np.testing.assert_allclose(bench.scene.camera.target, [10, 0, 0])


def test_an_unknown_target_frame_is_a_hint_until_it_is_known() -> None:
    bench = Bench()
    bench.transform("map", "base", (10.0, 0.0, 0.0), static=False)
    bench.session.view["Target Frame"] = "bas"
    (row,) = (row for row in bench.session.rows() if row.name == "Target Frame")
    assert row.level == "hint"
    assert row.text.endswith("Target Frame 'bas', so the view stays. Did you mean base?")
    bench.session.view["Target Frame"] = "base"
    assert not any(row.name == "Target Frame" for row in bench.session.rows())


def test_a_view_that_stands_still_leaves_the_camera_alone() -> None:
    bench = Bench()
    said: list[str] = []
    bench.scene.listen(lambda what, path: said.append(what))
    for at in (0.1, 0.2, 0.3):
        bench.look(at)
    assert "look" not in said
