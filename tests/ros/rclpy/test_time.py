import pytest
from builtin_interfaces.msg import Duration as DurationMsg
from builtin_interfaces.msg import Time as TimeMsg
from rclpy.duration import Duration, Infinite
from rclpy.time import ClockType, Time


def test_times_and_durations_can_be_added() -> None:
    assert Time(seconds=1) + Duration(seconds=0.5) == Time(nanoseconds=1_500_000_000)
    assert Duration(seconds=0.5) + Time(seconds=1) == Time(nanoseconds=1_500_000_000)
    assert Time(seconds=2) - Duration(seconds=0.5) == Time(seconds=1.5)
    assert Time(seconds=1) - Time(seconds=3) == Duration(seconds=-2)


def test_times_of_different_clocks_cannot_be_mixed() -> None:
    ours, theirs = Time(), Time(clock_type=ClockType.ROS_TIME)
    with pytest.raises(TypeError, match=r"^Can't subtract times with different clock types$"):
        ours - theirs
    for compare in ("__eq__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__"):
        with pytest.raises(TypeError, match=r"^Can't compare times with different clock types$"):
            getattr(ours, compare)(theirs)


def test_time_has_system_time_by_default_and_ros_time_if_made_from_a_message() -> None:
    assert Time().clock_type is ClockType.SYSTEM_TIME
    assert Time.from_msg(TimeMsg()).clock_type is ClockType.ROS_TIME


def test_times_compare_and_print_as_in_ros() -> None:
    early, late = Time(seconds=1), Time(seconds=2)
    assert early < late <= late
    assert late > early
    assert late >= early
    assert early != late
    assert early != 1
    assert repr(early) == "Time(nanoseconds=1000000000, clock_type=SYSTEM_TIME)"
    assert late.seconds_nanoseconds() == (2, 0)


def test_out_of_range_times_are_rejected() -> None:
    with pytest.raises(ValueError, match="Seconds value must not be negative"):
        Time(seconds=-1)
    with pytest.raises(ValueError, match="Nanoseconds value must not be negative"):
        Time(nanoseconds=-1)
    with pytest.raises(OverflowError, match="Total nanoseconds value is too large to store in C time point"):
        Time(seconds=2**40)
    with pytest.raises(OverflowError, match="Addition leads to overflow in C storage"):
        Time(nanoseconds=2**63 - 1) + Duration(nanoseconds=1)
    with pytest.raises(ValueError, match="Subtraction leads to negative time"):
        Time() - Duration(nanoseconds=1)
    with pytest.raises(TypeError, match="Clock type must be a ClockType enum"):
        Time(clock_type=1)  # type: ignore[arg-type]  # the mistake under test


def test_durations_can_be_compared_but_not_added_in_jazzy() -> None:
    assert Duration(seconds=1) < Duration(seconds=2) <= Duration(seconds=2)
    assert Duration(seconds=1) == Duration(nanoseconds=10**9)
    assert Duration() != 0
    with pytest.raises(TypeError, match="unsupported operand"):
        Duration() + Duration()  # type: ignore[operator]  # the mistake under test


def test_durations_print_as_in_ros() -> None:
    assert repr(Duration(seconds=1)) == "Duration(nanoseconds=1000000000)"
    assert str(Duration(nanoseconds=5)) == "5 nanoseconds"
    assert str(Infinite) == "Infinite"
    with pytest.raises(OverflowError, match="too large to store in C duration"):
        Duration(nanoseconds=2**63)


def test_times_convert_to_messages_and_back() -> None:
    assert Time(nanoseconds=1_000_000_002).to_msg() == TimeMsg(sec=1, nanosec=2)
    assert Duration(nanoseconds=-1).to_msg() == DurationMsg(sec=-1, nanosec=999_999_999)
    assert Duration.from_msg(DurationMsg(sec=-1, nanosec=999_999_999)) == Duration(nanoseconds=-1)
    assert Time.from_msg(TimeMsg(sec=1, nanosec=2)).nanoseconds == 1_000_000_002
    with pytest.raises(TypeError, match=r"^Must pass a builtin_interfaces.msg.Time object$"):
        Time.from_msg(DurationMsg())  # type: ignore[arg-type]  # the mistake under test
    with pytest.raises(TypeError, match=r"^Must pass a builtin_interfaces.msg.Duration object$"):
        Duration.from_msg(TimeMsg())  # type: ignore[arg-type]  # the mistake under test
