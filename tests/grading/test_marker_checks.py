from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA, String
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import expect_marker, expect_marker_count
from course_lib.grading.evidence import Evidence
from course_lib.grading.task import my

TOPIC = "/visualization_marker"
RED_CUBE = expect_marker(
    TOPIC, type="CUBE", frame="map", position=(0, 0, 0.5), scale=(1, 1, 1), color=(1, 0, 0, 0.8)
)

MakeEvidence = Callable[..., Evidence]
MakeCube = Callable[..., Any]


def test_the_cube_of_lesson_1_passes(evidence: MakeEvidence, cube: MakeCube) -> None:
    assert RED_CUBE.judge(evidence((1, TOPIC, cube()))).score == 1


def test_float_noise_does_not_matter(evidence: MakeEvidence, cube: MakeCube) -> None:
    assert RED_CUBE.judge(evidence((1, TOPIC, cube(pose__position__z=0.1 + 0.2 + 0.2)))).score == 1


@pytest.mark.parametrize(
    ("changes", "message", "mistake"),
    [
        (
            {"pose__position__z": 0.2},
            "the cube is 0.30 m too low: its centre is at z = 0.20 m, expected 0.50 m",
            "the position of a marker is wrong",
        ),
        (
            {"pose__position__x": 1.5},
            "the cube is 1.50 m too far towards +x: its centre is at x = 1.50 m, expected 0.00 m",
            "the position of a marker is wrong",
        ),
        (
            {"header__frame_id": "odom"},
            "the cube is in frame 'odom', expected 'map'",
            "the frame of a marker is wrong",
        ),
        (
            {"scale__y": 2.0},
            "the cube: scale.y is 2.00 m, expected 1.00 m",
            "the size of a marker is wrong",
        ),
        (
            {"color__r": 0.0, "color__g": 1.0},
            "the cube's color rgba is (0.00, 1.00, 0.00, 0.80) (green), "
            "expected (1.00, 0.00, 0.00, 0.80) (red)",
            "the color of a marker is wrong",
        ),
        ({"type": 2}, "the sphere is of type SPHERE, expected CUBE", "the type of a marker is wrong"),
    ],
)
def test_a_message_says_what_came_and_what_was_expected(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any], message: str, mistake: str
) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube(**changes))))
    assert (verdict.score, verdict.message, verdict.mistake) == (0, message, mistake)


def test_an_invisible_cube_is_named_as_such(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube(color__a=0.0))))
    assert "nobody can see it" in verdict.message


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"color__a": 0.0}, "color.a is 0"),
        ({"color__a": float("nan")}, "color.a is 0"),
        ({"scale__y": 0.0}, "scale.y is 0"),
        ({"type": Marker.LINE_STRIP, "scale__x": 0.0}, "scale.x is 0"),
        ({"type": Marker.LINE_STRIP, "scale__y": 0.0}, "it has no points"),
        ({"type": Marker.TEXT_VIEW_FACING}, "its text is empty"),
    ],
)
def test_an_invisible_marker_passes_no_check_and_counts_for_none(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any], why: str
) -> None:
    came = evidence((1, TOPIC, cube(**changes)))
    verdict = expect_marker(TOPIC, frame="map", position=(0, 0, 0.5)).judge(came)
    assert (verdict.score, verdict.mistake) == (0, "a marker is invisible")
    assert verdict.message.endswith(f"is invisible: {why}")
    assert f"nobody can see 1 more: {why}" in expect_marker_count(TOPIC, 1).judge(came).message
    assert expect_marker_count(TOPIC, 0).judge(came).score == 1


@pytest.mark.parametrize(
    "changes",
    [
        {"type": Marker.TEXT_VIEW_FACING, "text": "a", "scale__x": 0.0, "scale__y": 0.0},
        {"type": Marker.LINE_STRIP, "points": [Point(), Point(x=1.0)], "scale__y": 0.0},
        {"type": Marker.ARROW, "points": [Point(), Point(x=1.0)], "scale__z": 0.0},
        {"type": Marker.POINTS, "points": [Point()], "colors": [ColorRGBA(a=1.0)], "color__a": 0.0},
        {"type": Marker.MESH_RESOURCE, "mesh_use_embedded_materials": True, "color__a": 0.0},
    ],
)
def test_a_marker_needs_no_more_than_rviz_to_be_seen(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any]
) -> None:
    assert expect_marker_count(TOPIC, 1).judge(evidence((1, TOPIC, cube(**changes)))).score == 1


def test_a_color_up_to_255_is_explained(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube(color__r=255.0))))
    assert "colors go from 0 to 1, not to 255" in verdict.message


@pytest.mark.parametrize("field", ["pose__position__z", "scale__x", "color__r"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_nan_and_infinity_never_pass(
    evidence: MakeEvidence, cube: MakeCube, field: str, value: float
) -> None:
    assert RED_CUBE.judge(evidence((1, TOPIC, cube(**{field: value})))).score == 0


def test_the_marker_that_fits_best_is_meant(evidence: MakeEvidence, cube: MakeCube) -> None:
    other = cube(id=1, type=Marker.SPHERE, pose__position__z=9.0)
    assert RED_CUBE.judge(evidence((1, TOPIC, cube()), (1, TOPIC, other))).score == 1


def test_ns_and_id_select_a_marker(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_marker(TOPIC, id=4, position=(0, 0, 0.5))
    verdict = check.judge(evidence((1, TOPIC, cube(id=3))))
    assert "there is: 'basic_shapes' 3" in verdict.message


def test_what_is_deleted_is_not_shown(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube()), (2, TOPIC, cube(action=Marker.DELETE))))
    assert (
        verdict.message == f"{TOPIC} shows no marker at the end: all were deleted, or their lifetime is over"
    )


def test_marker_arrays_count_as_markers(evidence: MakeEvidence, cube: MakeCube) -> None:
    array = MarkerArray(markers=[cube(id=0), cube(id=1)])
    assert RED_CUBE.judge(evidence((1, TOPIC, array))).score == 1
    assert expect_marker_count(TOPIC, 2, type="CUBE").judge(evidence((1, TOPIC, array))).score == 1
    assert "shows 2 markers" in expect_marker_count(TOPIC, 3).judge(evidence((1, TOPIC, array))).message


def test_silence_names_the_topics_that_were_heard(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, "/visualisation_marker", cube())))
    assert verdict.message.startswith(f"nothing was published on {TOPIC} in 3 s")
    assert "/visualisation_marker" in verdict.message


def test_a_wrong_message_type_is_named(evidence: MakeEvidence) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, String(data="cube"))))
    assert "carries std_msgs/msg/String" in verdict.message


def test_values_of_the_student_are_used(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_marker(TOPIC, position=(0, 0, my("height")))
    came = (1, TOPIC, cube(pose__position__z=0.8))
    assert check.judge(evidence(came, personal={"height": 0.8})).score == 1
    assert check.judge(evidence(came, personal={"height": 1.1})).score == 0


def test_a_point_where_none_belongs_is_found_also_on_a_closed_line(
    evidence: MakeEvidence, cube: MakeCube
) -> None:
    from geometry_msgs.msg import Point

    corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    check = expect_marker(TOPIC, points=corners)
    closed = cube(points=[Point(), Point(x=1.0), Point()])
    astray = cube(points=[Point(), Point(x=1.0), Point(x=9.0)])
    assert check.judge(evidence((1, TOPIC, closed))).score == 1
    assert check.judge(evidence((1, TOPIC, astray))).score == 0


def test_the_title_names_what_is_asked_for() -> None:
    assert RED_CUBE.title == f"the marker on {TOPIC}: type, frame, position, scale and color"
    assert expect_marker(TOPIC).title == f"the marker on {TOPIC}: is there"


def test_text_points_and_yaw_are_compared(evidence: MakeEvidence, cube: MakeCube) -> None:
    from geometry_msgs.msg import Point

    points = [Point(x=1.0), Point(y=1.0)]
    marker = cube(text="hello", points=points, pose__orientation__w=0.0, pose__orientation__z=1.0)
    came = evidence((1, TOPIC, marker))
    check = expect_marker(TOPIC, text="hello", points=[(0, 1, 0), (1, 0, 0)], yaw=-3.14159)
    assert check.judge(came).score == 1
    wrong = expect_marker(TOPIC, text="hi", points=[(0, 1, 0), (2, 0, 0)], yaw=0.0).judge(came)
    for part in ("says 'hello'", "no point at (2.00, 0.00, 0.00) m", "turned by 3.14 rad"):
        assert part in wrong.message


def test_bytes_that_are_no_message_count_as_silence(evidence: MakeEvidence, cube: MakeCube) -> None:
    from dataclasses import replace

    came = evidence((1, TOPIC, cube()))
    broken = replace(came, samples=tuple(replace(s, cdr=b"\0\1\0\0\xff\xff") for s in came.samples))
    assert RED_CUBE.judge(broken).score == 0


def seconds(duration: float) -> dict[str, Any]:
    return {"lifetime__sec": int(duration), "lifetime__nanosec": round(duration % 1 * 1e9)}


def test_a_marker_whose_lifetime_is_over_is_not_shown(evidence: MakeEvidence, cube: MakeCube) -> None:
    brief = evidence((1, TOPIC, cube(**seconds(0.5))))
    assert RED_CUBE.judge(brief).mistake == "no marker is left at the end"
    renewed = evidence((0, TOPIC, cube(**seconds(0.5))), (1, TOPIC, cube()))
    assert RED_CUBE.judge(renewed).score == 1


def test_a_wrong_lifetime_is_named_in_seconds(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_marker(TOPIC, lifetime=1.0)
    assert check.judge(evidence((2.5, TOPIC, cube(lifetime__sec=1)))).score == 1
    verdict = check.judge(evidence((1, TOPIC, cube())))
    assert verdict.message == "the cube's lifetime is 0.00 s, expected 1.00 s"
    assert verdict.mistake == "the lifetime of a marker is wrong"


def test_markers_are_looked_at_at_any_time(evidence: MakeEvidence, cube: MakeCube) -> None:
    short = cube(lifetime__sec=1)
    came = evidence(
        (0.5, TOPIC, cube()), (1.0, TOPIC, cube(action=Marker.DELETE)), (2.0, TOPIC, short), seconds=4
    )
    counts = [(0.4, 0), (0.6, 1), (1.5, 0), (2.5, 1), (3.5, 0), (None, 0)]
    for at, count in counts:
        assert expect_marker_count(TOPIC, count, at=at).judge(came).message == "as expected"
    assert expect_marker(TOPIC, at=0.6, position=(0, 0, 0.5)).judge(came).score == 1
    messages = [expect_marker(TOPIC, at=at).judge(came).message for at in (0.4, 1.5, None)]
    assert messages == [
        f"{TOPIC} shows no marker after 0.40 s: the first one comes later",
        f"{TOPIC} shows no marker after 1.50 s: all were deleted, or their lifetime is over",
        f"{TOPIC} shows no marker at the end: all were deleted, or their lifetime is over",
    ]


def test_an_arrow_has_a_point_and_not_only_a_line(evidence: MakeEvidence, cube: MakeCube) -> None:
    came = evidence((1, TOPIC, cube(type=Marker.ARROW, points=[Point(), Point(x=1.0)])))
    assert expect_marker(TOPIC, points=((0, 0, 0), (1, 0, 0))).judge(came).score == 1
    verdict = expect_marker(TOPIC, points=((1, 0, 0), (0, 0, 0))).judge(came)
    assert verdict.message == "the arrow points the other way: from the second point to the first"


def test_a_length_that_does_not_matter_is_not_compared(evidence: MakeEvidence, cube: MakeCube) -> None:
    came = evidence((1, TOPIC, cube(scale__y=7.0)))
    assert expect_marker(TOPIC, scale=(1.0, None, 1.0)).judge(came).score == 1
    assert expect_marker(TOPIC, scale=(None, 1.0, None)).judge(came).score == 0


CORNERS = ((1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (-1.0, -1.0, 0.0), (1.0, -1.0, 0.0))  # [m]


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ((0, 1, 2, 3, 0), "as expected"),
        ((2, 3, 0, 1, 2), "as expected"),
        ((3, 2, 1, 0, 3), "as expected"),
        ((0, 2, 1, 3, 0), "the line strip does not go round from corner to corner"),
        ((0, 1, 2, 1, 0), "the line strip does not go round from corner to corner"),
        ((0, 1, 0), "the line strip does not go round from corner to corner"),
        ((0, 1, 2, 3), "the line strip does not come back to its first point"),
    ],
)
def test_a_loop_starts_anywhere_and_goes_either_way_round(
    evidence: MakeEvidence, cube: MakeCube, order: tuple[int, ...], message: str
) -> None:
    points = [Point(x=x, y=y, z=z) for x, y, z in (CORNERS[index] for index in order)]
    came = evidence((1, TOPIC, cube(type=Marker.LINE_STRIP, points=points)))
    assert expect_marker(TOPIC, loop=CORNERS).judge(came).message == message
