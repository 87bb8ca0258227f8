import math
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from course_lib.grading import expect_circling_frame, expect_transform
from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary import motion
from course_lib.ros.clock import START_NS

MakeEvidence = Callable[..., Evidence]


def transform(parent: str, child: str, at: float, x: float, y: float, yaw: float = 0.0) -> Any:
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id = parent
    made.header.stamp.sec, made.header.stamp.nanosec = divmod(START_NS + round(at * 1e9), 10**9)
    made.transform.translation.x, made.transform.translation.y = x, y
    made.transform.rotation.z, made.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return made


def circling(ahead: float = math.pi / 2, turn: float = 1.0) -> list[tuple[float, str, Any]]:
    """Half a turn on a circle of 2 m in 3 s."""
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


def test_a_chain_of_a_moving_and_a_static_frame_is_looked_up_at_any_time(evidence: MakeEvidence) -> None:
    came = evidence(LENS, *circling())
    angle = math.pi * 1.55 / 3  # between two stamps
    where = (2 * math.cos(angle) - 0.3 * math.sin(angle), 2 * math.sin(angle) + 0.3 * math.cos(angle), 0.0)
    check = expect_transform("map", "lens", at=1.55, translation=where, yaw=angle + math.pi / 2)
    assert check.judge(came).message == "as expected"


def test_all_checks_of_one_evidence_read_its_transforms_once(
    evidence: MakeEvidence, monkeypatch: pytest.MonkeyPatch
) -> None:
    read, buffers = motion.tree, list[Any]()

    def counted(given: Evidence) -> Any:
        buffers.append(read(given))
        return buffers[-1]

    monkeypatch.setattr(motion, "tree", counted)
    given = evidence()
    for _ in range(3):
        expect_transform("map", "base").judge(given)
    assert len(buffers) == 1
    given.release()
    expect_transform("map", "base").judge(given)
    assert len(buffers) == 2


def test_what_tf2_cannot_answer_is_said_in_its_words(evidence: MakeEvidence) -> None:
    verdict = expect_transform("map", "lens").judge(evidence(*circling()))
    assert '"lens" passed to lookupTransform argument source_frame does not exist' in verdict.message
    assert verdict.mistake == "a transform is missing or has wrong stamps"


def test_a_wrong_place_and_a_wrong_turn_are_named(evidence: MakeEvidence) -> None:
    verdict = expect_transform("base", "lens", translation=(0.3, 0.5, 0.0), yaw=1.0).judge(evidence(LENS))
    assert "lens is 0.50 m too far towards -y in base: y = 0.00 m, expected 0.50 m" in verdict.message
    assert "lens is turned by 0.00 rad about z, expected 1.00 rad" in verdict.message


def test_a_frame_that_goes_round_and_looks_ahead_passes(evidence: MakeEvidence) -> None:
    assert CIRCLE.judge(evidence(*circling())).message == "as expected"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ahead": 0.0}, "base is turned by 0.10 rad, expected the direction from the origin plus 1.57 rad"),
        ({"turn": -1.0}, "base goes clockwise (from above), expected counter-clockwise"),
        ({"turn": 0.5}, "one turn takes 12.00 s, expected 6.00 s"),
    ],
)
def test_a_circle_driven_otherwise_is_named(
    evidence: MakeEvidence, changes: dict[str, float], message: str
) -> None:
    assert message in CIRCLE.judge(evidence(*circling(**changes))).message


def test_what_never_moves_is_static_and_only_that(evidence: MakeEvidence) -> None:
    check = expect_transform("base", "lens", static=True)
    moving = (0.7, "/tf", TFMessage(transforms=[transform("base", "lens", 0.7, 0.3, 0.0)]))
    assert check.judge(evidence(LENS, *circling())).score == 1
    for came in (evidence(LENS, moving), evidence(moving)):
        verdict = check.judge(came)
        assert verdict.message == "lens is broadcast on /tf again and again, expected once on /tf_static"


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"radius": None, "period": 6.0, "heading": math.pi / 2}, "as expected"),
        ({"period": 6.0, "start": 0.0}, "base starts at the angle 0.10 rad, expected 0.00 rad"),
        ({"period": 6.0, "start": 0.1, "height": 0.0}, "as expected"),
        ({"height": 1.0}, "base is 1.00 m too low: z = 0.00 m, expected 1.00 m"),
    ],
)
def test_a_circle_may_be_asked_for_in_parts(
    evidence: MakeEvidence, wanted: dict[str, Any], message: str
) -> None:
    check = expect_circling_frame("map", "base", **{"radius": 2.0, **wanted})
    assert check.judge(evidence(*circling())).message == message


def test_one_pose_is_no_circle(evidence: MakeEvidence) -> None:
    verdict = CIRCLE.judge(evidence(*circling()[-1:]))
    assert verdict.message == "base was seen to move for 0.00 s of 3 s"


def test_another_parent_is_named(evidence: MakeEvidence) -> None:
    check = expect_circling_frame("world", "base", radius=2.0)
    assert check.judge(evidence(*circling())).message == "the parent of 'base' is 'map', expected 'world'"


def test_bytes_that_are_no_transforms_are_left_out(evidence: MakeEvidence) -> None:
    from std_msgs.msg import String

    came = evidence((1.0, "/tf", String(data="x")), *circling())
    assert CIRCLE.judge(came).message == "as expected"
