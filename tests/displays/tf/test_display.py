"""RViz's TF display (tf_display.cpp, frame_info.cpp)."""

import re
import sys
import time
from typing import Any

import numpy as np
import pytest

from course_lib.displays.display import Display
from course_lib.displays.panel.panels import display_rows
from course_lib.displays.properties import Property
from course_lib.errors import CourseError
from course_lib.viewer.drawables import Solids, Text
from tests.displays.bench import Bench

TF = "rviz_default_plugins/TF"


def visible_parts(bench: Bench) -> set[str]:
    """Return the visible drawables, by part/frame."""
    paths = (path for path in bench.scene.objects() if bench.scene.is_visible(path))
    return {path.removeprefix("displays/TF/") for path in paths if path.startswith("displays/TF/")}


def chain(bench: Bench, **properties: Any) -> Display:
    """Return a display of map → base (1 m along x) → camera."""
    display = bench.session.add(TF, "TF", {}, **properties)
    bench.transform("map", "base", (1.0, 0.0, 0.0))
    bench.transform("base", "camera", (0.0, 0.0, 0.5))
    bench.update()
    return display


def test_frames_have_axes_and_arrows_to_their_parents() -> None:
    bench = Bench()
    display = chain(bench)
    arrows = {f"arrows/{frame}/{part}" for frame in ("base", "camera") for part in ("shaft", "head")}
    assert visible_parts(bench) == {"axes/map", "axes/base", "axes/camera"} | arrows
    np.testing.assert_allclose(bench.scene.transform("displays/TF/axes/camera")[:3, 3], [1, 0, 0.5])
    assert bench.status(display, "camera") == ("ok", "Transform OK")


def test_arrow_extends_from_child_to_parent_with_its_head_at_the_parent() -> None:
    bench = Bench()
    chain(bench)
    tail = np.array([[0, 0, -0.5, 1], [0, 0, 0.5, 1]])
    shaft, head = (tail @ bench.scene.transform(f"displays/TF/arrows/base/{p}").T for p in ("shaft", "head"))
    np.testing.assert_allclose(shaft[:, :3], np.array([[1.0, 0.0, 0.0], [0.1, 0.0, 0.0]]), atol=1e-6)
    np.testing.assert_allclose(head[:, :3], np.array([[0.1, 0.0, 0.0], [0.0, 0.0, 0.0]]), atol=1e-6)


def test_show_properties_toggle_all_drawables_of_one_kind() -> None:
    bench = Bench()
    display = chain(bench, show_axes=False, show_arrows=False, show_names=True)
    assert visible_parts(bench) == {"names/map", "names/base", "names/camera"}
    text = bench.scene.node("displays/TF/names/base").object
    assert isinstance(text, Text)
    assert (text.text, text.height, text.below) == ("base", 0.1, True)
    display["Show Names"] = False
    assert not visible_parts(bench)


def test_marker_scale_scales_all_drawables_of_the_frame() -> None:
    bench = Bench()
    chain(bench, marker_scale=2.0)
    drawable = bench.scene.node("displays/TF/axes/base").object
    assert isinstance(drawable, Solids)
    np.testing.assert_allclose(np.linalg.norm(drawable.placements[0, :3, :3], axis=0), [0.04, 0.04, 0.4])


def test_frames_are_enabled_individually_and_together() -> None:
    bench = Bench()
    display = chain(bench, show_arrows=False)
    display["Frames/base"] = False
    assert visible_parts(bench) == {"axes/map", "axes/camera"}
    assert display["All Enabled"] is False
    display["All Enabled"] = True
    assert visible_parts(bench) == {"axes/map", "axes/base", "axes/camera"}


def test_layout_enables_frames_before_they_are_known_even_with_a_slash() -> None:
    bench = Bench()
    config = {"Frames": {"robot/base": {"Value": False}}, "Show Arrows": False}
    display = bench.session.add(TF, "TF", config)
    bench.transform("map", "robot/base")
    bench.update()
    assert visible_parts(bench) == {"axes/map"}
    display["robot/base"] = True
    assert visible_parts(bench) == {"axes/map", "axes/robot%2Fbase"}


@pytest.mark.parametrize(
    ("whitelist", "blacklist", "expected"),
    [
        ("a", "", {"map", "base", "camera"}),
        ("^ba", "", {"base"}),
        ("", "a[mp]", {"base"}),
        ("a", "b", {"map", "camera"}),
    ],
)
def test_filters_are_searched_as_regular_expressions(
    whitelist: str, blacklist: str, expected: set[str]
) -> None:
    bench = Bench()
    display = chain(bench, show_arrows=False)
    display["Filter (whitelist)"], display["Filter (blacklist)"] = whitelist, blacklist
    assert visible_parts(bench) == {f"axes/{name}" for name in expected}


def test_invalid_regular_expression_is_reported_with_its_position() -> None:
    with pytest.raises(CourseError, match=r"'Filter \(whitelist\)' is '\(', expected a regular expression;"):
        Bench().session.add(TF, "TF", {})["Filter (whitelist)"] = "("


@pytest.mark.parametrize(
    "pattern",
    [
        "(a+)+b",
        "(a|a)*b",
        "(a?){30}a{60}b",
        "a?" * 50 + "a" * 100,
        ".*.*.*.*.*x",
        "((((a*)*)*)*)*b",
        "((((a|){50}){50}){50}){50}b",
        "^(a(a(a(a(a)*)*)*)*)*b",
    ],
)
def test_filter_with_nested_repetitions_is_fast(pattern: str) -> None:
    bench = Bench()
    display = bench.session.add(TF, "TF", {})
    bench.transform("map", "a" * 99)
    start = time.perf_counter()
    display["Filter (whitelist)"] = pattern
    bench.update()
    assert time.perf_counter() - start < 5  # [s]; `re` takes years
    assert not visible_parts(bench)


@pytest.mark.parametrize("pattern", [r"(a)\1", "(?<=a)b", "(?>a)"])
def test_unsupported_part_of_a_regular_expression_is_reported(pattern: str) -> None:
    display = Bench().session.add(TF, "TF", {})
    with pytest.raises(CourseError, match="expected a regular expression without references to groups"):
        display["Filter (whitelist)"] = pattern
    assert display["Filter (whitelist)"] == ""


@pytest.mark.parametrize(
    "pattern",
    ["(_link|_base)+", "(_link|_base)+$", "^(left|right)_[a-z]{3,}?(_1|_2)*$", r"\bgrip", "(?i)LEFT",
     "^(?!left)", "k(?=_)", "[^_]{5}$", r"^\D+$", "(a|b|)*k$", "^.{0,9}$", "(x?){3}", "", "base|^$"],
)  # fmt: skip
def test_filters_agree_with_python(pattern: str) -> None:
    names = ["map", "left_link_base", "right_arm_1", "base_link", "grip2", "tool0", "k_"]
    bench = Bench()
    bench.session.add(TF, "TF", {"Filter (whitelist)": pattern, "Show Arrows": False})
    for name in names[1:]:
        bench.transform("map", name)
    bench.update()
    assert visible_parts(bench) == {f"axes/{name}" for name in names if re.search(pattern, name)}


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        ("(base|map)+$", {"base", "map"}),
        ("^(?!cam).*$", {"base", "map"}),
        ("c.*a.*r*", {"camera"}),
        ("^(.).(.).r.$", {"camera"}),
        (r"[a-m]{2,5}$|e$", {"base"}),
    ],
)
def test_usual_regular_expressions_are_accepted(pattern: str, expected: set[str]) -> None:
    bench = Bench()
    chain(bench, show_arrows=False)["Filter (whitelist)"] = pattern
    assert visible_parts(bench) == {f"axes/{name}" for name in expected}


@pytest.mark.parametrize(
    ("age", "color"),
    [
        (0.0, [1, 0, 0, 1]),
        (4.9, [1, 0, 0, 1]),
        (7.5, [0.85, 0.35, 0.35, 1]),
        (10.0, [0.7, 0.7, 0.7, 1]),
        (12.5, [0.7, 0.7, 0.7, 0.5]),
        (15.5, None),
    ],
)
def test_stale_frame_turns_gray_fades_and_is_removed(age: float, color: list[float] | None) -> None:
    bench = Bench()
    bench.session.add(TF, "TF", {})
    bench.transform("map", "base", static=False)
    bench.update()
    bench.update(age)
    if color is None:
        assert "axes/base" not in visible_parts(bench)
        return
    drawable = bench.scene.node("displays/TF/axes/base").object
    assert isinstance(drawable, Solids)
    np.testing.assert_allclose(drawable.colors[0], color, atol=0.05)


def test_static_frames_and_republished_frames_stay_fresh() -> None:
    bench = Bench()
    display = bench.session.add(TF, "TF", {})
    bench.transform("map", "fixed")
    for at in (0.0, 10.0, 20.0):
        bench.transform("map", "base", at=at, static=False)
        bench.update(at)
    assert {"axes/fixed", "axes/base", "axes/map"} <= visible_parts(bench)
    assert bench.status(display, "base") == ("ok", "Transform OK")


def test_frame_in_another_tree_is_hidden_and_causes_a_warning() -> None:
    bench = Bench()
    display = chain(bench)
    bench.transform("moon", "rover")
    bench.update()
    assert bench.status(display, "rover") == ("warn", "No transform from [rover] to [map]")
    assert "axes/rover" not in visible_parts(bench)


def test_loop_causes_a_warning_for_its_frames_and_others_are_shown() -> None:
    bench = Bench()
    display = chain(bench, show_arrows=False)
    bench.transform("b", "a", static=False)
    bench.transform("a", "b", static=False)
    bench.update()
    assert bench.status(display, "a") == ("warn", "No transform from [a] to [map]")
    assert visible_parts(bench) == {"axes/map", "axes/base", "axes/camera"}
    assert display["Tree"] == {"map": {"base": {"camera": {}}}}


def test_measured_properties_are_read_only() -> None:
    bench = Bench()
    display = chain(bench)
    assert display["Frames/camera/Parent"] == "base"
    assert display["Frames/camera/Position"] == (1.0, 0.0, 0.5)
    assert display["Frames/camera/Relative Position"] == (0.0, 0.0, 0.5)
    assert display["Frames/camera/Orientation"] == (0.0, 0.0, 0.0, 1.0)
    assert display["Frames/map/Relative Position"] == ""
    assert display["Tree"] == {"map": {"base": {"camera": {}}}}
    with pytest.raises(CourseError, match="the property is read-only"):
        display["Frames/camera/Position"] = (0, 0, 0)


def test_unchanged_frames_send_no_scene_changes() -> None:
    bench = Bench()
    chain(bench, show_names=True)
    bench.update(0.1)
    received: list[tuple[str, str]] = []
    bench.scene.listen(lambda what, path: received.append((what, path)))
    bench.update(0.2)
    assert received == []


def test_properties_of_new_frames_are_added_in_one_step(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench()
    display = bench.session.add("rviz_default_plugins/TF", "TF", {})
    grow = type(display).add_properties
    calls: list[int] = []

    def count(display: Display, *rows: Property) -> list[str]:
        calls.append(len(rows))
        return grow(display, *rows)

    monkeypatch.setattr(type(display), "add_properties", count)
    for number in range(50):
        bench.transform("map", f"frame{number}")
    bench.update()
    assert calls == [51 * 6]


def test_tree_has_a_row_for_each_frame_below_its_parent() -> None:
    bench = Bench()
    chain(bench)
    bench.transform("map", "wall")
    bench.transform("camera", "lens")
    bench.update()
    rows = [entry.row for key, entry in display_rows(bench.session).items() if "#Tree#" in key]
    assert [(row.label, row.parent.rpartition("#")[2]) for row in rows] == [
        ("map", "Tree"),
        ("base", "map"),
        ("camera", "base"),
        ("lens", "camera"),
        ("wall", "map"),
    ]


def test_tree_may_be_deeper_than_the_recursion_limit() -> None:
    bench = Bench()
    bench.session.add(TF, "TF", {})
    depth = sys.getrecursionlimit() + 100
    for number in range(depth):
        bench.transform(f"link{number}", f"link{number + 1}")
    bench.update()
    rows = display_rows(bench.session)
    assert sum("#Tree#" in key for key in rows) == depth + 1
