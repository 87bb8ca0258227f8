from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA, String
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.errors import CourseError
from course_lib.grading import expect_marker, expect_marker_count
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.task import my

TOPIC = "/visualization_marker"
RED_CUBE = expect_marker(
    TOPIC, type="CUBE", frame="map", position=(0, 0, 0.5), scale=(1, 1, 1), color=(1, 0, 0, 0.8)
)

MakeEvidence = Callable[..., Evidence]
MakeCube = Callable[..., Any]


def test_cube_of_lesson_1_passes(evidence: MakeEvidence, cube: MakeCube) -> None:
    assert RED_CUBE.judge(evidence((1, TOPIC, cube()))).score == 1


def test_floating_point_rounding_is_tolerated(evidence: MakeEvidence, cube: MakeCube) -> None:
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
            "expected (1.00, 0.00, 0.00, 0.80) (red): r and g are exchanged",
            "the color of a marker is wrong",
        ),
        ({"type": 2}, "the sphere is of type SPHERE, expected CUBE", "the type of a marker is wrong"),
    ],
)
def test_failure_message_reports_received_and_expected_values(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any], message: str, mistake: str
) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube(**changes))))
    assert (verdict.score, verdict.message, verdict.mistake) == (0, message, mistake)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        # A quarter turn about x leaves a cube as it is, and lays a cylinder down.
        ({"type": Marker.CUBE, "orientation": (1.0, 0.0, 0.0, 1.0)}, "as expected"),
        ({"type": Marker.CUBE, "orientation": (0.0, 0.0, 0.4, 0.9)}, "as expected"),
        (
            {"type": Marker.CUBE, "orientation": (0.383, 0.0, 0.0, 0.924)},
            "the cube is tilted by pose.orientation: it is 1.41 m high, expected 1.00 m",
        ),
        ({"type": Marker.CYLINDER, "orientation": (1.0, 0.0, 0.0, 0.0)}, "as expected"),
        ({"type": Marker.CYLINDER, "orientation": (0.0, 0.0, 0.0, 0.0)}, "as expected"),
        (
            {"type": Marker.CYLINDER, "orientation": (0.0, 1.0, 0.0, 1.0), "scale__z": 3.0},
            "the cylinder is tilted by pose.orientation: it is 1.00 m high, expected 3.00 m",
        ),
        ({"type": Marker.SPHERE, "orientation": (0.383, 0.0, 0.0, 0.924)}, "as expected"),
    ],
)
def test_height_of_a_tilted_shape_is_not_its_scale(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any], message: str
) -> None:
    x, y, z, w = changes.pop("orientation")
    marker = cube(**changes)
    turn = marker.pose.orientation
    turn.x, turn.y, turn.z, turn.w = x, y, z, w
    check = expect_marker(TOPIC, scale=(1.0, 1.0, changes.get("scale__z", 1.0)))
    assert check.judge(evidence((1, TOPIC, marker))).message == message


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (2, "none was added; action is DELETE (2), not ADD (0)"),
        (7, "none was added; action is 7, not ADD (0)"),
    ],
)
def test_action_is_reported_if_no_marker_is_added(
    evidence: MakeEvidence, cube: MakeCube, action: int, message: str
) -> None:
    assert message in RED_CUBE.judge(evidence((1, TOPIC, cube(action=action)))).message


def test_invisible_cube_is_reported(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube(color__a=0.0))))
    assert "it is invisible" in verdict.message


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"color__a": 0.0}, "color.a is 0"),
        ({"color__a": float("nan")}, "color.a is nan"),
        ({"scale__y": 0.0}, "scale.y is 0"),
        ({"type": Marker.LINE_STRIP, "scale__x": 0.0}, "scale.x is 0"),
        ({"type": Marker.LINE_STRIP, "scale__y": 0.0}, "it has no points"),
        ({"type": Marker.TEXT_VIEW_FACING}, "its text is empty"),
    ],
)
def test_invisible_marker_fails_every_check_and_is_not_counted(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any], why: str
) -> None:
    recorded = evidence((1, TOPIC, cube(**changes)))
    verdict = expect_marker(TOPIC, frame="map", position=(0, 0, 0.5)).judge(recorded)
    assert (verdict.score, verdict.mistake) == (0, "a marker is invisible")
    assert verdict.message.endswith(f"is invisible: {why}")
    assert f"1 more is invisible: {why}" in expect_marker_count(TOPIC, 1).judge(recorded).message
    assert expect_marker_count(TOPIC, 0).judge(recorded).score == 1


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
def test_marker_visibility_requires_only_the_fields_that_rviz_uses(
    evidence: MakeEvidence, cube: MakeCube, changes: dict[str, Any]
) -> None:
    assert expect_marker_count(TOPIC, 1).judge(evidence((1, TOPIC, cube(**changes)))).score == 1


def test_color_in_the_range_0_to_255_is_explained(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube(color__r=255.0))))
    assert "colors go from 0 to 1, not to 255" in verdict.message


@pytest.mark.parametrize("field", ["pose__position__z", "scale__x", "color__r"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_nan_and_infinity_fail_the_check(
    evidence: MakeEvidence, cube: MakeCube, field: str, value: float
) -> None:
    assert RED_CUBE.judge(evidence((1, TOPIC, cube(**{field: value})))).score == 0


def test_best_matching_marker_is_judged(evidence: MakeEvidence, cube: MakeCube) -> None:
    other = cube(id=1, type=Marker.SPHERE, pose__position__z=9.0)
    assert RED_CUBE.judge(evidence((1, TOPIC, cube()), (1, TOPIC, other))).score == 1


def test_ns_and_id_select_a_marker(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_marker(TOPIC, id=4, position=(0, 0, 0.5))
    verdict = check.judge(evidence((1, TOPIC, cube(id=3))))
    assert "it shows: 'basic_shapes' 3" in verdict.message


def test_deleted_marker_is_not_shown(evidence: MakeEvidence, cube: MakeCube) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, cube()), (2, TOPIC, cube(action=Marker.DELETE))))
    assert (
        verdict.message == f"{TOPIC} shows no marker at the end: all were deleted, or their lifetime is over"
    )


def test_marker_arrays_count_as_markers(evidence: MakeEvidence, cube: MakeCube) -> None:
    array = MarkerArray(markers=[cube(id=0), cube(id=1)])
    assert RED_CUBE.judge(evidence((1, TOPIC, array))).score == 1
    assert expect_marker_count(TOPIC, 2, type="CUBE").judge(evidence((1, TOPIC, array))).score == 1
    assert "shows 2 markers" in expect_marker_count(TOPIC, 3).judge(evidence((1, TOPIC, array))).message


def test_marker_twice_in_one_array_is_reported(evidence: MakeEvidence, cube: MakeCube) -> None:
    marker = cube()
    recorded = evidence((0.0, "/boxes", MarkerArray(markers=[marker, marker])))
    message = expect_marker_count("/boxes", 1, type="CUBE").judge(recorded).message
    name = f"CUBE markers with ns {marker.ns!r} and id {marker.id}"
    assert message == f"one array on /boxes adds 2 equal {name}, expected one: is append called twice?"
    other = evidence((0.0, "/boxes", MarkerArray(markers=[marker, cube(color__a=0.5)])))
    assert expect_marker_count("/boxes", 1, type="CUBE").judge(other).score == 1


def test_missing_messages_are_reported_with_the_published_topics(
    evidence: MakeEvidence, cube: MakeCube
) -> None:
    verdict = RED_CUBE.judge(evidence((1, "/visualisation_marker", cube())))
    assert verdict.message.startswith(f"nothing was published on {TOPIC} in 3 s")
    assert "/visualisation_marker" in verdict.message


def test_wrong_message_type_is_reported(evidence: MakeEvidence) -> None:
    verdict = RED_CUBE.judge(evidence((1, TOPIC, String(data="cube"))))
    assert "carries std_msgs/msg/String" in verdict.message


def test_personal_values_of_the_student_are_compared(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_marker(TOPIC, position=(0, 0, my("height")))
    came = (1, TOPIC, cube(pose__position__z=0.8))
    assert check.judge(evidence(came, personal={"height": 0.8})).score == 1
    assert check.judge(evidence(came, personal={"height": 1.1})).score == 0


def test_misplaced_point_on_a_closed_line_fails_the_check(evidence: MakeEvidence, cube: MakeCube) -> None:
    from geometry_msgs.msg import Point

    corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    check = expect_marker(TOPIC, points=corners)
    closed = cube(points=[Point(), Point(x=1.0), Point()])
    astray = cube(points=[Point(), Point(x=1.0), Point(x=9.0)])
    assert check.judge(evidence((1, TOPIC, closed))).score == 1
    assert check.judge(evidence((1, TOPIC, astray))).score == 0


def test_check_title_lists_the_checked_fields() -> None:
    assert RED_CUBE.title == f"the marker on {TOPIC}: type, frame, position, scale and color"
    assert expect_marker(TOPIC).title == f"the marker on {TOPIC}: is there"


def test_text_points_and_yaw_are_compared(evidence: MakeEvidence, cube: MakeCube) -> None:
    from geometry_msgs.msg import Point

    points = [Point(x=1.0), Point(y=1.0)]
    marker = cube(text="hello", points=points, pose__orientation__w=0.0, pose__orientation__z=1.0)
    recorded = evidence((1, TOPIC, marker))
    check = expect_marker(TOPIC, text="hello", points=[(0, 1, 0), (1, 0, 0)], yaw=-3.14159)
    assert check.judge(recorded).score == 1
    wrong = expect_marker(TOPIC, text="hi", points=[(0, 1, 0), (2, 0, 0)], yaw=0.0).judge(recorded)
    for part in ("reads 'hello'", "no point at (2.00, 0.00, 0.00) m", "turned by 3.14 rad"):
        assert part in wrong.message


def test_invalid_message_bytes_count_as_no_message(evidence: MakeEvidence, cube: MakeCube) -> None:
    from dataclasses import replace

    recorded = evidence((1, TOPIC, cube()))
    broken = replace(recorded, samples=tuple(replace(s, cdr=b"\0\1\0\0\xff\xff") for s in recorded.samples))
    assert RED_CUBE.judge(broken).score == 0


def seconds(duration: float) -> dict[str, Any]:
    return {"lifetime__sec": int(duration), "lifetime__nanosec": round(duration % 1 * 1e9)}


def test_expired_marker_is_not_shown(evidence: MakeEvidence, cube: MakeCube) -> None:
    brief = evidence((1, TOPIC, cube(**seconds(0.5))))
    assert RED_CUBE.judge(brief).mistake == "no marker is left at the end"
    renewed = evidence((0, TOPIC, cube(**seconds(0.5))), (1, TOPIC, cube()))
    assert RED_CUBE.judge(renewed).score == 1


def test_wrong_marker_lifetime_is_reported_in_seconds(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_marker(TOPIC, lifetime=1.0)
    assert check.judge(evidence((2.5, TOPIC, cube(lifetime__sec=1)))).score == 1
    verdict = check.judge(evidence((1, TOPIC, cube())))
    assert verdict.message == "the cube's lifetime is 0.00 s, expected 1.00 s"
    assert verdict.mistake == "the lifetime of a marker is wrong"


def test_marker_is_checked_at_the_requested_time(evidence: MakeEvidence, cube: MakeCube) -> None:
    short = cube(lifetime__sec=1)
    recorded = evidence(
        (0.5, TOPIC, cube()), (1.0, TOPIC, cube(action=Marker.DELETE)), (2.0, TOPIC, short), seconds=4
    )
    counts = [(0.4, 0), (0.6, 1), (1.5, 0), (2.5, 1), (3.5, 0), (None, 0)]
    for at, count in counts:
        assert expect_marker_count(TOPIC, count, at=at).judge(recorded).message == "as expected"
    assert expect_marker(TOPIC, at=0.6, position=(0, 0, 0.5)).judge(recorded).score == 1
    messages = [expect_marker(TOPIC, at=at).judge(recorded).message for at in (0.4, 1.5, None)]
    assert messages == [
        f"{TOPIC} shows no marker after 0.40 s: the first one is published later",
        f"{TOPIC} shows no marker after 1.50 s: all were deleted, or their lifetime is over",
        f"{TOPIC} shows no marker at the end: all were deleted, or their lifetime is over",
    ]


def test_reversed_arrow_is_reported(evidence: MakeEvidence, cube: MakeCube) -> None:
    recorded = evidence((1, TOPIC, cube(type=Marker.ARROW, points=[Point(), Point(x=1.0)])))
    assert expect_marker(TOPIC, points=((0, 0, 0), (1, 0, 0))).judge(recorded).score == 1
    verdict = expect_marker(TOPIC, points=((1, 0, 0), (0, 0, 0))).judge(recorded)
    assert verdict.message == "the arrow points the other way: from the second point to the first"


def test_third_point_of_an_arrow_is_compared_like_a_point_of_a_line(
    evidence: MakeEvidence, cube: MakeCube
) -> None:
    points = [Point(), Point(x=1.0), Point(x=2.0)]
    recorded = evidence((1, TOPIC, cube(type=Marker.ARROW, points=points)))
    verdict = expect_marker(TOPIC, points=((0, 0, 0), (1, 0, 0), (1, 1, 0))).judge(recorded)
    assert verdict.message == (
        "the arrow has no point at (1.00, 1.00, 0.00) m; the nearest is at (1.00, 0.00, 0.00) m"
    )


def test_end_of_an_arrow_is_reported_and_not_its_nearest_point(
    evidence: MakeEvidence, cube: MakeCube
) -> None:
    recorded = evidence((1, TOPIC, cube(type=Marker.ARROW, points=[Point(x=3.0), Point(x=1.0)])))
    verdict = expect_marker(TOPIC, points=((3, 0, 0), (4, 0, 0))).judge(recorded)
    assert verdict.message == "the arrow ends at (1.00, 0.00, 0.00) m, expected (4.00, 0.00, 0.00) m"


def test_arrow_with_points_is_reported_where_the_pose_turns_it(
    evidence: MakeEvidence, cube: MakeCube
) -> None:
    between = cube(type=Marker.ARROW, points=[Point(), Point(x=0.3)])
    verdict = expect_marker(TOPIC, scale=(1.0, 1.0, 1.0), points=()).judge(evidence((1, TOPIC, between)))
    assert verdict.message == (
        "the arrow has 2 points, expected none: with points scale.x is the diameter of its shaft, "
        "not its length"
    )
    posed = evidence((1, TOPIC, cube(type=Marker.ARROW)))
    assert expect_marker(TOPIC, scale=(1.0, 1.0, 1.0), points=()).judge(posed).score == 1


def test_unspecified_scale_component_is_not_compared(evidence: MakeEvidence, cube: MakeCube) -> None:
    recorded = evidence((1, TOPIC, cube(scale__y=7.0)))
    assert expect_marker(TOPIC, scale=(1.0, None, 1.0)).judge(recorded).score == 1
    assert expect_marker(TOPIC, scale=(None, 1.0, None)).judge(recorded).score == 0


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
        ((0, 1, 2, 3), "the line strip does not end at its first point"),
    ],
)
def test_loop_matches_from_any_start_in_both_directions(
    evidence: MakeEvidence, cube: MakeCube, order: tuple[int, ...], message: str
) -> None:
    points = [Point(x=x, y=y, z=z) for x, y, z in (CORNERS[index] for index in order)]
    recorded = evidence((1, TOPIC, cube(type=Marker.LINE_STRIP, points=points)))
    assert expect_marker(TOPIC, loop=CORNERS).judge(recorded).message == message


@pytest.mark.parametrize(
    ("changes", "message", "mistake"),
    [
        ([{"id": 0}, {"id": 0}], "several have ns 'x' and id 0", "markers with the same ns and id"),
        (
            [{"id": 0, "type": Marker.SPHERE}],
            "its markers are of type SPHERE",
            "the type of a marker is wrong",
        ),
        (
            [{"id": 0, "lifetime__nanosec": 1}],
            "the lifetime of 0.00 s is over",
            "no marker is shown in between",
        ),
        ([{"id": 0}], "shows 1 marker of type CUBE at the end, expected 2", "the count is wrong"),
    ],
)
def test_missing_markers_have_their_cause(
    evidence: MakeEvidence, cube: MakeCube, changes: list[dict[str, Any]], message: str, mistake: str
) -> None:
    recorded = evidence(*((1, TOPIC, cube(ns="x", **one)) for one in changes))
    verdict = expect_marker_count(TOPIC, 2, type="CUBE").judge(recorded)
    assert message in verdict.message
    assert verdict.mistake.startswith(mistake)


def test_empty_arrays_are_reported(evidence: MakeEvidence) -> None:
    verdict = expect_marker_count(TOPIC, 2).judge(evidence((1, TOPIC, MarkerArray())))
    assert verdict.message.endswith("expected 2; its arrays are empty")


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("Person(0.95)", ": the spaces differ"),
        ("person (0.95)", ": upper and lower case differ"),
        ("Person (0.950)", ": the digits of the number differ"),
        ("Person 0.95", ": the punctuation around the words differs"),
        ("{label} (0.95)", ": is f missing before the quotes of the string, or is a brace doubled?"),
        ("Car (0.95)", ""),
    ],
)
def test_difference_of_a_text_is_described(
    evidence: MakeEvidence, cube: MakeCube, text: str, cause: str
) -> None:
    recorded = evidence((1, TOPIC, cube(type=Marker.TEXT_VIEW_FACING, text=text)))
    verdict = expect_marker(TOPIC, text="Person (0.95)").judge(recorded)
    assert verdict.message == f"the text reads {text!r}, expected 'Person (0.95)'{cause}"


def test_turn_about_another_axis_is_reported(evidence: MakeEvidence, cube: MakeCube) -> None:
    recorded = evidence((1, TOPIC, cube(pose__orientation__x=0.6, pose__orientation__w=0.8)))
    assert "turned about x instead" in expect_marker(TOPIC, yaw=1.0).judge(recorded).message


@pytest.mark.parametrize(
    ("frame", "end"),
    [
        ("/map", ": a frame's name has no slash"),
        ("map/", ": a frame's name has no slash"),
        (" map", ": there is a space too many"),
        ("Map", ": upper and lower case differ"),
        ("odom", "expected 'map'"),
    ],
)
def test_difference_between_similar_frames_is_explained(
    evidence: MakeEvidence, cube: MakeCube, frame: str, end: str
) -> None:
    recorded = evidence((1, TOPIC, cube(header__frame_id=frame)))
    assert expect_marker(TOPIC, frame="map").judge(recorded).message.endswith(end)


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda: expect_marker("/m", type="CUBEE"), r"expect_marker: type='CUBEE', .*Did you mean CUBE\?"),
        (lambda: expect_marker_count("/m", 2, type="Cube"), r"type='Cube', expected one of ARROW, CUBE"),
        (
            lambda: expect_marker("m", type="CUBE"),
            r"topic='m', expected a name that begins with a slash, '/m'",
        ),
    ],
)
def test_marker_type_or_topic_that_no_message_has_is_rejected(
    call: Callable[[], Check], expected: str
) -> None:
    with pytest.raises(CourseError, match=expected):
        call()
