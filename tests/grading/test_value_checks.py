from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from course_lib.grading import expect_text, expect_value
from course_lib.grading.evidence import Evidence
from course_lib.grading.run.outcome import RAISED, is_plain, plain
from course_lib.grading.run.scenario import run_in_this_process
from course_lib.grading.task import Call, Scenario, Task

MakeEvidence = Callable[..., Evidence]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.1 + 0.2, 0.3),
        (np.float32(0.5), 0.5),
        (3, 3.0),
        ([1, 2], (1.0, 2.0)),
        (np.array([[1, 2], [3, 4]]), [[1, 2], [3, 4]]),
        ([1.0, 2.0], np.array([1.0, 2.0])),
        ("map ", "map"),
        (True, True),
        ({"x": 1.0, "extra": 2}, {"x": 1.0}),
    ],
)
def test_equal_values_pass_in_every_supported_type(evidence: MakeEvidence, value: Any, expected: Any) -> None:
    assert expect_value(expected).judge(evidence(returns=(plain(value),))).score == 1


@pytest.mark.parametrize(
    ("expected", "value", "names"),
    [
        ([1.0, 2.0, 3.0], [1.0, 2.0, 4.0], ["z of the tip"]),
        ([[1.0, 2.0, 3.0]], [[5.0, 2.0, 4.0]], ["x of [0] of the tip", "z of [0] of the tip"]),
        ([0.0, 1.0, 0.0, 1.0], [0.5, 1.0, 0.0, 1.0], ["red of the tip"]),
        ([1.0, 2.0], [1.0, 4.0], ["[1] of the tip"]),
    ],
)
def test_wrong_number_of_a_point_is_reported_with_its_axis(
    evidence: MakeEvidence, expected: Any, value: Any, names: list[str]
) -> None:
    check = expect_value(expected, name="the tip", axes="x y z, red green blue alpha")
    message = check.judge(evidence(returns=(value,))).message
    assert [part.split(" is ")[0] for part in message.split("; ")] == names


def test_exchanged_axes_are_reported(evidence: MakeEvidence) -> None:
    check = expect_value([0.0, 0.0, 0.25], name="the centre", axes="x y z")
    message = check.judge(evidence(returns=([0.25, 0.0, 0.0],))).message
    assert message == "the centre is [0.25, 0.0, 0.0], expected [0.0, 0.0, 0.25]: x and z are exchanged"


ROWS = [["/scan", 10.0, 400.0], ["/imu", 5.0, 8.0]]
TABLE = expect_value(ROWS, name="the table", parts=("topic", "rate", "size"))


@pytest.mark.parametrize(
    ("row", "message", "mistake"),
    [
        (
            ["/scan", 12.0, 400.0],
            "the rate of row 0 of the table is 12.00, expected 10.00: 2.00 too much",
            "a value is wrong: the rate",
        ),
        (
            ["/scan", 10.0, -400.0],
            "the size of row 0 of the table is -400.00, expected 400.00: 800.00 too little",
            "a value has the wrong sign: the size",
        ),
        (
            ["/scan", 400.0, 10.0],
            "row 0 of the table is ['/scan', 400.0, 10.0], expected ['/scan', 10.0, 400.0]: the "
            "order is another one",
            "values are in the wrong order",
        ),
    ],
)
def test_message_states_the_wrong_part_of_a_row(
    evidence: MakeEvidence, row: list[Any], message: str, mistake: str
) -> None:
    verdict = TABLE.judge(evidence(returns=([row, ROWS[1]],)))
    assert (verdict.message, verdict.mistake) == (message, mistake)


def test_length_of_a_list_in_a_list_is_a_kind_of_its_own(evidence: MakeEvidence) -> None:
    verdict = expect_value([[1.0, 2.0]]).judge(evidence(returns=([[1.0]],)))
    assert verdict.mistake == "a list in a list has the wrong length"


@pytest.mark.parametrize(
    ("value", "expected", "message"),
    [
        (0.5, 0.8, "the value is 0.50 m, expected 0.80 m: 0.30 m too little"),
        (
            [2.0, 1.0],
            [1.0, 2.0],
            "the value is [2.0, 1.0], expected [1.0, 2.0]: the order is the other way round",
        ),
        ({}.items, 0.8, "the value is a builtin_function_or_method, expected a number: are its ( ) missing?"),
        ((x for x in [1.0]), [1.0], "the value is a generator, expected a list of 1: put it into list( )"),
        (
            {1.0, 2.0},
            [1.0, 2.0],
            "the value is a set, expected a list of 2: a set has no order, write [ ] instead of { }",
        ),
        (
            {"x": 1.0},
            [1.0],
            "the value is {'x': 1.0}, expected a list of 1: return the values alone, in order and "
            "without their names",
        ),
        (
            {"a": "b"},
            [["a", "b"]],
            "the value is {'a': 'b'}, expected a list of 1: a list of pairs is needed instead of a dict",
        ),
        (
            "1, 2",
            [1, 2],
            "the value is '1, 2', expected a list of 2: return the values themselves, not a string of them",
        ),
        (
            [1.0],
            1.0,
            "the value is [1.0], expected a number: take it out of its list, or call .ravel() on a "
            "column of numpy",
        ),
        (
            [1.0, 0.0],
            1.0,
            "the value is [1.0, 0.0], expected a number: is a matrix multiplied with * instead of @?",
        ),
        (1.116, 1.11603, "the value is 1.116 m, expected 1.11603 m: rounded to 3 digits"),
        (0.1, 0.1499, "the value is 0.10 m, expected 0.15 m: 0.0499 m too little"),
        (1.11599, 1.11603, "the value is 1.11599 m, expected 1.11603 m: 0.00 m too little"),
        (float("nan"), 0.8, "the value is nan m, expected 0.80 m"),
        (True, 1.0, "the value is True, expected a number"),
        (1, True, "the value is 1, expected True"),
        ([1, 2], [1, 2, 3], "the value has 2 items, expected 3: [1, 2]"),
        ([1, 2], [1, 3], "[1] of the value is 2.00 m, expected 3.00 m: 1.00 m too little"),
        ("odom", "map", "the value is 'odom', expected 'map'"),
        (None, 1.0, "the value is None, expected a number"),
        (object(), 1.0, "the value is a object, expected a number"),
        ({}, {"x": 1}, "the value has no 'x'"),
        ([1], [1, 2], "the value has 1 item, expected 2: [1]"),
        ([1, 2], [], "the value has 2 items, expected none: [1, 2]"),
        ([[1, 2]], [[1, 2], [3, 4]], "the value has 1 item, expected 2: [[1, 2]]"),
        ([], [1, 2], "the value has 0 items, expected 2"),
        ([["a" * 90]], [1, 2], "the value has 1 item, expected 2"),
        (
            [[1, 2]],
            [1, 2],
            "the value has 1 item, expected 2: [[1, 2]]: it is a list in a list, leave out the outer [ ]",
        ),
        (3.0, [3.0], "the value is 3.0, expected a list of 1"),
        (None, [], "the value is None, expected an empty list"),
        ([1], {"x": 1}, "the value is [1], expected a dict"),
    ],
)
def test_different_values_fail_with_the_difference(
    evidence: MakeEvidence, value: Any, expected: Any, message: str
) -> None:
    verdict = expect_value(expected, unit="m").judge(evidence(returns=(plain(value),)))
    assert (verdict.score, verdict.message) == (0, message)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (
            [[0.2], "red"],
            "the color of a bar is 'red', expected a list of 2: return the values "
            "themselves, not a string of them",
        ),
        ([[0.3], [0.0, 1.0]], "[0] of the size of a bar is 0.30, expected 0.20: 0.1000 too much"),
        ([[0.2]], "a bar has 1 item, expected 2: [[0.2]]"),
        (0.2, "a bar is 0.2, expected a list of 2"),
    ],
)
def test_named_components_of_a_value_are_reported_by_name(
    evidence: MakeEvidence, value: Any, message: str
) -> None:
    check = expect_value([[0.2], [0.0, 1.0]], name="a bar", parts=("size", "color"))
    assert check.judge(evidence(returns=(plain(value),))).message == message


@pytest.mark.parametrize(
    ("value", "expected", "message", "mistake"),
    [
        (50.0, 0.05, "1000 times too much", "a value is in another unit"),
        (-0.002, -0.2, "100 times too little", "a value is in another unit"),
        (5e8, 0.5, "1000000000 times too much", "a value is in another unit"),
        (63.75, 0.25, "255 times too much", "a value is in another unit"),
        (1.0, 0.0, "1.00 too much", "a value is wrong"),
        (3.0, 0.5, "2.50 too much", "a value is wrong"),
        (141.0, 141.03, "0.0300 too little", "a value is rounded"),
        (2.0, 1.5, "0.50 too much", "a value is wrong"),
        (141.0, 142.0, "1.00 too little", "a value is wrong"),
    ],
)
def test_wrong_unit_and_missing_fraction_are_distinguished_from_other_wrong_values(
    evidence: MakeEvidence, value: float, expected: float, message: str, mistake: str
) -> None:
    verdict = expect_value(expected).judge(evidence(returns=(value,)))
    assert (verdict.message.rpartition(": ")[2], verdict.mistake) == (message, mistake)


def test_wrong_sign_is_reported_without_the_value(evidence: MakeEvidence) -> None:
    assert expect_value(0.5).judge(evidence(returns=(-0.5,))).mistake == "a value has the wrong sign"


def test_each_call_has_its_own_expected_value(evidence: MakeEvidence) -> None:
    assert expect_value(2, call=1).judge(evidence(returns=(1, 2))).score == 1
    assert "nothing was returned" in expect_value(2, call=2).judge(evidence(returns=(1, 2))).message


def test_call_that_raised_fails_the_value_check() -> None:
    scenario = Scenario("public", calls=(Call(0), Call(1)))
    task = Task("week01.inverse", "1 / x", "function", "inverse", ("a", "b", "c"), (scenario,))
    evidence = run_in_this_process(task, scenario, lambda x: {"x": 1 / x}, {})
    answers: tuple[Any, ...] = (None, {}, RAISED, [], "", 0)
    for expected in answers:
        verdict = expect_value(expected).judge(evidence)
        assert (verdict.score, verdict.message) == (0, "the value is missing: the call raised an exception")
    assert expect_value({"x": 1}, call=1).judge(evidence).score == 1


def test_custom_object_is_not_accepted_as_a_dict(evidence: MakeEvidence) -> None:
    verdict = expect_value({}).judge(evidence(returns=(plain(object()),)))
    assert (verdict.score, verdict.message) == (0, "the value is a object, expected a dict")


@pytest.mark.parametrize("text", ["The fixed frame!", "it is  the FIXED-FRAME, I think"])
def test_text_with_the_expected_terms_in_any_wording_passes(evidence: MakeEvidence, text: str) -> None:
    assert expect_text("fixed frame", "map").judge(evidence(returns=(text,))).score == 1


@pytest.mark.parametrize("text", ["", "the fixed frames", None, 3])
def test_text_without_the_expected_terms_fails(evidence: MakeEvidence, text: Any) -> None:
    assert expect_text("fixed frame").judge(evidence(returns=(text,))).score == 0


def test_returned_value_is_limited_to_plain_data() -> None:
    deep: Any = []
    for _ in range(1000):
        deep = [deep]
    assert is_plain(plain(deep))
    assert is_plain(plain(10**5000))
    assert len(str(plain(np.zeros(10**7)))) < 100
    assert plain({1: (2, "\ud800")}) == {"1": [2, "?"]}


@pytest.mark.parametrize("value", [b"bytes", {1: 2}, (1,), object(), [[set()]]])
def test_non_plain_value_is_rejected(value: Any) -> None:
    assert not is_plain(value)


@pytest.mark.parametrize("value", [1e300, -1e300, 1.7e308, 10**18])
def test_number_with_hundreds_of_digits_is_abbreviated(value: float) -> None:
    verdict = expect_value(2.0, unit="m").judge(Evidence("week01.t", "public", 1.0, returns=(value,)))
    assert "e+" in verdict.message
    assert len(verdict.message) < 80


def test_nested_item_is_reported_as_an_index() -> None:
    check = expect_value([[1, 2], {"a": [3]}], name="a bar")
    verdict = check.judge(Evidence("week01.t", "public", 1.0, returns=([[1, 5], {"a": [4]}],)))
    assert verdict.message == (
        "[0][1] of a bar is 5, expected 2: 3 too much; [1]['a'][0] of a bar is 4, expected 3: 1 too much"
    )


@pytest.mark.parametrize(
    ("value", "score"),
    [
        ([-1.2, 0.5], 1),
        ([-1.2 + 2 * np.pi, 0.5], 1),
        # Beyond the limit of the joint.
        ([-1.2 - 2 * np.pi, 0.5], 0),
        ([-1.2, 0.5 - 2 * np.pi], 0),
        ([True, 0.5], 0),
        ([-1.2], 0),
        ([], 0),
    ],
)
def test_joint_angle_may_differ_by_a_full_turn(
    evidence: MakeEvidence, value: list[float], score: float
) -> None:
    check = expect_value([-1.2, 0.5], unit="rad", angles=(0,))
    assert check.judge(evidence(returns=(plain(value),))).score == score
