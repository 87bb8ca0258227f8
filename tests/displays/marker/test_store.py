from collections.abc import Callable
from math import nan, pi

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.errors import CourseError
from tests.displays.bench import ARRAY, Bench, marker, ns, points


def at(x: float) -> Pose:
    return Pose(position=Point(x=x))


def test_the_same_namespace_and_id_is_the_same_marker() -> None:
    bench = Bench()
    bench.show(marker(number=1, pose=at(1.0)))
    bench.show(marker(number=1, pose=at(2.0)), at=1.0)
    assert bench.shown() == ["n/1"]
    assert bench.place("n/1")[0, 3] == 2.0


def test_another_type_makes_another_object() -> None:
    bench = Bench()
    bench.show(marker(Marker.CUBE))
    bench.show(marker(Marker.ARROW), at=1.0)
    assert sorted(path.rpartition("/")[2] for path in bench.scene.objects()) == ["head", "shaft"]


def test_a_marker_that_only_moves_keeps_its_picture() -> None:
    bench = Bench()
    bench.show(marker(pose=at(1.0)))
    (before,) = bench.scene.objects().values()
    bench.show(marker(pose=at(2.0)), at=1.0)
    (after,) = bench.scene.objects().values()
    assert after is before
    bench.show(marker(color=ColorRGBA(g=1.0, a=1.0)), at=2.0)
    (repainted,) = bench.scene.objects().values()
    assert repainted is not before


def test_namespaces_with_odd_names_do_not_get_into_each_others_way() -> None:
    bench = Bench()
    names = ("", "a", "a/0", "/", " ", "ä")
    bench.show(*[marker(ns=name) for name in names])
    assert len(bench.scene.objects()) == len(names)
    bench.show(marker(ns="a", action=Marker.DELETE), at=1.0)
    assert len(bench.scene.objects()) == len(names) - 1


def test_delete_removes_one_marker() -> None:
    bench = Bench()
    bench.show(marker(number=0), marker(number=1))
    bench.show(marker(number=0, action=Marker.DELETE), at=1.0)
    assert bench.shown() == ["n/1"]


@pytest.mark.parametrize(("namespace", "left"), [("", []), ("a", ["b/0"])])
def test_delete_all_respects_a_namespace(namespace: str, left: list[str]) -> None:
    bench = Bench()
    bench.show(marker(ns="a"), marker(ns="b"))
    bench.show(marker(ns=namespace, action=Marker.DELETEALL), at=1.0)
    assert bench.shown() == left


def test_an_unknown_action_changes_nothing() -> None:
    bench = Bench()
    bench.show(marker())
    bench.show(marker(action=1), at=1.0)
    assert bench.shown() == ["n/0"]
    assert "RViz's log: Unknown marker action: 1" in bench.hints(bench.array)


def test_a_lifetime_counts_from_reception_and_not_from_the_stamp() -> None:
    bench = Bench()
    old = marker(lifetime=Duration(sec=1))
    old.header.stamp.sec = 5
    bench.transform("map", "base")
    bench.show(old, at=10.0)
    bench.look(10.99)
    assert bench.shown() == ["n/0"]
    bench.look(11.0)
    assert bench.shown() == []
    assert "the last marker expired: its lifetime is 1 s." in bench.hints(bench.array)


@pytest.mark.parametrize(("nanosec", "left"), [(0, ["n/0"]), (100_000, ["n/0"]), (100_001, [])])
def test_a_lifetime_up_to_a_tenth_of_a_millisecond_never_ends(nanosec: int, left: list[str]) -> None:
    bench = Bench()
    bench.show(marker(lifetime=Duration(nanosec=nanosec)))
    bench.look(3600.0)
    assert bench.shown() == left


def test_a_new_message_renews_the_lifetime() -> None:
    bench = Bench()
    for second in range(5):
        bench.show(marker(lifetime=Duration(sec=1)), at=float(second))
        assert bench.shown() == ["n/0"]
    bench.show(marker(), at=4.5)
    bench.look(60.0)
    assert bench.shown() == ["n/0"]


BAD: dict[str, Callable[[], Marker]] = {
    "position": lambda: marker(pose=at(nan)),
    "orientation": lambda: marker(pose=Pose(orientation=Quaternion(w=nan))),
    "scale": lambda: marker(scale=Vector3(x=float("inf"))),
    "colour": lambda: marker(color=ColorRGBA(a=nan)),
    "points": lambda: marker(Marker.POINTS, points=points((0.0, 0.0, nan))),
}


@pytest.mark.parametrize("name", BAD)
def test_a_marker_with_no_number_is_dropped_and_the_old_one_stays(name: str) -> None:
    bench = Bench()
    bench.show(marker(pose=at(1.0)))
    bench.show(BAD[name](), at=1.0)
    assert bench.said(bench.array, "n/0") == (
        "error",
        "Contains invalid floating point values (nans or infs)",
    )
    assert bench.place("n/0")[0, 3] == 1.0


def test_a_good_message_takes_back_the_error_of_a_bad_one() -> None:
    bench = Bench()
    bench.show(marker(Marker.LINE_LIST, points=points((0.0, 0.0, 0.0))))
    assert bench.said(bench.array, "n/0") is not None
    bench.show(marker(Marker.LINE_LIST, points=points((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))), at=1.0)
    assert bench.said(bench.array, "n/0") is None


def test_a_repeated_name_in_an_array_is_an_error_but_the_last_one_is_shown() -> None:
    bench = Bench()
    bench.show(marker(ns="a", number=1, pose=at(1.0)), marker(ns="a", number=1, pose=at(2.0)))
    assert bench.said(bench.array, "Duplicate Marker Check") == (
        "error",
        "Multiple Markers in the same MarkerArray message had the same ns and id: (a, 1)",
    )
    assert bench.place("a/1")[0, 3] == 2.0
    bench.show(marker(ns="a", number=1), at=1.0)
    assert bench.said(bench.array, "Duplicate Marker Check") is None


def test_the_fixed_frame_needs_no_transform() -> None:
    bench = Bench()
    bench.show(marker(frame="map"), marker(number=1, frame="/map"))
    assert bench.shown() == ["n/0", "n/1"]


def test_a_frame_places_its_markers_once() -> None:
    bench = Bench()
    bench.transform("map", "base", (1.0, 0.0, 0.0), yaw=pi / 2)
    bench.show(marker(frame="base", pose=at(2.0)))
    np.testing.assert_allclose(bench.place("n/0")[:3, 3], [1, 2, 0], atol=1e-12)
    bench.transform("map", "base", (9.0, 0.0, 0.0), at=1.0)
    bench.look(2.0)
    np.testing.assert_allclose(bench.place("n/0")[:3, 3], [1, 2, 0], atol=1e-12)


def test_a_marker_that_its_frame_has_left_is_hinted_at_after_a_while() -> None:
    bench = Bench()
    bench.transform("map", "base")
    bench.show(marker(frame="base"), marker(number=1, frame="base", frame_locked=True))
    bench.transform("map", "base", (1.0, 0.0, 0.0), at=0.5)
    bench.look(0.5)
    assert bench.hints(bench.array) == []
    bench.look(1.5)
    (hint,) = bench.hints(bench.array)
    assert hint.startswith("base has moved since this marker came")


def test_a_locked_marker_follows_its_frame_whatever_its_stamp() -> None:
    bench = Bench()
    locked = marker(frame="base", pose=at(2.0), frame_locked=True)
    locked.header.stamp.sec = 10**9
    bench.transform("map", "base", (1.0, 0.0, 0.0))
    bench.show(locked)
    bench.transform("map", "base", (5.0, 0.0, 0.0), yaw=pi / 2, at=1.0)
    bench.look(2.0)
    np.testing.assert_allclose(bench.place("n/0")[:3, 3], [5, 2, 0], atol=1e-12)


def test_a_locked_marker_hides_while_its_frame_is_unknown() -> None:
    bench = Bench()
    bench.transform("map", "other")
    bench.show(marker(frame="base", frame_locked=True))
    assert bench.shown() == []
    assert bench.said(bench.array, "n/0") == ("error", "For frame [base]: Frame [base] does not exist")
    bench.transform("map", "base", (1.0, 0.0, 0.0), at=1.0)
    bench.look(2.0)
    assert bench.shown() == ["n/0"]


def test_a_stamp_asks_for_the_transform_of_its_time() -> None:
    bench = Bench()
    for second in (0.0, 1.0):
        bench.transform("map", "base", (second, 0.0, 0.0), at=second, static=False)
    stamped = marker(frame="base")
    stamped.header.stamp.sec, stamped.header.stamp.nanosec = divmod(ns(0.25), 10**9)
    bench.show(stamped, at=2.0)
    np.testing.assert_allclose(bench.place("n/0")[0, 3], 0.25)


ERRORS = {
    "unknown frame": ("map", "base", "For frame [base]: Frame [base] does not exist"),
    "unknown fixed frame": ("world", "odom", "For frame [odom]: Fixed Frame [world] does not exist"),
    "empty frame": ("map", "", "For frame []: Frame [] does not exist"),
    "two trees": (
        "map",
        "moon",
        "No transform to fixed frame [map]. TF error: [Could not find a connection between 'map' and 'moon' "
        "because they are not part of the same tree.Tf has two or more unconnected trees.]",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_a_marker_that_cannot_be_placed_is_hidden_and_an_error(name: str) -> None:
    fixed_frame, frame, text = ERRORS[name]
    bench = Bench(fixed_frame)
    bench.transform("map", "odom")
    bench.transform("space", "moon")
    bench.show(marker(frame=frame))
    assert bench.said(bench.array, "n/0") == ("error", text)
    assert bench.shown() == []


def test_a_marker_that_is_hidden_comes_back_with_a_message_that_can_be_placed() -> None:
    bench = Bench()
    bench.show(marker(pose=at(1.0)))
    bench.show(marker(frame="nowhere"), at=1.0)
    assert bench.shown() == []
    bench.show(marker(), at=2.0)
    assert bench.shown() == ["n/0"]
    assert bench.said(bench.array, "n/0") is None


QUATERNIONS = [
    (Quaternion(x=0.0, y=0.0, z=0.0, w=0.0), 180.0),
    (Quaternion(z=1.0, w=1.0), 106.26),
    (Quaternion(z=0.5, w=0.5), 67.38),
    (Quaternion(z=0.7, w=0.7), 89.42),
    (Quaternion(z=0.5**0.5, w=0.5**0.5), 90.0),
]


@pytest.mark.parametrize(("quaternion", "degrees"), QUATERNIONS)
def test_quaternions_of_another_length_turn_as_in_rviz2(quaternion: Quaternion, degrees: float) -> None:
    bench = Bench()
    bench.show(marker(pose=Pose(orientation=quaternion)))
    turned = bench.place("n/0")
    assert np.degrees(np.arctan2(turned[1, 0], turned[0, 0])) % 360 == pytest.approx(degrees, abs=0.01)
    np.testing.assert_allclose(turned[:3, :3] @ turned[:3, :3].T, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("locked", [False, True])
def test_no_rotation_at_all_is_half_a_turn_of_the_fixed_frame_whatever_the_frame(locked: bool) -> None:
    bench = Bench()
    bench.transform("map", "base", (1.0, 0.0, 0.0), yaw=0.7)
    none = Pose(orientation=Quaternion(x=0.0, y=0.0, z=0.0, w=0.0))
    bench.show(marker(frame="base", pose=none, frame_locked=locked))
    np.testing.assert_allclose(bench.place("n/0")[:3, :3], np.diag([-1, -1, 1]), atol=1e-9)


def test_an_unticked_namespace_loses_its_markers_until_they_are_published_again() -> None:
    bench = Bench()
    bench.show(marker(ns="a"), marker(ns="b"))
    bench.array["Namespaces"] = {"a": False}
    assert bench.shown() == ["b/0"]
    bench.show(marker(ns="a"), at=1.0)
    assert bench.shown() == ["b/0"]
    assert any("'a' is not ticked" in hint for hint in bench.hints(bench.array))
    bench.array["Namespaces"] = {"a": True}
    assert bench.shown() == ["b/0"]
    bench.show(marker(ns="a"), at=2.0)
    assert bench.shown() == ["a/0", "b/0"]
    assert bench.array["Namespaces"] == {"a": True, "b": True}


def test_a_namespace_has_a_label_of_its_own() -> None:
    bench = Bench()
    bench.show(marker(ns="a"), marker(ns="b/c"))
    assert bench.array["Namespaces/b/c"] is True
    bench.array["Namespaces/b/c"] = False
    assert bench.shown() == ["a/0"]
    assert bench.array["namespaces/b/c"] is False
    assert bench.array["Namespaces/a"] is True
    with pytest.raises(CourseError, match=r"'Namespaces' is .*, expected True or False"):
        bench.array["Namespaces/a"] = 0


def test_markers_that_share_a_name_within_a_moment_are_hinted_at() -> None:
    bench = Bench()
    for x in (1.0, 2.0):
        bench.hear(ARRAY, MarkerArray(markers=[marker(pose=at(x))]))
    bench.look()
    assert any("Give each its own id" in hint for hint in bench.hints(bench.array))
    bench.show(marker(), at=1.0)
    assert not any("Give each its own id" in hint for hint in bench.hints(bench.array))


def test_a_type_that_rviz_does_not_draw_shows_nothing_and_has_no_status() -> None:
    bench = Bench()
    bench.show(marker(Marker.ARROW_STRIP, points=points((0.0, 0.0, 0.0))))
    bench.show(marker(Marker.ARROW_STRIP), at=1.0)
    assert bench.shown() == []
    assert bench.said(bench.array, "n/0") is None
    assert any("Unknown marker type: 12" in hint for hint in bench.hints(bench.array))
