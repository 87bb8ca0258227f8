import math
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from course_lib.grading import expect_circling_frame, expect_transform
from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary import motion
from course_lib.ros.graph.graph import START_NS

MakeEvidence = Callable[..., Evidence]


def transform(parent: str, child: str, at: float, x: float, y: float, yaw: float = 0.0) -> Any:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(START_NS + round(at * 1e9), 10**9)
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return message


def circling(ahead: float = math.pi / 2, turn: float = 1.0) -> list[tuple[float, str, Any]]:
    """Return the transforms of half a turn on a circle of 2 m in 3 s."""
    steps = [(0.1 * n, turn * math.pi * n / 30) for n in range(1, 31)]
    return [
        (
            s,
            "/tf",
            TFMessage(transforms=[transform("map", "base", s, 2 * math.cos(a), 2 * math.sin(a), a + ahead)]),
        )
        for s, a in steps
    ]


LENS = (0.5, "/tf_static", TFMessage(transforms=[transform("base", "lens", 0.0, 0.3, 0.0)]))
CIRCLE = expect_circling_frame(
    "map", "base", radius=2.0, period=6.0, counter_clockwise=True, heading=math.pi / 2
)


def test_transform_chain_of_moving_and_static_frames_is_looked_up_at_any_time(evidence: MakeEvidence) -> None:
    recorded = evidence(LENS, *circling())
    angle = math.pi * 1.55 / 3  # between two stamps
    where = (2 * math.cos(angle) - 0.3 * math.sin(angle), 2 * math.sin(angle) + 0.3 * math.cos(angle), 0.0)
    check = expect_transform("map", "lens", at=1.55, translation=where, yaw=angle + math.pi / 2)
    assert check.judge(recorded).message == "as expected"


def test_transforms_are_read_once_for_all_checks(
    evidence: MakeEvidence, monkeypatch: pytest.MonkeyPatch
) -> None:
    read, buffers = motion.transform_buffer, list[Any]()

    def counted(given: Evidence) -> Any:
        buffers.append(read(given))
        return buffers[-1]

    monkeypatch.setattr(motion, "transform_buffer", counted)
    given = evidence()
    for _ in range(3):
        expect_transform("map", "base").judge(given)
    assert len(buffers) == 1
    given.release()
    expect_transform("map", "base").judge(given)
    assert len(buffers) == 2


def test_failed_lookup_transform_is_reported_with_the_tf2_message(evidence: MakeEvidence) -> None:
    verdict = expect_transform("map", "lens").judge(evidence(*circling()))
    assert '"lens" passed to lookupTransform argument source_frame does not exist' in verdict.message
    assert verdict.mistake == "a transform is missing"


def test_wrong_translation_and_rotation_are_reported(evidence: MakeEvidence) -> None:
    verdict = expect_transform("base", "lens", translation=(0.3, 0.5, 0.0), yaw=1.0).judge(evidence(LENS))
    assert "lens is 0.50 m too far towards -y in base: y = 0.00 m, expected 0.50 m" in verdict.message
    assert "lens is turned by 0.00 rad (0°) about z, expected 1.00 rad (57°)" in verdict.message


def test_circling_frame_facing_forward_passes(evidence: MakeEvidence) -> None:
    assert CIRCLE.judge(evidence(*circling())).message == "as expected"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"ahead": 0.0},
            "base is turned by 0.10 rad (6°), expected 1.68 rad (96°): the direction from the origin "
            "plus 1.57 rad (90°)",
        ),
        ({"turn": -1.0}, "base goes clockwise (from above), expected counter-clockwise"),
        ({"turn": 0.5}, "one turn takes 12.00 s, expected 6.00 s"),
    ],
)
def test_faults_of_a_circling_frame_are_reported(
    evidence: MakeEvidence, changes: dict[str, float], message: str
) -> None:
    assert message in CIRCLE.judge(evidence(*circling(**changes))).message


def test_constant_transform_must_be_broadcast_as_static_only(evidence: MakeEvidence) -> None:
    check = expect_transform("base", "lens", static=True)
    moving = (0.7, "/tf", TFMessage(transforms=[transform("base", "lens", 0.7, 0.3, 0.0)]))
    assert check.judge(evidence(LENS, *circling())).score == 1
    for came in (evidence(LENS, moving), evidence(moving)):
        verdict = check.judge(came)
        assert verdict.message == "lens is broadcast repeatedly on /tf, expected once on /tf_static"
    # The place in the map is right, but the tree of frames is another one.
    other = (0.5, "/tf_static", TFMessage(transforms=[transform("map", "lens", 0.0, 0.3, 0.0)]))
    assert check.judge(evidence(other)).message == "the parent of 'lens' is 'map', expected 'base'"


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"radius": None, "period": 6.0, "heading": math.pi / 2}, "as expected"),
        ({"period": 6.0, "start": 0.0}, "base starts at the angle 0.10 rad (6°), expected 0.00 rad (0°)"),
        ({"period": 6.0, "start": 0.1, "height": 0.0}, "as expected"),
        ({"height": 1.0}, "base is 1.00 m too low: z = 0.00 m, expected 1.00 m"),
    ],
)
def test_circling_frame_check_accepts_partial_parameters(
    evidence: MakeEvidence, wanted: dict[str, Any], message: str
) -> None:
    check = expect_circling_frame("map", "base", **{"radius": 2.0, **wanted})
    assert check.judge(evidence(*circling())).message == message


def test_single_pose_is_not_a_circle(evidence: MakeEvidence) -> None:
    verdict = CIRCLE.judge(evidence(*circling()[-1:]))
    assert verdict.message == "base moves for only 0.00 s of 3 s"


def test_transform_the_wrong_way_round_is_reported(evidence: MakeEvidence) -> None:
    check = expect_circling_frame("base", "map", radius=2.0)
    assert check.judge(evidence(*circling())).message == (
        "'map' is the parent of 'base' on /tf, expected the other way round"
    )


def test_wrong_parent_frame_is_reported(evidence: MakeEvidence) -> None:
    check = expect_circling_frame("world", "base", radius=2.0)
    assert check.judge(evidence(*circling())).message == "the parent of 'base' is 'map', expected 'world'"


def test_invalid_transform_messages_are_ignored(evidence: MakeEvidence) -> None:
    from std_msgs.msg import String

    recorded = evidence((1.0, "/tf", String(data="x")), *circling())
    assert CIRCLE.judge(recorded).message == "as expected"


def test_frame_with_several_poses_at_one_time_is_ambiguous(evidence: MakeEvidence) -> None:
    lens = expect_transform("base", "lens", translation=(0.3, 0.0, 0.0))
    base = (0.4, "/tf", TFMessage(transforms=[transform("map", "base", 0.4, 0.0, 0.0)]))
    other = TFMessage(transforms=[transform("base", "lens", 0.0, 0.5, 0.0)])
    assert lens.judge(evidence(base, LENS, LENS)).score == 1
    verdict = lens.judge(evidence(base, (0.4, "/tf_static", other), LENS))
    assert verdict.mistake == "a frame has several poses at one time"
    assert verdict.message == (
        "lens is broadcast as static at (0.50, 0.00, 0.00) m in 'base' and at (0.30, 0.00, 0.00) m "
        "in 'base': it is undefined which one applies"
    )
    moving = TFMessage(transforms=[transform("base", "lens", 0.6, 0.5, 0.0)])
    assert "on /tf_static and on /tf" in lens.judge(evidence(base, LENS, (0.6, "/tf", moving))).message
    twice = TFMessage(transforms=[transform("base", "lens", 0.6, x, 0.0) for x in (0.3, 0.5)])
    assert "for one time" in lens.judge(evidence(base, (0.6, "/tf", twice))).message


def test_frame_published_with_two_trajectories_fails_the_circle_check(evidence: MakeEvidence) -> None:
    rows = circling()
    wider = [
        (s, "/tf", TFMessage(transforms=[transform("map", "base", s, 3 * math.cos(s), 3 * math.sin(s))]))
        for s, _, _ in rows
    ]
    both = sorted([*rows, *wider], key=lambda row: row[0])
    check = expect_circling_frame("map", "base", radius=2.0, period=6.0)
    assert check.judge(evidence(*rows)).score == 1
    assert check.judge(evidence(*both)).mistake == "a frame has several poses at one time"
