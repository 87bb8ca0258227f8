from collections.abc import Callable
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from std_msgs.msg import Float64
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import (
    expect_circle,
    expect_frame,
    expect_marker,
    expect_message,
    expect_rate,
    expect_stamps,
    expect_throughout,
    expect_topic,
)
from course_lib.grading.evidence import Evidence
from course_lib.ros.graph.graph import START_NS

MakeEvidence = Callable[..., Evidence]
MakeCube = Callable[..., Any]

KIND = "std_msgs/msg/Float64"


def ticks(*times: float) -> list[tuple[float, str, Any]]:
    return [(at, "/tick", Float64(data=float(at))) for at in times]


def test_topic_with_the_expected_type_passes(evidence: MakeEvidence) -> None:
    assert expect_topic("/tick", KIND, at_least=2).judge(evidence(*ticks(1, 2))).score == 1
    assert (
        "expected at least 3" in expect_topic("/tick", KIND, at_least=3).judge(evidence(*ticks(1, 2))).message
    )
    assert (
        "expected at most 1" in expect_topic("/tick", KIND, at_most=1).judge(evidence(*ticks(1, 2))).message
    )
    assert (
        "carries std_msgs/msg/Float64"
        in expect_topic("/tick", "std_msgs/msg/String").judge(evidence(*ticks(1))).message
    )


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ((1, 2, 3), "as expected"),
        ((1, 1, 2, 3), "as expected"),
        (
            (1, 1, 2, 2, 3, 3),
            "2 messages with the same names and ids are published on /tick at 3.00 s, expected one",
        ),
        ((0.5, 1, 1.5, 2, 2.5, 3), "/tick is too fast: 2.00 Hz, expected 1.00 Hz"),
        ((0, 2), "/tick is too slow: 0.50 Hz, expected 1.00 Hz"),
        ((2.5, 3.0, 3.5), "/tick is too fast: 2.00 Hz, expected 1.00 Hz"),
        ((2.05, 3.0), "/tick is silent from 0.00 s to 2.05 s"),
        ((0.1, 0.2, 0.3, 2.9), "/tick is silent from 0.30 s to 2.90 s"),
        ((1,), "/tick was published once in 3 s, expected 1.00 Hz"),
        ((0, 0.98), "/tick is silent from 0.98 s to 3.00 s"),
        ((), "nothing was published on /tick in 3 s, nor on any other topic"),
    ],
)
def test_rate_is_measured_over_the_whole_scenario(
    evidence: MakeEvidence, times: tuple[float, ...], message: str
) -> None:
    assert expect_rate("/tick", 1.0).judge(evidence(*ticks(*times))).message == message


@pytest.mark.parametrize(
    ("begin", "end", "message"),
    [
        (0.0, 3.0, "as expected"),
        (4.0, None, "/tick is too fast: 2.00 Hz, expected 1.00 Hz"),
        (3.1, 3.9, "nothing was published on /tick from 3.1 to 3.9 s"),
    ],
)
def test_rate_may_be_measured_over_a_time_range(
    evidence: MakeEvidence, begin: float, end: float | None, message: str
) -> None:
    recorded = evidence(*ticks(1, 2, 3, 4, 4.5, 5), seconds=5.0)
    assert expect_rate("/tick", 1.0, begin=begin, end=end).judge(recorded).message == message


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ((1.0, 2.0, 3.0), "as expected"),
        ((1.5, 3.0), "as expected"),
        ((3.0,), "/tick was published only once in 3 s, expected messages the whole time"),
        ((1.5,), "/tick was published only once in 3 s, expected messages the whole time"),
        (
            (0.0, 3.0),
            "/tick is silent from 0.00 s to 3.00 s, expected messages all the time, at most 1.55 s apart",
        ),
    ],
)
def test_silence_of_more_than_half_of_a_scenario_is_rejected(
    evidence: MakeEvidence, times: tuple[float, ...], message: str
) -> None:
    assert expect_throughout("/tick").judge(evidence(*ticks(*times))).message == message


def test_list_items_are_addressed_by_index_in_a_field_path(evidence: MakeEvidence) -> None:
    array = DiagnosticArray(status=[DiagnosticStatus(name="a"), DiagnosticStatus(name="b")])
    recorded = evidence((1.0, "/diagnostics", array))
    assert expect_message("/diagnostics", {"status.1.name": "b"}).judge(recorded).score == 1
    message = expect_message("/diagnostics", {"status.2.name": "b"}).judge(recorded).message
    assert message == "status.2.name is None, expected 'b'"


@pytest.mark.parametrize(
    ("stamp_s", "message"),
    [
        (1.0, "as expected"),
        (0.0, "header.stamp on /m is 1.00 s in the past"),
        (3.0, "header.stamp on /m is 2.00 s in the future"),
        (-START_NS / 1e9, "header.stamp on /m is not set"),
    ],
)
def test_header_stamps_must_equal_the_publishing_time(
    evidence: MakeEvidence, cube: MakeCube, stamp_s: float, message: str
) -> None:
    marker = cube(header__stamp__sec=int(START_NS // 10**9 + stamp_s))
    assert expect_stamps("/m").judge(evidence((1.0, "/m", marker))).message.startswith(message)


@pytest.mark.parametrize(
    ("stamp_s", "message"),
    [
        (3.0, "as expected"),
        (4.0, "header.stamp on /m is 1.00 s later than the stamp of the input"),
        (2.0, "header.stamp on /m is 1.00 s earlier than the stamp of the input"),
        (-START_NS / 1e9, "header.stamp on /m is not set"),
    ],
)
def test_header_stamps_must_equal_the_stamps_of_a_delayed_input(
    evidence: MakeEvidence, cube: MakeCube, stamp_s: float, message: str
) -> None:
    marker = cube(header__stamp__sec=int(START_NS // 10**9 + stamp_s))
    check = expect_stamps("/m", delay=1.0)
    assert check.judge(evidence((4.0, "/m", marker))).message.startswith(message)


def test_fields_of_the_last_message_are_compared(evidence: MakeEvidence, cube: MakeCube) -> None:
    fields = {"header.frame_id": "map", "scale.x": 1.0}
    assert expect_message("/m", fields).judge(evidence((1, "/m", cube()))).score == 1
    wrong = expect_message("/m", fields, unit="m").judge(evidence((1, "/m", cube(scale__x=1.5))))
    assert wrong.message == "scale.x is 1.50 m, expected 1.00 m: 0.50 m too much"


def test_message_type_without_a_header_fails_the_check(evidence: MakeEvidence, cube: MakeCube) -> None:
    mixed = evidence((1, "/m", Float64(data=1.0)), (2, "/m", cube()))
    assert expect_stamps("/m").judge(mixed).message == "std_msgs/msg/Float64 on /m has no header"
    assert expect_circle("/m", radius=1.0).judge(mixed).score == 0
    assert expect_marker("/m", type="CUBE").judge(mixed).score == 1


def test_every_marker_must_be_in_the_expected_frame(evidence: MakeEvidence, cube: MakeCube) -> None:
    gone = cube(action=Marker.DELETE, header__frame_id="")
    here, there = cube(), cube(id=1, header__frame_id="odom")
    for arrays, message in (
        ([[here], [here, gone]], "as expected"),
        ([[here, there], [here]], "a Marker on /m is in frame 'odom', expected 'map'"),
        ([[gone]], "no marker is added on /m"),
    ):
        recorded = evidence(*((1.0, "/m", MarkerArray(markers=array)) for array in arrays))
        assert expect_frame("/m", "map").judge(recorded).message == message
    assert "has no header" in expect_frame("/tick", "map").judge(evidence(*ticks(1))).message


def test_empty_marker_array_fails_the_stamp_check(evidence: MakeEvidence) -> None:
    assert expect_stamps("/m").judge(evidence((1, "/m", MarkerArray()))).score == 0


def test_invalid_message_bytes_fail_the_rate_check(evidence: MakeEvidence) -> None:
    from dataclasses import replace

    recorded = evidence(*ticks(1, 2, 3))
    broken = replace(recorded, samples=tuple(replace(sample, cdr=b"") for sample in recorded.samples))
    for check in (expect_rate("/tick", 1.0), expect_topic("/tick", KIND)):
        assert check.judge(recorded).score == 1
        assert check.judge(broken).score == 0


def test_stamp_difference_is_reported_in_seconds(evidence: MakeEvidence, cube: MakeCube) -> None:
    check = expect_message("/cubes", {"header.stamp.nanosec": 520_000_000})
    late = check.judge(evidence((1, "/cubes", cube(header__stamp__nanosec=700_000_000))))
    assert late.message == (
        "the fraction of a second in header.stamp is 0.70 s, expected 0.52 s: 0.18 s too much"
    )
    assert check.judge(evidence((1, "/cubes", cube(header__stamp__nanosec=520_000_000)))).score == 1
    assert check.judge(evidence((1, "/cubes", cube(header__stamp__nanosec=520_000_001)))).score == 0


def lamps(*rows: tuple[float, int]) -> list[tuple[float, str, Any]]:
    return [(at, "/lamps", Marker(ns="lamp", id=number)) for at, number in rows]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([(at, number) for at in (1, 2, 3) for number in (0, 1)], "as expected"),
        # Two timers of the same period, which do not start together.
        ([(at + number / 2, number) for at in (0.4, 1.4, 2.4) for number in (0, 1)], "as expected"),
        # A node that gives each message a new id.
        ([(1, 0), (2, 1), (3, 2)], "as expected"),
        (
            [(1, 0), (2, 1), (3, 0), (4, 1)],
            "the marker lamp/0 is too slow: 0.50 Hz, expected 1.00 Hz: the markers take turns",
        ),
        ([(at / 2, 0) for at in range(1, 9)], "the marker lamp/0 is too fast: 2.00 Hz, expected 1.00 Hz"),
    ],
)
def test_rate_of_each_marker(evidence: MakeEvidence, rows: list[tuple[float, int]], message: str) -> None:
    check = expect_rate("/lamps", 1.0, by_marker=True)
    assert check.judge(evidence(*lamps(*rows), seconds=max(at for at, _ in rows))).message == message
