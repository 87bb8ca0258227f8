import math
from collections.abc import Callable
from math import nan

import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Pose, Quaternion, Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.displays.markers import DisplayedMarker
from course_lib.errors import CourseError
from tests.displays.bench import ARRAY, Bench, at, marker, points


def test_marker_is_identified_by_namespace_and_id() -> None:
    bench = Bench()
    bench.show(marker(number=1, pose=at(1.0)))
    bench.show(marker(number=1, pose=at(2.0)), at=1.0)
    assert bench.marker_names() == ["n/1"]
    assert bench.place("n/1")[0, 3] == 2.0


def test_changed_type_creates_another_object() -> None:
    bench = Bench()
    bench.show(marker(Marker.CUBE))
    bench.show(marker(Marker.ARROW), at=1.0)
    assert sorted(path.rpartition("/")[2] for path in bench.scene.objects()) == ["head", "shaft"]


def test_moved_marker_keeps_its_drawables() -> None:
    bench = Bench()
    bench.show(marker(pose=at(1.0)))
    (before,) = bench.scene.objects().values()
    bench.show(marker(pose=at(2.0)), at=1.0)
    (after,) = bench.scene.objects().values()
    assert after is before
    bench.show(marker(color=ColorRGBA(g=1.0, a=1.0)), at=2.0)
    (repainted,) = bench.scene.objects().values()
    assert repainted is not before


@pytest.mark.parametrize("kind", [Marker.LINE_STRIP, Marker.SPHERE_LIST, Marker.POINTS, Marker.TRIANGLE_LIST])
def test_repeated_marker_with_points_changes_nothing_in_the_scene(kind: int) -> None:
    bench = Bench()
    corners = points((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    bench.show(marker(kind, points=corners))
    changes: list[tuple[str, str]] = []
    bench.scene.listen(lambda change, path: changes.append((change, path)))
    bench.show(marker(kind, points=corners), at=1.0)
    assert changes == []
    bench.show(marker(kind, points=corners[::-1]), at=2.0)
    assert [change for change, _ in changes] == ["object"]


def test_namespaces_with_special_characters_do_not_collide() -> None:
    bench = Bench()
    names = ("", "a", "a/0", "/", " ", "ä")
    bench.show(*[marker(ns=name) for name in names])
    assert len(bench.scene.objects()) == len(names)
    bench.show(marker(ns="a", action=Marker.DELETE), at=1.0)
    assert len(bench.scene.objects()) == len(names) - 1


def test_delete_action_removes_one_marker() -> None:
    bench = Bench()
    bench.show(marker(number=0), marker(number=1))
    bench.show(marker(number=0, action=Marker.DELETE), at=1.0)
    assert bench.marker_names() == ["n/1"]


@pytest.mark.parametrize(("namespace", "remaining"), [("", []), ("a", ["b/0"])])
def test_delete_all_action_respects_a_namespace(namespace: str, remaining: list[str]) -> None:
    bench = Bench()
    bench.show(marker(ns="a"), marker(ns="b"))
    bench.show(marker(ns=namespace, action=Marker.DELETEALL), at=1.0)
    assert bench.marker_names() == remaining


def test_unknown_action_is_ignored() -> None:
    bench = Bench()
    bench.show(marker())
    bench.show(marker(action=1), at=1.0)
    assert bench.marker_names() == ["n/0"]
    assert "RViz's log: Unknown marker action: 1" in bench.hints(bench.array)


def test_lifetime_starts_at_reception_and_not_at_the_stamp() -> None:
    bench = Bench()
    old = marker(lifetime=Duration(sec=1))
    old.header.stamp.sec = 5
    bench.transform("map", "base")
    bench.show(old, at=10.0)
    bench.update(10.99)
    assert bench.marker_names() == ["n/0"]
    bench.update(11.0)
    assert bench.marker_names() == []
    assert "the last marker expired: its lifetime is 1 s." in bench.hints(bench.array)


@pytest.mark.parametrize(("nanosec", "remaining"), [(0, ["n/0"]), (100_000, ["n/0"]), (100_001, [])])
def test_lifetime_up_to_a_tenth_of_a_millisecond_never_expires(nanosec: int, remaining: list[str]) -> None:
    bench = Bench()
    bench.show(marker(lifetime=Duration(nanosec=nanosec)))
    bench.update(3600.0)
    assert bench.marker_names() == remaining


def test_new_message_restarts_the_lifetime() -> None:
    bench = Bench()
    for second in range(5):
        bench.show(marker(lifetime=Duration(sec=1)), at=float(second))
        assert bench.marker_names() == ["n/0"]
    bench.show(marker(), at=4.5)
    bench.update(60.0)
    assert bench.marker_names() == ["n/0"]


BAD: dict[str, Callable[[], Marker]] = {
    "position": lambda: marker(pose=at(nan)),
    "orientation": lambda: marker(pose=Pose(orientation=Quaternion(w=nan))),
    "scale": lambda: marker(scale=Vector3(x=float("inf"))),
    "colour": lambda: marker(color=ColorRGBA(a=nan)),
    "points": lambda: marker(Marker.POINTS, points=points((0.0, 0.0, nan))),
}


@pytest.mark.parametrize("name", BAD)
def test_marker_with_nan_is_dropped_and_the_previous_one_is_kept(name: str) -> None:
    bench = Bench()
    bench.show(marker(pose=at(1.0)))
    bench.show(BAD[name](), at=1.0)
    assert bench.status(bench.array, "n/0") == (
        "error",
        "Contains invalid floating point values (nans or infs)",
    )
    assert bench.place("n/0")[0, 3] == 1.0


def test_valid_message_clears_the_error_of_an_invalid_one() -> None:
    bench = Bench()
    bench.show(marker(Marker.LINE_LIST, points=points((0.0, 0.0, 0.0))))
    assert bench.status(bench.array, "n/0") is not None
    bench.show(marker(Marker.LINE_LIST, points=points((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))), at=1.0)
    assert bench.status(bench.array, "n/0") is None


def test_duplicate_marker_in_an_array_is_an_error_and_the_last_one_is_shown() -> None:
    bench = Bench()
    bench.show(marker(ns="a", number=1, pose=at(1.0)), marker(ns="a", number=1, pose=at(2.0)))
    assert bench.status(bench.array, "Duplicate Marker Check") == (
        "error",
        "Multiple Markers in the same MarkerArray message had the same ns and id: (a, 1)",
    )
    assert bench.place("a/1")[0, 3] == 2.0
    bench.show(marker(ns="a", number=1), at=1.0)
    assert bench.status(bench.array, "Duplicate Marker Check") is None


def test_disabled_namespace_loses_its_markers_until_they_are_published_again() -> None:
    bench = Bench()
    bench.show(marker(ns="a"), marker(ns="b"))
    bench.array["Namespaces"] = {"a": False}
    assert bench.marker_names() == ["b/0"]
    bench.show(marker(ns="a"), at=1.0)
    assert bench.marker_names() == ["b/0"]
    assert any("'a' is not enabled" in hint for hint in bench.hints(bench.array))
    bench.array["Namespaces"] = {"a": True}
    assert bench.marker_names() == ["b/0"]
    bench.show(marker(ns="a"), at=2.0)
    assert bench.marker_names() == ["a/0", "b/0"]
    assert bench.array["Namespaces"] == {"a": True, "b": True}


def test_namespace_has_a_unique_label() -> None:
    bench = Bench()
    bench.show(marker(ns="a"), marker(ns="b/c"))
    assert bench.array["Namespaces/b/c"] is True
    bench.array["Namespaces/b/c"] = False
    assert bench.marker_names() == ["a/0"]
    assert bench.array["namespaces/b/c"] is False
    assert bench.array["Namespaces/a"] is True
    with pytest.raises(CourseError, match=r"'Namespaces' is .*, expected True or False"):
        bench.array["Namespaces/a"] = 0


def test_different_markers_with_one_id_in_quick_succession_cause_a_hint() -> None:
    bench = Bench()
    for x in (1.0, 2.0):
        bench.publish(ARRAY, MarkerArray(markers=[marker(pose=at(x))]))
    bench.update()
    assert any("Give each its own id" in hint for hint in bench.hints(bench.array))
    later = marker()
    later.header.stamp.sec += 1
    bench.publish(ARRAY, MarkerArray(markers=[marker()]))
    bench.publish(ARRAY, MarkerArray(markers=[later]))
    bench.update()
    assert not any("Give each its own id" in hint for hint in bench.hints(bench.array))


def test_very_many_markers_cause_a_hint_until_they_are_deleted() -> None:
    bench = Bench()
    bench.show(*(marker(Marker.CUBE, number) for number in range(5001)))
    assert any(hint.startswith("5,001 markers make this view") for hint in bench.hints(bench.array))
    bench.show(marker(Marker.CUBE, 7, action=Marker.DELETE))
    assert not bench.hints(bench.array)


def test_marker_type_unsupported_by_rviz_is_not_drawn_and_has_no_status() -> None:
    bench = Bench()
    bench.show(marker(Marker.ARROW_STRIP, points=points((0.0, 0.0, 0.0))))
    bench.show(marker(Marker.ARROW_STRIP), at=1.0)
    assert bench.marker_names() == []
    assert bench.status(bench.array, "n/0") is None
    assert any("Unknown marker type: 12" in hint for hint in bench.hints(bench.array))


def test_frame_without_new_messages_visits_only_markers_that_expire_or_are_locked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bench = Bench()
    bench.show(*(marker(number=number) for number in range(20)))
    bench.show(marker(number=20, lifetime=Duration(sec=1)), marker(number=21, frame_locked=True))
    bench.show(*(marker(number=number, lifetime=Duration(sec=1)) for number in (1, 2)))
    bench.show(marker(number=2))
    visited: list[int] = []

    def visit(live: DisplayedMarker) -> float:
        visited.append(live.marker.id)
        return math.inf

    monkeypatch.setattr(DisplayedMarker, "expires_ns", property(visit))
    bench.update(0.5)
    assert sorted(visited) == [1, 20, 21]
    bench.show(Marker(action=Marker.DELETEALL), at=0.6)
    visited.clear()
    bench.update(0.7)
    assert visited == []
