import pytest
from geometry_msgs.msg import PoseStamped

from course_lib.real.check import are_equal_in_value, compare, move_stamps
from course_lib.ros.graph.graph import START_NS, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize


def _samples(values: list[float], at_ns: int, period_ns: int = 10**8) -> list[Sample]:
    samples = []
    for index, value in enumerate(values):
        pose = PoseStamped()
        stamp_ns = at_ns + index * period_ns
        pose.header.stamp.sec, pose.header.stamp.nanosec = divmod(stamp_ns, 10**9)
        pose.pose.position.x = value
        samples.append(Sample(stamp_ns, "/pose", "geometry_msgs/msg/PoseStamped", serialize(pose), Qos(), 1))
    return samples


def test_recordings_with_other_stamps_and_a_later_start_are_equal() -> None:
    values = [float(number) for number in range(10)]
    (comparison,) = compare(_samples(values, START_NS), _samples(values[2:], START_NS + 10**17))
    assert str(comparison) == "/pose: kit 10, ROS 8 messages; 8 of 8 pairs bit-equal"


def test_recording_of_a_fast_topic_may_begin_a_second_later() -> None:
    values = [float(number) for number in range(1000)]
    late = _samples(values[200:], START_NS, 5_000_000)
    (comparison,) = compare(_samples(values, START_NS, 5_000_000), late)
    assert str(comparison) == "/pose: kit 1000, ROS 800 messages; 800 of 800 pairs bit-equal"


def test_recordings_without_equal_messages_are_compared_from_the_start() -> None:
    (comparison,) = compare(
        _samples([1.0] * 400, START_NS, 5_000_000), _samples([2.0] * 400, START_NS, 5_000_000)
    )
    assert (comparison.equal, comparison.pairs) == (0, 400)


def test_different_value_is_reported_with_its_field() -> None:
    (comparison,) = compare(_samples([1.0, 2.0, 3.0], START_NS), _samples([1.0, 2.5, 3.0], START_NS))
    assert (comparison.equal, comparison.pairs, comparison.different_field) == (2, 3, "pose.position.x")


def test_topic_on_one_side_only_has_no_pairs() -> None:
    (comparison,) = compare([], _samples([1.0], START_NS))
    assert str(comparison) == "/pose: kit 0, ROS 1 messages"


@pytest.mark.parametrize(
    ("count", "last", "is_equal"), [(10, 9.0, True), (8, 7.0, True), (7, 6.0, False), (10, 20.0, False)]
)
def test_messages_with_the_values_of_the_kit_differ_in_time_only(
    count: int, last: float, is_equal: bool
) -> None:
    values = [float(number) for number in range(10)]
    in_ros = _samples([*values[: count - 1], last], START_NS)
    assert are_equal_in_value(compare(_samples(values, START_NS), in_ros)) == is_equal


def test_missing_messages_are_not_equal_in_value() -> None:
    assert not are_equal_in_value([])
    assert not are_equal_in_value(compare(_samples([1.0], START_NS), []))


def test_run_stamps_are_shifted_and_others_are_kept() -> None:
    pose = PoseStamped()
    pose.header.stamp.sec = 1_800_000_000
    move_stamps(pose, -5 * 10**9, 1_800_000_000 * 10**9)
    assert pose.header.stamp.sec == 1_799_999_995
    latest = move_stamps(PoseStamped(), -5 * 10**9, 1_800_000_000 * 10**9)
    assert latest.header.stamp.sec == 0
