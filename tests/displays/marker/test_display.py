import pytest
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.displays.display import Display
from course_lib.ros.graph.topics import Qos
from tests.displays.bench import ARRAY, TOPIC, Bench, marker, ns


def stamped(at: float, frame: str = "base", number: int = 0) -> Marker:
    made = marker(frame=frame, number=number)
    made.header.stamp.sec, made.header.stamp.nanosec = divmod(ns(at), 10**9)
    return made


def test_marker_waits_for_the_transform_at_its_stamp() -> None:
    bench = Bench()
    bench.transform("map", "base", at=0.0, static=False)
    bench.publish(TOPIC, stamped(0.5), at=0.5)
    bench.update(0.6)
    assert bench.marker_names() == []
    assert bench.status(bench.marker, "n/0") is None
    assert bench.hints(bench.marker) == [], "every message of a driving robot waits that long"
    bench.update(1.05)
    assert any("1 message waiting for tf2. No transform" in hint for hint in bench.hints(bench.marker))
    bench.transform("map", "base", (1.0, 0.0, 0.0), at=1.0, static=False)
    bench.update(1.1)
    assert bench.marker_names() == ["n/0"]
    assert bench.place("n/0")[0, 3] == 0.5
    assert bench.hints(bench.marker) == []


def test_hint_about_a_waiting_marker_ends_when_corrected_markers_are_shown() -> None:
    bench = Bench()
    bench.publish(TOPIC, stamped(0.0, "wolrd"), at=0.0)
    bench.update(0.5)
    bench.publish(TOPIC, stamped(0.9, "map"), at=0.9)
    bench.update(0.9)
    assert "wolrd" in bench.hints(bench.marker)[0], "one of two lamps may still be wrong"
    bench.publish(TOPIC, stamped(1.0, "map"), at=1.0)
    bench.update(1.0)
    assert bench.hints(bench.marker) == []
    bench.publish(TOPIC, stamped(1.5, "wolrd"), at=1.5)
    bench.update(1.5)
    assert "wolrd" in bench.hints(bench.marker)[0], "a new mistake gets its hint"


def test_hint_about_a_dropped_marker_ends_when_corrected_markers_are_shown() -> None:
    bench = Bench()
    bench.publish(TOPIC, stamped(0.0, ""), at=0.0)
    assert "the frame id of the message is empty" in bench.hints(bench.marker)[0]
    bench.publish(TOPIC, stamped(2.0, "map"), at=2.0)
    bench.update(2.0)
    assert bench.hints(bench.marker) == []


def test_marker_array_does_not_wait_and_is_an_error_immediately() -> None:
    bench = Bench()
    bench.transform("map", "base", at=0.0, static=False)
    bench.show(stamped(0.5), at=0.5)
    status = bench.status(bench.array, "n/0")
    assert status is not None
    assert status[1].startswith(
        "No transform to fixed frame [map]. TF error: [Lookup would require extrapolation"
    )


def test_marker_display_also_receives_the_array_topic() -> None:
    bench = Bench()
    bench.publish(TOPIC + "_array", MarkerArray(markers=[marker(), stamped(9.0, number=1)]))
    bench.update()
    assert bench.marker_names() == ["n/0"]
    assert bench.status(bench.marker, "Array Topic") == ("ok", "OK")
    assert bench.status(bench.marker, "Topic") == ("ok", "OK")


def test_number_of_waiting_markers_is_limited() -> None:
    bench = Bench()
    for number in range(12):
        bench.publish(TOPIC, stamped(0.5, number=number), at=0.5)
    assert any(
        "for reason 'discarding message because the queue is full'" in h for h in bench.hints(bench.marker)
    )
    bench.transform("map", "base", at=1.0)
    bench.update(1.0)
    assert bench.marker_names() == sorted(f"n/{number}" for number in range(2, 12))


def test_marker_older_than_the_cache_of_tf2_is_dropped_as_in_rviz() -> None:
    bench = Bench()
    for at in (1.0, 12.0, 12.5):
        bench.transform("map", "base", at=at, static=False)
    bench.publish(TOPIC, stamped(1.5), at=12.5)
    reason = "for reason 'the timestamp on the message is earlier than all the data in the transform cache'"
    assert any(one.endswith(reason) for one in bench.hints(bench.marker))


def test_waiting_marker_is_dropped_when_the_cache_of_tf2_moves_past_it() -> None:
    bench = Bench()
    bench.transform("map", "base", at=5.0, static=False)
    bench.publish(TOPIC, stamped(4.0), at=5.0)
    bench.update(5.0)
    assert not any("transform cache" in one for one in bench.hints(bench.marker))
    bench.transform("map", "base", at=14.5, static=False)
    bench.update(14.5)
    assert any("transform cache" in one for one in bench.hints(bench.marker))


def test_old_marker_in_the_fixed_frame_is_drawn_as_in_rviz() -> None:
    bench = Bench()
    bench.transform("map", "base", at=20.0, static=False)
    bench.publish(TOPIC, stamped(1.0, frame="map"), at=20.0)
    bench.update(20.0)
    assert bench.marker_names() == ["n/0"]


def test_marker_without_a_frame_is_dropped_with_the_text_of_the_rviz_log() -> None:
    bench = Bench()
    bench.publish(TOPIC, marker(frame=""))
    bench.update()
    assert bench.marker_names() == []
    assert bench.status(bench.marker, "n/0") is None
    assert bench.hints(bench.marker) == [
        "RViz's log: Message Filter dropping message: frame '' at time 0.000 for reason "
        "'the frame id of the message is empty'"
    ]


@pytest.mark.parametrize("which", ["marker", "array"])
def test_changed_fixed_frame_clears_all_markers(which: str) -> None:
    bench = Bench()
    display: Display = getattr(bench, which)
    message = marker() if which == "marker" else MarkerArray(markers=[marker()])
    bench.publish(TOPIC if which == "marker" else ARRAY, message)
    bench.update()
    assert bench.marker_names() == ["n/0"]
    bench.session.fixed_frame = "odom"
    assert bench.marker_names() == []
    bench.session.fixed_frame = "map"
    assert bench.marker_names() == []
    assert bench.status(display, "Topic") is None


def test_received_messages_are_counted() -> None:
    bench = Bench()
    for second in (1.0, 2.0, 3.0, 4.0):
        bench.publish(TOPIC, marker(), at=second)
    assert bench.status(bench.marker, "Topic") == ("ok", "4 messages received at 1.0 hz.")


def test_namespace_disabled_in_a_layout_is_not_shown() -> None:
    bench = Bench()
    config = {"Topic": {"Value": "/layout"}, "Namespaces": {"hidden": False, "seen": True}}
    bench.session.add("rviz_default_plugins/MarkerArray", "Layout", config)
    bench.publish("/layout", MarkerArray(markers=[marker(ns="hidden"), marker(ns="seen")]))
    bench.update()
    assert bench.marker_names() == ["seen/0"]


def test_default_topics_equal_the_defaults_in_rviz() -> None:
    bench = Bench()
    array = bench.session.add("rviz_default_plugins/MarkerArray", "Default", {})
    assert [s.topic for s in array.subscriptions] == ["/visualization_marker_array"]
    single = bench.session.add("rviz_default_plugins/Marker", "Default", {})
    assert single.subscriptions == ()
    assert bench.status(single, "Topic") == ("error", "Error subscribing: Empty topic name")


def test_disabled_display_shows_no_markers_and_discards_them() -> None:
    bench = Bench()
    bench.publish(TOPIC, marker())
    bench.update()
    bench.marker["Enabled"] = False
    assert bench.marker_names() == []
    bench.publish(TOPIC, marker(), at=1.0)
    bench.marker["Enabled"] = True
    assert bench.marker_names() == []
    bench.publish(TOPIC, marker(), at=2.0)
    bench.update(2.0)
    assert bench.marker_names() == ["n/0"]


def test_message_of_another_type_causes_a_hint() -> None:
    bench = Bench()
    bench.publish(TOPIC, MarkerArray(markers=[marker()]))
    bench.update()
    assert bench.marker_names() == []
    assert bench.hints(bench.marker) == [
        "/markers carries visualization_msgs/msg/MarkerArray; "
        "this display expects visualization_msgs/msg/Marker."
    ]


def test_incompatible_qos_causes_a_hint() -> None:
    bench = Bench()
    bench.publish(TOPIC, marker(), qos=Qos(reliability="best_effort"))
    bench.update()
    assert bench.marker_names() == []
    (hint,) = bench.hints(bench.marker)
    assert hint.startswith("/markers is published with another RELIABILITY than this display requests")
    bench.marker["Reliability Policy"] = "Best Effort"
    bench.publish(TOPIC, marker(), at=1.0, qos=Qos(reliability="best_effort"))
    bench.update(1.0)
    assert bench.marker_names() == ["n/0"]
    assert bench.hints(bench.marker) == []
